"""An edit of what is asserted of one model."""

from dataclasses import dataclass

from sdt_kg.iri import Iri
from sdt_kg.store import Triple


@dataclass(frozen=True, slots=True)
class Replacement:
    """An edit of one model's asserted triples.

    Attributes:
        model: IRI of the model.
        removed: Triples that have to be there, and then are not.
        added: Triples that then are.
        note: What was edited, in words.
    """

    model: Iri
    removed: frozenset[Triple]
    added: frozenset[Triple]
    note: str
