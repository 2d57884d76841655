"""The out-of-scope map: which containers are in which TEE class, and what would bring the others in."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import rdflib
from rdflib.namespace import RDF as RDF_NS
from rdflib.term import Node

from sdt_kg.annotating.annotate import tee_triples
from sdt_kg.iri import RDF, RDFS, SH, TEE, Iri, local_name
from sdt_kg.scope import D_ARTIC, TeeClass, request_graph, violations
from sdt_kg.shacl import TOO_MANY, Violation
from sdt_kg.twin import Container, LeftOut, Twin

SEVERAL: Final = "several"
"""What is told as the value of a property that has too many; the message says which."""

_SH = rdflib.Namespace(SH)
_BELOW = ("minInclusive", "minExclusive")
_ABOVE = ("maxInclusive", "maxExclusive")
_OTHER = ("lessThan", "lessThanOrEquals")


@dataclass(frozen=True, slots=True)
class Lack:
    """Why a container is outside a class.

    Attributes:
        value: As it is; None where nothing is known, `SEVERAL` where there are too many.
        bound: Where the interval ends; None where it is no number.
        missing: By how much the value is beyond the bound; None where it is no number.
        demanded: The interval in which a value has to lie, in words; empty where there is none.
    """

    focus: Iri
    path: Iri | None
    value: object
    bound: object
    missing: float | None
    demanded: str
    message: str

    @property
    def is_unmeasured(self) -> bool:
        """Whether a value that nobody has given would decide."""
        return self.value is None and self.path is not None


@dataclass(frozen=True, slots=True)
class End:
    """How near a value of a container that is inside comes to the end of its interval.

    Attributes:
        room: Until the bound, in the value's own unit.
    """

    focus: Iri
    path: Iri
    value: float
    bound: float
    room: float

    @property
    def share(self) -> float:
        """[1] Room relative to the larger of value and bound."""
        return self.room / max(abs(self.value), abs(self.bound), 1e-12)


@dataclass(frozen=True, slots=True)
class Membership:
    """Whether a container is in a class: what it lacks, or its ends, the nearest first."""

    container: str
    tee: TeeClass
    lacks: tuple[Lack, ...]
    ends: tuple[End, ...]

    @property
    def holds(self) -> bool:
        """Whether the container is inside."""
        return not self.lacks


@dataclass(frozen=True, slots=True)
class ScopeMap:
    """Every container of a kitchen in every class; and what is no container at all, with the reason."""

    classes: tuple[TeeClass, ...]
    members: tuple[Membership, ...]
    left_out: tuple[LeftOut, ...]

    def inside(self, tee: TeeClass) -> tuple[str, ...]:
        """Names of the containers in a class."""
        return tuple(each.container for each in self.members if each.tee == tee and each.holds)


def tee_classes() -> tuple[TeeClass, ...]:
    """Every class that `tee.ttl` describes, those which refine another after it."""
    own = {s for s, p, o in tee_triples() if p == RDF + "type" and o.value == TEE + "TeeClass"}
    labels = {s: o.value for s, p, o in tee_triples() if p == RDFS + "label" and s in own}
    found = [TeeClass(iri, labels.get(iri, local_name(iri))) for iri in own]
    return tuple(sorted(found, key=lambda each: (_depth(each), each.name)))


def _depth(tee: TeeClass) -> int:
    return 0 if tee.refined is None else 1 + _depth(tee.refined)


def scope_map(twin: Twin, robot: Iri | None = None) -> ScopeMap:
    """The map of a kitchen, with a robot or without.

    Args:
        twin: With what is known of forces, if anything is.
        robot: Left out, R is not checked.
    """
    classes = tee_classes()
    members = tuple(_member(twin, each, robot, tee) for each in twin.containers() for tee in classes)
    return ScopeMap(classes, members, twin.left_out())


def _member(twin: Twin, container: Container, robot: Iri | None, tee: TeeClass) -> Membership:
    found = violations(twin, container, robot, tee=tee)
    lacks = tuple(dict.fromkeys(_lack(each, tee) for each in found))
    ends = () if lacks else tuple(sorted(_ends(twin, container, robot, tee), key=lambda each: each.share))
    return Membership(container.name, tee, lacks, ends)


def _lack(one: Violation, tee: TeeClass) -> Lack:
    value, bound = SEVERAL if one.component == TOO_MANY else one.value, one.bound
    measured = isinstance(value, int | float) and isinstance(bound, int | float)
    missing = abs(float(value) - float(bound)) if measured else None  # pyright: ignore[reportArgumentType]  # both are numbers
    known = value if one.path is not None and measured else None
    demanded = _demanded(tee, one.path) if one.path is not None and value != SEVERAL else ""
    return Lack(one.focus, one.path, value if known is None else known, bound, missing, demanded, one.message)


def _demanded(tee: TeeClass, path: Iri) -> str:
    """The bounds of all shapes on a path, those of wider classes too; of a thing, the figures it needs."""
    words = {"minInclusive": "≥", "minExclusive": ">", "maxInclusive": "≤", "maxExclusive": "<"}
    words |= {"lessThan": "<", "lessThanOrEquals": "≤"}
    found: list[str] = []
    at: TeeClass | None = tee
    while at is not None:
        for shape in at.shapes.subjects(_SH.path, rdflib.URIRef(path)):
            for parameter, sign in words.items():
                found += [f"{sign} {_shown(bound)}" for bound in at.shapes.objects(shape, _SH[parameter])]
        for owner in at.shapes.subjects(_SH.targetObjectsOf, rdflib.URIRef(path)):
            paths = (at.shapes.value(each, _SH.path) for each in at.shapes.objects(owner, _SH.property))
            found += sorted(local_name(str(each)) for each in paths if each is not None)
        at = at.refined
    return ", ".join(dict.fromkeys(found))


def _shown(node: Node) -> str:
    return local_name(str(node)) if isinstance(node, rdflib.URIRef) else f"{float(str(node)):g}"


def _ends(twin: Twin, container: Container, robot: Iri | None, tee: TeeClass) -> Iterator[End]:
    """Every value that a shape bounds, with the bound that is nearer."""
    if tee.refined is not None:
        yield from _ends(twin, container, robot, tee.refined)
    data = request_graph(twin, container, robot, tee=tee)
    for shape, path in tee.shapes.subject_objects(_SH.path):
        bounds = [(float(str(each)), sign) for each, sign in _bounds(tee.shapes, shape)]
        others = [other for name in _OTHER for other in tee.shapes.objects(shape, _SH[name])]
        for focus in _focus(tee.shapes, shape, data):
            for value in _numbers(data, focus, path):
                rooms = [(sign * (bound - value) + 0.0, bound) for bound, sign in bounds]
                rooms += [(each - value, each) for other in others for each in _numbers(data, focus, other)]
                if rooms:
                    room, bound = min(rooms)
                    yield End(str(focus), str(path), value, bound, room)


def _bounds(shapes: rdflib.Graph, shape: Node) -> Iterator[tuple[Node, int]]:
    for names, sign in ((_BELOW, -1), (_ABOVE, 1)):
        for name in names:
            for bound in shapes.objects(shape, _SH[name]):
                yield bound, sign


def _focus(shapes: rdflib.Graph, shape: Node, data: rdflib.Graph) -> set[Node]:
    """What the shape that has this property looks at; nothing where it is part of a choice."""
    found: set[Node] = set()
    for owner in shapes.subjects(_SH.property, shape):
        for target in shapes.objects(owner, _SH.targetClass):
            found.update(data.subjects(RDF_NS.type, target))
        for target in shapes.objects(owner, _SH.targetObjectsOf):
            found.update(data.objects(None, target))
    return found


def _numbers(data: rdflib.Graph, focus: Node, path: Node) -> list[float]:
    values: Sequence[Node] = list(data.objects(focus, path))
    return [float(str(each)) for each in values if isinstance(each, rdflib.Literal) and _is_number(each)]


def _is_number(literal: rdflib.Literal) -> bool:
    value = literal.toPython()
    return not isinstance(value, bool | str) and value is not None


def report_turtle(twin: Twin, robot: Iri | None = None, tee: TeeClass = D_ARTIC) -> str:
    """SHACL validation report of all containers, as Turtle."""
    found = {each: None for one in twin.containers() for each in violations(twin, one, robot, tee=tee)}
    graph = rdflib.Graph()
    graph.bind("sh", SH)
    report = rdflib.URIRef(f"{twin.environment}/scope")
    graph.add((report, RDF_NS.type, _SH.ValidationReport))
    graph.add((report, _SH.conforms, rdflib.Literal(not found)))
    for number, violation in enumerate(found, 1):
        result = rdflib.URIRef(f"{report}/{number}")
        graph.add((report, _SH.result, result))
        for name, node in _result(violation):
            graph.add((result, name, node))
    return graph.serialize(format="turtle")


def _result(violation: Violation) -> Iterator[tuple[rdflib.URIRef, Node]]:
    yield rdflib.URIRef(RDF + "type"), _SH.ValidationResult
    yield _SH.focusNode, rdflib.URIRef(violation.focus)
    yield _SH.resultMessage, rdflib.Literal(violation.message)
    yield _SH.resultSeverity, _SH.Violation
    yield _SH.sourceShape, rdflib.URIRef(violation.shape)
    if violation.component is not None:
        yield _SH.sourceConstraintComponent, rdflib.URIRef(violation.component)
    if violation.path is not None:
        yield _SH.resultPath, rdflib.URIRef(violation.path)
    if violation.value is not None:
        yield _SH.value, rdflib.Literal(violation.value)


def to_json(kitchen: str, found: ScopeMap) -> dict[str, object]:
    """The object that `sdt scope --explain --json` prints."""
    count = len({each.container for each in found.members})
    return {
        "kitchen": kitchen,
        "classes": [
            {"iri": each.iri, "name": each.name, "in": len(found.inside(each)), "of": count}
            for each in found.classes
        ],
        "containers": [
            {
                "container": each.container,
                "class": each.tee.name,
                "in_scope": each.holds,
                "lacks": [lack_json(lack) for lack in each.lacks],
                "ends": [end_json(end) for end in each.ends],
            }
            for each in found.members
        ],
        "left_out": [
            {"body": local_name(each.body), "joint": local_name(each.joint), "reason": each.reason}
            for each in found.left_out
        ],
    }


def lack_json(one: Lack) -> dict[str, object]:
    """Why a container is outside, with names."""
    return {
        "focus": local_name(one.focus),
        "path": None if one.path is None else local_name(one.path),
        "value": one.value,
        "bound": one.bound,
        "missing": one.missing,
        "demanded": one.demanded,
        "unmeasured": one.is_unmeasured,
        "message": one.message,
    }


def end_json(one: End) -> dict[str, object]:
    """The end of an interval, with names."""
    return {
        "focus": local_name(one.focus),
        "path": local_name(one.path),
        "value": one.value,
        "bound": one.bound,
        "room": one.room,
    }
