"""Entities: what a twin says whatever its state, shared by all its branches."""

import hashlib
import math
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import chain
from threading import Lock
from typing import Final

import pyoxigraph as ox

import ontology
from sdt_kg.annotate import TEE_GRAPH, annotate
from sdt_kg.annotation import RobotAnnotation
from sdt_kg.coupling import Coupling
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.iri import SDT, Iri, graph_iri, local_name
from sdt_kg.mechanism import Mechanism
from sdt_kg.state import State
from sdt_kg.store import MemoryStore, Row, Store, Triple, Value, double, rows_of, term_of
from sdt_kg.triples import Facts, checked_model, read_mechanism_of
from sdt_kg.vocabulary import fits, properties

KEPT_STATES: Final = 256
"""State graphs that a store keeps at a time; a dropped one is written again when asked for."""

_PLACE_ONLY: Final = {SDT + "meshFile"}
"""Properties that say where something lies, not what it is: not hashed."""


@dataclass(frozen=True, slots=True)
class Container:
    """A counted container of a kitchen.

    Attributes:
        iri: IRI of its body.
        name: Name of its body.
        kind: `door` or `drawer`.
        joint: IRI of its own joint p_c.
        active_joint: IRI of the joint that is actuated: the mimicked one for a mimic door.
        multiplier: p_c = multiplier · p_active + offset.
        offset: See multiplier.
        handle: IRI of its handle's body.
        lower, upper: Effective limits of p_c [rad or m], over the coupling; infinite if there are none.
        open_from: Threshold of open(c): 0.9 · upper.
        closed_to: Threshold of closed(c): lower + epsilon.
        velocity, acceleration: Effective limits of p_c; infinite if there are none.
    """

    iri: Iri
    name: str
    kind: str
    joint: Iri
    active_joint: Iri
    multiplier: float
    offset: float
    handle: Iri
    lower: float
    upper: float
    open_from: float
    closed_to: float
    velocity: float
    acceleration: float


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A joint with a handle, or a door or drawer by name, that is not counted.

    Attributes:
        joint: IRI of the joint.
        body: IRI of the body which it moves.
        reason: One sentence.
    """

    joint: Iri
    body: Iri
    reason: str


@dataclass(frozen=True)
class Entities:
    """What does not change with the state: shared by all branches of a twin.

    Attributes:
        store: Holds every graph.
        environment: IRI of the kitchen.
        robots: IRIs of the robots.
        asserted: Model IRI → its asserted graph.
        inferred: Model IRI → its inferred graphs.
        notes: What loading noticed, one sentence each.
    """

    store: Store
    environment: Iri
    robots: tuple[Iri, ...]
    asserted: Mapping[Iri, Iri]
    inferred: Mapping[Iri, tuple[Iri, ...]]
    notes: tuple[str, ...] = ()

    @cached_property
    def graphs(self) -> tuple[Iri, ...]:
        """All entity graphs, the constants of D_artic first."""
        models = (self.environment, *self.robots)
        return (TEE_GRAPH, *chain.from_iterable(self.graphs_of(model) for model in models))

    def graphs_of(self, model: Iri) -> tuple[Iri, ...]:
        """Graphs of one model."""
        return (self.asserted[model], *self.inferred[model])

    @cached_property
    def facts(self) -> Facts:
        """All entity triples, grouped."""
        return Facts(chain.from_iterable(self.store.triples(graph) for graph in self.graphs))

    @cached_property
    def mechanisms(self) -> dict[Iri, Mechanism]:
        """Mechanisms read back so far."""
        return {}

    @cached_property
    def annotations(self) -> dict[Iri, RobotAnnotation]:
        """Annotations of robots read back so far."""
        return {}

    @cached_property
    def _states(self) -> "OrderedDict[State, Iri]":
        return OrderedDict()

    @cached_property
    def _lock(self) -> Lock:
        return Lock()

    def state_graph(self, state: State) -> Iri:
        """Named graph of a state, written when first asked for; the oldest of many are dropped."""
        with self._lock:
            if state in self._states:
                self._states.move_to_end(state)
                return self._states[state]
            graph = state_iri(self.environment, state)
            positions = ((joint, SDT + "position", double(value)) for joint, value in state.positions)
            self.store.add(graph, positions)
            self._states[state] = graph
            if len(self._states) > KEPT_STATES:
                self.store.drop(self._states.popitem(last=False)[1])
            return graph

    @cached_property
    def containers(self) -> tuple["Container", ...]:
        """The counted containers, by name."""
        _, rows = rows_of(self.store.query(query_text("containers"), self.graphs))
        found: dict[Iri, Container] = {}
        for row in rows:
            container = _container(row)
            found.setdefault(container.iri, container)
        return tuple(sorted(found.values(), key=lambda container: container.name))

    @cached_property
    def coupling(self) -> Coupling:
        """How the kitchen's joints depend on each other."""
        return Coupling.of(read_mechanism_of(self.facts, self.environment))

    def content_hash(self, model: Iri) -> str:
        """SHA-256 over the model's entity triples, in the order of their text."""
        if model not in self._hashes:
            lines = {
                f"<{subject}> <{predicate}> {value}"
                for graph in self.graphs_of(model)
                for subject, predicate, value in self.store.triples(graph)
                if predicate not in _PLACE_ONLY
            }
            self._hashes[model] = hashlib.sha256("\n".join(sorted(lines)).encode()).hexdigest()
        return self._hashes[model]

    @cached_property
    def _hashes(self) -> dict[Iri, str]:
        return {}

    def edited(self, subject: Iri, changes: Mapping[str, Value]) -> "Entities":
        """The same entities, with these properties of the subject replaced and all rules run again.

        Raises:
            UnknownEntityError: No such subject, or no such property in `sdt.ttl`.
            InputError: A value of the wrong kind.
            GraphError: The model is not whole without what was removed.
        """
        for name, value in changes.items():
            if name not in properties():
                raise UnknownEntityError("property of sdt.ttl", name, properties())
            if value is not None and not fits(properties()[name], term_of(value)):
                raise InputError(f"sdt:{name} cannot be {value!r}", allowed=properties()[name].value)
        model = self._model_of(subject)
        replaced = {SDT + name for name in changes}
        kept = (
            triple
            for triple in self.store.triples(self.asserted[model])
            if triple[0] != subject or triple[1] not in replaced
        )
        added: list[Triple] = [
            (subject, SDT + name, term_of(value)) for name, value in changes.items() if value is not None
        ]
        store = MemoryStore()
        for graph in self.graphs:
            if graph not in self.graphs_of(model):
                store.add(graph, self.store.triples(graph))
        changed = [*kept, *added]
        checked_model(changed, model, "Environment" if model == self.environment else "Robot")
        store.add(self.asserted[model], changed)
        inferred = {**self.inferred, model: tuple(annotate(store, model, self.asserted[model]))}
        shown = ", ".join(f"{name} = {value}" for name, value in changes.items())
        note = f"{local_name(model)}: edited: {local_name(subject)}: {shown}"
        return replace(self, store=store, inferred=inferred, notes=(*self.notes, note))

    def _model_of(self, subject: Iri) -> Iri:
        node = ox.NamedNode(subject)
        for model, graph in self.asserted.items():
            if any(triple[0] == node.value for triple in self.store.triples(graph)):
                return model
        known = [iri for iri in self.facts.subjects() if iri.startswith(self.environment)]
        raise UnknownEntityError("individual", subject, known)


def state_iri(environment: Iri, state: State) -> Iri:
    """Named graph of a state: the hash of its positions."""
    digest = hashlib.sha256(repr(state.positions).encode()).hexdigest()
    return graph_iri("state", f"{local_name(environment)}/{digest[:16]}")


@cache
def query_text(name: str) -> str:
    """Text of a query of `ontology/queries`."""
    return ontology.path(f"queries/{name}.rq").read_text(encoding="utf-8")


def _container(row: Row) -> Container:
    def number(name: str, missing: float = math.inf) -> float:
        value = row[name]
        return float(value) if isinstance(value, int | float) else missing

    iri = str(row["container"])
    return Container(
        iri=iri,
        name=local_name(iri),
        kind=local_name(str(row["kind"])).lower(),
        joint=str(row["joint"]),
        active_joint=str(row["active"]),
        multiplier=number("multiplier"),
        offset=number("offset"),
        handle=str(row["handle"]),
        lower=number("lower", -math.inf),
        upper=number("upper"),
        open_from=number("openFrom"),
        closed_to=number("closedTo", -math.inf),
        velocity=number("velocity"),
        acceleration=number("acceleration"),
    )
