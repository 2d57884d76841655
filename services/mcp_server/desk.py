"""What the tools ask: kitchens to read, workers that answer SPARQL, a process that judges, kept verdicts."""

import asyncio
import json
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Final

import pyoxigraph as ox

import ontology
from sdt_kg.errors import InputError, QueryError, UnknownEntityError
from sdt_kg.iri import Iri
from sdt_kg.load import model_name
from services.app import Service, load
from services.http.judges import Judges
from services.http.problems import RefusedError
from services.http.world import lines
from services.judging.codec import JSON
from services.judging.loaded import models_of
from services.judging.workers.jobs import Kept, Task
from services.judging.workers.pool import Pool
from services.mcp_server.judge import Head, JudgeSetup
from services.store.records import graph_of
from services.store.workers import Asked, Delta, Limits, NotAcceptableError, Workers, bulk, drop, put

ROWS: Final = 10_000
"""Of a query's answer, shown or not; with more there is none."""
QUERY_SECONDS: Final = 10.0
"""[s] A query may take."""
QUERY_SIZE: Final = 8 * 2**20
"""[bytes] Of a query's answer."""
KEPT: Final = 500
"""Verdicts that are kept; the oldest gives way."""
FIRST: Final = 60.0
"""[s] A judgement may take beyond its search: models are built and compiled, motions certified."""

VOCABULARIES: Final = ("sdt.ttl", "law.ttl", "tee.ttl")
_TABLE: Final = "application/sparql-results+json"


@dataclass(frozen=True, slots=True)
class Setup:
    """What is loaded.

    Attributes:
        kitchens: Bundled names or paths.
        robots: Bundled names or paths, loaded with every kitchen.
        connect: Endpoint on the bus whose oracles answer for Φ and R; None: a process of ours does.
    """

    kitchens: tuple[str, ...]
    robots: tuple[str, ...]
    connect: str | None = None

    def services(self) -> dict[str, Service]:
        """The Law over each kitchen, by name.

        Raises:
            InputError: A model that is not there or not valid, or two kitchens of one name.
        """
        found: dict[str, Service] = {}
        for source in self.kitchens:
            name = model_name(source)
            if name in found:
                raise InputError(f"two kitchens are named '{name}'", allowed="each name once")
            found[name] = load(source, self.robots)
        return found

    def judging(self, services: Iterable[Service]) -> JudgeSetup:
        """What the process that judges loads, which is to be what these services are about."""
        served = models_of(each.twin for each in services)
        if self.connect is None:
            return JudgeSetup(self.kitchens, self.robots, served)
        from services.bus.oracles.remote import OnBus  # noqa: PLC0415 - most need no bus
        from services.bus.sessions import Reach  # noqa: PLC0415 - see above

        return JudgeSetup(self.kitchens, self.robots, served, OnBus(Reach(self.connect)))


@dataclass
class Desk:
    """Everything that the tools ask.

    Attributes:
        services: By the kitchen's name; read here, judged elsewhere.
        workers: Processes that answer SPARQL, without a network.
        judges: The process that judges; killed when it is late.
        kept: Verdict → its graph as N-Quads, oldest first.
        edited: Verdict about another world → the edits that had made it of the one that is loaded.
    """

    services: dict[str, Service]
    workers: Workers
    judges: Judges
    kept: dict[Iri, bytes] = field(default_factory=dict[Iri, bytes])
    edited: dict[Iri, tuple[str, ...]] = field(default_factory=dict[Iri, tuple[str, ...]])

    def service(self, kitchen: str | None) -> Service:
        """A kitchen by name, with the errors of `kitchen_name`."""
        return self.services[self.kitchen_name(kitchen)]

    def kitchen_name(self, kitchen: str | None) -> str:
        """Under which a kitchen was loaded; may be left out where there is one.

        Raises:
            UnknownEntityError: None of that name.
        """
        if kitchen is None and len(self.services) == 1:
            return next(iter(self.services))
        if kitchen is None:
            raise InputError("no kitchen is named", allowed=", ".join(self.services), remedy="give 'kitchen'")
        if kitchen not in self.services:
            raise UnknownEntityError("kitchen", kitchen, self.services)
        return kitchen

    @staticmethod
    def robot(service: Service, robot: str | None) -> Iri:
        """A robot by name; may be left out where there is one.

        Raises:
            UnknownEntityError: None of that name.
        """
        names = {service.twin.name(each): each for each in service.twin.robots}
        if robot is None and len(names) == 1:
            return next(iter(names.values()))
        if robot is None:
            raise InputError("no robot is named", allowed=", ".join(names), remedy="give 'robot'")
        if robot not in names:
            raise UnknownEntityError("robot", robot, names)
        return names[robot]

    async def query(self, sparql: str) -> ox.QuerySolutions | ox.QueryBoolean:
        """The complete answer to a SELECT or ASK.

        Raises:
            QueryError: No SPARQL that reads.
            LimitError: Above a limit of time, memory, rows or size.
        """
        try:
            answered = await self.workers.ask(Asked("query", sparql, accepted=(_TABLE,)))
        except NotAcceptableError:
            raise QueryError(
                "the query gives triples", allowed="SELECT, ASK", remedy="ask for rows"
            ) from None
        found = ox.parse_query_results(answered.body, format=ox.QueryResultsFormat.JSON)
        assert not isinstance(found, ox.QueryTriples), "no graph format is accepted"
        return found

    async def judge(self, question: Head, seconds: float) -> Head:
        """The reply of the process that judges; new verdicts are kept.

        Raises:
            InputError: The question is wrong.
            RefusedError: There is no answer in time; the process is killed.
            OracleUnavailableError: There is no oracle that could judge, or too many are waiting.
            InternalError: The process died twice, or failed.
        """
        task = Task(question["kitchen"], question["do"], json.dumps(question).encode(), JSON, seconds)
        try:
            done = await self.judges.answer(task)
        except RefusedError:
            raise RefusedError(
                504,
                f"there is no verdict after {seconds:g} s: nothing is claimed",
                allowed=f"'budget' (or 'within') and {FIRST:g} s more",
                remedy="ask again, about one container, or with another 'budget'",
            ) from None
        return json.loads(done.payload)


@dataclass(frozen=True, slots=True)
class _Kept:
    """The verdicts of a session, as the threads of the pool see them.

    Attributes:
        graphs: Verdict → its graph as N-Quads, oldest first.
        workers: They belong to the loop.
    """

    graphs: dict[Iri, bytes]
    workers: Workers
    loop: asyncio.AbstractEventLoop

    def recall(self, iri: Iri) -> bytes | None:
        """The graph of a kept verdict."""
        return self.graphs.get(iri)

    def keep(self, kept: Iterable[Kept]) -> None:
        """The verdicts can be asked about; what is judged anew is better than what it replaces."""
        for iri, quads in kept:
            asyncio.run_coroutine_threadsafe(self._keep(iri, quads), self.loop).result()

    async def _keep(self, verdict: Iri, quads: bytes) -> None:
        self.graphs.pop(verdict, None)
        self.graphs[verdict] = quads
        triples = (quad.triple for quad in ox.parse(quads, format=ox.RdfFormat.N_QUADS))
        await self.workers.apply(put(graph_of(verdict), lines(triples), instead=True))
        while len(self.graphs) > KEPT:
            oldest = next(iter(self.graphs))
            del self.graphs[oldest]
            await self.workers.apply(drop(graph_of(oldest)))


@asynccontextmanager
async def opened(setup: Setup, services: dict[str, Service]) -> AsyncIterator[Desk]:
    """A desk whose processes are there, until it is closed."""
    workers = Workers(count=1, limits=Limits(seconds=QUERY_SECONDS, rows=ROWS, size=QUERY_SIZE))
    kept: dict[Iri, bytes] = {}
    judging = setup.judging(services.values())
    judges = Judges(Pool(judging, 1, _Kept(kept, workers, asyncio.get_running_loop())))
    desk = Desk(services, workers, judges, kept)
    try:
        models = [bulk(each.twin.serialize("nquads")) for each in services.values()]
        await workers.start([*models, *map(_vocabulary, VOCABULARIES)])
        warming = asyncio.create_task(judges.warm())
        try:
            yield desk
        finally:
            warming.cancel()
            await asyncio.gather(warming, return_exceptions=True)
    finally:
        await judges.close()
        await workers.close()


def _vocabulary(file: str) -> Delta:
    quads = ox.parse(ontology.path(file).read_bytes(), format=ox.RdfFormat.TURTLE)
    return put(
        f"https://example.org/{file.removesuffix('.ttl')}", lines(quad.triple for quad in quads), shown=False
    )
