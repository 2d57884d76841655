"""Where a descent is in vain: when it ends, and what a refusal says of it."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Kind
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.motion import Motion
from services.embodiment.body.demands import Margins
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.descent.depths import unmoved
from services.embodiment.descent.descended import STARTS, Descended
from services.embodiment.hold.kit import Kits
from services.embodiment.search.plan import LAST, Planner
from services.embodiment.search.report import refusal, searched
from services.embodiment.setting import Setting
from services.embodiment.ways.roads import Known
from services.kernel import worked
from services.physics.generate import HINGE_DEPTH
from services.physics.model import Scene
from tests.soak.doors import draw, write

pytestmark = pytest.mark.oracle

HERE, FAR = (0.0, 0.0, 0.0), (-5.0, 0.0, 0.0)
DOOR_AT_BASE = 261
"""A door that comes too near to a TIAGo++'s base at the end of its way."""
NO_HAND_FITS = 40
BUDGET = 100.0  # [s]


def planner_of(seed: int, folder: Path, start: tuple[float, float, float], budget: float) -> Planner:
    """Who plans to open a front, and has looked for nothing as yet."""
    twin = load_twin(write(draw(np.random.default_rng(seed)), folder, "front"), ["tiago_dual"])
    world, container = World(Scene(twin, twin.robots[0])), twin.container("front_door")
    ends = np.array([[0.0], [container.open_from + HINGE_DEPTH]])
    motion = Motion(container.joint, np.array([0.0, 1.0]), ends, timed=False)
    own = Kits(world, Margins()), Known(), Tolerances()
    setting = Setting(world, container, motion, Drive.FIXED, start, twin.robots[0], *own)
    planner = Planner(setting, worked() + budget, 0, lambda _step, _since: None)
    planner.attempts = [one for kit in planner.kits() if (one := planner.attempt(kit)) is not None]
    assert len(planner.attempts) == 2
    return planner


def said(planner: Planner) -> list[str]:
    """What a refusal says of the descents."""
    found = refusal(planner, [], searched(planner, 1.0), BUDGET)
    assert {one.kind for one in found} == {Kind.EMBODIMENT}
    return [one.reason for one in found if "by descent" in one.reason]


def test_where_the_door_comes_into_what_no_arm_moves_nothing_is_started(tmp_path: Path) -> None:
    planner = planner_of(DOOR_AT_BASE, tmp_path, HERE, BUDGET)
    before = searched(planner, 0.0).seeds
    planner.descended = descended = Descended(planner)
    assert not list(descended.plans(*LAST))
    assert searched(planner, 0.0).seeds == before
    assert said(planner) == [
        f"holds were looked for by descent: gripper {gripper} has none with front_door at 1.45 rad: "
        "base_link is too near to front_door there wherever the arm is"
        for gripper in ("left", "right")
    ]


def test_what_is_in_contact_wherever_the_arm_is_is_found_at_its_value(tmp_path: Path) -> None:
    planner = planner_of(DOOR_AT_BASE, tmp_path, HERE, BUDGET)
    last = float(planner.setting.motion.values[-1, 0])
    limb, mechanics, world = planner.attempts[0].limb, planner.mechanics, planner.setting.world
    contact = unmoved(limb, mechanics, np.array(HERE), np.linspace(0.0, last, 5))
    assert contact is not None
    assert contact.index == 4
    for value, touches in ((last, True), (0.75 * last, False)):
        q = mechanics.put(world.scene.q(HERE, {}), np.array([value]))[0]
        apart = world.distance(contact.shapes, *world.frames(q))
        assert (apart < world.scene.annotation.overhang) == touches
    assert unmoved(limb, mechanics, np.array(FAR), np.linspace(0.0, last, 5)) is None


def test_a_gripper_is_out_once_holds_reach_no_farther(tmp_path: Path) -> None:
    planner = planner_of(NO_HAND_FITS, tmp_path, FAR, BUDGET)
    planner.descended = descended = Descended(planner)
    assert not list(descended.plans(*LAST))
    assert not planner.late()
    assert searched(planner, 0.0).seeds == 2 * LAST[1] * STARTS
    last = float(planner.setting.motion.values[-1, 0])
    assert said(planner) == [
        f"holds were looked for by descent: gripper {gripper} has none with front_door at 0 to {last:.3g} rad"
        for gripper in ("left", "right")
    ]


def test_nothing_is_started_once_the_budget_is_spent(tmp_path: Path) -> None:
    planner = planner_of(NO_HAND_FITS, tmp_path, HERE, 0.0)
    planner.descended = descended = Descended(planner)
    assert not list(descended.plans(*LAST))
    assert searched(planner, 0.0).seeds == 0
    assert said(planner) == []


def test_where_no_grasp_that_is_reached_fits_a_refusal_says_what_is_too_near(tmp_path: Path) -> None:
    planner = planner_of(NO_HAND_FITS, tmp_path, HERE, BUDGET)
    world, tally = planner.setting.world, planner.attempts[0].searcher.tally
    tally.grasps = tally.solved = 1
    (door, *_), (palm, *_) = (
        world.shapes_of(bodies).tolist()
        for bodies in ((planner.setting.container.iri,), tuple(planner.attempts[0].limb.palm))
    )
    planner.unfit.clear()
    planner.unfit[palm, door] = 1
    first, *_ = refusal(planner, [], searched(planner, 1.0), BUDGET)
    assert "no posture that reaches the handle is free of contact, most often because" in first.reason
    assert first.reason.endswith("is too near to front_door")
