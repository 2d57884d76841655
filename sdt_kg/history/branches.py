"""History: branches of a twin over one store. The past never changes; each edit makes a branch."""

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import pyoxigraph as ox

from sdt_kg.annotating.annotate import TEE_GRAPH
from sdt_kg.entities import Entities, query_text, state_iri
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.history.edits import Edit, Followed, Moved, key_of
from sdt_kg.history.events import Event, events_along, events_between
from sdt_kg.history.records import (
    branch_triples,
    event_triples,
    first_triples,
    graph_triples,
    move_triples,
    record_graph,
    trajectory_triples,
)
from sdt_kg.history.trajectory import Trajectory
from sdt_kg.iri import SDT, Iri, branch_iri, graph_iri, local_name
from sdt_kg.state import State
from sdt_kg.store import MemoryStore, Row, Store, Triple, Value, checked_query, double, rows_of, term_of
from sdt_kg.twin import Twin


@dataclass(frozen=True, slots=True)
class _Written:
    """Where a store holds some entities: the graph that lists them, and the graphs."""

    manifest: Iri
    graphs: tuple[Iri, ...]
    content: str


SHOWN: Final = 12
"""[characters] Of a branch's hash, where it is shown."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Branch:
    """A twin in a history.

    Attributes:
        iri: Hash of parent and edit: the same edit of the same branch is the same branch.
        twin: What is so here.
        parent: Where it comes from; None for the first.
        edit: What made it from its parent; None for the first.
        undo: The edit that would make its parent's content again; None for the first.
        content_hash: Hash of models and state, whatever the way to them.
        step: Number of states since the first: an edit is one, a trajectory each of its samples.
        events: What happened on the way from its parent.
    """

    iri: Iri
    twin: Twin
    parent: "Branch | None"
    edit: Edit | None
    undo: Edit | None
    content_hash: str
    step: int
    events: tuple[Event, ...]
    written: _Written

    def __repr__(self) -> str:
        made = "the first" if self.edit is None else self.edit.sentence
        return f"<Branch {local_name(self.iri)[:SHOWN]} of {self.twin!r}: {made}>"

    @property
    def trajectory(self) -> Trajectory | None:
        """The trajectory that ends here, if one does."""
        return self.edit.trajectory if isinstance(self.edit, Followed) else None

    def past(self) -> Iterator["Branch"]:
        """This branch, its parent, and so on to the first."""
        branch: Branch | None = self
        while branch is not None:
            yield branch
            branch = branch.parent


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class History:
    """Branches over one store. Nothing writes to it; `derived` gives another history.

    Attributes:
        store: Holds entity graphs by content, state graphs, and a graph for each branch.
        branches: IRI → branch, the first one first.
    """

    store: Store
    branches: Mapping[Iri, Branch]

    def __repr__(self) -> str:
        return f"<History of {self.first.twin!r}, {len(self.branches)} branches>"

    @staticmethod
    def of(twin: Twin, store: Store | None = None) -> "History":
        """The history that begins with this twin.

        Args:
            twin: The first branch.
            store: Where to write; by default in memory.
        """
        store = MemoryStore() if store is None else store
        store.add(TEE_GRAPH, twin.entities.store.triples(TEE_GRAPH))
        written = _write_entities(store, twin.entities)
        content = content_hash(twin)
        iri = branch_iri(hashlib.sha256(f"root {content}".encode()).hexdigest())
        first = Branch(iri, twin, None, None, None, content, 0, (), written)
        _write_branch(store, first)
        return History(store, {iri: first})

    @property
    def first(self) -> Branch:
        """Where the history begins."""
        return next(iter(self.branches.values()))

    @property
    def latest(self) -> Branch:
        """The branch with the most steps behind it; of several, the one that was made last."""
        return max([*self.branches.values()][::-1], key=lambda branch: branch.step)

    def branch(self, branch: Branch | Iri) -> Branch:
        """The branch of that IRI; UnknownEntityError if the history has none."""
        iri = branch.iri if isinstance(branch, Branch) else branch
        if iri not in self.branches:
            raise UnknownEntityError("branch", iri, self.branches)
        return self.branches[iri]

    def derived(self, branch: Branch | Iri, edit: Edit) -> "tuple[History, Branch]":
        """A history with one branch more, and that branch.

        Raises:
            InputError: The edit cannot be made there.
        """
        history, (made,) = self.spread(branch, [edit])
        return history, made

    def spread(self, branch: Branch | Iri, edits: Iterable[Edit]) -> "tuple[History, list[Branch]]":
        """A history with a branch for each edit, all from the same parent, and those branches."""
        parent = self.branch(branch)
        made = [self._made(parent, edit) for edit in edits]
        return History(self.store, {**self.branches, **{each.iri: each for each in made}}), made

    def undone(self, branch: Branch | Iri) -> "tuple[History, Branch]":
        """A history with a branch more, in which the branch's edit is undone: its parent's content.

        Raises:
            InputError: It is the first branch.
        """
        last = self.branch(branch)
        if last.undo is None:
            raise InputError("the first branch has no edit to undo", allowed="a branch that an edit made")
        return self.derived(last, last.undo)

    def _made(self, parent: Branch, edit: Edit) -> Branch:
        iri = branch_iri(hashlib.sha256(f"{parent.iri} {key_of(edit)}".encode()).hexdigest())
        if iri in self.branches:
            return self.branches[iri]
        twin = edit.applied(parent.twin)
        same = twin.entities is parent.twin.entities
        written = parent.written if same else _write_entities(self.store, twin.entities)
        events = (
            events_along(parent.twin, edit.trajectory)
            if isinstance(edit, Followed)
            else events_between(parent.twin, twin)
        )
        made = Branch(
            iri=iri,
            twin=twin,
            parent=parent,
            edit=edit,
            undo=edit.inverse(parent.twin),
            content_hash=_content_hash(written.content, twin.state),
            step=parent.step + (len(edit.trajectory.times) - 1 if isinstance(edit, Followed) else 1),
            events=tuple(events),
            written=written,
        )
        _write_branch(self.store, made)
        return made

    def at(self, trajectory: Branch | Iri, sample: int) -> Twin:
        """G_k of the trajectory that ends in this branch; samples count from 0, negative ones from the end.

        Raises:
            UnknownEntityError: No such branch.
            InputError: No trajectory ends there.
        """
        last = self.branch(trajectory)
        if last.trajectory is None or last.parent is None:
            raise InputError(f"no trajectory ends in <{last.iri}>", allowed="a branch that `Followed` made")
        return last.trajectory.at(last.parent.twin, sample)

    def query(self, sparql: str, branch: Branch | Iri) -> tuple[list[str], list[Row]]:
        """Columns and rows of anybody's query, over a branch's entities and state and all its past.

        States of the past are named graphs: `?past sdt:stateGraph ?g . GRAPH ?g { … }`.

        Raises:
            QueryError: It does not parse, or would write or fetch.
        """
        return self._answer(checked_query(sparql), branch, {})

    def select(self, query: str, branch: Branch | Iri, **known: Value) -> list[Row]:
        """Rows of a query of `ontology/queries` (by file stem), seen from a branch."""
        return self._answer(query_text(query), branch, known)[1]

    def _answer(
        self, sparql: str, branch: Branch | Iri, known: Mapping[str, Value]
    ) -> tuple[list[str], list[Row]]:
        here = self.branch(branch)
        past = list(here.past())
        records = [record_graph(each.iri) for each in past]
        graphs = [TEE_GRAPH, *here.written.graphs, _state_graph(here), *records]
        states = [_state_graph(each) for each in past[1:]]
        bound = {name: term_of(value) for name, value in known.items()}
        return rows_of(self.store.query(sparql, graphs, bound, states))


def content_hash(twin: Twin) -> str:
    """SHA-256 over the content of the models, in the order of their IRIs, and the state."""
    return _content_hash(_models_hash(twin.entities), twin.state)


def _models_hash(entities: Entities) -> str:
    lines = (f"{model} {entities.content_hash(model)}\n" for model in sorted(entities.asserted))
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def _content_hash(models: str, state: State) -> str:
    return hashlib.sha256(f"{models}\n{state.positions!r}".encode()).hexdigest()


def _state_graph(branch: Branch) -> Iri:
    return state_iri(branch.twin.environment, branch.twin.state)


def _write_entities(store: Store, entities: Entities) -> _Written:
    """The entity graphs, each named after its content, and a graph that lists them."""
    graphs: list[Iri] = []
    for model in sorted(entities.asserted):
        version = entities.content_hash(model)[:16]
        for graph in entities.graphs_of(model):
            name = f"{graph}/{version}"
            graphs.append(name)
            if next(iter(store.triples(name)), None) is None:
                store.add(name, _renamed(entities.store.triples(graph), graph, name))
    content = _models_hash(entities)
    manifest = graph_iri("entities", content)
    listed: list[Triple] = [(manifest, SDT + "entityGraph", ox.NamedNode(graph)) for graph in graphs]
    store.add(manifest, listed)
    return _Written(manifest, tuple(graphs), content)


def _renamed(triples: Iterable[Triple], old: Iri, new: Iri) -> Iterator[Triple]:
    for subject, predicate, value in triples:
        yield (new if subject == old else subject), predicate, value


def _write_branch(store: Store, branch: Branch) -> None:
    parent = None if branch.parent is None else branch.parent.iri
    edit = "the first branch" if branch.edit is None else branch.edit.sentence
    state = _state_graph(branch)
    trajectory = branch.trajectory
    triples = [*branch_triples(branch.iri, parent, edit, branch.content_hash, branch.step)]
    triples += graph_triples(branch.iri, branch.written.manifest, state)
    if branch.parent is None:
        opened = branch.twin.select("open")
        triples += first_triples(branch.iri, (str(row["container"]) for row in opened))
    else:
        along = None if trajectory is None else trajectory.iri
        triples += event_triples(branch.iri, branch.events, along, branch.parent.step)
    if isinstance(branch.edit, Moved):
        triples += move_triples(branch.iri, branch.edit.positions)
    if trajectory is not None and parent is not None:
        triples += trajectory_triples(branch.iri, parent, trajectory)
    store.add(record_graph(branch.iri), triples)
    store.add(state, _positions(branch.twin.state.positions))


def _positions(positions: Sequence[tuple[Iri, float]]) -> Iterator[Triple]:
    return ((joint, SDT + "position", double(at)) for joint, at in positions)
