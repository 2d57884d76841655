"""The same question to a robot of which planning moves, too, what hangs beside its arms: a head.

Limbs have its joints besides their own, so a search brings it out of the way. Where the container is let go
amid its way, the robot parks; what hangs beside then stands where the container passes it with the most room.
"""

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
PLACES = 240  # drawn from all within limits
ROOM = 0.1, 0.05, 0.025, 0.0125, 0.00625, 0.003  # [m] looked for one after the other


def freed(setting: Setting, mechanics: Mechanics) -> Setting | None:
    """That question; None where nothing hangs beside the arms, or the question is that one."""
    beside = hanging(setting.world.scene)
    if not beside or setting.kits.beside:
        return None
    end = farthest(setting.motion, mechanics.start, setting.container)
    at = _clear(setting, mechanics, beside, np.linspace(mechanics.start, end, LOOKS))
    kits = replace(setting.kits, beside=dict(zip(beside, at.tolist(), strict=True)))
    return replace(setting, kits=kits, roads=Known(), proves=False)


def _clear(setting: Setting, mechanics: Mechanics, beside: tuple[Iri, ...], values: Array) -> Array:
    """Where these joints bring what they carry clear of all at values (T,), the robot parked, shape (h,).

    That is with the most room, as far as it was looked for; where they are parked, if there is none.
    """
    world = setting.world
    scene, rng = world.scene, np.random.default_rng(0)
    own = np.array([scene.coordinate[joint] for joint in beside])
    parked = scene.q(setting.start, {})
    low, high = (np.clip(ends[own], -np.pi, np.pi) for ends in (scene.bounds.lower, scene.bounds.upper))
    places = np.vstack((parked[own], rng.uniform(low, high, (PLACES, len(own)))))
    for room in ROOM:
        rules = _rules(world, own, parked, room)
        for at in places:
            q = parked.copy()
            q[own] = at
            if world.contact(mechanics.put(scene.coupling.positions(q), values), rules) is None:
                return at
    return parked[own]


def _rules(world: World, own: Indices, parked: Array, room: float) -> Rules:
    """So much room from the kitchen for what these coordinates carry, and some of itself."""
    scene = world.scene
    carried = np.asarray(world.above()[world.boxes[0]][:, own + 1].any(axis=1))
    environment = np.full((len(world.body) - world.split, world.split), MAY_TOUCH)
    environment[carried[world.split :]] = room
    pairs = np.asarray(scene.self_pairs, dtype=np.int64).reshape(-1, 2)
    pairs = pairs[carried[pairs].sum(axis=1) == 1]
    return eased(
        world, Rules(environment, pairs, np.full(len(pairs), room)), parked, scene.annotation.overhang
    )
