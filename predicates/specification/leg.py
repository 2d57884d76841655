"""Leg: what a step's motion does to the kitchen, between samples too."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from predicates.specification.cubic import Array, Cubic
from sdt_kg.history.events import claims, own_positions
from sdt_kg.history.trajectory import Grasp, Trajectory, held_from
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion
from sdt_kg.state import State
from sdt_kg.twin import Container, Twin

AT_ONCE: Final = 1e-9
"""[s] What begins or ends nearer together than this happens at once."""


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """One step's body motion, as the kitchen sees it.

    Attributes:
        number: Of the step, counted from 1.
        twin: Kitchen and robot in the state in which the step begins.
        motion: The body motion; between its samples it is a cubic Hermite spline.
        trajectory: Of the kitchen's joints, at the samples, at every extremum of every joint between
            them, and wherever a container begins or ceases to be open, closed or at a limit: from one
            sample of it to the next each joint only rises or only falls. What a joint reaches, it
            therefore reaches at one of these samples, and what happens earlier is at an earlier one.
        not_checked: Names of containers that the trajectory has where they were, and of which nobody
            checked whether they stay there; of those that move together, one.
    """

    number: int
    twin: Twin
    motion: BodyMotion
    trajectory: Trajectory
    not_checked: tuple[str, ...] = ()

    @staticmethod
    def of(number: int, twin: Twin, motion: BodyMotion, not_checked: tuple[str, ...] = ()) -> "Leg":
        """The leg of a body motion that says how the kitchen's joints move."""
        spline = Cubic(motion.times, motion.kitchen_q, motion.kitchen_v)
        times = _with_crossings(twin, motion.kitchen_joints, spline)
        held = [int(np.searchsorted(times, float(motion.times[sample]))) for sample in held_from(motion)]
        grasp = Grasp(motion.robot, held[0]) if held else None
        trajectory = Trajectory(motion.kitchen_joints, times, spline.at(times), grasp, tuple(held[1:]))
        return Leg(number, twin, motion, trajectory, not_checked)

    def positions(self, container: Container) -> Array:
        """The container's own joint at each sample of the trajectory, shape (T,) [rad or m]."""
        found = own_positions(self.twin, container, self.trajectory.joints, self.trajectory.positions)
        if found is None:
            return np.full(len(self.trajectory.times), self.twin.state[container.joint])
        return found

    def state(self, sample: int) -> State:
        """The state at a sample of the trajectory."""
        return self.trajectory.at(self.twin, sample).state


def _with_crossings(twin: Twin, joints: tuple[Iri, ...], spline: Cubic) -> Array:
    """Times of samples and extrema, and between them the first at which something has begun or ended."""
    times = spline.refined()
    crossed = np.sort(
        [each for one in twin.containers() for each in _crossings(twin, one, joints, (spline, times))]
    )
    apart = np.diff(np.append(crossed, np.inf)) > AT_ONCE
    later = times[np.searchsorted(times, crossed)] - crossed
    return np.union1d(times, crossed[apart & (later > AT_ONCE)])


def _crossings(
    twin: Twin, container: Container, joints: tuple[Iri, ...], way: tuple[Cubic, Array]
) -> Iterator[float]:
    """Times at which what is claimed of a container is another than at the sample before, by halving."""
    spline, times = way

    def so(at: Array) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
        own = own_positions(twin, container, joints, spline.at(at))
        return np.zeros((0, len(at)), dtype=bool) if own is None else claims(container, own)

    holds = so(times)
    for which, piece in np.argwhere(holds[:, 1:] != holds[:, :-1]).tolist():
        low, high = float(times[piece]), float(times[piece + 1])
        while high - low > AT_ONCE / 2:
            middle = (low + high) / 2
            if so(np.array([middle]))[which, 0] == holds[which, piece]:
                low = middle
            else:
                high = middle
        yield high
