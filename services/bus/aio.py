"""The client for event loops: the same questions, answers and errors, awaited."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import pyoxigraph as ox

from sdt_kg.store import Row
from services.bus.client import Connection, Verdicts
from services.bus.sessions import DEFAULT_ENDPOINT, open_session
from services.judging.replies import CausesReply, HistoryReply, JobReply, MetRequest, TextReply

P = ParamSpec("P")
T = TypeVar("T")

AT_ONCE = 64
"""Questions of one connection that are under way; more wait their turn."""


@dataclass(frozen=True, slots=True)
class AsyncConnection:
    """A twin on the bus. A question that nobody awaits any more ends at its deadline.

    Attributes:
        here: The same for threads.
    """

    here: Connection
    _threads: ThreadPoolExecutor

    async def select(self, query: str) -> tuple[list[str], list[Row]]:
        """Columns and rows of a SELECT."""
        return await self._asked(self.here.select, query)

    async def ask(self, query: str) -> bool:
        """Whether the pattern of an ASK is there."""
        return await self._asked(self.here.ask, query)

    async def construct(self, query: str) -> list[ox.Triple]:
        """Triples of a CONSTRUCT or DESCRIBE."""
        return await self._asked(self.here.construct, query)

    async def satisfies(self, *state: str) -> tuple[MetRequest, ...]:
        """Every request that the state meets."""
        return await self._asked(self.here.satisfies, *state)

    async def causes(
        self,
        task: str,
        *state: str,
        motion: Mapping[str, object] | None = None,
        **relative: Any,  # noqa: ANN401 - fields of CausesRequest, checked there
    ) -> CausesReply:
        """Motions that would cause the task, or whether the given one does; no robot."""
        return await self._asked(self.here.causes, task, *state, motion=motion, **relative)

    async def achieve(
        self,
        task: str,
        robot: str | None = None,
        *state: str,
        motion: Mapping[str, object] | None = None,
        **policy: Any,  # noqa: ANN401 - fields of AchieveRequest, checked there
    ) -> Verdicts:
        """CanAchieve: one verdict for each container that the task is about."""
        return await self._asked(self.here.achieve, task, robot, *state, motion=motion, **policy)

    async def place(self, task: str, robot: str | None = None, *state: str, **search: Any) -> dict[str, Any]:  # noqa: ANN401 - fields of PlaceRequest
        """Where the base may stand for a task: the object of `sdt place --json`."""
        return await self._asked(self.here.place, task, robot, *state, **search)

    async def whatif(
        self,
        task: str,
        edits: Sequence[str] = (),
        robot: str | None = None,
        *state: str,
        **policy: Any,  # noqa: ANN401 - fields of WhatIfRequest, checked there
    ) -> dict[str, Any]:
        """The same question in another world, and what turns: the object of `sdt whatif --json`."""
        return await self._asked(self.here.whatif, task, edits, robot, *state, **policy)

    async def task(self, task: str, robot: str | None = None, *state: str, **policy: Any) -> dict[str, Any]:  # noqa: ANN401 - fields of TaskRequest
        """What becomes of a task with steps and rules: the object of `sdt task --json`."""
        return await self._asked(self.here.task, task, robot, *state, **policy)

    async def why(self, iri: str) -> str:
        """A kept verdict in plain words."""
        return await self._asked(self.here.why, iri)

    async def story(self, iri: str) -> TextReply:
        """The same, and part by part."""
        return await self._asked(self.here.story, iri)

    async def history(
        self, kind: str = "verdict", after: int = 0, epoch: str = "", limit: int = 100, instance: str = ""
    ) -> HistoryReply:
        """Events of `verdict` or `state` after a sequence number; a gap is told."""
        return await self._asked(self.here.history, kind, after, epoch, limit, instance)

    async def sweep(self, verb: str = "open", *state: str, **policy: Any) -> JobReply:  # noqa: ANN401 - fields of SweepRequest
        """A job that judges every container for every robot, and whatever else is varied."""
        return await self._asked(self.here.sweep, verb, *state, **policy)

    async def progress(self, job: str) -> JobReply:
        """How far a job is."""
        return await self._asked(self.here.progress, job)

    async def result(self, job: str) -> dict[str, Any]:
        """`{job, state, verdicts, problems}` of a job, so far."""
        return await self._asked(self.here.result, job)

    async def cancel(self, job: str) -> JobReply:
        """The job stops; what it has found stays."""
        return await self._asked(self.here.cancel, job)

    async def health(self) -> list[dict[str, Any]]:
        """What each server says of itself."""
        return await self._asked(self.here.health)

    async def metrics(self) -> list[dict[str, Any]]:
        """Counters of each server, by Prometheus' names and labels."""
        return await self._asked(self.here.metrics)

    async def servers(self) -> list[str]:
        """Instances that are there now."""
        return await self._asked(self.here.servers)

    async def _asked(self, question: Callable[P, T], *given: P.args, **named: P.kwargs) -> T:
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._threads, partial(question, *given, **named))


@asynccontextmanager
async def connect_async(
    twin: str, endpoint: str = DEFAULT_ENDPOINT, *, deadline: float = 60.0, config: Path | None = None
) -> AsyncIterator[AsyncConnection]:
    """A twin on the bus at an endpoint, for `async with`.

    Raises:
        BusUnavailableError: Nobody listens there.
    """
    session = await asyncio.to_thread(open_session, connect=endpoint, mode="client", config=config)
    threads = ThreadPoolExecutor(AT_ONCE, "sdt-bus")
    try:
        yield AsyncConnection(Connection(session, twin, deadline), threads)
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        await asyncio.to_thread(session.close)
