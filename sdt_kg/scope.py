"""Scope: is a request inside a TEE class D, so that its physics may be trusted at all?

The class's shapes run on the request's own subgraph (pySHACL; on a whole twin it is a hundred
times slower). Conforming is not enough: a shape which finds no focus node is a violation too,
since a typo in a target would otherwise let everything pass.
"""

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import chain
from typing import Final

import pyoxigraph as ox
import rdflib

import ontology
from sdt_kg.annotating.annotate import tee_triples
from sdt_kg.entities import Entities
from sdt_kg.entities.moving_together import MOVES_WITH, moving_together
from sdt_kg.entities.narrowed import narrowed
from sdt_kg.iri import LAW, RDF, SDT, TEE, Iri, local_name
from sdt_kg.shacl import Violation, check, order
from sdt_kg.shapes import followed, mentioned
from sdt_kg.store import Triple
from sdt_kg.triples import Facts
from sdt_kg.triples.to_rdflib import rdflib_graph
from sdt_kg.twin import Container, Twin

_TASK: Final = "https://example.org/id/request/task"

OF_ITS_WAY: Final = frozenset({SDT + "closedTo", SDT + "lowerLimit"})
"""What of a joint may be outside for where others let it move that it moves with."""

KEPT: Final = 256
"""[1] Parts of requests whose violations are kept: the containers of some kitchens, and robots."""

Asked = tuple["TeeClass", tuple[Triple, ...], tuple[Iri, ...]]
"""A class, what is said of a request's kitchen or robot, and the shapes that have to find something there."""

Seen = dict[Asked, tuple[Violation, ...]]
"""How it lies outside the class."""


@dataclass(frozen=True, slots=True)
class Asks:
    """What shapes ask for.

    Attributes:
        names: Predicates; None: any.
        onward: Those of them whose values' own triples are asked for.
    """

    names: frozenset[Iri] | None
    onward: frozenset[Iri]

    @staticmethod
    def of(shapes: rdflib.Graph) -> "Asks":
        """What these do."""
        return Asks(mentioned(shapes), followed(shapes))

    def __contains__(self, name: Iri) -> bool:
        return self.names is None or name in self.names


@dataclass(frozen=True)
class TeeClass:
    """D: tasks, environments, robots, physics and its validity intervals, each a set of shapes.

    Attributes:
        iri: Individual of `tee.ttl`.
        name: For people.
    """

    iri: Iri
    name: str

    def __reduce__(self) -> tuple[type["TeeClass"], tuple[Iri, str]]:
        """Another process reads its files itself."""
        return TeeClass, (self.iri, self.name)

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
    def asks(self) -> "Asks":
        """What has to be said of a request, so that the shapes can judge it."""
        return Asks.of(self.shapes)

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

    Outside every class is a kitchen that no state keeps within its limits: of that, too, no shape tells.

    Args:
        twin: The kitchen, and the robot if there is one.
        container: What the request is about.
        robot: Left out, R is not checked.
        verb: `law:Open` or `law:Close`; left out, T is not checked.
        tee: D.
    """
    wider = (
        list(_stateless(twin, tee))
        if tee.refined is None
        else violations(twin, container, robot, verb, tee.refined)
    )
    found = chain.from_iterable(_checked(*each) for each in _asked(twin, container, robot, verb, tee))
    return [*wider, *(_explained(twin, container, each) for each in sorted(found, key=order))]


def _explained(twin: Twin, container: Container, violation: Violation) -> Violation:
    """The violation; where another joint leaves the container's too little of its way, that first."""
    if violation.focus != container.joint or violation.path not in OF_ITS_WAY:
        return violation
    why = narrowed(twin.entities.coupling, container.joint)
    return replace(violation, message=f"{why} ({violation.message})") if why else violation


def _stateless(twin: Twin, tee: TeeClass) -> Iterator[Violation]:
    """Joints of the kitchen whose limits contradict each other; the class itself says so, not a shape."""
    kitchen = twin.entities.coupling
    for each in kitchen.contradictions:
        name, other = local_name(each.joint), local_name(each.other)
        path, most, own = (
            ("lowerLimit", "most", "lower") if each.is_lower else ("upperLimit", "least", "upper")
        )
        where = f"wherever '{other}' keeps its limits" if each.other != each.joint else "by its other limit"
        said = (
            f"no state of the kitchen keeps its limits: '{name}' is at {most} {each.reached:.6g} {where}, "
            f"and its own {own} limit is {each.limit:.6g}: repair one of the two"
        )
        yield Violation(each.joint, SDT + path, each.limit, each.reached, said, tee.iri)


def look(twin: Twin, verb: Iri | None = None, tee: TeeClass = D_ARTIC) -> Seen:
    """What `violations` finds of all containers, for another process to `remember`."""
    asked = (_asked_of_kitchen(twin, one, verb, tee) for one in twin.containers())
    return {each: _checked(*each) for each in asked}


def look_at_robot(robot: Entities, tee: TeeClass = D_ARTIC) -> Seen:
    """The same of a robot that stands alone."""
    asked = _asked_of_robot(robot.facts, robot.environment, tee)
    return {asked: _checked(*asked)}


def remember(found: Seen) -> None:
    """What another process found is not looked for here; what is said otherwise by then is."""
    _elsewhere.update(found)


_elsewhere: Seen = {}
"""What another process found, until it is asked for."""


def _asked(
    twin: Twin, container: Container, robot: Iri | None, verb: Iri | None, tee: TeeClass
) -> Iterator[Asked]:
    """The kitchen's and the robot's part of a request: no shape looks from one into the other."""
    yield _asked_of_kitchen(twin, container, verb, tee)
    if robot is not None:
        yield _asked_of_robot(twin.entities.facts, robot, tee)


def _asked_of_kitchen(twin: Twin, container: Container, verb: Iri | None, tee: TeeClass) -> Asked:
    parts = ["Environment", "Physics", *(["Task"] if verb is not None else [])]
    return tee, tuple(_of_kitchen(twin, container, verb, tee.asks)), _shapes_of(tee, parts)


def _asked_of_robot(facts: Facts, robot: Iri, tee: TeeClass) -> Asked:
    return tee, tuple(_of_robot(facts, robot, tee.asks)), _shapes_of(tee, ["Robot"])


def _shapes_of(tee: TeeClass, parts: list[str]) -> tuple[Iri, ...]:
    return tuple(shape for part in parts for shape in tee.shapes_of(part))


@lru_cache(maxsize=KEPT)
def _checked(tee: TeeClass, request: tuple[Triple, ...], expected: tuple[Iri, ...]) -> tuple[Violation, ...]:
    """Violations of a part of a request: kept, since a motion is found and verified for the same one."""
    found = _elsewhere.pop((tee, request, expected), None)
    return tuple(check(rdflib_graph(request), tee.shapes, list(expected))) if found is None else found


def request_graph(
    twin: Twin,
    container: Container,
    robot: Iri | None = None,
    verb: Iri | None = None,
    tee: TeeClass | rdflib.Graph = D_ARTIC,
) -> rdflib.Graph:
    """What the graph says of the individuals that the request is about, as far as the class asks.

    Args:
        twin: The kitchen, and the robot if there is one.
        container: What the request is about.
        robot: Left out, nothing of R is said.
        verb: `law:Open` or `law:Close`; left out, nothing of T is said.
        tee: D, or shapes that are to become one.
    """
    asks = Asks.of(tee) if isinstance(tee, rdflib.Graph) else tee.asks
    kitchen = _of_kitchen(twin, container, verb, asks)
    return rdflib_graph(chain(kitchen, () if robot is None else _of_robot(twin.entities.facts, robot, asks)))


def _of_robot(facts: Facts, robot: Iri, asks: Asks) -> Iterator[Triple]:
    yield from _mentioned(facts, [robot, *facts.iris(robot, "hasGripper")], asks)


def _of_kitchen(twin: Twin, container: Container, verb: Iri | None, asks: Asks) -> Iterator[Triple]:
    facts = twin.entities.facts
    subjects = [twin.environment, container.iri, *facts.iris(container.iri, "hasHandle")]
    subjects += facts.iris(container.iri, "hasJoint")
    if SDT + "hasForceModel" in asks:
        yield from (coupled := list(moving_together(twin.mechanism(twin.environment), container.joint)))
        subjects += [term.value for _, name, term in coupled if name == MOVES_WITH]
        subjects += [model for each in subjects for model in facts.iris(each, "hasForceModel")]
    yield from _mentioned(facts, subjects, asks)
    if verb is not None:
        yield _TASK, RDF + "type", ox.NamedNode(LAW + "Task")
        yield _TASK, LAW + "verb", ox.NamedNode(verb)
        yield _TASK, LAW + "container", ox.NamedNode(container.iri)


def _mentioned(facts: Facts, subjects: Iterable[Iri], asks: Asks) -> Iterator[Triple]:
    """What is asked for of the subjects, and of what they lead on to."""
    left = list(subjects)
    known = set(left)
    while left:
        subject = left.pop(0)
        for name, term in facts.about(subject):
            if name in asks:
                yield subject, name, term
            if name in asks.onward and isinstance(term, ox.NamedNode) and term.value not in known:
                known.add(term.value)
                left.append(term.value)
