"""Turtle → Specification about a kitchen; everything that does not fit is named."""

import math
from collections.abc import Callable
from dataclasses import replace
from enum import Enum
from textwrap import shorten
from typing import Final, TypeVar

import rdflib
from rdflib.namespace import RDF, RDFS
from rdflib.term import Node

from predicates.specification.model import (
    Demand,
    KeepsDistance,
    NeverBeyond,
    OpensBefore,
    Quality,
    QueryRule,
    Rule,
    Scope,
    Specification,
    StaysClosed,
    Step,
)
from predicates.specification.question import faults, is_question
from predicates.specification.written import written_task
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.iri import LAW, body_iri, local_name
from sdt_kg.numbers import number_in
from sdt_kg.store import checked_query
from sdt_kg.task import Verb
from sdt_kg.twin import Container, Twin

Member = TypeVar("Member", bound=Enum)

_LAW: Final = rdflib.Namespace(LAW)
_KNOWN: Final[dict[str, frozenset[str]]] = {
    "TaskSpecification": frozenset({"hasStep", "avoids", "keeps", "reaches", "optimises"}),
    "Task": frozenset({"index", "verb", "container", "containerName", "everyContainer", "goalPosition"}),
    "StaysClosed": frozenset({"container", "containerName"}),
    "NeverBeyond": frozenset({"container", "containerName", "limitPosition"}),
    "KeepsDistance": frozenset({"bodyName", "leastDistance"}),
    "OpensBefore": frozenset({"container", "containerName", "thenContainerName"}),
    "QueryRule": frozenset({"sparql", "over"}),
}
"""Which terms of law: each class may have: a misspelt rule must not be no rule."""

SHOWN: Final = 80
"""[characters] Of a query that has no name."""

_TERMS: Final = frozenset(term for terms in _KNOWN.values() for term in terms)


def read_specification(twin: Twin, text: str, source: str) -> Specification:
    """The one specification in a Turtle text, about the containers and bodies of the twin's kitchen.

    Args:
        twin: The kitchen.
        text: Turtle.
        source: Name of the file, for errors.

    Raises:
        InputError: It does not parse, lacks a part, or has one that is not known.
        UnknownEntityError: No such container or body.
        QueryError: A rule's query is not SPARQL that only reads.
    """
    graph, subject = written_task(text, source)
    try:
        return replace(_Reader(twin, graph, source).specification(subject), written=text)
    except UnknownEntityError as error:  # of a name in it, which may be meant for another kitchen
        error.be_from(f"{source}, asked in kitchen {twin.name(twin.environment)}")
        raise


class _Reader:
    """A graph that is read against a kitchen."""

    def __init__(self, twin: Twin, graph: rdflib.Graph, source: str) -> None:
        self._twin, self._graph, self._source = twin, graph, source
        self._read: set[Node] = set()

    def specification(self, subject: Node) -> Specification:
        self._check(subject, "TaskSpecification")
        rules = [
            self._rule(node, demand)
            for demand in Demand
            for node in sorted(self._graph.objects(subject, _LAW[demand.value]), key=str)
        ]
        steps = self._steps(subject)
        self._all_read()
        label = self._graph.value(subject, RDFS.label)
        quality = self._one(subject, "optimises")
        return Specification(
            iri=str(subject),
            label=self._source if label is None else str(label),
            steps=steps,
            rules=tuple(rules),
            quality=None if quality is None else self._member(Quality, quality, "quality"),
        )

    def _all_read(self) -> None:
        """That nothing which looks like a step or rule hangs in the air: it would silently not count."""
        for name in _KNOWN:
            loose = set(self._graph.subjects(RDF.type, _LAW[name])) - self._read
            if loose:
                raise self._error(f"{_name(min(loose, key=str))} is a law:{name} that nothing uses")
        for subject, predicate, value in self._graph:
            term = str(predicate if predicate != RDF.type else value)
            if term.startswith(LAW) and subject not in self._read:
                raise self._error(f"nothing uses {_name(subject)}, of which law:{local_name(term)} is said")

    def _steps(self, subject: Node) -> tuple[Step, ...]:
        numbered = [
            (self._number(node, "index"), self._step(node))
            for node in self._graph.objects(subject, _LAW.hasStep)
        ]
        if not numbered:
            raise self._error("the task has no steps", allowed="at least one law:hasStep")
        if len({index for index, _ in numbered}) < len(numbered):
            raise self._error("two steps have one law:index", allowed="a number for each")
        return tuple(step for _, step in sorted(numbered, key=lambda each: each[0]))

    def _step(self, node: Node) -> Step:
        self._check(node, "Task")
        verb = self._verb(node)
        if (every := self._one(node, "everyContainer")) is not None:
            if not (isinstance(every, rdflib.Literal) and every.toPython() is True):
                raise self._error(f"law:everyContainer of {_name(node)} is {every}", allowed="true")
            if any(
                self._one(node, name) is not None for name in ("container", "containerName", "goalPosition")
            ):
                raise self._error(f"{_name(node)} is about every container, and about one")
            return Step(verb, None)
        container = self._container(node)
        position = None
        if self._one(node, "goalPosition") is not None:
            if verb is not Verb.OPEN:
                raise self._error("law:goalPosition is of law:Open", remedy="leave it out to close")
            position = self._position(node, "goalPosition", container)
        return Step(verb, container, position)

    def _rule(self, node: Node, demand: Demand) -> Rule:
        if demand is not Demand.ALWAYS or self._is(node, "QueryRule"):
            return self._query_rule(node, demand)
        kinds: dict[str, Callable[[Node], Rule]] = {
            "StaysClosed": lambda each: StaysClosed(self._container(each)),
            "NeverBeyond": self._never_beyond,
            "KeepsDistance": self._keeps_distance,
            "OpensBefore": lambda each: OpensBefore(
                self._container(each), self._twin.container(self._text(each, "thenContainerName"))
            ),
        }
        for name, make in kinds.items():
            if self._is(node, name):
                self._check(node, name)
                return make(node)
        types = ", ".join(_name(each) for each in self._graph.objects(node, RDF.type)) or "of no class"
        raise self._error(
            f"the rule {_name(node)} is {types}", allowed=", ".join(f"law:{n}" for n in (*kinds, "QueryRule"))
        )

    def _never_beyond(self, node: Node) -> Rule:
        container = self._container(node)
        return NeverBeyond(container, self._position(node, "limitPosition", container))

    def _keeps_distance(self, node: Node) -> Rule:
        name, kitchen = self._text(node, "bodyName"), self._twin.mechanism(self._twin.environment)
        bodies = {body.name: body for body in kitchen.bodies}
        if name not in bodies:
            raise UnknownEntityError("body", name, bodies)
        if not bodies[name].collision:
            raise self._error(f"the body {name} has no collision shape", allowed="a body that has one")
        distance = self._number(node, "leastDistance")
        if distance <= 0:
            raise self._error(f"law:leastDistance is {distance:g}", allowed="more than 0 [m]")
        return KeepsDistance(body_iri(kitchen.name, name), distance)

    def _query_rule(self, node: Node, demand: Demand) -> Rule:
        if not self._is(node, "QueryRule"):
            raise self._error(
                f"law:{demand.value} {_name(node)}, which is no law:QueryRule",
                allowed="a query",
                remedy="rules that are ready, such as law:StaysClosed, are kept: use law:keeps",
            )
        self._check(node, "QueryRule")
        sparql = checked_query(self._text(node, "sparql"))
        if not is_question(sparql):
            raise self._error(f"the query of {_name(node)} is no question", allowed="ASK or SELECT")
        over = self._one(node, "over")
        scope = Scope.STATES if over is None else self._member(Scope, over, "scope")
        for what, allowed in faults(sparql, self._twin, scope):
            raise self._error(
                f"the query of {_name(node)} {what}",
                allowed=allowed,
                remedy="correct it: a question that has but one answer keeps every rule, or none",
            )
        label = self._graph.value(node, RDFS.label)
        name = shorten(sparql, SHOWN) if isinstance(node, rdflib.BNode) else _name(node)
        return QueryRule(name if label is None else str(label), sparql, scope, demand)

    def _is(self, node: Node, name: str) -> bool:
        return (node, RDF.type, _LAW[name]) in self._graph

    def _check(self, node: Node, name: str) -> None:
        """That the node is of the class and has no term of law: that the class does not have."""
        if not self._is(node, name):
            raise self._error(f"{_name(node)} is no law:{name}", remedy=f"write 'a law:{name}'")
        kinds = {str(each) for each in self._graph.objects(node, RDF.type) if str(each).startswith(LAW)}
        if len(kinds) > 1:
            raise self._error(
                f"{_name(node)} is {' and '.join(f'a law:{local_name(each)}' for each in sorted(kinds))}",
                allowed="one of them",
            )
        self._read.add(node)
        for predicate in set(self._graph.predicates(node)):
            term = local_name(str(predicate))
            if str(predicate) != LAW + term and term in _TERMS:
                raise self._error(f"{predicate} is no law:{term}", allowed=LAW + term)
            if str(predicate).startswith(LAW) and term not in _KNOWN[name]:
                raise self._error(
                    f"a law:{name} has no law:{term}",
                    allowed=", ".join(f"law:{each}" for each in sorted(_KNOWN[name])),
                )

    def _container(self, node: Node) -> Container:
        found = [self._one(node, name) for name in ("container", "containerName")]
        named = [each for each in found if each is not None]
        if len(named) != 1:
            raise self._error(
                f"{_name(node)} names {len(named)} containers",
                allowed="one law:containerName (or law:container, an IRI)",
            )
        return self._twin.container(str(named[0]))

    def _verb(self, node: Node) -> Verb:
        verb = self._one(node, "verb")
        verbs = {_LAW[each.value.capitalize()]: each for each in Verb}
        if not isinstance(verb, rdflib.URIRef) or verb not in verbs:
            raise self._error(f"the verb of {_name(node)} is {verb}", allowed="law:Open, law:Close")
        return verbs[verb]

    def _member(self, kind: type[Member], node: Node, what: str) -> Member:
        for each in kind:
            if node == _LAW[each.value]:
                return each
        raise self._error(
            f"no {what} '{_name(node)}'", allowed=", ".join(f"law:{each.value}" for each in kind)
        )

    def _one(self, node: Node, name: str) -> Node | None:
        found = list(self._graph.objects(node, _LAW[name]))
        if len(found) > 1:
            raise self._error(f"{_name(node)} has {len(found)} of law:{name}", allowed="one")
        return found[0] if found else None

    def _text(self, node: Node, name: str) -> str:
        found = self._one(node, name)
        if found is None:
            raise self._error(f"{_name(node)} has no law:{name}")
        return str(found)

    def _number(self, node: Node, name: str) -> float:
        text = self._text(node, name)
        try:
            found = number_in(text)
        except ValueError:
            found = math.nan
        if not math.isfinite(found):
            raise self._error(f"law:{name} of {_name(node)} is '{text}'", allowed="a finite number")
        return found

    def _position(self, node: Node, name: str, container: Container) -> float:
        position = self._number(node, name)
        if not container.lower <= position <= container.upper:
            raise self._error(
                f"law:{name} of {container.name} is {position:g}",
                allowed=f"{container.lower:g} to {container.upper:g} [rad or m]",
            )
        return position

    def _error(self, what: str, *, allowed: str = "", remedy: str = "") -> InputError:
        return InputError(f"{self._source}: {what}", allowed=allowed, remedy=remedy)


def _name(node: Node) -> str:
    return local_name(str(node))
