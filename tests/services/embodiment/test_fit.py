"""Grasps that a hand alone can take: its fingers touch the handle, whatever was closed before."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.iri import body_iri
from services.embodiment.certify.held.grip import Grip
from services.embodiment.certify.sweep.kinematics import Kinematics
from services.embodiment.certify.sweep.shapes import Shapes
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.fit import OPENINGS, Fitted
from services.embodiment.hold.grasp import TOUCH, Grasp
from services.embodiment.hold.sets import FREE_MOST
from tests.services.embodiment.front import Front, free_grasp, front

pytestmark = pytest.mark.oracle

FRONT, WAYPOINTS = 14, 7
ROBOTS = ("pr2", "tiago_dual", "stretch")
FAR_NUMBER = 90_000  # of grasps that no set has


def gap(seen: Front, grasp: Grasp, rest: np.ndarray) -> float:
    """Distance of the fingers from the handle [m], the hand where the grasp has it, by coal."""
    world, kit, problem = seen.world, seen.kit, seen.problem
    tool_r, tool_p = grasp.tool(problem.handle_r[0], problem.handle_p[0])
    frames_r, frames_p = world.frames(rest)
    own_r, own_p = kit.limb.tool(np.zeros(len(kit.limb.lower)))
    turn = tool_r @ own_r.T
    moved = {int(world.boxes[0][one]) for one in kit.hand.fingers}
    for joint in moved:
        frames_r[joint], frames_p[joint] = turn @ frames_r[joint], turn @ (frames_p[joint] - own_p) + tool_p
    bars = world.shapes_of((problem.mechanics.container.handle,))
    return min(
        world.distance((int(finger), int(bar)), frames_r, frames_p)
        for finger in kit.hand.fingers
        for bar in bars
    )


@pytest.mark.parametrize("robot", ROBOTS)
def test_fingers_that_are_closed_touch_the_handle_and_are_not_in_it(tmp_path: Path, robot: str) -> None:
    seen = front(tmp_path, FRONT, robot, WAYPOINTS)
    fitted = [*seen.fitter.fitting()][::10]
    assert len(fitted) > 3
    for grasp, rest in fitted:
        assert -1e-6 <= gap(seen, grasp, rest) <= TOUCH + 1e-6


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_grasp_closes_alike_whatever_was_closed_before(tmp_path: Path, robot: str) -> None:
    fitter = front(tmp_path, FRONT, robot, WAYPOINTS).fitter
    after_others = {grasp.index: (grasp, rest) for grasp, rest in fitter.fitting()}
    other = front(tmp_path, FRONT, robot, WAYPOINTS).fitter
    steep = {grasp.index: (grasp, rest) for grasp, rest in other.fitting(steep=True)}
    assert steep.keys() == after_others.keys()
    for index, (grasp, rest) in after_others.items():
        np.testing.assert_allclose(steep[index][0].translation, grasp.translation, atol=2 * TOUCH)
        np.testing.assert_allclose(steep[index][1], rest, atol=0.02)


def gripped(seen: Front, grasp: Grasp, rest: np.ndarray) -> Grip:
    """What certification says of the hand, to which the handle comes."""
    world, scene, limb, joint = seen.world, seen.world.scene, seen.kit.limb, seen.fitter.bar.joint
    moving = np.append(np.flatnonzero(seen.kit.hand.closing[1].any(axis=0)), joint - 1)
    kinematics = Kinematics(scene, rest, moving)
    placed = kinematics.place(rest[moving][None], np.zeros((1, len(moving))))
    (frames_r, frames_p), (tool_r, tool_p) = world.frames(rest), limb.tool(np.zeros(len(limb.lower)))
    handle_r = tool_r @ grasp.rotation.T
    turn = handle_r @ frames_r[joint].T
    shift = tool_p - handle_r @ grasp.translation - turn @ frames_p[joint]
    carrier = int(kinematics.carrier[joint])
    placed.rotation[0, carrier] = turn @ placed.rotation[0, carrier]
    placed.origin[0, carrier] = turn @ placed.origin[0, carrier] + shift
    bodies = [body_iri(scene.robot.mechanism.name, name) for name in limb.gripper.fingers]
    fingers = {one: world.shapes_of((one,)).tolist() for one in bodies}
    bar = world.shapes_of((seen.problem.mechanics.container.handle,)).tolist()
    return Grip(Shapes(scene, kinematics), placed, tool_r, fingers, bar, {}, Tolerances())


def held(seen: Front, grasp: Grasp, rest: np.ndarray) -> bool:
    """Whether certification has the handle between fingers that reach over it."""
    pinch = gripped(seen, grasp, rest).pinch()
    return pinch is not None and pinch.over >= Tolerances().engaged


def test_grasps_by_faces_that_look_along_the_way_fingers_close_come_first(tmp_path: Path) -> None:
    seen, most = front(tmp_path, FRONT, "stretch", WAYPOINTS), []
    for fitted in seen.fitter.fitting():
        grip = gripped(seen, *fitted)
        pinch = grip.pinch()
        assert pinch is not None
        most.append(np.degrees(grip.slant(pinch)))
    flat = int(np.argmax(np.array(most) > 1.0 + np.degrees(np.arctan(np.sqrt(2) * np.tan(np.radians(20))))))
    assert flat > 36  # as many as are ever searched one by one
    assert np.median(most[flat:]) > 21.0


@pytest.mark.parametrize("robot", ROBOTS)
def test_fingers_at_the_end_of_a_bar_touch_it_and_do_not_reach_over_it(tmp_path: Path, robot: str) -> None:
    seen = front(tmp_path, FRONT, robot, WAYPOINTS)
    fitter, bar = seen.fitter, seen.fitter.bar
    middle = min((grasp for grasp, _ in fitter.fitting()), key=lambda one: one.index)
    over, certified = [], []
    for number, place in enumerate(np.arange(0.0, bar.length, 0.001).tolist(), FAR_NUMBER):
        moved = replace(middle, translation=middle.translation + place * bar.along, index=number)
        fitted = fitter.fitted((moved, 0.0))
        if fitted is not None:
            over.append(fitter.engaged(fitted[0]))
            certified.append(held(seen, *fitted))
    assert over[0]
    assert not over[-1]
    assert over == certified


@pytest.mark.parametrize("robot", ROBOTS)
def test_certification_says_the_same_of_fingers_that_reach_over_a_bar(tmp_path: Path, robot: str) -> None:
    seen, rng = front(tmp_path, FRONT, robot, WAYPOINTS), np.random.default_rng(0)
    said = Counter[tuple[bool, bool]]()
    for number in range(FAR_NUMBER, FAR_NUMBER + 600):
        grasp = free_grasp(seen.fitter.bar, rng.uniform(-FREE_MOST, FREE_MOST), 1, number)
        tried = (seen.fitter.fitted((grasp, share)) for share in OPENINGS)
        fitted: Fitted | None = next((one for one in tried if one is not None), None)
        if fitted is not None:
            said[seen.fitter.engaged(fitted[0]), held(seen, *fitted)] += 1
    assert said[True, True] > 40
    assert said[False, False] > 20
    assert said[True, False] <= 0.08 * said[True, True]
    assert said[False, True] <= 0.08 * said[True, True]
