"""The search with one gripper, made ready: its grasps, its paths, and the ways to them."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.body.demands import beside, touching
from services.embodiment.hold.fit import Fitter
from services.embodiment.hold.handle import Bar, Mechanics
from services.embodiment.hold.holding import WAYPOINTS, Problem, Searcher
from services.embodiment.hold.kit import Kit
from services.embodiment.search.attempt import Attempt
from services.embodiment.setting import Setting
from services.embodiment.ways.approach import Approacher
from services.embodiment.ways.assemble import Assembler
from services.embodiment.ways.roads import Roads, make_roads
from services.embodiment.ways.slim import slim
from services.embodiment.ways.timing import farthest

Array = NDArray[np.float64]


def make_attempt(  # noqa: PLR0913  # what is asked, of whom, and how it is searched
    setting: Setting,
    mechanics: Mechanics,
    bar: Bar,
    kit: Kit,
    *,
    unfit: Counter[tuple[int, int]],
    seed: int,
    late: Callable[[], bool],
) -> Attempt:
    """The search with one gripper.

    Args:
        setting: What is asked.
        mechanics: Of its container.
        bar: Of its handle.
        kit: The gripper's.
        unfit: Counts pairs of shapes in contact that rule grasps out.
        seed: Of the search.
        late: Whether time is up.
    """
    world, limb = setting.world, kit.limb
    problem = _problem(setting, mechanics, bar, limb.q(limb.parked))
    holding = touching(world, limb, kit.demands, (setting.container.handle,))
    fitter = Fitter(kit.hand, problem, bar, (holding, kit.demands), unfit, setting.tolerances.facing)
    fitted, steep = (fitter.fitting(late, steep) for steep in (False, True))
    searcher = Searcher(world, limb, problem, holding, setting.drive)
    start = np.array(setting.start)
    if setting.drive is Drive.FIXED:
        searcher.stand(start)
    parked, narrow = (partial(_roads, setting, kit, seed, parked=each) for each in (True, False))
    opened = beside(world, kit.opened, world.scene.q(setting.start, {}))
    approacher = Approacher(parked(), narrow, replace(kit, opened=opened), start, late)
    assembler = Assembler(world, limb, setting.robot, problem, setting.motion)
    rng = np.random.default_rng(seed)
    return Attempt(limb, fitter, [], fitted, [], steep, searcher, approacher, assembler, rng)


def _roads(setting: Setting, kit: Kit, seed: int, *, parked: bool) -> Roads:
    """Drives with the arm parked, or as slim as it can be; at first nothing is known but free poses."""
    key = kit.limb.gripper.name, parked
    if key not in setting.roads:
        posture = kit.limb.parked if parked else slim(setting.world, kit.limb, kit.opened)
        setting.roads[key] = make_roads(setting.world, kit.limb, posture, kit.opened, setting.drive)
    setting.roads[key].begin(seed)
    return setting.roads[key]


def _problem(setting: Setting, mechanics: Mechanics, bar: Bar, q: Array) -> Problem:
    start = mechanics.start
    end = farthest(setting.motion, start, setting.container)
    values = np.linspace(start, end, WAYPOINTS)
    return Problem.through(mechanics, bar, q, values)
