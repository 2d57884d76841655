"""Containers as a query tells them, and what is left out."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import Iri, local_name
from sdt_kg.state import ROUNDING
from sdt_kg.store import Row


@dataclass(frozen=True, slots=True)
class Container:
    """A counted container of a kitchen.

    Attributes:
        iri: IRI of its body.
        name: Name of its body.
        kind: `door` or `drawer`.
        joint: IRI of its own joint p_c.
        active_joint: IRI of the joint that is actuated: the mimicked one for a mimic door.
        multiplier: p_c = multiplier · p_active + offset.
        offset: See multiplier.
        handle: IRI of its handle's body.
        lower, upper: Effective limits of p_c [rad or m], over the coupling; infinite if there are none.
        open_from: Threshold of open(c): 0.9 · upper.
        closed_to: Threshold of closed(c): lower + epsilon.
        velocity, acceleration: Effective limits of p_c; infinite if there are none.
        more_handles: IRIs of its other handles.
    """

    iri: Iri
    name: str
    kind: str
    joint: Iri
    active_joint: Iri
    multiplier: float
    offset: float
    handle: Iri
    lower: float
    upper: float
    open_from: float
    closed_to: float
    velocity: float
    acceleration: float
    more_handles: tuple[Iri, ...] = ()

    def is_open(self, at: Any) -> Any:  # noqa: ANN401 - one position, or an array of them
        """Eq. (8): whether it is open at positions of its own joint, one or shape (T,) [rad or m]."""
        return at >= self.open_from - ROUNDING

    def is_closed(self, at: Any) -> Any:  # noqa: ANN401 - likewise
        """Eq. (8): whether it is closed at them."""
        return at <= self.closed_to + ROUNDING

    @property
    def by_each_handle(self) -> "tuple[Container, ...]":
        """The same with each of its handles in place of its own, that first."""
        every = self.handle, *self.more_handles
        return tuple(
            replace(self, handle=own, more_handles=tuple(each for each in every if each != own))
            for own in every
        )

    def by_handle(self, handle: Iri | None) -> "Container":
        """The same by one of its handles; None: by its own.

        Raises:
            UnknownEntityError: It has no such handle.
        """
        handles = {each.handle: each for each in self.by_each_handle}
        if handle is not None and handle not in handles:
            raise UnknownEntityError(f"handle of {self.name}", handle, handles)
        return self if handle is None else handles[handle]


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A joint with a handle, or a door or drawer by name, that is not counted.

    Attributes:
        joint: IRI of the joint.
        body: IRI of the body which it moves.
        reason: One sentence.
    """

    joint: Iri
    body: Iri
    reason: str


def containers_of(rows: Iterable[Row]) -> tuple[Container, ...]:
    """The containers of the rows of `containers.rq`; a container's first row is of its handle."""
    found: dict[Iri, Container] = {}
    for one in map(_container, rows):
        known = found.setdefault(one.iri, one)
        if one.handle not in {known.handle, *known.more_handles}:
            found[one.iri] = replace(known, more_handles=(*known.more_handles, one.handle))
    return tuple(found.values())


def _container(row: Row) -> Container:

    def number(name: str, missing: float = math.inf) -> float:
        value = row[name]
        return float(value) if isinstance(value, int | float) else missing

    iri = str(row["container"])
    return Container(
        iri=iri,
        name=local_name(iri),
        kind=local_name(str(row["kind"])).lower(),
        joint=str(row["joint"]),
        active_joint=str(row["active"]),
        multiplier=number("multiplier"),
        offset=number("offset"),
        handle=str(row["handle"]),
        lower=number("lower", -math.inf),
        upper=number("upper"),
        open_from=number("openFrom"),
        closed_to=number("closedTo", -math.inf),
        velocity=number("velocity"),
        acceleration=number("acceleration"),
    )
