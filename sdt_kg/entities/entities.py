"""Entities: what a twin says whatever its state, shared by all its branches."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import TypeVar

from sdt_kg.annotating.annotate import TEE_GRAPH, annotate, tee_facts, tee_triples
from sdt_kg.annotating.checks import check_edited, check_limits
from sdt_kg.annotation import KitchenAnnotation, RobotAnnotation
from sdt_kg.entities.container import Container, containers_of
from sdt_kg.entities.coupling import Coupling
from sdt_kg.entities.queries import query_text
from sdt_kg.entities.replacement import Replacement
from sdt_kg.entities.states import States
from sdt_kg.entities.told import Told
from sdt_kg.errors import GraphError, InputError, UnknownEntityError
from sdt_kg.iri import SDT, Iri, graph_iri, local_name
from sdt_kg.mechanism import Mechanism
from sdt_kg.store import MemoryStore, Store, Triple, Value, rows_of, stored, term_of
from sdt_kg.triples import Facts, checked_model, read_kitchen, read_mechanism_of, same
from sdt_kg.triples.vocabulary import fits, properties

T = TypeVar("T")


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
        return (TEE_GRAPH, *chain.from_iterable(map(self.graphs_of, (self.environment, *self.robots))))

    def graphs_of(self, model: Iri) -> tuple[Iri, ...]:
        """Graphs of one model."""
        return (self.asserted[model], *self.inferred[model])

    @cached_property
    def facts(self) -> Facts:
        """All entity triples, grouped."""
        return Facts.merged([*map(self._facts_of, (TEE_GRAPH, self.environment, *self.robots))])

    def _facts_of(self, part: Iri) -> Facts:
        """What is said of a model, or in the graph of the constants."""
        if part not in self._facts:
            graphs = (TEE_GRAPH,) if part == TEE_GRAPH else self.graphs_of(part)
            self._facts[part] = Facts(chain.from_iterable(map(self.store.triples, graphs)))
        return self._facts[part]

    @cached_property
    def _facts(self) -> dict[Iri, Facts]:
        return {}

    def mechanism(self, model: Iri) -> Mechanism:
        """The kitchen or a robot, read back from the graph alone (cached)."""
        if model not in self._mechanisms:
            self._mechanisms[model] = read_mechanism_of(self.facts, model)
        return self._mechanisms[model]

    @cached_property
    def _mechanisms(self) -> dict[Iri, Mechanism]:
        return {}

    @cached_property
    def annotations(self) -> dict[Iri, RobotAnnotation]:
        """Annotations of robots read back so far."""
        return {}

    @cached_property
    def kitchen(self) -> KitchenAnnotation:
        """Annotation of the kitchen."""
        return read_kitchen(self.facts, self.environment)

    @cached_property
    def states(self) -> States:
        """The kitchen's states beside these entities."""
        return States(self.store, self.environment, self.graphs)

    @property
    def bare(self) -> "Entities":
        """The kitchen without robots, one for all that were put beside it: they share what it is asked."""
        if not self.robots:
            return self
        if self.environment not in self._bare:
            bare = self
            for robot in self.robots:
                bare = bare.without_robot(robot)
            self._bare[self.environment] = bare
        return self._bare[self.environment]

    @cached_property
    def _bare(self) -> "dict[Iri, Entities]":
        return {}

    @cached_property
    def containers(self) -> tuple[Container, ...]:
        """The counted containers, by name."""
        found = chain.from_iterable(map(self._containers_of, (self.environment, *self.robots)))
        return tuple(sorted(found, key=lambda container: container.name))

    def _containers_of(self, model: Iri) -> tuple[Container, ...]:
        if model not in self._containers:
            found = self.store.query(query_text("containers"), (TEE_GRAPH, *self.graphs_of(model)))
            self._containers[model] = containers_of(rows_of(found)[1])
        return self._containers[model]

    @cached_property
    def _containers(self) -> dict[Iri, tuple[Container, ...]]:
        return {}

    @cached_property
    def coupling(self) -> Coupling:
        """How the kitchen's joints depend on each other."""
        return Coupling.of(self.mechanism(self.environment))

    def content_hash(self, model: Iri) -> str:
        """SHA-256 over the model's entity triples."""
        if model not in self._hashes:
            self._hashes[model] = self._facts_of(model).content_hash()
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
        return self.rewritten(self.replacement(subject, changes))

    def replacement(self, subject: Iri, changes: Mapping[str, Value]) -> Replacement:
        """The triples by which these properties of the subject are replaced; None removes one."""
        for name, value in changes.items():
            if name not in properties():
                raise UnknownEntityError("property of sdt.ttl", name, properties())
            if value is not None and not fits(properties()[name], term_of(value)):
                raise InputError(f"sdt:{name} cannot be {value!r}", allowed=properties()[name].value)
        model = self.model_of(subject)
        check_edited(self.mechanism(model), subject, changes)
        if model != self.environment:  # in a kitchen the Law abstains of it
            check_limits(self.mechanism(model), subject, changes)
        replaced = {SDT + name for name in changes}
        removed = frozenset(
            triple
            for triple in self.store.triples(self.asserted[model])
            if triple[0] == subject and triple[1] in replaced
        )
        added = frozenset(
            (subject, SDT + name, term_of(value)) for name, value in changes.items() if value is not None
        )
        shown = ", ".join(f"{name} = {value}" for name, value in changes.items())
        return Replacement(model, removed - added, added - removed, f"edited: {local_name(subject)}: {shown}")

    def rewritten(self, by: Replacement) -> "Entities":
        """The same entities, with asserted triples of one model replaced and its rules run again.

        Raises:
            UnknownEntityError: No such model.
            GraphError: What is to be removed is not there, or the model is then not whole, or no tree.
        """
        model, name = by.model, local_name(by.model)
        if model not in self.asserted:
            raise UnknownEntityError("model", name, map(local_name, self.asserted))
        present = set(self.store.triples(self.asserted[model]))
        if not by.removed <= present:
            raise GraphError(f"'{name}' was changed since: {by.note}", remedy="undo the later edits first")
        changed = [*(present - by.removed), *by.added]
        kind = "Environment" if model == self.environment else "Robot"
        mechanism = checked_model(
            changed, model, kind, same(self.mechanism(model), changed, by.removed | by.added)
        )
        store = self._copy(self.graphs_of(model))
        store.add(self.asserted[model], changed)
        inferred = {**self.inferred, model: tuple(annotate(store, model, self.asserted[model]))}
        notes = (*self.notes, f"{name}: {by.note}")
        made = self._kept_by(replace(self, store=store, inferred=inferred, notes=notes), model)
        said = [triple for graph in inferred[model] for triple in store.triples(graph)]
        made._mechanisms[model] = read_mechanism_of(made.facts, model, same(mechanism, changed, said).bodies)
        return made

    def with_robot(self, robot: Iri, triples: Sequence[Triple], notes: Sequence[str] = ()) -> "Entities":
        """The same entities and a robot, of which these triples are asserted.

        Raises:
            InputError: There is a model of that name.
            GraphError: The robot is not whole.
        """
        checked_model(triples, robot, "Robot")
        return self.beside(Entities.alone(robot, triples, notes))

    @staticmethod
    def alone(model: Iri, triples: Iterable[Triple], notes: Sequence[str] = ()) -> "Entities":
        """One model, whose triples were just made from a whole one, and nothing around it."""
        store, graph = MemoryStore(), graph_iri("asserted", local_name(model))
        store.add(TEE_GRAPH, tee_triples())
        store.add(graph, triples)
        inferred = tuple(annotate(store, model, graph))
        return Entities(store, model, (), {model: graph}, {model: inferred}, tuple(notes))

    @staticmethod
    def recalled(told: Told) -> "Entities":
        """One model alone, as it was read before."""
        asserted, *inferred = told.graphs
        store = MemoryStore(lambda: stored({TEE_GRAPH: tee_triples(), **told.graphs}))
        graphs = {told.model: asserted}, {told.model: tuple(inferred)}
        made = Entities(store, told.model, (), *graphs, tuple(told.notes))
        made._facts.update({TEE_GRAPH: tee_facts(), told.model: Facts(chain(*told.graphs.values()))})
        made._hashes[told.model], made._containers[told.model] = told.content_hash, told.containers
        return made

    def beside(self, robot: "Entities") -> "Entities":
        """These entities and a robot that was alone, with what was read of it there.

        Raises:
            InputError: There is a model of that name.
        """
        model = robot.environment
        if model in self.asserted:
            name = local_name(model)
            raise InputError(f"there is a model named '{name}' already", allowed="each name once")
        robots = (*self.robots, model)
        store = MemoryStore(lambda: robot.store.dump(robot.graphs_of(model), self.store.dump(self.graphs)))
        asserted, inferred = {**self.asserted, **robot.asserted}, {**self.inferred, **robot.inferred}
        said = (*self.notes, *robot.notes)
        made = self._kept_by(Entities(store, self.environment, robots, asserted, inferred, said))
        made._facts[model], made._mechanisms[model] = robot._facts_of(model), robot.mechanism(model)
        made._hashes[model], made._containers[model] = robot.content_hash(model), robot._containers_of(model)
        return made

    def without_robot(self, robot: Iri) -> "Entities":
        """The same entities but for one robot; UnknownEntityError if it is not there."""
        if robot not in self.robots:
            raise UnknownEntityError("robot", local_name(robot), map(local_name, self.robots))
        others = Entities(
            self._copy(self.graphs_of(robot)),
            self.environment,
            tuple(each for each in self.robots if each != robot),
            {model: graph for model, graph in self.asserted.items() if model != robot},
            {model: graphs for model, graphs in self.inferred.items() if model != robot},
            (*self.notes, f"{local_name(robot)}: taken away"),
        )
        return self._kept_by(others, robot)

    def _kept_by(self, others: "Entities", changed: Iri = "") -> "Entities":
        """The others, which have read what they share with these: all models but the changed one."""
        same = [model for model in others.asserted if model in self.asserted and model != changed]
        if changed != self.environment:
            others._bare.update(self._bare if self.robots else {self.environment: self})
        others._facts.update(_of((TEE_GRAPH, *same), self._facts))
        others._mechanisms.update(_of(same, self._mechanisms))
        others._hashes.update(_of(same, self._hashes))
        others._containers.update(_of(same, self._containers))
        others.annotations.update(_of(same, self.annotations))
        return others

    def _copy(self, left_out: Sequence[Iri]) -> MemoryStore:
        """A store of its own with the same entity graphs, but for these."""
        copy = self.store.dump([graph for graph in self.graphs if graph not in left_out])
        return MemoryStore(lambda: copy)

    def model_of(self, subject: Iri) -> Iri:
        """The kitchen or robot which an individual is asserted of; UnknownEntityError if none is."""
        for model, graph in self.asserted.items():
            if any(triple[0] == subject for triple in self.store.triples(graph)):
                return model
        known = [iri for iri in self.facts.subjects() if iri.startswith(self.environment)]
        raise UnknownEntityError("individual", subject, known)


def _of(models: Iterable[Iri], read: Mapping[Iri, T]) -> dict[Iri, T]:
    return {model: read[model] for model in models if model in read}
