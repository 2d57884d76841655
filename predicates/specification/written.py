"""The Turtle of a task: a graph with one task in it that has a name, and says all that it means."""

from typing import Final

import pyoxigraph as ox
import rdflib
from rdflib.namespace import OWL, RDF, RDFS
from rdflib.term import Node

from sdt_kg.errors import InputError
from sdt_kg.iri import ID, LAW, local_name

_UNFOLLOWED: Final = frozenset(
    {
        OWL.imports,
        OWL.sameAs,
        OWL.equivalentClass,
        OWL.equivalentProperty,
        RDFS.subClassOf,
        RDFS.subPropertyOf,
    }
)
"""What says that something counts which is not written here: nothing is fetched, and nothing inferred."""

BASE: Final = f"{ID}task/"
"""What IRIs are relative to that are so."""


def written_task(text: str, source: str) -> tuple[rdflib.Graph, rdflib.URIRef]:
    """The graph, and the one task in it.

    Raises:
        InputError: It does not parse, has not just one task with an IRI, or rests on what is not there.
    """
    graph = rdflib.Graph()
    try:
        graph.parse(data=text, format="turtle", publicID=BASE)  # whatever folder is the current one
    except (
        SyntaxError,
        ValueError,
        IndexError,
    ) as error:  # IndexError: rdflib's, of a text that ends too early
        raise InputError(f"{source} is not Turtle: {error}") from None
    found = list(graph.subjects(RDF.type, rdflib.URIRef(LAW + "TaskSpecification")))
    if len(found) != 1:
        raise InputError(
            f"{source} has {len(found)} task specifications", allowed="one law:TaskSpecification"
        )
    for subject, predicate, _ in graph:
        if predicate in _UNFOLLOWED:
            raise InputError(
                f"{source}: {predicate.n3()} of {local_name(str(subject))} is not followed",
                remedy="write out what it stands for",
            )
    return graph, _named(found[0], source)


def _named(node: Node, source: str) -> rdflib.URIRef:
    if isinstance(node, rdflib.URIRef):
        try:
            ox.NamedNode(str(node))
        except ValueError as error:
            raise InputError(
                f"{source}: the task's IRI is none: {error}", allowed="an absolute IRI"
            ) from None
        return node
    raise InputError(f"{source}: the task has no IRI", allowed="one, by which a result names it")
