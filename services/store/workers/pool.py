"""Workers as the event loop sees them: ask, change, and replace the one that was killed."""

import asyncio
import os
import signal
import socket
import sys
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from typing import Self

from services.store.workers.deltas import Delta
from services.store.workers.errors import (
    BusyError,
    CrashedQueryError,
    Limit,
    LimitError,
    WorkersGoneError,
)
from services.store.workers.evaluate import Answered, Asked, error_of
from services.store.workers.frames import Head, packed, read, receive

LARGE = 2**20
"""[bytes] After a change that is larger, workers are forked anew instead of making it too."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What one query may take.

    Attributes:
        seconds: From asking to the complete answer, waiting for a worker included.
        memory: Address space that a worker may add to the data [bytes].
        rows: Of a table, or triples.
        size: Of an answer [bytes].
        waiting: Questions that may wait for a worker.
    """

    seconds: float = 10.0
    memory: int = 512 * 2**20
    rows: int = 1_000_000
    size: int = 64 * 2**20
    waiting: int = 64


@dataclass(eq=False)
class _Worker:
    pid: int
    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    spent: bool = False
    stale: bool = False

    @property
    def gone(self) -> bool:
        """Whether its end was noticed; one that leaves data unread resets its channel, not ends it."""
        return self.reader.at_eof() or self.writer.is_closing()


class _KilledError(CrashedQueryError):
    """Somebody killed the worker, perhaps before it read the question: another one may be asked, once."""


@dataclass
class Workers:
    """Some workers over one set of data.

    Attributes:
        count: Worker processes.
        namespace: Whether they are in a network namespace of their own; without it they still cannot
            open a socket.
    """

    count: int = field(default_factory=lambda: min(4, max(2, os.cpu_count() or 1)))
    limits: Limits = field(default_factory=Limits)
    namespace: bool = False

    def __post_init__(self) -> None:
        self._process: asyncio.subprocess.Process | None = None
        self._control: socket.socket | None = None
        self._lock = asyncio.Lock()
        self._idle: list[_Worker] = []
        self._all: set[_Worker] = set()
        self._free = asyncio.Condition()
        self._ending: set[asyncio.Task[Head]] = set()
        self._waiting = 0

    @property
    def running(self) -> bool:
        """Whether questions can be asked."""
        return self._process is not None and self._process.returncode is None and bool(self._all)

    @property
    def pids(self) -> tuple[int, ...]:
        """Processes that evaluate queries."""
        return tuple(worker.pid for worker in self._all)

    async def start(self, deltas: Iterable[Delta] = ()) -> Self:
        """The data is loaded and the workers are there."""
        ours, theirs = socket.socketpair()
        command = (sys.executable, "-m", "services.store.workers.nursery", str(theirs.fileno()))
        self._process = await asyncio.create_subprocess_exec(
            *command,
            str(self.limits.memory),
            pass_fds=[theirs.fileno()],
            stdin=asyncio.subprocess.DEVNULL,
            process_group=0,  # Ctrl-C in a terminal is for this process, which ends it
        )
        theirs.close()
        self._control = ours
        self.namespace = (await asyncio.to_thread(self._received))["namespace"]
        for delta in deltas:
            await self.apply(delta)
        for _ in range(self.count):
            await self._add()
        return self

    async def close(self) -> None:
        """No process is left."""
        await asyncio.gather(*self._ending, return_exceptions=True)
        for worker in self._all:
            worker.writer.close()
        self._all.clear()
        if self._control is not None:
            self._control.close()
        if self._process is not None:
            await self._process.wait()

    async def ask(self, asked: Asked, seconds: float = float("inf")) -> Answered:
        """The complete answer, within all limits.

        Args:
            asked: The question.
            seconds: After which nobody waits, where that is sooner than the limit.

        Raises:
            QueryError: The query is refused or not SPARQL.
            LimitError: A limit is reached; a worker that was killed for it is replaced.
            NotAcceptableError: No accepted media type fits.
            CrashedQueryError: The query ended its worker.
            BusyError: Too many questions are waiting.
            WorkersGoneError: The process with the data has ended.
        """
        limits = self.limits
        asked = replace(asked, rows=min(asked.rows, limits.rows), size=min(asked.size, limits.size))
        most = min(limits.seconds, seconds)
        try:
            async with asyncio.timeout(most):
                try:
                    return await self._answer(asked)
                except _KilledError:
                    return await self._answer(asked)
        except TimeoutError:
            raise LimitError(Limit.TIME, f"{most:g} s") from None

    async def _answer(self, asked: Asked) -> Answered:
        async with self._borrowed() as worker:
            worker.writer.write(packed(asked.head()))
            head, body = await read(worker.reader)
            worker.spent = head["spent"]
        if "error" in head:
            raise error_of(head)
        return Answered(head["media"], body, head["found"])

    async def apply(self, delta: Delta) -> None:
        """The change is made, and whoever asks from now on sees it.

        Raises:
            ValueError: The body is not RDF; nothing is changed.
        """
        frame = packed(delta.head, delta.body)
        async with self._lock:
            reply = await asyncio.to_thread(self._told, frame)
            if "error" in reply:
                raise ValueError(reply["error"])
            for worker in self._all:
                if len(frame) > LARGE:
                    worker.stale = True
                else:
                    worker.writer.write(frame)

    @asynccontextmanager
    async def _borrowed(self) -> AsyncIterator[_Worker]:
        """A worker for one question; whatever leaves it without an answer costs it its life."""
        worker = await self._taken()
        try:
            yield worker
        except (asyncio.IncompleteReadError, ConnectionError):
            raise self._cause(await asyncio.shield(self._replacing(worker))) from None
        except BaseException:
            await asyncio.shield(self._replacing(worker))
            raise
        if worker.spent:
            self._replacing(worker)
        else:
            await self._give(worker)

    async def _taken(self) -> _Worker:
        if not self.running:
            raise WorkersGoneError("the process that holds the data has ended: restart the service")
        if self._waiting >= self.limits.waiting:
            raise BusyError(f"{self._waiting} questions are waiting already: ask again in a second")
        self._waiting += 1
        try:
            while True:
                if self._waiting > 1 or not self._idle:  # in turn
                    async with self._free:
                        await self._free.wait_for(lambda: bool(self._idle))
                worker = self._idle.pop()
                if not (worker.stale or worker.gone):
                    return worker
                await asyncio.shield(self._replacing(worker))
        finally:
            self._waiting -= 1

    async def _give(self, worker: _Worker) -> None:
        async with self._free:
            self._idle.append(worker)
            self._free.notify()

    def _cause(self, end: Head) -> Exception:
        """Why a worker died: Rust says so when it gets no memory, and aborts."""
        if "memory allocation" in end["said"] or "MemoryError" in end["said"]:
            return LimitError(Limit.MEMORY, f"{self.limits.memory} bytes")
        kind = _KilledError if end["signal"] == signal.SIGKILL else CrashedQueryError
        return kind(
            f"the query ended its process (signal {end['signal']})",
            allowed="queries that are not nested thousands deep",
            remedy="simplify it",
        )

    def _replacing(self, worker: _Worker) -> asyncio.Task[Head]:
        """The replacement under way, which goes on even if who waits for it is stopped."""
        task = asyncio.create_task(self._replaced(worker))
        self._ending.add(task)
        task.add_done_callback(self._ending.discard)
        return task

    async def _replaced(self, worker: _Worker) -> Head:
        """How the worker ended; another one is there."""
        self._all.discard(worker)
        worker.writer.close()
        async with self._lock:
            end = await asyncio.to_thread(self._told, packed({"do": "end", "pid": worker.pid}))
        await self._add()
        return end

    async def _add(self) -> None:
        async with self._lock:
            pid, channel = await asyncio.to_thread(self._forked)
            reader, writer = await asyncio.open_connection(sock=channel)
            worker = _Worker(pid, reader, writer)
            self._all.add(worker)
        await self._give(worker)

    def _forked(self) -> tuple[int, socket.socket]:
        assert self._control is not None, "started"
        head = self._told(packed({"do": "fork"}))
        try:
            _, descriptors, _, _ = socket.recv_fds(self._control, 1, 1)
        except OSError as error:
            raise WorkersGoneError(f"no worker could be started: {error}") from None
        return head["pid"], socket.socket(fileno=descriptors[0])

    def _told(self, frame: bytes) -> Head:
        assert self._control is not None, "started"
        try:
            self._control.sendall(frame)
        except OSError as error:
            raise WorkersGoneError(f"the process that holds the data has ended: {error}") from None
        return self._received()

    def _received(self) -> Head:
        assert self._control is not None, "started"
        try:
            return receive(self._control)[0]
        except (EOFError, OSError) as error:
            raise WorkersGoneError(f"the process that holds the data has ended: {error}") from None
