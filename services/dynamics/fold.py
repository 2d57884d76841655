"""Panels of a folding door: what hangs on hinges that move together, one on the other, all parallel."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.iri import Iri
from sdt_kg.twin import Container, Twin
from services.dynamics.load import axis_of, handle_corners, placed, unit_inertia
from services.dynamics.model import LOAD_ERROR, Array, Fold, Reach, Wave
from services.physics.tree import UNIVERSE, Model

Moves = Mapping[Iri, tuple[float, float]]
"""Ratio and offset of every joint that moves together, by the container's own."""

Term = tuple[complex, float, float]
"""z, rate and phase of z exp(i (rate q + phase))."""


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Hinges that carry one another, the first hanging on none of them, seen along their axis.

    Places are complex numbers in the plane across the axis: turning by θ is a factor exp(i θ).

    Attributes:
        joints: Pinocchio's indices.
        axis, plane: Unit vectors of the axis, shape (3,), and of the plane, shape (2, 3).
        hinges: Places of the hinges when all are at 0, shape (N,).
        rates, phases: Panel k is turned by rates[k] · q + phases[k], q the container's own joint.
    """

    joints: tuple[int, ...]
    axis: Array
    plane: Array
    hinges: "np.ndarray[tuple[int], np.dtype[np.complex128]]"
    rates: Array
    phases: Array

    @property
    def arms(self) -> "np.ndarray[tuple[int], np.dtype[np.complex128]]":
        """From each hinge to the next."""
        return np.diff(self.hinges)

    def across(self, vector: Array) -> complex:
        """A vector in the plane."""
        one, other = self.plane @ vector
        return complex(one, other)


def chain_of(model: Model, twin: Twin, joint: Iri, moves: Moves) -> Chain | None:
    """The hinges from the first that moves with it to this one; None where it hangs on none of them.

    Args:
        model: Built from the twin's environment.
        twin: The kitchen in its state.
        joint: The last hinge.
        moves: Of all that move together.
    """
    index, joints = int(model.model.getJointId(joint)), list[int]()
    while index != UNIVERSE:
        if model.model.names[index] in moves:
            joints.insert(0, index)
        index = int(model.model.parents[index])
    if len(joints) < 2:
        return None
    placed(model, twin, zero=moves)
    axes = [model.placements.world_T_joint[k].rotation @ axis_of(model, k) for k in joints]
    axis = axes[0]
    signs = np.array([np.sign(axis @ each) for each in axes])
    ways = np.array([moves[model.model.names[k]] for k in joints]) * signs[:, None]
    rates, phases = np.cumsum(ways, axis=0).T
    flattest = np.eye(3)[int(np.argmin(np.abs(axis)))]
    east = np.cross(axis, flattest)
    east /= np.linalg.norm(east)
    plane = np.stack([east, np.cross(axis, east)])
    hinges = np.array([complex(*(plane @ model.placements.world_T_joint[k].translation)) for k in joints])
    return Chain(tuple(joints), axis, plane, hinges, rates, phases)


def fold_of(model: Model, twin: Twin, chain: Chain, moves: Moves) -> Fold:
    """Inertia and weight of the last panel of a chain, for one kilogram of it."""
    placed(model, twin, zero=moves)
    last = chain.joints[-1]
    body = unit_inertia(model, last, apart=moves)
    centre = chain.across(model.placements.world_T_joint[last].rotation @ body.lever)
    turn = model.placements.world_T_joint[last].rotation.T @ chain.axis
    about = float(turn @ (body.inertia - pin.skew(body.lever) @ pin.skew(body.lever)) @ turn)
    ways = [1j * rate * arm for rate, arm in zip(chain.rates, chain.arms, strict=False)]
    swing, turned = 1j * chain.rates[-1] * centre, chain.phases[-1]
    up = chain.across(-model.model.gravity.linear).conjugate()
    first = list(zip(ways, chain.rates, chain.phases, strict=False))
    own = chain.rates[-1]
    return Fold(
        carried=_square(first),
        mixed=_wave(
            [(2 * swing * way.conjugate(), own - rate, turned - phase) for way, rate, phase in first]
        ),
        turned=float(own**2) * about,
        weight_carried=_wave([(way * up, rate, phase) for way, rate, phase in first]),
        weight_own=_wave([(swing * up, own, turned)]),
    )


def reach_of(model: Model, twin: Twin, chain: Chain, container: Container, moves: Moves) -> Reach:
    """Where the handle on the last panel of a chain goes."""
    placed(model, twin, zero=moves)
    place = model.placements.world_T_joint[chain.joints[-1]]
    corners = [chain.across(place.rotation @ each) for each in handle_corners(model.part, container)]
    middle = complex(np.mean(corners))
    points = [*chain.arms, middle]
    ways = [1j * rate * point for rate, point in zip(chain.rates, points, strict=True)]
    arms = np.array([each.real * chain.plane[0] + each.imag * chain.plane[1] for each in chain.arms])
    spread = (1 + LOAD_ERROR) * abs(float(chain.rates[-1])) * max(abs(each - middle) for each in corners)
    origin = model.placements.world_T_joint[chain.joints[0]].translation.copy()
    lever = _square(list(zip(ways, chain.rates, chain.phases, strict=True)))
    return Reach(chain.axis, origin, arms, chain.rates, chain.phases, lever, spread)


def _square(terms: list[Term]) -> Wave:
    """|z|² of a sum of z exp(i (rate q + phase))."""
    return _wave(
        [
            (one[0] * other[0].conjugate(), one[1] - other[1], one[2] - other[2])
            for one in terms
            for other in terms
        ]
    )


def _wave(terms: list[Term]) -> Wave:
    """The real part of a sum of z exp(i (rate q + phase))."""
    z = np.array([each[0] for each in terms])
    rates, phases = (np.array([each[k] for each in terms], dtype=np.float64) for k in (1, 2))
    return Wave(np.abs(z), rates, phases + np.angle(z))
