"""A graph with the ontology as OWL: for owlready2 and for reasoners. Nothing is fetched."""

import io
from collections.abc import Iterable
from functools import cache
from typing import Any, Final

import pyoxigraph as ox

import ontology
from sdt_kg.errors import GraphError
from sdt_kg.iri import OWL, RDF, RDFS, SH, Iri

CORE: Final = ("sdt", "tee", "law")
TYPE: Final = ox.NamedNode(RDF + "type")
_IMPORTS: Final = ox.NamedNode(OWL + "imports")
_ONTOLOGY: Final = ox.NamedNode(OWL + "Ontology")
_INDIVIDUAL: Final = ox.NamedNode(OWL + "NamedIndividual")
_SCHEMA: Final = (OWL, RDF, RDFS, SH)

# owlready2 has no types of its own.
Owl = Any


@cache
def core_triples() -> frozenset[ox.Triple]:
    """What the three core ontologies say."""
    found: set[ox.Triple] = set()
    for name in CORE:
        text = ontology.path(f"{name}.ttl").read_bytes()
        found |= {quad.triple for quad in ox.parse(text, format=ox.RdfFormat.TURTLE)}
    return frozenset(found)


def with_core(quads: Iterable[ox.Quad]) -> frozenset[ox.Triple]:
    """The quads of all graphs and the core ontologies, as one ontology.

    Without `owl:imports`, which readers would fetch, and without the heads of the ontologies, of which
    owlready2 would take one for its own. Every subject with a type of ours is declared an individual:
    owlready2 lists no others.
    """
    triples = {quad.triple for quad in quads} | core_triples()
    triples = {each for each in triples if each.predicate != _IMPORTS and each.object != _ONTOLOGY}
    return frozenset(triples) | {
        ox.Triple(triple.subject, TYPE, _INDIVIDUAL)
        for triple in triples
        if triple.predicate == TYPE
        and isinstance(triple.object, ox.NamedNode)
        and not triple.object.value.startswith(_SCHEMA)
    }


def ntriples(triples: Iterable[ox.Triple]) -> bytes:
    """The triples as N-Triples, sorted."""
    written = ox.serialize(sorted(triples, key=str), format=ox.RdfFormat.N_TRIPLES)
    assert written is not None, "without an output, the bytes are returned"
    return written


def owlready_ontology(quads: Iterable[ox.Quad], iri: Iri) -> Owl:
    """The quads with the core ontologies as an owlready2 ontology of that IRI, in a world of its own.

    `onto.world[IRI]` gives a class or an individual, `onto.world.individuals()` all of them.

    Raises:
        GraphError: owlready2 cannot read it.
    """
    import owlready2  # noqa: PLC0415  # pyright: ignore[reportMissingTypeStubs] - only here; it has none

    library: Owl = owlready2
    made: Owl = library.World().get_ontology(f"{iri}#")
    try:
        # With an open file nothing is looked for elsewhere.
        made.load(fileobj=io.BytesIO(ntriples(with_core(quads))))
    except (library.OwlReadyError, ValueError, TypeError) as error:
        raise GraphError(f"owlready2 cannot read the graph: {error}") from None
    return made
