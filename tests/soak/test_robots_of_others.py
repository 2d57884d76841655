"""Robots that others published, as `sdt robot describe` guesses them: what they open, against the audit.

`SDT_MODELS` is a folder into which wheels of PyPI were unpacked, example-robot-data 6.0.0 and mani_skill
3.0.1; what is not there is skipped.
"""

import os
from pathlib import Path

import pytest

import kitchens
from predicates.case import Outcome
from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion
from services.app import Policy, load
from services.cli import run
from services.embodiment.setting import container_of
from services.motions import arrays_of
from tests.soak.annotated import Note, accelerations
from tests.soak.audit import Stage
from tests.soak.test_audit import broken_rules, machine

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

TIAGO_PRO = "**/tiago_pro_description/robots/tiago_pro.urdf"
FETCH = "**/assets/robots/fetch/fetch.urdf"


@pytest.mark.parametrize(
    "asked",
    [
        (TIAGO_PRO, Drive.DIFFERENTIAL, "a", 26),
        (TIAGO_PRO, Drive.DIFFERENTIAL, "b", 17),
        (FETCH, Drive.OMNI, "a", 26),
        (FETCH, Drive.OMNI, "b", 17),
    ],
)
def test_a_robot_as_it_is_described_opens_what_others_do(
    tmp_path: Path, asked: tuple[str, Drive, str, int]
) -> None:
    pattern, drive, kitchen, opened = asked
    folder = Path(os.environ.get("SDT_MODELS", "nowhere"))
    urdf = next(iter(sorted(folder.glob(pattern))), None)
    if urdf is None:
        pytest.skip(f"no {pattern} below $SDT_MODELS")
    annotation = tmp_path / "robot.ttl"
    assert run(["robot", "describe", str(urdf), "-o", str(annotation)]) == 0
    service = load(kitchen, [urdf], annotation=annotation, policy=Policy(drive))
    certified = [each for each in service.achieve("open") if each.outcome is Outcome.CERTIFIED]
    assert len(certified) == opened
    ours = kitchens.path(kitchen)
    world, robot, note = machine(ours / f"{kitchen}.urdf", True), machine(urdf, False), Note(annotation)
    limits = accelerations(ours / f"{kitchen}.ttl")
    for verdict in certified:
        one, motion = container_of(verdict.case), verdict.case.body_motion
        assert isinstance(motion, BodyMotion)
        names = (each.rsplit("/", 1)[1] for each in (one.joint, one.handle))
        stage = Stage(world, robot, note, limits, {}, *names, "open", drive.value)
        assert broken_rules(stage, arrays_of(motion)) == {}, one.name
