"""An arm carried slim touches nothing, and so the robot comes where it is too wide with its arm parked."""

import numpy as np
import pytest

from predicates.case import Case
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from sdt_kg.state import Interval, Region
from sdt_kg.task import Task, Verb
from services.embodiment.body.demands import Margins
from services.embodiment.body.parked import Parked
from services.embodiment.body.world import World
from services.embodiment.certify.check import Certified, certify
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.kit import Kits
from services.embodiment.oracle import WholeBody
from services.embodiment.ways.slim import slim
from services.physics.model import Scene
from services.physics.oracle import Kinematics

pytestmark = pytest.mark.oracle

DOOR = "wardrobe_door_left"
"""Behind a strait of kitchen a that the PR2 does not pass with its arms parked."""


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_a_slim_posture_is_free_of_the_robot_and_of_the_floor_within_limits(robot: str) -> None:
    twin = load_twin("b", [robot])
    world = World(Scene(twin, twin.robots[0]))
    kit = Kits(world, Margins()).of(world.scene.annotation.grippers[0])
    found = slim(world, kit.limb, kit.opened)
    np.testing.assert_array_equal(found, slim(world, kit.limb, kit.opened))
    assert (found[:3] == 0.0).all()
    assert (found[3:] >= kit.limb.lower[3:]).all()
    assert (found[3:] <= kit.limb.upper[3:]).all()
    start = np.array([twin.kitchen().start])
    assert Parked(world, kit.limb.q(found), kit.opened).stands(start).all()
    there = found.copy()
    there[:3] = start
    assert world.free(kit.limb.q(there), kit.opened)


def test_pr2_drives_with_an_arm_slim_where_it_is_too_wide_and_starts_parked() -> None:
    twin = load_twin("a", ["pr2"])
    container = twin.container(DOOR)
    goal = Region(((container.joint, Interval(container.open_from, container.upper)),))
    motion = next(Kinematics().generate(twin, goal))
    body = WholeBody(drive=Drive.OMNI)
    answer = body.perform(Case(twin, twin.robots[0], Task(Verb.OPEN, container.iri), motion))
    found = answer.case.body_motion
    assert answer.holds, answer.diagnoses
    assert isinstance(found, BodyMotion)
    start = body.start_pose(answer.case)
    judged = certify(twin, twin.robots[0], found, container, Tolerances(), drive=Drive.OMNI, start=start)
    assert isinstance(judged, Certified)
    moves = np.linalg.norm(np.diff(found.base[:, :2], axis=0), axis=1) > 0
    first = int(np.flatnonzero(moves)[0])
    assert np.abs(found.q[first] - found.q[0]).max() > 0.5
    assert (
        np.ptp(found.q[first : dict(found.phases)["approach"]], axis=0)[np.abs(found.q[first]) > 0.2].max()
        < 1e-9
    )
