"""Events: when containers became open or closed, reached a limit, or were grasped.

A trajectory is known at its samples: an event has the first sample at which it is so. What comes
and goes between two samples is not seen.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from sdt_kg.history.trajectory import Trajectory
from sdt_kg.iri import Iri
from sdt_kg.twin import Container, Twin

LIMIT_TOLERANCE: Final = 1e-4
"""[rad or m] So near to it, a limit counts as reached."""


class EventType(Enum):
    """What happened; the value is the local name of its class in `sdt.ttl`."""

    OPENED = "Opened"
    NO_LONGER_OPEN = "NoLongerOpen"
    CLOSED = "Closed"
    NO_LONGER_CLOSED = "NoLongerClosed"
    UPPER_LIMIT_REACHED = "UpperLimitReached"
    LOWER_LIMIT_REACHED = "LowerLimitReached"
    GRASPED = "Grasped"


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened.

    Attributes:
        about: IRI of the container, or of the handle that was grasped.
        sample: Of the trajectory, counted from 0; None where an edit made it so at once.
        time: At that sample [s], counted as the trajectory counts.
        by: IRI of the robot that grasped.
    """

    type: EventType
    about: Iri
    sample: int | None = None
    time: float | None = None
    by: Iri | None = None


Values = NDArray[np.float64]

# Positions come one by one or as arrays, shape (T,); the answers likewise: hence Any.
_CLAIMS: Final[tuple[tuple[Callable[[Container, Any], Any], EventType, EventType | None], ...]] = (
    (lambda c, at: c.is_open(at), EventType.OPENED, EventType.NO_LONGER_OPEN),
    (lambda c, at: c.is_closed(at), EventType.CLOSED, EventType.NO_LONGER_CLOSED),
    (lambda c, at: at >= c.upper - LIMIT_TOLERANCE, EventType.UPPER_LIMIT_REACHED, None),
    (lambda c, at: at <= c.lower + LIMIT_TOLERANCE, EventType.LOWER_LIMIT_REACHED, None),
)
"""What may be so of a container at its own position [rad or m], and the events of beginning and ending."""


def events_between(before: Twin, after: Twin) -> Iterator[Event]:
    """Events of an edit: what is so after it and was not before, and the other way round."""
    then, now = dict(before.state.positions), dict(after.state.positions)
    for past, container in _pairs(before, after):
        was, at = then[past.joint], now[container.joint]
        if past is container and was == at:
            continue
        for claim, begun, ended in _CLAIMS:
            held, holds = bool(claim(past, was)), bool(claim(container, at))
            if holds and not held:
                yield Event(begun, container.iri)
            elif held and not holds and ended is not None:
                yield Event(ended, container.iri)


def _pairs(before: Twin, after: Twin) -> Iterator[tuple[Container, Container]]:
    """Each container that is in both, as it was and as it is."""
    if before.entities is after.entities:
        return zip(after.containers(), after.containers(), strict=True)
    known = {container.iri: container for container in before.containers()}
    return ((known[each.iri], each) for each in after.containers() if each.iri in known)


def claims(container: Container, values: Values) -> NDArray[np.bool_]:
    """What is so of a container at positions of shape (T,): a row for each kind of claim."""
    return np.stack([claim(container, values) for claim, _, _ in _CLAIMS])


def events_along(twin: Twin, trajectory: Trajectory) -> list[Event]:
    """Events of a trajectory that begins in the twin's state, in the order of their samples."""
    found = list(_grasps(twin, trajectory))
    for container in twin.containers():
        values = own_positions(twin, container, trajectory.joints, trajectory.positions)
        if values is not None:
            values[0] = twin.state[container.joint]
            found += _changes(container, values, trajectory)
    return sorted(found, key=lambda event: (event.sample or 0, event.about, event.type.value))


def own_positions(
    twin: Twin, container: Container, joints: Sequence[Iri], positions: Values
) -> Values | None:
    """The container's own position at each sample, shape (T,) [rad or m]; None where none of them moves it.

    Args:
        twin: Whose joints move together.
        container: Whose joint, the one that it follows, or another that follows that, may be among them.
        joints: IRIs of m joints.
        positions: Shape (T, m).
    """
    if container.joint in joints and container.active_joint not in joints:
        return positions[:, joints.index(container.joint)].copy()
    active = _active(twin, container.active_joint, joints, positions)
    return None if active is None else container.multiplier * active + container.offset


def _active(twin: Twin, active: Iri, joints: Sequence[Iri], positions: Values) -> Values | None:
    """Positions of a joint that others may follow, by its own, else by those of the first that does."""
    if active in joints:
        return positions[:, joints.index(active)]
    followers = twin.entities.coupling.followers
    for index, joint in enumerate(joints):
        each = followers.get(joint)
        if each is not None and each.active == active and each.multiplier != 0:
            return (positions[:, index] - each.offset) / each.multiplier
    return None


def _changes(container: Container, values: Values, trajectory: Trajectory) -> Iterator[Event]:
    for holds, (_, begun, ended) in zip(claims(container, values), _CLAIMS, strict=True):
        for sample in (np.flatnonzero(holds[1:] != holds[:-1]) + 1).tolist():
            kind = begun if holds[sample] else ended
            if kind is not None:
                yield Event(kind, container.iri, sample, float(trajectory.times[sample]))


def _grasps(twin: Twin, trajectory: Trajectory) -> Iterator[Event]:
    grasp = trajectory.grasp
    if grasp is None:
        return
    for container in twin.containers():
        if own_positions(twin, container, trajectory.joints, trajectory.positions) is not None:
            for sample in (grasp.sample, *trajectory.again):
                time = float(trajectory.times[sample])
                yield Event(EventType.GRASPED, container.handle, sample, time, grasp.robot)
