"""What was read of a model before, for those who would read it again."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sdt_kg.entities.container import Container
from sdt_kg.iri import Iri
from sdt_kg.store import Triple


@dataclass(frozen=True, slots=True)
class Told:
    """A model that stands alone.

    Attributes:
        model: Its IRI.
        graphs: Its graphs; first what is asserted of it, then what was inferred, in order.
        notes: What loading noticed.
        content_hash: Of its triples.
        containers: Those in it.
    """

    model: Iri
    graphs: Mapping[Iri, Sequence[Triple]]
    notes: Sequence[str]
    content_hash: str
    containers: tuple[Container, ...] = ()
