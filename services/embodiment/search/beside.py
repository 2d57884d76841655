"""The same question to a robot of which planning moves, too, what hangs beside its arm: a head, another arm.

Limbs have these joints besides their own, so a search brings what they carry out of the way. Where the
container is let go amid its way, the robot parks; then each arm and the head stand where the container passes
them with the most room.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri
from services.embodiment.body.demands import eased
from services.embodiment.body.limb import hanging
from services.embodiment.body.world import MAY_TOUCH, Rules, World
from services.embodiment.hold.handle import Mechanics
from services.embodiment.setting import Setting
from services.embodiment.ways.roads import Known
from services.embodiment.ways.timing import farthest

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

LOOKS = 17  # values of the container
PLACES = 240  # drawn from all within limits and half a turn
ROOM = 0.1, 0.05, 0.025, 0.0125, 0.00625, 0.003  # [m] from the kitchen, looked for one after the other
OWN = 0.01  # [m] from the robot itself


def freed(setting: Setting, mechanics: Mechanics) -> Iterator[Setting]:
    """That question: first the head moves too, then other arms as well; none where one of both is asked."""
    end, known = farthest(setting.motion, mechanics.start, setting.container), setting.kits.beside.keys()
    for arms in (False, True) if not known else ():
        beside = hanging(setting.world.scene, arms=arms)
        if known != {*beside}:
            at = _clear(setting, mechanics, beside, np.linspace(mechanics.start, end, LOOKS))
            kits = replace(setting.kits, beside=dict(zip(beside, at.tolist(), strict=True)))
            yield replace(setting, kits=kits, roads=Known(), proves=False)
            known = {*beside}


def _clear(setting: Setting, mechanics: Mechanics, beside: tuple[Iri, ...], values: Array) -> Array:
    """Where these joints bring what they carry clear of all at values (T,), the robot parked, shape (h,).

    Each branch is placed as one, then the next: with the most room, as far as it was looked for; where it is
    parked, if there is none.
    """
    scene, rng = setting.world.scene, np.random.default_rng(0)
    q = scene.q(setting.start, {})
    every = np.array([scene.coordinate[joint] for joint in beside])
    for own in _branches(setting.world, every):
        low, high = (np.clip(ends[own], -np.pi, np.pi) for ends in (scene.bounds.lower, scene.bounds.upper))
        q[own] = _place(mechanics, q, own, rng.uniform(low, high, (PLACES, len(own))), values)
    return q[every]


def _branches(world: World, every: Indices) -> Iterator[Indices]:
    """Coordinates of each of those that no other one carries, and what it carries."""
    carries = world.above()[np.ix_(every + 1, every + 1)]
    for k in np.flatnonzero(carries.sum(axis=1) == 1):
        yield every[carries[:, k]]


def _place(mechanics: Mechanics, q: Array, own: Indices, places: Array, values: Array) -> Array:
    """Where these coordinates have the most room, of where they are and of some places (N, h)."""
    world = mechanics.world
    carried = np.any(world.carried(own + 1), axis=1)
    kept = _kept(world, carried, q)
    for room in ROOM:
        environment = np.where(carried[world.split :, None], room, kept.environment)
        rules = Rules(environment, kept.pairs, kept.own)
        for at in np.vstack((q[own], places)):
            there = q.copy()
            there[own] = at
            moved = mechanics.put(world.scene.coupling.positions(there), values)
            if world.contact(moved, rules) is None:
                return at
    return q[own]


def _kept(world: World, carried: NDArray[np.bool_], q: Array) -> Rules:
    """What such shapes keep from the robot itself, less if they are nearer at q; nothing else."""
    environment = np.full((len(world.body) - world.split, world.split), MAY_TOUCH)
    pairs = np.asarray(world.scene.self_pairs, dtype=np.int64).reshape(-1, 2)
    pairs = pairs[np.any(carried[pairs], axis=1)]
    least = world.scene.annotation.overhang
    return eased(world, Rules(environment, pairs, np.full(len(pairs), OWN)), q, least)
