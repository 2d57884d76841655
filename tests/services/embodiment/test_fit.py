"""Grasps that a hand alone can take: its fingers touch the handle, whatever was closed before."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.load import load_twin
from services.embodiment.body.limb import Margins, touching
from services.embodiment.body.world import World
from services.embodiment.hold.fit import Fitter
from services.embodiment.hold.grasp import TOUCH, Grasp
from services.embodiment.hold.handle import Mechanics, find_bar
from services.embodiment.hold.holding import Problem
from services.embodiment.hold.kit import Kit, Kits
from services.physics.model import Scene
from tests.soak.doors import draw, write

pytestmark = pytest.mark.oracle

FRONT = 14
ROBOTS = ("pr2", "tiago_dual", "stretch")


def setting(folder: Path, robot: str) -> tuple[World, Kit, Problem, Fitter]:
    twin = load_twin(write(draw(np.random.default_rng(FRONT)), folder, "front"), [robot])
    world = World(Scene(twin, twin.robots[0]))
    kit = Kits(world, Margins()).of(world.scene.annotation.grippers[0])
    container = twin.container("front_door")
    mechanics, q = Mechanics(world, container), kit.limb.q(kit.limb.parked)
    bar = find_bar(world, mechanics, q)
    assert bar is not None
    values = np.linspace(0.0, container.open_from, 7)
    poses = mechanics.handle_poses(q, bar.joint, values)
    problem = Problem(mechanics, values, *poses, poses[0][0] @ bar.outward)
    holding = touching(world, kit.limb, kit.demands, (container.handle,))
    return world, kit, problem, Fitter(kit.hand, problem, bar, (holding, kit.demands), Counter())


def gap(world: World, kit: Kit, problem: Problem, grasp: Grasp, rest: np.ndarray) -> float:
    """Distance of the fingers from the handle [m], the hand where the grasp has it, by coal."""
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
    world, kit, problem, fitter = setting(tmp_path, robot)
    fitted = [*fitter.fitting()][::10]
    assert len(fitted) > 3
    for grasp, rest in fitted:
        assert -1e-6 <= gap(world, kit, problem, grasp, rest) <= TOUCH + 1e-6


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_grasp_closes_alike_whatever_was_closed_before(tmp_path: Path, robot: str) -> None:
    *_, fitter = setting(tmp_path, robot)
    after_others = {grasp.index: (grasp, rest) for grasp, rest in fitter.fitting()}
    *_, other = setting(tmp_path, robot)
    steep = {grasp.index: (grasp, rest) for grasp, rest in other.fitting(steep=True)}
    assert steep.keys() == after_others.keys()
    for index, (grasp, rest) in after_others.items():
        np.testing.assert_allclose(steep[index][0].translation, grasp.translation, atol=2 * TOUCH)
        np.testing.assert_allclose(steep[index][1], rest, atol=0.02)
