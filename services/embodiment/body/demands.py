"""Distances that planning demands: of all bodies, and where a hand holds something, or stands near by."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import joint_iri
from services.embodiment.body.limb import Limb
from services.embodiment.body.world import MAY_TOUCH, Rules, World

Array = NDArray[np.float64]

NEIGHBOURS = 2  # moving joints between two bodies which count as close


@dataclass(frozen=True, slots=True)
class Margins:
    """Distances that planning keeps, beyond what certification demands [m].

    Attributes:
        free: Between any two bodies.
        fine: Between hand and kitchen.
        close: Between bodies of the robot that one or two joints part, built with little play.
    """

    free: float = 0.003
    fine: float = 0.0015
    close: float = 0.0003


def eased(world: World, demands: Rules, q: Array, least: float) -> Rules:
    """The same distances, but half of what is there for self pairs nearer at q; at least `least` [m]."""
    r, p = world.frames(q)
    joint, _, centre = world.boxes
    at = (r[joint] @ centre[:, :, None])[:, :, 0] + p[joint]
    one, other = demands.pairs.T
    away = np.linalg.norm(at[one] - at[other], axis=1) - world.radius[one] - world.radius[other]
    close = np.flatnonzero(away <= demands.own)
    there = world.distances(demands.pairs[close], r, p)
    near = there <= demands.own[close]
    own = demands.own.copy()
    own[close[near]] = np.maximum(there[near] / 2, least)
    return Rules(demands.environment, demands.pairs, own)


def beside(world: World, demands: Rules, q: Array) -> Rules:
    """The same distances, but half of what is there where the robot is nearer to the kitchen at q.

    What certification demands is demanded still, and where that is not there nothing is changed.
    """
    least, environment = world.scene.annotation.overhang, demands.environment.copy()
    eased = demands
    while (contact := world.contact(q[None], eased)) is not None:
        one, other = sorted(contact.shapes)
        if one >= world.split:
            break
        there = world.distance(contact.shapes, *world.frames(q))
        if there <= least:
            break
        environment[other - world.split, one] = (there + least) / 2
        eased = Rules(environment.copy(), demands.pairs, demands.own)
    return eased


def rules(world: World, limb: Limb, margins: Margins) -> Rules:
    """Distances that planning demands."""
    overhang = world.scene.annotation.overhang
    robot = len(world.body) - world.split
    environment = np.full((robot, world.split), margins.free + overhang)
    hand = world.shapes_of((*limb.palm, *limb.fingers))
    environment[hand - world.split] = margins.fine + overhang
    standing = world.shapes_of(world.scene.standing) - world.split
    environment[np.ix_(standing, world.scene.ground)] = MAY_TOUCH
    pairs, parted = _moving_pairs(world, limb)
    within = (parted <= NEIGHBOURS) | np.isin(pairs, hand).all(axis=1)
    return Rules(environment, pairs, np.where(within, margins.close, margins.free) + overhang)


def touching(world: World, limb: Limb, demands: Rules, bodies: tuple[str, ...]) -> Rules:
    """The same distances, but the fingers may touch these bodies of the kitchen."""
    environment = demands.environment.copy()
    fingers = world.shapes_of(limb.fingers) - world.split
    environment[np.ix_(fingers, world.shapes_of(bodies))] = MAY_TOUCH
    return Rules(environment, demands.pairs, demands.own)


def without_fingers(world: World, limb: Limb, demands: Rules) -> Rules:
    """The same distances, but none of the fingers."""
    fingers, environment = world.shapes_of(limb.fingers), demands.environment.copy()
    environment[fingers - world.split] = MAY_TOUCH
    others = ~np.isin(demands.pairs, fingers).any(axis=1)
    return Rules(environment, demands.pairs[others], demands.own[others])


def _moving_pairs(world: World, limb: Limb) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Self pairs whose relative pose depends on the limb's arm or fingers, and how many joints part them."""
    scene = world.scene
    moves = np.array(np.abs(limb.expansion[:, 3:]).any(axis=1))
    fingers = {joint_iri(scene.robot.mechanism.name, one.joint) for one in limb.gripper.finger_joints}
    for k, source in enumerate(scene.coupling.source):
        moves[k] |= scene.names[source] in fingers
    on_way = (world.above() & np.append(False, moves)).astype(np.int64)
    count = on_way.sum(axis=1)
    pairs = np.asarray(scene.self_pairs, dtype=np.int64).reshape(-1, 2)
    one, other = world.boxes[0][pairs.T]
    parted = count[one] + count[other] - 2 * (on_way @ on_way.T)[one, other]
    return pairs[parted > 0], parted[parted > 0]
