"""Shapes of a class D: what of them would let everything pass, and what they have to be shown."""

import math
from collections.abc import Iterator
from functools import cache, lru_cache
from typing import Final

import pyoxigraph as ox
import rdflib
from rdflib.namespace import DCTERMS, OWL, RDF, RDFS
from rdflib.namespace import SH as TERMS
from rdflib.term import Node

import ontology
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, SDT, SH, TEE, Iri

KEPT: Final = 16
"""[1] Graphs of shapes that are not looked at again."""

VOCABULARIES: Final = ("sdt.ttl", "law.ttl", "tee.ttl")

CORE: Final = (str(RDF), str(RDFS), str(DCTERMS))
"""Namespaces of which graphs of twins have terms, beside our own."""

IDLE: Final = frozenset(
    {
        *("targetClass", "targetNode", "targetObjectsOf", "targetSubjectsOf", "deactivated", "severity"),
        *("message", "name", "description", "order", "group", "defaultValue", "ignoredProperties"),
    }
)
"""Terms of SHACL that demand nothing."""

ASKING: Final = ("path", "inversePath", "targetClass", "targetObjectsOf", "targetSubjectsOf", "class")
"""Terms of SHACL whose values name what is looked at."""

LOOKING_ON: Final = ("node", "property", "qualifiedValueShape", "and", "or", "not", "xone", "closed")
"""Terms of SHACL by which a property shape asks what its values are, and have."""


def check_shapes(shapes: rdflib.Graph, expected: tuple[Iri, ...]) -> None:
    """Nothing in the shapes lets everything pass: no misspelt term, nothing idle, switched off or elsewhere.

    Args:
        shapes: SHACL.
        expected: IRIs of those that are to demand something.

    Raises:
        InputError: What would.
    """
    _checked(shapes, len(shapes), expected)


@lru_cache(maxsize=KEPT)
def _checked(shapes: rdflib.Graph, size: int, expected: tuple[Iri, ...]) -> None:
    del size  # so that a graph which grew is looked at again
    for triple in shapes:
        for what, allowed in _faults(*triple):
            raise InputError(f"the shapes {what}", allowed=allowed, remedy="correct them: they let all pass")
    for shape in expected:
        demands = {str(each).removeprefix(SH) for each in shapes.predicates(rdflib.URIRef(shape))}
        if not any(each in TERMS and each not in IDLE for each in demands):
            raise InputError(f"the shape <{shape}> demands nothing", allowed="sh:property, sh:class, …")


def _faults(subject: Node, predicate: Node, value: Node) -> Iterator[tuple[str, str]]:
    yield from _unknown(predicate)
    yield from _unknown(value)
    if predicate == OWL.imports:
        yield f"import {value.n3()}, which nothing fetches", "all shapes in one file"
    if predicate == TERMS.deactivated and str(value) in {"true", "1"}:
        yield f"have {_called(subject)} deactivated", "shapes that are wanted"
    if predicate == TERMS.js:
        yield f"have sh:js in {_called(subject)}, which nothing runs", "SHACL core"
    if isinstance(value, rdflib.Literal) and isinstance(number := value.value, float) and math.isnan(number):
        yield f"have a bound that is no number in {_called(subject)}", "a number"
    asked = isinstance(value, rdflib.URIRef) and predicate in {TERMS[each] for each in ASKING}
    if asked and not str(value).startswith((SDT, LAW, TEE, *CORE)):
        yield f"ask for {value.n3()}, which no graph of a twin has", "terms of sdt:, law: and tee:"


def _called(shape: Node) -> str:
    return shape.n3() if isinstance(shape, rdflib.URIRef) else "a shape without IRI"


def _unknown(node: Node) -> Iterator[tuple[str, str]]:
    name = str(node) if isinstance(node, rdflib.URIRef) else ""
    if name.startswith(SH.removesuffix("#")) and name.removeprefix(SH) not in TERMS:
        yield f"have <{name}>, which is no term of SHACL", f"terms of <{SH}>"
    if name.startswith((SDT, LAW, TEE)) and name not in declared():
        yield f"have <{name}>, which no vocabulary has", "sdt ontology lists all terms"


@cache
def declared() -> frozenset[Iri]:
    """IRIs that the vocabularies declare."""
    quads = (quad for name in VOCABULARIES for quad in ox.parse(path=str(ontology.path(name))))
    return frozenset(quad.subject.value for quad in quads if isinstance(quad.subject, ox.NamedNode))


def mentioned(shapes: rdflib.Graph) -> frozenset[Iri] | None:
    """Every IRI that the shapes speak of, and rdf:type; None where they may be about any predicate."""
    if any(predicate in {TERMS.closed, TERMS.sparql, TERMS.select} for predicate in shapes.predicates()):
        return None
    named = {str(node) for node in shapes.objects() if isinstance(node, rdflib.URIRef)}
    return frozenset({str(RDF.type), *named})


def followed(shapes: rdflib.Graph) -> frozenset[Iri]:
    """Predicates whose values the shapes look on to: on the way of longer paths, or of shapes of values."""
    found = set[Node]()
    for shape, path in shapes.subject_objects(TERMS.path):
        looks_on = any((shape, TERMS[each], None) in shapes for each in LOOKING_ON)
        if isinstance(path, rdflib.BNode) or looks_on:
            found |= {path, *shapes.transitive_objects(path, None)}
    return frozenset(str(each) for each in found if isinstance(each, rdflib.URIRef))
