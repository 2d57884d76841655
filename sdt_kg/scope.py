"""Scope: is a request inside a TEE class D, so that its physics may be trusted at all?

The class's shapes run on the request's own subgraph (pySHACL; on a whole twin it is a hundred
times slower). Conforming is not enough: a shape which finds no focus node is a violation too,
since a typo in a target would otherwise let everything pass.
"""

import hashlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property, lru_cache
from itertools import chain
from typing import Final

import pyoxigraph as ox
import rdflib
from rdflib.namespace import RDF as RDF_NS
from rdflib.term import Node

import ontology
from sdt_kg.annotating.annotate import tee_triples
from sdt_kg.entities.moving_together import MOVES_WITH, moving_together
from sdt_kg.iri import LAW, RDF, SDT, SH, TEE, Iri, local_name
from sdt_kg.shacl import pyshacl
from sdt_kg.store import Triple, Value
from sdt_kg.triples import Facts
from sdt_kg.triples.to_rdflib import rdflib_graph
from sdt_kg.twin import Container, Twin

_TASK: Final = "https://example.org/id/request/task"
_SH: Final = rdflib.Namespace(SH)

KEPT: Final = 256
"""[1] Requests whose violations are kept: the containers of some kitchens."""

Engine = Callable[[rdflib.Graph, rdflib.Graph], rdflib.Graph]
"""Data and shapes → SHACL validation report."""

# Constraint component → the parameter which holds its bound.
_BOUNDS: Final = {
    "ClassConstraintComponent": "class",
    "InConstraintComponent": "in",
    "LessThanConstraintComponent": "lessThan",
    "LessThanOrEqualsConstraintComponent": "lessThanOrEquals",
    "MaxCountConstraintComponent": "maxCount",
    "MaxExclusiveConstraintComponent": "maxExclusive",
    "MaxInclusiveConstraintComponent": "maxInclusive",
    "MinCountConstraintComponent": "minCount",
    "MinExclusiveConstraintComponent": "minExclusive",
    "MinInclusiveConstraintComponent": "minInclusive",
}


@dataclass(frozen=True, slots=True)
class Violation:
    """One SHACL result.

    Attributes:
        focus: The individual that is outside, or the shape which found none to look at.
        path: The property concerned, None for a constraint on the individual itself.
        value: Its value, None where there is none.
        bound: What the shape asks for, None where it is no single value.
        message: What to repair.
        shape: IRI of the shape.
        component: IRI of the constraint component, None for a shape without focus node.
    """

    focus: Iri
    path: Iri | None
    value: Value
    bound: Value
    message: str
    shape: Iri
    component: Iri | None = None


@dataclass(frozen=True)
class TeeClass:
    """D: tasks, environments, robots, physics and its validity intervals, each a set of shapes.

    Attributes:
        iri: Individual of `tee.ttl`.
        name: For people.
    """

    iri: Iri
    name: str

    @cached_property
    def _facts(self) -> Facts:
        return Facts(tee_triples())

    @cached_property
    def refined(self) -> "TeeClass | None":
        """The wider class whose shapes and constants hold here too."""
        wider = self._facts.iris(self.iri, TEE + "refines")
        return TeeClass(wider[0], local_name(wider[0])) if wider else None

    @cached_property
    def shapes(self) -> rdflib.Graph:
        """The shapes file, without those of a class that it refines."""
        # Without the prefixes that rdflib knows: each report would bind them all. In a store of one graph
        # only: pySHACL asks it so often that the other takes a quarter of its time to look for contexts.
        graph = rdflib.Graph(store="SimpleMemory", bind_namespaces="none")
        return graph.parse(data=self._shapes_text(), format="turtle")

    @cached_property
    def mentioned(self) -> frozenset[Iri]:
        """Every IRI that the shapes speak of, and rdf:type."""
        named = {str(node) for node in self.shapes.objects() if isinstance(node, rdflib.URIRef)}
        return frozenset({RDF + "type", *named})

    def shapes_of(self, part: str) -> list[Iri]:
        """Shapes of a part of D: Task, Environment, Robot or Physics."""
        return self._facts.iris(self.iri, f"{TEE}has{part}Shape")

    def number(self, name: str) -> float:
        """A constant of the class: openFraction, closedTolerance, defaultAcceleration."""
        own = self.refined.number(name) if self.refined is not None else None
        return self._facts.number(self.iri, TEE + name, own)

    @cached_property
    def content_hash(self) -> str:
        """SHA-256 of its constants and shapes, and of what it refines; part of every verdict's hash.

        What `tee.ttl` says about its own terms, labels and comments say, decides no verdict.
        """
        own = (each for each in tee_triples() if each[0] == self.iri and each[1].startswith(TEE))
        constants = sorted(f"{s} {p} {o}" for s, p, o in own)
        wider = () if self.refined is None else (self.refined.content_hash,)
        return hashlib.sha256("\n".join((*constants, self._shapes_text(), *wider)).encode()).hexdigest()

    def _shapes_text(self) -> str:
        return ontology.path(f"shapes/{self._facts.one(self.iri, TEE + 'shapesFile')}").read_text("utf-8")


D_ARTIC: Final = TeeClass(TEE + "D_artic", "D_artic")
D_ARTIC_DYN: Final = TeeClass(TEE + "D_artic_dyn", "D_artic_dyn")
TEE_CLASSES: Final = (D_ARTIC, D_ARTIC_DYN)


def violations(
    twin: Twin,
    container: Container,
    robot: Iri | None = None,
    verb: Iri | None = None,
    tee: TeeClass = D_ARTIC,
) -> list[Violation]:
    """How the request lies outside the class, and outside those that it refines; empty inside.

    Args:
        twin: The kitchen, and the robot if there is one.
        container: What the request is about.
        robot: Left out, R is not checked.
        verb: `law:Open` or `law:Close`; left out, T is not checked.
        tee: D.
    """
    wider = [] if tee.refined is None else violations(twin, container, robot, verb, tee.refined)
    asked = ["Environment", "Physics", *(["Task"] if verb is not None else [])]
    found = _checked(tee, tuple(_of_kitchen(twin, container, verb, tee)), _shapes_of(tee, asked))
    if robot is not None:
        found += _checked(tee, tuple(_of_robot(twin, robot, tee)), _shapes_of(tee, ["Robot"]))
    return [*wider, *sorted(found, key=_order)]


def _shapes_of(tee: TeeClass, parts: list[str]) -> tuple[Iri, ...]:
    return tuple(shape for part in parts for shape in tee.shapes_of(part))


@lru_cache(maxsize=KEPT)
def _checked(tee: TeeClass, request: tuple[Triple, ...], expected: tuple[Iri, ...]) -> tuple[Violation, ...]:
    """Violations of the kitchen's or the robot's part of a request: no shape looks from one into the other.

    Kept, since a motion is found and verified for the same one, and other robots are asked about it.
    """
    return tuple(check(rdflib_graph(request), tee.shapes, list(expected)))


def pyshacl_report(data: rdflib.Graph, shapes: rdflib.Graph) -> rdflib.Graph:
    """The validation report of pySHACL, without inference: the engine of every verdict."""
    report = pyshacl().validate(data, shacl_graph=shapes, inference="none")[1]
    assert isinstance(report, rdflib.Graph), "pyshacl answers with a graph, or raises"
    return report


def check(
    data: rdflib.Graph, shapes: rdflib.Graph, expected: list[Iri], engine: Engine = pyshacl_report
) -> list[Violation]:
    """SHACL results of the data, and a violation for each expected shape without focus node."""
    found = [_without_focus(shape) for shape in expected if not _has_focus(data, shapes, shape)]
    found += read_report(data, shapes, engine(data, shapes))
    return sorted(found, key=_order)


def _order(each: Violation) -> tuple[str, str, str]:
    return each.focus, each.path or "", each.message


def read_report(data: rdflib.Graph, shapes: rdflib.Graph, report: rdflib.Graph) -> list[Violation]:
    """The results of a SHACL validation report about the data; details of a result are not results."""
    return [_violation(data, shapes, report, result) for result in report.objects(None, _SH.result)]


def _has_focus(data: rdflib.Graph, shapes: rdflib.Graph, shape: Iri) -> bool:
    node = rdflib.URIRef(shape)
    found = [data.subjects(RDF_NS.type, each) for each in shapes.objects(node, _SH.targetClass)]
    found += [data.objects(None, each) for each in shapes.objects(node, _SH.targetObjectsOf)]
    return any(next(each, None) is not None for each in found)


def _without_focus(shape: Iri) -> Violation:
    said = f"the shape <{shape}> finds nothing to look at: nothing is known to be inside the class"
    return Violation(shape, None, None, None, said, shape)


def _violation(data: rdflib.Graph, shapes: rdflib.Graph, report: rdflib.Graph, result: Node) -> Violation:
    def one(name: str) -> Node | None:
        return report.value(result, _SH[name])

    focus, path, source = one("focusNode"), one("resultPath"), one("sourceShape")
    component = str(one("sourceConstraintComponent"))
    parameter = _BOUNDS.get(component.removeprefix(SH), "")
    bound = shapes.value(source, _SH[parameter]) if parameter else None
    if parameter.startswith("lessThan") and focus is not None and bound is not None:
        bound = data.value(focus, bound)
    return Violation(
        focus=str(focus),
        path=None if path is None else str(path),
        value=_value(one("value")),
        bound=_value(bound),
        message=str(one("resultMessage")),
        shape=str(source),
        component=component,
    )


def _value(node: Node | None) -> Value:
    if not isinstance(node, rdflib.Literal):
        return None if node is None or isinstance(node, rdflib.BNode) else str(node)
    value = node.toPython()
    if isinstance(value, bool | int | str):
        return value
    return float(value) if isinstance(value, float | Decimal) else str(node)


def request_graph(
    twin: Twin,
    container: Container,
    robot: Iri | None = None,
    verb: Iri | None = None,
    tee: TeeClass = D_ARTIC,
) -> rdflib.Graph:
    """What the graph says of the individuals that the request is about, as far as the class asks."""
    kitchen = _of_kitchen(twin, container, verb, tee)
    return rdflib_graph(chain(kitchen, () if robot is None else _of_robot(twin, robot, tee)))


def _of_robot(twin: Twin, robot: Iri, tee: TeeClass) -> Iterator[Triple]:
    facts = twin.entities.facts
    yield from _mentioned(facts, [robot, *facts.iris(robot, "hasGripper")], tee)


def _of_kitchen(twin: Twin, container: Container, verb: Iri | None, tee: TeeClass) -> Iterator[Triple]:
    facts = twin.entities.facts
    subjects = [twin.environment, container.iri, *facts.iris(container.iri, "hasHandle")]
    subjects += facts.iris(container.iri, "hasJoint")
    if SDT + "hasForceModel" in tee.mentioned:
        yield from (coupled := list(moving_together(twin.mechanism(twin.environment), container.joint)))
        subjects += [term.value for _, name, term in coupled if name == MOVES_WITH]
        subjects += [model for each in subjects for model in facts.iris(each, "hasForceModel")]
    yield from _mentioned(facts, subjects, tee)
    if verb is not None:
        yield _TASK, RDF + "type", ox.NamedNode(LAW + "Task")
        yield _TASK, LAW + "verb", ox.NamedNode(verb)
        yield _TASK, LAW + "container", ox.NamedNode(container.iri)


def _mentioned(facts: Facts, subjects: Iterable[Iri], tee: TeeClass) -> Iterator[Triple]:
    for subject in subjects:
        yield from ((subject, name, term) for name, term in facts.about(subject) if name in tee.mentioned)
