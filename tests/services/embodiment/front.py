"""A random front before a robot, as the search for holdings sees it."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sdt_kg.annotation import Drive
from services.embodiment.body.demands import Margins, touching
from services.embodiment.body.world import World
from services.embodiment.hold.fit import Fitter
from services.embodiment.hold.grasp import Grasp
from services.embodiment.hold.handle import Bar, Mechanics, find_bar
from services.embodiment.hold.holding import Problem, Searcher
from services.embodiment.hold.kit import Kit, Kits
from services.embodiment.hold.sets import free_grasps
from services.physics.model import Scene
from tests.small import beside
from tests.soak.doors import draw, write


@dataclass(frozen=True)
class Front:
    """What is to be held, and by what."""

    world: World
    kit: Kit
    problem: Problem
    fitter: Fitter

    def searcher(self, base: tuple[float, float, float]) -> Searcher:
        """The search for one that stands there."""
        holding, _ = self.fitter.demands
        found = Searcher(self.world, self.kit.limb, self.problem, holding, Drive.FIXED)
        found.stand(np.array(base))
        return found


def front(
    folder: Path, number: int, robot: str, waypoints: int, *, gripper: int = 0, last: float | None = None
) -> Front:
    """The front of this number, closed at first; last: [rad or m], None: where it counts as open."""
    twin = beside(write(draw(np.random.default_rng(number)), folder, "front"), robot)
    world = World(Scene(twin, twin.robots[0]))
    kit = Kits(world, Margins()).of(world.scene.annotation.grippers[gripper])
    container = twin.container("front_door")
    mechanics, q = Mechanics(world, container), kit.limb.q(kit.limb.parked)
    bar = find_bar(world, mechanics, q)
    assert bar is not None
    values = np.linspace(0.0, container.open_from if last is None else last, waypoints)
    poses = mechanics.handle_poses(q, bar.joint, values)
    problem = Problem(mechanics, values, *poses, poses[0][0] @ bar.outward)
    holding = touching(world, kit.limb, kit.demands, (container.handle,))
    return Front(world, kit, problem, Fitter(kit.hand, problem, bar, (holding, kit.demands), Counter()))


def free_grasp(bar: Bar, genes: np.ndarray, flip: int, number: int) -> Grasp:
    """One grasp of any kind."""
    (grasp,) = free_grasps([bar], genes[None], np.array([flip]), np.array([number]))
    return grasp
