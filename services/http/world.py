"""What is served: kitchens in their present state, with their robots, verdicts and observations."""

import asyncio
import logging
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

import pyoxigraph as ox

import ontology
from predicates.record import Record
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.history import Branch, Edit, Trajectory, moved
from sdt_kg.history.records import record_graph
from sdt_kg.iri import ID, Iri, local_name
from sdt_kg.twin import Twin
from services.http.kitchens import Kitchen, Recording
from services.requests import parse_state
from services.store.quads import QuadStore
from services.store.records import changed_since, graph_of, is_kept, is_result, keep
from services.store.workers import Asked, Delta, Workers, bulk, put
from services.why import beginnings

VOCABULARIES: Final = {
    "https://example.org/sdt": "sdt.ttl",
    "https://example.org/tee": "tee.ttl",
    "https://example.org/law": "law.ttl",
}
"""Named graph → file; there by name, not in the default graph."""

WHOLE: Final = 64
"""[characters] Of a hash."""
BEGINNING: Final = """SELECT ?verdict ?beginning0 ?beginning1 WHERE {
  VALUES ?kind { law:Verdict law:TaskResult }
  ?verdict a ?kind .
  FILTER(STRSTARTS(STR(?verdict), ?beginning0) || STRSTARTS(STR(?verdict), ?beginning1))
} LIMIT 8"""
"""Verdicts and results of tasks whose IRI begins in one of two ways."""

SHOWN = frozenset({"asserted", "inferred", "verdict", "task_result", "observed", "branch", "present"})
"""Kinds of graphs, as their IRIs have them."""
_log = logging.getLogger("sdt.http")


@dataclass
class World:
    """Everything that is served, and the workers that answer queries about it.

    Attributes:
        kitchens: By name.
        archive: Where writes are kept; None keeps them until the service ends.
        samples: Of trajectories that branches there follow, by IRI.
        version: How often something was written.
        listeners: Called with every verdict that is kept.
        movers: Called with a kitchen whose present state is another one now.
    """

    kitchens: dict[str, Kitchen]
    workers: Workers
    archive: QuadStore | None = None
    samples: Mapping[Iri, Trajectory] = field(default_factory=dict[Iri, Trajectory])
    version: int = 0
    listeners: list[Callable[[Record], None]] = field(default_factory=list[Callable[[Record], None]])
    movers: list[Callable[[Kitchen], None]] = field(default_factory=list[Callable[[Kitchen], None]])
    _kept: ox.Store | None = None
    _lock: asyncio.Lock = field(default_factory=asyncio.Lock)

    def remember(self) -> None:
        """What was kept is read, and kitchens are as they were left.

        Raises:
            GraphError: Branches that were kept were changed.
            InputError: Samples of a trajectory that one of them follows are missing.
            StoreError: What was kept cannot be read.
        """
        if self.archive is None or self._kept is not None:
            return
        self._kept = self.archive.dump()
        for name, kitchen in self.kitchens.items():
            self.kitchens[name] = kitchen.continued(self._kept, self.samples)

    async def start(self) -> None:
        """Workers hold everything; raises as `remember`."""
        await asyncio.to_thread(self.remember)
        await self.workers.start(self._first())
        self._kept = None

    async def close(self) -> None:
        """No process is left."""
        await self.workers.close()

    async def recall(self, verdict: Iri) -> bytes:
        """The graph of a verdict as N-Quads; empty where it is not kept."""
        return await self.quads(graph_of(verdict))

    async def told(self, verdict: Iri) -> bytes:
        """The same of a verdict, or result of a task, that is named by the beginning of its hash.

        Of several whose hash begins so, some: `services.why` tells that they are several.
        """
        begins = beginnings(verdict)
        if begins == (verdict,) and len(local_name(verdict)) >= WHOLE:
            return await self.recall(verdict)
        known = {f"beginning{k}": ("text", each) for k, each in enumerate(begins)}
        if not known:
            return b""
        known.setdefault("beginning1", known["beginning0"])
        answered = await self.workers.ask(Asked("query", BEGINNING, ("text/csv",), known=known))
        found = {line.partition(",")[0] for line in answered.body.decode().split()[1:]}
        return b"".join([await self.recall(each) for each in sorted(found)])

    async def quads(self, graph: Iri) -> bytes:
        """A named graph as N-Quads; empty where there is none."""
        held = await self.workers.ask(Asked("graph", graph, accepted=("application/n-triples",)))
        name = ox.NamedNode(graph)
        parsed = ox.parse(held.body, format=ox.RdfFormat.N_TRIPLES)
        return lines(ox.Quad(each.subject, each.predicate, each.object, name) for each in parsed)

    def serves(self, environment: str, robot: str) -> bool:
        """Whether these models, as inputs of a verdict name them, are served with this content now.

        Args:
            environment: IRI, blank, content hash.
            robot: Likewise; or that none is given.
        """
        return any((environment, robot) in kitchen.models for kitchen in self.kitchens.values())

    def names(self) -> dict[str, set[str]]:
        """Names of the kitchens, robots and containers that are served."""
        twins = [kitchen.twin for kitchen in self.kitchens.values()]
        return {
            "kitchen": {twin.name(twin.environment) for twin in twins},
            "robot": {local_name(robot) for twin in twins for robot in twin.robots},
            "container": {container.name for twin in twins for container in twin.containers()},
        }

    def kitchen(self, name: str | None) -> Kitchen:
        """A kitchen by name; may be left out where there is one.

        Raises:
            UnknownEntityError: None of that name.
        """
        if name is None and len(self.kitchens) == 1:
            return next(iter(self.kitchens.values()))
        if name is None:
            raise InputError("no kitchen is named", allowed=", ".join(self.kitchens) or "none is loaded")
        if name not in self.kitchens:
            raise UnknownEntityError("kitchen", name, self.kitchens, "sdt serve --kitchen NAME loads it")
        return self.kitchens[name]

    async def move(self, name: str | None, states: tuple[str, ...]) -> Kitchen:
        """The kitchen in another present state; the old one stays, by its name."""
        async with self._lock:
            before = self.kitchen(name)
            positions = parse_state(before.twin, states)
            changed = {joint: at for joint, at in positions.items() if at != before.twin.state[joint]}
            if not changed:
                return before
            derived, branch = await asyncio.to_thread(before.derived, moved(changed))
            after = derived.at(branch)
            await self._keep_history(after)
            turned = after.state_graph, before.state_graph
            await self._keep(after.present_graph, [after.present_triple()], turned=turned)
            self.kitchens[after.name] = after
            for mover in self.movers:
                mover(after)
            return after

    async def branch(self, name: str | None, edit: Callable[[Twin], Edit], parent: Iri | None) -> Branch:
        """A new branch of the kitchen, made by an edit of its parent; the present is as it was."""
        async with self._lock:
            begun = await asyncio.to_thread(self.kitchen(name).begun)
            assert begun.history is not None, "begun"
            assert begun.present is not None, "begun"
            twin = begun.history.branch(parent or begun.present).twin
            derived, made = await asyncio.to_thread(begun.derived, edit(twin), parent)
            await self._keep_history(derived)
            self.kitchens[derived.name] = derived
            return made

    async def _keep_history(self, kitchen: Kitchen) -> None:
        """Graphs that the history has written since the last time.

        Records of branches come last, of parents before their children: when the service dies meanwhile,
        no record is there without what it names. What cannot be kept now is kept with the next branch, but
        for the record of a branch that was not acknowledged.
        """
        assert kitchen.history is not None, "begun"
        store = kitchen.history.store
        assert isinstance(store, Recording), "as begun"
        records = {record_graph(iri): place for place, iri in enumerate(kitchen.history.branches)}
        present = {each.state_graph for each in self.kitchens.values()}
        for graph in sorted(store.written, key=lambda graph: (records.get(graph, -1), graph)):
            if graph in records or not graph.startswith(record_graph("")):
                triples = [quad.triple for quad in store.dump([graph])]
                await self._keep(graph, triples, shown=graph in present or _is_shown(graph))
            store.written.discard(graph)

    async def write(self, graph: Iri, triples: Iterable[ox.Triple], *, shown: bool = True) -> None:
        """A named graph has these triples and no others."""
        async with self._lock:
            await self._keep(graph, list(triples), shown=shown)

    async def write_verdict(self, record: Record) -> bool:
        """Whether the verdict was written: one that is there gives way only to a better one.

        The result of a task likewise; listeners hear of the verdicts that it rests on.
        """
        async with self._lock:
            fresh = list(record.quads())
            stored = list(ox.parse(await self.recall(record.verdict), format=ox.RdfFormat.N_QUADS))
            if not is_kept(stored, fresh, record.verdict):
                return False
            is_new = self.archive is None or await asyncio.to_thread(keep, self.archive, record)
            if self.archive is not None and not is_new:  # somebody else's, who shares the store, is better
                fresh = await asyncio.to_thread(self.archive.graph, record.graph)
            await self._serve(put(record.graph, lines(quad.triple for quad in fresh), instead=True))
        if not is_new:
            return False
        if is_result(record.verdict):
            return True
        for listener in self.listeners:
            listener(record)
        return True

    async def _keep(
        self,
        graph: Iri,
        triples: list[ox.Triple],
        *,
        shown: bool = True,
        turned: tuple[Iri, Iri] | None = None,
    ) -> None:
        """First kept, then served: what was acknowledged is not lost."""
        if self.archive is not None:
            node = ox.NamedNode(graph)
            quads = [ox.Quad(each.subject, each.predicate, each.object, node) for each in triples]
            await asyncio.to_thread(self.archive.replace, graph, quads)
        await self._serve(put(graph, lines(triples), shown=shown, instead=True, turned=turned))

    async def _serve(self, delta: Delta) -> None:
        """Queries see it."""
        await self.workers.apply(delta)
        self.version += 1

    def _damaged(self, kept: ox.Store) -> set[Iri]:
        """Graphs of records that are not as they were written: there by name, in no list and no count."""
        found = dict(changed_since(kept))
        for why in found.values():
            _log.warning("%s; it is not listed, and judged anew when it is asked about", why)
        return set(found)

    def _first(self) -> Iterator[Delta]:
        """What is served at the start."""
        if self._kept is not None:
            served = {graph for kitchen in self.kitchens.values() for graph in kitchen.twin.graphs()}
            named = {ox.NamedNode(graph) for graph in served}  # as they are now, not as they were kept
            quads = [quad for quad in self._kept if quad.graph_name not in named]
            apart = {
                str(quad.graph_name.value) for quad in quads if isinstance(quad.graph_name, ox.NamedNode)
            }
            hidden = {graph for graph in apart if not _is_shown(graph)} | self._damaged(self._kept)
            yield bulk(lines(quads), hidden)
        for kitchen in self.kitchens.values():
            yield bulk(kitchen.twin.serialize("nquads"))
        for graph, file in VOCABULARIES.items():
            parsed = ox.parse(ontology.path(file).read_bytes(), format=ox.RdfFormat.TURTLE)
            triples = [quad.triple for quad in parsed]
            yield put(graph, lines(triples), shown=False)


def lines(statements: Iterable[ox.Triple] | Iterable[ox.Quad]) -> bytes:
    """N-Triples or N-Quads."""
    return b"".join(f"{each} .\n".encode() for each in statements)


def _is_shown(graph: Iri) -> bool:
    """Whether it belongs to the default graph: models, verdicts, results of tasks, observations, branches.

    States and versions of models do not: which of them hold now, a kitchen says.
    """
    kind, _, key = graph.removeprefix(f"{ID}graph/").partition("/")
    return kind in SHOWN and "/" not in key
