"""A door that no one hold opens, from where the base stands: in several, judged by other code too."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Outcome, Verdict
from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion, Motion
from services.app import Policy, Service, load
from services.embodiment import plan
from services.embodiment.oracle import WholeBody
from services.motions import arrays_of, motion_of
from tests.soak.annotated import Note
from tests.soak.audit import Stage, audited
from tests.soak.doors import draw, write
from tests.soak.test_audit import COARSE, NO_LESS, bundled, machine

pytestmark = pytest.mark.oracle

HERE = (0.0, 0.0, 0.0)
LASTS_NOT = 34
"""A door 0.92 m away that a TIAGo++ holds at each angle, and in no way that it can keep."""
BUDGET = 60.0  # [s]


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(draw(np.random.default_rng(LASTS_NOT)), tmp_path_factory.mktemp("front"), "front")


@pytest.fixture(scope="module")
def service(path: Path) -> Service:
    return load(path, ["tiago_dual"], policy=Policy(Drive.FIXED, HERE, BUDGET))


@pytest.fixture(scope="module")
def found(service: Service) -> Verdict:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plan, "FIRST", (0, 0))  # holds by descent open it too
        (verdict,) = service.achieve("open:front_door")
    return verdict


def body_of(verdict: Verdict) -> BodyMotion:
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses
    assert verdict.can_perform is not None
    body = verdict.can_perform.case.body_motion
    assert isinstance(body, BodyMotion)
    return body


def test_it_is_certified_in_several_holds_and_says_so(found: Verdict) -> None:
    body = body_of(found)
    assert found.can_perform is not None
    assert found.can_perform.figures["holds"] == (2.0, "1")
    assert any("let go on the way: front_door is held from" in note for note in found.can_perform.notes)
    names = [name for name, _ in body.phases]
    assert names[:6] == ["drive", "approach", "grasp", "follow", "let go", "leave"]
    assert names[-1] == "follow 2"
    assert len(set(names)) == len(names)


def test_its_motion_of_the_door_is_that_of_the_body(found: Verdict) -> None:
    body = body_of(found)
    assert found.can_perform is not None
    motion = found.can_perform.case.motion
    assert isinstance(motion, Motion)
    begin = body.times[dict(body.phases)["follow"]]
    column = body.kitchen_joints.index(motion.of)
    follows = np.interp(begin + motion.times, body.times, body.kitchen_q[:, column])
    np.testing.assert_allclose(motion.values[:, 0], follows, atol=1e-6)


def test_nothing_jumps_where_one_part_follows_another(found: Verdict) -> None:
    body = body_of(found)
    for _, sample in body.phases[1:]:
        for q, v in ((body.base, body.base_v), (body.q, body.v), (body.kitchen_q, body.kitchen_v)):
            assert np.abs(v[sample]).max(initial=0.0) < 1e-9
            assert np.abs(q[sample] - q[sample - 1]).max(initial=0.0) < 0.2


def test_who_shares_no_code_with_it_finds_no_rule_broken(found: Verdict, path: Path) -> None:
    robot = (bundled("robots", "tiago_dual", suffix) for suffix in (".urdf", ".ttl"))
    stage = Stage(
        machine(path, True),
        machine(next(robot), False),
        Note(next(robot)),
        {},
        {},
        "front_door_joint",
        "front_handle",
        "open",
        "fixed",
        HERE,
    )
    slack = audited(stage, arrays_of(body_of(found)), COARSE).slack
    assert {rule: one for rule, one in slack.items() if one < NO_LESS} == {}


def test_it_is_certified_again_when_somebody_gives_it(service: Service, found: Verdict) -> None:
    given = motion_of(arrays_of(body_of(found)), service.twin)
    (verdict,) = service.achieve("open:front_door", motion=given)
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses


def test_where_one_hold_is_asked_for_it_is_refused(service: Service, found: Verdict) -> None:
    assert found.can_perform is not None
    answer = WholeBody(Drive.FIXED, HERE, regrasps=False).perform(found.can_perform.case)
    assert not answer.holds
    assert any("is let go at" in each.reason for each in answer.diagnoses)
