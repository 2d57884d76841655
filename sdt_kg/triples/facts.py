"""Facts: triples grouped by subject and property, for reading values back."""

import hashlib
import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import Final

from sdt_kg.errors import GraphError
from sdt_kg.iri import RDF, SDT, Iri
from sdt_kg.mechanism import Pose
from sdt_kg.store import Term, Triple, Value, value_of

TYPE: Final = RDF + "type"

PLACE_ONLY: Final = frozenset({SDT + "meshFile"})
"""Properties that say where something lies, not what it is: not hashed."""

UNIT_NORM: Final = 1e-5
"""[1] How far the norm of a quaternion or axis may be from 1: what is farther scales what it turns by more
than 0.02 mm for each metre. People who write 0.7071 are within."""


class Facts:
    """Triples by subject and property.

    Property names are local names of `sdt.ttl`; a full IRI works too.
    """

    def __init__(self, triples: Iterable[Triple]) -> None:
        self._values: dict[Iri, dict[Iri, list[Term]]] = {}
        self._subjects: dict[tuple[Iri, Iri], list[Iri]] = defaultdict(list)
        for subject, predicate, value in triples:
            self._values.setdefault(subject, {}).setdefault(predicate, []).append(value)
            if predicate in (TYPE, SDT + "partOf"):
                self._subjects[predicate, value.value].append(subject)

    @staticmethod
    def merged(parts: Sequence["Facts"]) -> "Facts":
        """What all parts say, in their order."""
        whole = Facts(())
        for part in parts:
            for subject, values in part._values.items():
                mine = whole._values.get(subject)
                whole._values[subject] = values if mine is None else _both(mine, values)
            for key, subjects in part._subjects.items():
                whole._subjects[key] += subjects
        return whole

    def all(self, subject: Iri, name: str) -> list[Value]:
        """All values, in a fixed order."""
        values = self._values.get(subject)
        terms = values.get(_iri(name), []) if values is not None else []
        return (
            [value_of(term) for term in sorted(terms, key=str)] if len(terms) > 1 else [*map(value_of, terms)]
        )

    def one(self, subject: Iri, name: str) -> Value:
        """The value, or None; the first in a fixed order where there are several."""
        values = self._values.get(subject)
        terms = None if values is None else values.get(_iri(name))
        if not terms:
            return None
        return value_of(terms[0] if len(terms) == 1 else min(terms, key=str))

    def number(self, subject: Iri, name: str, default: float | None = None) -> float:
        """The number, or the default.

        Raises:
            KeyError: There is none and no default: a bug of ours.
        """
        value = self.one(subject, name)
        if isinstance(value, int | float):
            return float(value)
        if default is None:
            raise KeyError((subject, name))
        return default

    def iris(self, subject: Iri, name: str) -> list[Iri]:
        """All values as IRIs."""
        return [str(value) for value in self.all(subject, name)]

    def types(self, subject: Iri) -> set[Iri]:
        """Classes of the subject."""
        return {str(value) for value in self.all(subject, TYPE)}

    def having(self, name: str, value: Iri) -> list[Iri]:
        """Subjects with that type, or part of that model."""
        return self._subjects.get((_iri(name), value), [])

    def subjects(self) -> Iterable[Iri]:
        """All subjects."""
        return self._values.keys()

    def triples(self) -> Iterable[Triple]:
        """All of them."""
        return (
            (subject, name, term)
            for subject, values in self._values.items()
            for name, terms in values.items()
            for term in terms
        )

    def content_hash(self) -> str:
        """SHA-256 over all of them, in the order of their text."""
        lines = {
            f"<{subject}> <{predicate}> {value}"
            for subject, predicate, value in self.triples()
            if predicate not in PLACE_ONLY
        }
        return hashlib.sha256("\n".join(sorted(lines)).encode()).hexdigest()

    def properties(self, subject: Iri) -> set[Iri]:
        """Properties that the subject has."""
        return set(self._values.get(subject, ()))

    def about(self, subject: Iri) -> Iterable[tuple[Iri, Term]]:
        """Properties and values of the subject."""
        values = self._values.get(subject, {})
        return ((name, term) for name, terms in values.items() for term in terms)

    def pose(self, subject: Iri) -> Pose:
        """The pose individual's value; coordinates in m, quaternion xyzw.

        Raises:
            GraphError: The quaternion is none of a rotation.
        """
        x, y, z = (self.number(subject, name) for name in ("x", "y", "z"))
        qx, qy, qz, qw = (self.number(subject, name) for name in ("qx", "qy", "qz", "qw"))
        norm = math.hypot(qx, qy, qz, qw)
        if abs(norm - 1) > UNIT_NORM:
            raise GraphError(
                f"the quaternion of '{subject}' has the norm {norm:.6g}",
                allowed="1",
                remedy="divide sdt:qx, sdt:qy, sdt:qz and sdt:qw by it",
            )
        return Pose((x, y, z), (qx, qy, qz, qw))

    def axis(self, subject: Iri) -> tuple[float, float, float]:
        """The joint's axis, of length 1.

        Raises:
            GraphError: It is longer or shorter: a slide would go farther than its position says.
        """
        x, y, z = (self.number(subject, name) for name in ("axisX", "axisY", "axisZ"))
        length = math.hypot(x, y, z)
        if abs(length - 1) > UNIT_NORM:
            raise GraphError(
                f"the axis of '{subject}' has the length {length:.6g}",
                allowed="1",
                remedy="divide sdt:axisX, sdt:axisY and sdt:axisZ by it",
            )
        return x, y, z


def _both(one: dict[Iri, list[Term]], other: dict[Iri, list[Term]]) -> dict[Iri, list[Term]]:
    return {name: one.get(name, []) + other.get(name, []) for name in (*one, *other)}


def _iri(name: str) -> Iri:
    return name if "/" in name else SDT + name
