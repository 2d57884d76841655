"""Certified motions before random fronts, among random obstacles, against an audit that shares no code.

Opening and closing from anywhere on the way, as hardware moves and in the paper's set-up. `make soak`;
SDT_WORLDS asks for fewer.
"""

import os
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Outcome
from predicates.record import to_json
from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion
from services.app import Policy, load
from services.motions import arrays_of
from tests.soak.doors import SWING, Front, draw, urdf
from tests.soak.judge import ROBOTS, STANDS
from tests.soak.test_audit import broken_rules, bundled, stage

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

WORLDS = int(os.environ.get("SDT_WORLDS", "50"))
BUDGET = 5.0  # [s] of search for one case
ROOM = 0.75  # [m] about the robot's start, in which no obstacle has its middle


@pytest.mark.parametrize("robot", ROBOTS)
def test_no_motion_certified_in_a_random_world_is_refuted(tmp_path: Path, robot: str) -> None:
    odd, certified = dict[str, dict[str, float]](), 0
    for seed in range(WORLDS):
        rng = np.random.default_rng(seed)
        front = draw(rng)
        path = tmp_path / f"world{seed}.urdf"
        path.write_text(urdf(front).replace("</robot>", f"{obstacles(front, rng)}</robot>"))
        begin = float(rng.uniform(0, 0.8)) * (front.travel if front.kind == "drawer" else SWING)
        for goal in ("open", "close"):
            for drive in (Drive.OMNI, None):
                broken = _broken(path, robot, (goal, begin, drive))
                certified += broken is not None
                if broken:
                    odd[f"{seed} {goal} {drive}"] = broken
    assert odd == {}
    assert certified > WORLDS


def _broken(path: Path, robot: str, asked: tuple[str, float, Drive | None]) -> dict[str, float] | None:
    """Rules that the certified motion breaks, and by how much; None where none is certified."""
    goal, begin, drive = asked
    state = (f"front_door={begin!r}",)
    service = load(path, [robot], state=state, policy=Policy(drive, STANDS, BUDGET))
    (verdict,) = service.achieve(f"{goal}:front_door")
    if verdict.outcome is not Outcome.CERTIFIED:
        return None
    motion = verdict.case.body_motion
    assert isinstance(motion, BodyMotion)
    about = {"kitchen": path.stem, "robot": robot, "verb": goal, "drive": to_json(verdict)["drive"]}
    judged = stage(path, bundled("robots", robot, ".urdf"), about, "front_door", state)
    return broken_rules(judged, arrays_of(motion))


def obstacles(front: Front, rng: np.random.Generator) -> str:
    """Two to four boxes, rods or balls about the handle, turned anyhow, as links of the front's root."""
    x, y, _ = front.handle
    return "".join(_obstacle(k, (x, y), rng) for k in range(int(rng.integers(2, 5))))


def _obstacle(k: int, handle: tuple[float, float], rng: np.random.Generator) -> str:
    x, y = rng.uniform(-0.8, handle[0] + 0.3), rng.uniform(handle[1] - 1.2, handle[1] + 1.2)
    farther = max(1.0, ROOM / max(float(np.hypot(x, y)), 0.05))
    a, b, c = rng.uniform(0.03, 0.3, 3)
    shapes = (
        f'<box size="{a} {b} {c}"/>',
        f'<cylinder radius="{a / 2}" length="{c}"/>',
        f'<sphere radius="{a / 2}"/>',
    )
    at, turned = (
        f"{x * farther} {y * farther} {rng.uniform(0.05, 1.8)}",
        " ".join(map(str, rng.uniform(-3, 3, 3))),
    )
    return (
        f'<link name="thing{k}"><collision><geometry>{shapes[rng.integers(3)]}</geometry></collision></link>'
        f'<joint name="thing{k}_joint" type="fixed"><parent link="world"/><child link="thing{k}"/>'
        f'<origin xyz="{at}" rpy="{turned}"/></joint>'
    )
