"""Values of the properties of the individuals in one verdict's graph."""

from collections.abc import Iterable, Mapping
from typing import TypeVar

import pyoxigraph as ox

from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, RDF, Iri, local_name
from sdt_kg.store import Value, value_of

T = TypeVar("T")


class Facts:
    """Values of the properties of one verdict's graph.

    Raises:
        InputError: From any method that needs a value: the graph is not what the record writer wrote.
    """

    def __init__(self, quads: Iterable[ox.Quad]) -> None:
        self._values: dict[tuple[str, str], list[Value]] = {}
        for quad in quads:
            if not isinstance(quad.subject, ox.NamedNode):
                raise damaged(str(quad.subject), "no blank node is written here")
            key = (quad.subject.value, quad.predicate.value)
            self._values.setdefault(key, []).append(value_of(quad.object))

    def all(self, subject: Iri, name: Iri) -> list[str]:
        """IRIs or texts, numbered parts in the order of their numbers."""
        return sorted((str(each) for each in self._values.get((subject, name), [])), key=_numbered)

    def text(self, subject: Iri, name: Iri) -> str | None:
        """The IRI or text, the first of several; None where there is none."""
        return next(iter(self.all(subject, name)), None)

    def value(self, subject: Iri, name: Iri) -> Value:
        """The value, whatever its type."""
        return next(iter(self._values.get((subject, name), [])), None)

    def check_kind(self, subject: Iri, kind: str) -> None:
        """The individual is of a class of law:.

        Raises:
            InputError: It is not.
        """
        if LAW + kind not in self.all(subject, RDF + "type"):
            raise InputError(
                f"the record of {local_name(subject)} is of no law:{kind}",
                allowed="a record as it was written",
                remedy="it was changed: judge the case again into another store",
            )

    def check_once(self, subject: Iri, names: Iterable[Iri]) -> None:
        """The individual has none of these properties twice: else queries find what nobody reads.

        Raises:
            InputError: It has.
        """
        for name in names:
            if len(values := self._values.get((subject, name), [])) > 1:
                raise damaged(subject, f"it has {len(values)} values of {name}")

    def truth(self, subject: Iri, name: Iri) -> bool | None:
        """The boolean, None where there is none."""
        value = self.value(subject, name)
        return value if isinstance(value, bool) else None

    def number(self, subject: Iri, name: Iri) -> float | None:
        """The number, None where there is none."""
        value = self.value(subject, name)
        return float(value) if isinstance(value, int | float) else None

    def needed(self, subject: Iri, name: Iri) -> str:
        """The IRI or text that must be there."""
        text = self.text(subject, name)
        if text is None:
            raise damaged(subject, f"it has no {name}")
        return text

    def measured(self, subject: Iri, name: Iri) -> float:
        """The number that must be there."""
        number = self.number(subject, name)
        if number is None:
            raise damaged(subject, f"{name} is no number")
        return number


def damaged(subject: Iri, what: str) -> InputError:
    """The error of a record that was not written like this."""
    return InputError(
        f"the record of {subject} is damaged: {what}", remedy="it was edited, or another version wrote it"
    )


def term(terms: Mapping[str, T], iri: Iri) -> T:
    """The value for which a term of law: stands."""
    if local_name(iri) not in terms:
        raise damaged(iri, "no such term is known here")
    return terms[local_name(iri)]


def _numbered(iri: str) -> tuple[int, str]:
    number = iri.rsplit("/", 1)[-1]
    return (int(number) if number.isdecimal() else 0), iri
