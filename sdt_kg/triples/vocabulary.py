"""The vocabulary of `sdt.ttl`, as far as what comes from outside is checked against it."""

import math
from enum import Enum
from functools import cache

import pyoxigraph as ox

import ontology
from sdt_kg.iri import OWL, RDFS, SDT, XSD, local_name
from sdt_kg.store import Term, value_of


class Kind(Enum):
    """What values of a property are."""

    INDIVIDUAL = "an IRI"
    NUMBER = "a finite number"
    AMOUNT = "a finite number, 0 or above"
    TEXT = "a text"
    TRUTH = "true or false"


NUMBERS = frozenset((Kind.NUMBER, Kind.AMOUNT))


AMOUNTS = frozenset(
    (
        "accelerationLimit",
        "baseAngularAcceleration",
        "baseAngularVelocity",
        "baseLinearAcceleration",
        "baseLinearVelocity",
        "effortLimit",
        "fingerDifference",
        "length",
        "mass",
        "opening",
        "overhang",
        "radius",
        "sizeX",
        "sizeY",
        "sizeZ",
        "softLimitGain",
        "velocityLimit",
    )
)
"""Properties that mean nothing below 0: no motion would break a negative limit of its speed."""


@cache
def _quads() -> tuple[ox.Quad, ...]:
    """All that `sdt.ttl` says, read once."""
    return tuple(ox.parse(ontology.path("sdt.ttl").read_bytes(), format=ox.RdfFormat.TURTLE))


@cache
def properties() -> dict[str, Kind]:
    """Local name of each property of `sdt.ttl` → what its values are."""
    kinds: dict[str, Kind] = {}
    ranges: dict[str, str] = {}
    for quad in _quads():
        if not isinstance(quad.subject, ox.NamedNode) or not isinstance(quad.object, ox.NamedNode):
            continue
        name = local_name(quad.subject.value)
        if quad.object.value == OWL + "ObjectProperty":
            kinds[name] = Kind.INDIVIDUAL
        elif quad.object.value == OWL + "DatatypeProperty":
            kinds[name] = Kind.AMOUNT if name in AMOUNTS else Kind.NUMBER
        elif quad.predicate.value == RDFS + "range":
            ranges[name] = quad.object.value
    by_range = {XSD + "string": Kind.TEXT, XSD + "boolean": Kind.TRUTH}
    return {name: by_range.get(ranges.get(name, ""), kind) for name, kind in kinds.items()}


@cache
def classes() -> frozenset[str]:
    """Local name of each class of `sdt.ttl`."""
    kind = ox.NamedNode(OWL + "Class")
    named = (
        quad.subject.value
        for quad in _quads()
        if quad.object == kind and isinstance(quad.subject, ox.NamedNode)
    )
    return frozenset(local_name(iri) for iri in named if iri.startswith(SDT))


def fits(kind: Kind, term: Term) -> bool:
    """Whether the term is a value of that kind."""
    value = value_of(term)
    if kind is Kind.INDIVIDUAL or isinstance(term, ox.NamedNode):
        return kind is Kind.INDIVIDUAL and isinstance(term, ox.NamedNode)
    if kind is Kind.TRUTH or isinstance(value, bool):
        return kind is Kind.TRUTH and isinstance(value, bool)
    if kind in NUMBERS:
        least = 0 if kind is Kind.AMOUNT else -math.inf
        return isinstance(value, int | float) and math.isfinite(value) and value >= least
    return isinstance(value, str)


DRIVES = {SDT + name for name in ("Omni", "Differential", "Fixed")}
"""Individuals that sdt:drive may name."""
