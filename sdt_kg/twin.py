"""Twin (G): a kitchen and robots as a graph, in one state."""

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import chain
from typing import Final

import pyoxigraph as ox
import rdflib

import ontology
from sdt_kg.annotate import TEE_GRAPH
from sdt_kg.annotation import KitchenAnnotation, RobotAnnotation
from sdt_kg.coupling import Coupling
from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import PREFIXES, SDT, Iri, graph_iri, local_name
from sdt_kg.mechanism import Mechanism
from sdt_kg.state import State
from sdt_kg.store import Row, Store, Value, checked_query, double, rows_of, term_of
from sdt_kg.triples import Facts, read_kitchen, read_mechanism_of, read_robot

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


class Twin:
    """G. Nothing writes to it; `at`, `with_edit` give another twin.

    Attributes:
        state: Complete: every movable kitchen joint, mimicking ones too.
    """

    def __init__(self, entities: Entities, state: State | None = None) -> None:
        self.entities = entities
        self.state = entities.coupling.start() if state is None else state
        self._state_graph: Iri | None = None

    @property
    def environment(self) -> Iri:
        """IRI of the kitchen."""
        return self.entities.environment

    @property
    def robots(self) -> tuple[Iri, ...]:
        """IRIs of the robots."""
        return self.entities.robots

    @property
    def notes(self) -> tuple[str, ...]:
        """What loading changed, chose or assumed, one sentence each."""
        return self.entities.notes

    @staticmethod
    def name(model: Iri) -> str:
        """Name of the kitchen or robot."""
        return local_name(model)

    def graphs(self) -> tuple[Iri, ...]:
        """Named graphs of this twin: entities, then the present state."""
        if self._state_graph is None:
            self._state_graph = self._write_state()
        return (*self.entities.graphs, self._state_graph)

    def _write_state(self) -> Iri:
        text = repr(self.state.positions).encode()
        key = f"{local_name(self.environment)}/{hashlib.sha256(text).hexdigest()[:16]}"
        graph = graph_iri("state", key)
        self.entities.store.add(
            graph, ((joint, SDT + "position", double(value)) for joint, value in self.state.positions)
        )
        return graph

    def select(self, query: str, **known: Value) -> list[Row]:
        """Rows of a query of `ontology/queries` (by file stem), over [entities, state].

        Args:
            query: File stem.
            known: Values for variables that the query selects.
        """
        bound = {name: term_of(value) for name, value in known.items()}
        return rows_of(self.entities.store.query(query_text(query), self.graphs(), bound))[1]

    def query(self, sparql: str) -> tuple[list[str], list[Row]]:
        """Columns and rows of anybody's query, over [entities, state].

        Raises:
            QueryError: It does not parse, or would write or fetch.
        """
        return rows_of(self.entities.store.query(checked_query(sparql), self.graphs()))

    def containers(self) -> tuple[Container, ...]:
        """The counted containers, by name."""
        return self.entities.containers

    def container(self, name_or_iri: str) -> Container:
        """One container; UnknownEntityError names the nearest."""
        for container in self.containers():
            if name_or_iri in (container.name, container.iri):
                return container
        names = [container.name for container in self.containers()]
        left_out = {local_name(each.body): each.reason for each in self.left_out()}
        reason = left_out.get(name_or_iri)
        remedy = f"'{name_or_iri}' is not counted: {reason}" if reason else "sdt containers lists them"
        raise UnknownEntityError("container", local_name(name_or_iri), names, remedy)

    def left_out(self) -> tuple[LeftOut, ...]:
        """Joints that could be taken for a container's but are not counted, with the reason."""
        rows = self.select("left_out")
        found = {
            str(row["joint"]): LeftOut(str(row["joint"]), str(row["body"]), str(row["reason"]))
            for row in rows
        }
        return tuple(found.values())

    def mechanism(self, model: Iri) -> Mechanism:
        """The kitchen or a robot, read back from the graph alone (cached)."""
        cached = self.entities.mechanisms
        if model not in cached:
            cached[model] = read_mechanism_of(self.entities.facts, self._known(model))
        return cached[model]

    def robot(self, robot: Iri) -> RobotAnnotation:
        """Annotation of a robot, read back from the graph alone."""
        return read_robot(self.entities.facts, self._known(robot))

    def kitchen(self) -> KitchenAnnotation:
        """Annotation of the kitchen, read back from the graph alone."""
        return read_kitchen(self.entities.facts, self.environment)

    def _known(self, model: Iri) -> Iri:
        if model not in self.entities.asserted:
            raise UnknownEntityError("model", model, self.entities.asserted, "load it with the twin")
        return model

    def content_hash(self, model: Iri) -> str:
        """SHA-256 over the model's entity triples (asserted and inferred), canonical order.

        Paths of mesh files are left out: their content counts, not where they lie.
        """
        lines = (
            f"<{subject}> <{predicate}> {value}"
            for graph in self.entities.graphs_of(self._known(model))
            for subject, predicate, value in self.entities.store.triples(graph)
            if predicate not in _PLACE_ONLY
        )
        return hashlib.sha256("\n".join(sorted(set(lines))).encode()).hexdigest()

    def at(self, state: Mapping[Iri, float]) -> "Twin":
        """The same twin with these joints elsewhere; StateError outside limits.

        A mimicking joint follows the one that it mimics; setting it sets that one.
        """
        return Twin(self.entities, self.entities.coupling.moved(self.state, state))

    def serialize(self, form: str) -> bytes:
        """The twin as RDF: `turtle` (all graphs merged), `trig` or `nquads` (named graphs)."""
        store = self.entities.store.dump(self.graphs())
        formats = {
            "turtle": ox.RdfFormat.TURTLE,
            "trig": ox.RdfFormat.TRIG,
            "nquads": ox.RdfFormat.N_QUADS,
        }
        if form != "turtle":
            dumped = store.dump(format=formats[form], prefixes=PREFIXES if form == "trig" else None)
        else:
            triples = {ox.Triple(quad.subject, quad.predicate, quad.object) for quad in store}
            ordered = sorted(triples, key=str)
            dumped = ox.serialize(ordered, format=formats[form], prefixes=PREFIXES)
        assert dumped is not None, "without an output, the bytes are returned"
        return dumped

    def to_rdflib(self) -> rdflib.Dataset:
        """The twin as an rdflib dataset, for notebooks: a copy."""
        dataset = rdflib.Dataset(default_union=True)
        dataset.parse(data=self.serialize("nquads"), format="nquads")
        for prefix, namespace in PREFIXES.items():
            dataset.bind(prefix, namespace)
        return dataset

    def triple_count(self) -> int:
        """How many triples the twin has, state included."""
        return len(self.entities.store.dump(self.graphs()))


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
