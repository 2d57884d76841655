"""What is to be refuted as plain arrays, the middles of intervals, for compiled loops."""

import numpy as np
from numpy.typing import NDArray

from sdt_kg.motion import BASE_JOINTS
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.geometry.mechanics import Chain, Link
from services.embodiment.proof_check.inside.boxes import Core
from services.embodiment.proof_check.inside.solids import Around
from services.embodiment.proof_check.target import Target

Array = NDArray[np.float64]
Three = tuple[Array, Array, Array]
Aim = tuple[Array, Three, Three]

ANYWHERE = 1e3  # [m] half the size of a box from which nothing is too far


def joints(chain: Chain) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    """A chain as `boxes` takes it."""
    links = chain.links
    return (
        np.array([one.before.rotation.middle for one in links]),
        np.array([one.before.translation.middle for one in links]),
        np.array([one.axis for one in links]),
        np.array([one.turns for one in links]),
    )


def inner(arm: Arm, around: tuple[Around, ...]) -> tuple[object, ...]:
    """Cores, solids near enough, and which of them are kept apart, as `boxes` takes them."""
    cores = arm.cores
    carrier = np.concatenate([np.full(len(one.solids.half), one.carrier) for one in around] or [np.zeros(0)])
    turns = np.concatenate([one.solids.at.rotation.middle for one in around] or [np.zeros((0, 3, 3))])
    places = np.concatenate([one.solids.at.translation.middle for one in around] or [np.zeros((0, 3))])
    half = np.concatenate([one.solids.half for one in around] or [np.zeros((0, 3))])
    keeps = np.concatenate([one.keeps for one in around] or [np.zeros((0, 0), np.bool_)], axis=1)
    keeps = keeps & ((carrier >= 0) | _near(arm, turns, places, half))
    near = keeps.any(axis=0)
    return (
        (
            np.array([core.link for core in cores], dtype=np.int64),
            np.array([core.middle.rotation.middle for core in cores]).reshape(-1, 3, 3),
            np.array([core.middle.translation.middle for core in cores]).reshape(-1, 3),
            np.array([core.half for core in cores]).reshape(-1, 3),
        ),
        (
            turns[near],
            places[near],
            half[near],
            carrier[near].astype(np.int64),
        ),
        np.ascontiguousarray(keeps[:, near]),
    )


def _near(arm: Arm, turns: Array, places: Array, half: Array) -> NDArray[np.bool_]:
    """To which boxes of the kitchen each core can come, shape (C, S)."""
    links, cores = arm.chain.links, arm.cores
    if len(links) <= len(BASE_JOINTS):  # a lift alone, on a base that is anywhere: all of it counts
        return np.ones((len(cores), len(places)), dtype=np.bool_)
    base, rest = links[: len(BASE_JOINTS)], links[len(BASE_JOINTS) :]
    stands = np.sum([link.before.translation.middle for link in base], axis=0)
    stands[:2] += [(link.lower + link.upper) / 2 for link in base[:2]]
    room = sum(link.upper - link.lower for link in base[:2])
    far = np.cumsum([0.0] * len(BASE_JOINTS) + [_step(link) for link in rest])
    reach = np.array([far[core.link] + _size(core) for core in cores]) + room
    beyond = np.abs(((stands - places)[:, None] @ turns)[:, 0]) - half
    away = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    near: NDArray[np.bool_] = away < reach[:, None]
    return near


def _step(link: Link) -> float:
    """How far a link's origin is from that of the one before, at most [m]."""
    slid = 0.0 if link.turns else max(abs(link.lower), abs(link.upper))
    return float(np.linalg.norm(link.before.translation.middle)) + slid


def _size(core: Core) -> float:
    """How far a core reaches from the origin of the link that carries it [m]."""
    return float(np.linalg.norm(core.middle.translation.middle) + np.linalg.norm(core.half))


def grasp(arm: Arm) -> tuple[Array, Array, Array]:
    """The grasp box in the last joint's frame, as `boxes` takes it: rotation, middle, half extents."""
    turn, place = arm.chain.end.rotation.middle, arm.chain.end.translation.middle
    return turn, turn @ arm.middle + place, arm.half


def _boxes(target: Target) -> tuple[Array, Array, Array]:
    """The handle's boxes as `boxes` takes them."""
    return (
        np.array([box.rotation.middle for box in target.boxes]),
        np.array([box.translation.middle for box in target.boxes]),
        target.half,
    )


def aim(arm: Arm, target: Target) -> Aim:
    """How far the arm reaches, its grasp box and the handle's boxes, as `boxes` takes them."""
    return arm.reach, grasp(arm), _boxes(target)


def loosely(arm: Arm, target: Target) -> Aim:
    """The same, with reaches as lengths that add up, which are longer: what they refute is refuted.

    Halved for these, trees of an arm that has its wrist in a cell are smaller: TIAGo++ 68 takes a hundredth.
    """
    links, reach = arm.chain.links, arm.reach.copy()
    for k in range(len(links) - 2, -1, -1):
        step = links[k + 1]
        ends = (0.0,) if step.turns else (step.lower, step.upper)
        start = step.before.translation.middle
        axis = step.before.rotation.middle @ step.axis
        reach[k] = reach[k + 1] + max(np.linalg.norm(start + axis * one) for one in ends)
    return np.maximum(reach, arm.reach), grasp(arm), _boxes(target)


def anywhere(count: int) -> Aim:
    """What refutes nothing, of so many joints."""
    tool = np.eye(3), np.zeros(3), np.zeros(3)
    return np.full(count, ANYWHERE), tool, (np.eye(3)[None], np.zeros((1, 3)), np.full((1, 3), ANYWHERE))
