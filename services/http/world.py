"""What is served: kitchens in their present state, with their robots, verdicts and observations."""

import asyncio
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Final

import pyoxigraph as ox

import ontology
from predicates.record import Record
from predicates.record import write as write_record
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.iri import Iri
from sdt_kg.twin import Twin
from services.app import Service, load
from services.store.quads import QuadStore
from services.store.workers import Asked, Delta, Workers, bulk, drop, hide, put

VOCABULARIES: Final = {
    "https://example.org/sdt": "sdt.ttl",
    "https://example.org/tee": "tee.ttl",
    "https://example.org/law": "law.ttl",
}
"""Named graph → file; there by name, not in the default graph."""


@dataclass(frozen=True, slots=True)
class Kitchen:
    """A kitchen that is served.

    Attributes:
        source: Bundled name or path, for processes that load it too.
        robots: Bundled names or paths.
        states: Texts that give its present state, from the state in which all is closed.
        service: The Law over its twin.
    """

    source: str
    robots: tuple[str, ...]
    states: tuple[str, ...]
    service: Service

    @property
    def twin(self) -> Twin:
        """The twin in its present state."""
        return self.service.twin

    @property
    def state_graph(self) -> Iri:
        """Named graph of the present state."""
        return self.twin.graphs()[-1]


@dataclass
class World:
    """Everything that is served, and the workers that answer queries about it.

    Attributes:
        kitchens: By name.
        archive: Where writes are kept; None keeps them until the service ends.
        version: How often something was written.
    """

    kitchens: dict[str, Kitchen]
    workers: Workers
    archive: QuadStore | None = None
    version: int = 0
    _lock: asyncio.Lock = field(default_factory=asyncio.Lock)

    async def start(self) -> None:
        """Workers hold everything."""
        await self.workers.start(self._first())

    async def close(self) -> None:
        """No process is left."""
        await self.workers.close()

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

    async def move(self, name: str, states: tuple[str, ...]) -> Kitchen:
        """The kitchen in another present state; the old one stays, by its name."""
        async with self._lock:
            before = self.kitchen(name)
            service = await asyncio.to_thread(before.service.at, *states)
            after = replace(before, states=before.states + states, service=service)
            if after.state_graph != before.state_graph:
                await self._keep(after.state_graph, graph_triples(after.twin, after.state_graph))
                await self.workers.apply(hide(before.state_graph))
            self.kitchens[name] = after
            return after

    async def write(self, graph: Iri, triples: Iterable[ox.Triple], *, shown: bool = True) -> None:
        """A named graph has these triples and no others."""
        async with self._lock:
            await self._keep(graph, list(triples), shown=shown)

    async def write_verdict(self, record: Record) -> bool:
        """Whether the verdict was written: one that is there gives way only to a better one."""
        async with self._lock:
            held = await self.workers.ask(Asked("graph", record.graph, accepted=("application/n-triples",)))
            before = ox.Store()
            before.load(held.body, format=ox.RdfFormat.N_TRIPLES, to_graph=ox.NamedNode(record.graph))
            if not write_record(before, record):
                return False
            await self._keep(record.graph, [quad.triple for quad in record.quads()])
            return True

    async def _keep(self, graph: Iri, triples: list[ox.Triple], *, shown: bool = True) -> None:
        """First kept, then served: what was acknowledged is not lost."""
        if self.archive is not None:
            node = ox.NamedNode(graph)
            quads = [ox.Quad(each.subject, each.predicate, each.object, node) for each in triples]
            await asyncio.to_thread(self.archive.replace, graph, quads)
        body = lines(triples)
        await self.workers.apply(drop(graph))
        await self.workers.apply(put(graph, body, shown=shown))
        self.version += 1

    def _first(self) -> Iterator[Delta]:
        """What is served at the start."""
        if self.archive is not None:
            quads = list(self.archive.dump())
            apart = {
                str(quad.graph_name.value) for quad in quads if isinstance(quad.graph_name, ox.NamedNode)
            }
            body = lines(quads)
            yield bulk(body, (graph for graph in apart if _is_by_name_only(graph)))
        for kitchen in self.kitchens.values():
            yield bulk(kitchen.twin.serialize("nquads"))
        for graph, file in VOCABULARIES.items():
            parsed = ox.parse(ontology.path(file).read_bytes(), format=ox.RdfFormat.TURTLE)
            triples = [quad.triple for quad in parsed]
            yield put(graph, lines(triples), shown=False)


def open_kitchens(sources: Iterable[str], robots: tuple[str, ...]) -> dict[str, Kitchen]:
    """Kitchens with all robots, by name.

    Raises:
        InputError: A model that is not there or not valid, or two kitchens of one name.
    """
    found: dict[str, Kitchen] = {}
    for source in sources:
        service = load(source, robots)
        name = service.twin.name(service.twin.environment)
        if name in found:
            raise InputError(f"two kitchens are named '{name}'", allowed="each name once")
        found[name] = Kitchen(source, robots, (), service)
    return found


def graph_triples(twin: Twin, graph: Iri) -> list[ox.Triple]:
    """Triples of one of the twin's named graphs."""
    return [quad.triple for quad in twin.entities.store.dump([graph])]


def lines(statements: Iterable[ox.Triple] | Iterable[ox.Quad]) -> bytes:
    """N-Triples or N-Quads."""
    return b"".join(f"{each} .\n".encode() for each in statements)


def _is_by_name_only(graph: Iri) -> bool:
    """States and branches of the past: a present state is added by its kitchen."""
    return any(f"/graph/{kind}/" in graph for kind in ("state", "branch", "trajectory"))
