"""Triples → an rdflib graph, for those who take no other: pySHACL does."""

from collections.abc import Iterable
from functools import lru_cache
from typing import Final

import pyoxigraph as ox
import rdflib
from rdflib.term import Node

from sdt_kg.iri import Iri
from sdt_kg.store import Term, Triple

KEPT: Final = 4096
"""[1] Terms that are kept: making one costs more than all that is done with it."""


def rdflib_graph(triples: Iterable[Triple]) -> rdflib.Graph:
    """A graph of its own with these triples."""
    graph = rdflib.Graph(bind_namespaces="none")  # of use to who prints it
    for subject, name, term in triples:
        graph.add((_iri(subject), _iri(name), _node(term)))
    return graph


@lru_cache(maxsize=KEPT)
def _iri(iri: Iri) -> rdflib.URIRef:
    return rdflib.URIRef(iri)


@lru_cache(maxsize=KEPT)
def _node(term: Term) -> Node:
    if isinstance(term, ox.NamedNode):
        return _iri(term.value)
    if term.language:
        return rdflib.Literal(term.value, lang=term.language)
    return rdflib.Literal(term.value, datatype=_iri(term.datatype.value))
