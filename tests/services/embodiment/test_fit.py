"""Grasps that a hand alone can take: its fingers touch the handle, whatever was closed before."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from services.embodiment.hold.grasp import TOUCH, Grasp
from tests.services.embodiment.front import Front, front

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


@pytest.mark.parametrize("robot", ROBOTS)
def test_fingers_at_the_end_of_a_bar_touch_it_and_do_not_reach_over_it(tmp_path: Path, robot: str) -> None:
    seen = front(tmp_path, FRONT, robot, WAYPOINTS)
    fitter, bar = seen.fitter, seen.fitter.bar
    middle = min((grasp for grasp, _ in fitter.fitting()), key=lambda one: one.index)
    over = []
    for number, place in enumerate(np.arange(0.0, bar.length, 0.0005).tolist(), FAR_NUMBER):
        moved = replace(middle, translation=middle.translation + place * bar.along, index=number)
        fitted = fitter.fitted((moved, 0.0))
        if fitted is not None:
            over.append(fitter.engaged(fitted))
    assert over[0]
    assert not over[-1]
    assert sorted(over, reverse=True) == over
