"""What an edit leaves as it is: bodies that need not be read from the graph again."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from sdt_kg.iri import SDT, Iri, body_iri
from sdt_kg.mechanism import Body, Mechanism
from sdt_kg.store import Triple

_PARTS: Final = {SDT + name for name in ("hasInertia", "hasCollisionGeometry", "hasPose")}
"""Properties that lead from a body to all else that is read of it."""


@dataclass(frozen=True, slots=True)
class Same:
    """What a model was before an edit, as far as it still is that.

    Attributes:
        changed: Individuals of which something else is said now.
        bodies: IRI → the body, of those of which no part is among them.
    """

    changed: Collection[Iri]
    bodies: Mapping[Iri, Body]


def same(before: Mechanism, triples: Iterable[Triple], changed: Collection[Triple]) -> Same:
    """What is as it was.

    Args:
        before: The mechanism, read from a whole model.
        triples: What is said of the model now.
        changed: What was not said before, or is no longer.
    """
    bodies = {body_iri(before.name, each.name): each for each in before.bodies}
    owners: dict[Iri, list[Iri]] = {}
    for subject, predicate, value in triples:
        if predicate in _PARTS:
            owners.setdefault(value.value, []).append(subject)
    todo = [subject for subject, predicate, _ in changed if predicate in _PARTS or subject not in bodies]
    touched = set(todo)
    while todo:
        above = [each for each in owners.get(todo.pop(), ()) if each not in touched]
        touched.update(above)
        todo += above
    return Same(
        {subject for subject, _, _ in changed},
        {iri: body for iri, body in bodies.items() if iri not in touched},
    )
