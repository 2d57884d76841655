"""Judging processes as the event loop sees them: started when needed, killed when late."""

import asyncio
import socket
import sys
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Final

from sdt_kg.errors import InputError, OracleUnavailableError
from sdt_kg.iri import Iri
from services.http.problems import RefusedError
from services.store.workers import BusyError
from services.store.workers.frames import Head, packed, read

WAITING: Final = 16
"""Cases that may wait for a process; one more is refused."""
START: Final = 120.0
"""[s] A process may take to load its kitchens."""

Recall = Callable[[Iri], Awaitable[bytes]]


@dataclass(eq=False)
class _Process:
    child: asyncio.subprocess.Process
    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter

    def kill(self) -> None:
        """It is gone."""
        self.writer.close()
        if self.child.returncode is None:
            self.child.kill()


@dataclass
class Judges:
    """Some judging processes.

    Attributes:
        setup: What each loads: kitchens (name → source) and robots.
        count: How many.
        recall: A verdict's graph as N-Quads; empty where none is kept.
        module: What a process runs.
    """

    setup: Head
    count: int
    recall: Recall
    module: str = "services.http.judging.process"
    _idle: list[_Process] = field(default_factory=list[_Process])
    _all: set[_Process] = field(default_factory=set[_Process])
    _waiting: int = 0

    def __post_init__(self) -> None:
        self._turns = asyncio.Semaphore(self.count)

    async def warm(self) -> None:
        """One process is there."""
        async with self._turns:
            if not self._idle:
                self._idle.append(await self._started())

    async def close(self) -> None:
        """No process is left."""
        for process in self._all:
            process.kill()
            await process.child.wait()
        self._all.clear()

    async def judge(self, question: Head, seconds: float) -> Head:
        """The reply to a question.

        Raises:
            InputError: The question is wrong.
            RefusedError: There was no answer in time: the process is killed, nothing is kept.
            BusyError: Too many cases are waiting.
            OracleUnavailableError: The process died, or could not judge.
        """
        if self._waiting >= WAITING + self.count:
            raise BusyError(f"{self._waiting} cases are waiting already: ask again later")
        self._waiting += 1
        try:
            async with asyncio.timeout(seconds), self._turns:
                return _checked(await self._asked(question))
        except TimeoutError:
            raise RefusedError(
                504,
                f"there is no verdict after {seconds:g} s",
                allowed="600 s",
                remedy="ask with more 'seconds', about one container, or with a smaller 'budget'",
            ) from None
        finally:
            self._waiting -= 1

    async def _asked(self, question: Head) -> Head:
        process = self._idle.pop() if self._idle else await self._started()
        try:
            reply = await self._exchanged(process, question)
        except (asyncio.IncompleteReadError, ConnectionError):
            self._lost(process)
            raise OracleUnavailableError(
                "the process that judged this has died: there is no verdict"
            ) from None
        except BaseException:
            self._lost(process)
            raise
        self._idle.append(process)
        return reply

    async def _exchanged(self, process: _Process, question: Head) -> Head:
        process.writer.write(packed(question))
        while True:
            reply, _ = await read(process.reader)
            if "wanted" not in reply:
                return reply
            process.writer.write(packed({}, await self.recall(reply["wanted"])))

    async def _started(self) -> _Process:
        ours, theirs = socket.socketpair()
        command = (sys.executable, "-m", self.module, str(theirs.fileno()))
        child = await asyncio.create_subprocess_exec(*command, pass_fds=[theirs.fileno()])
        theirs.close()
        process = _Process(child, *await asyncio.open_connection(sock=ours))
        self._all.add(process)
        try:
            process.writer.write(packed(self.setup))
            async with asyncio.timeout(START):
                await read(process.reader)
        except (asyncio.IncompleteReadError, ConnectionError, TimeoutError):
            self._lost(process)
            raise OracleUnavailableError("a process that judges could not be started") from None
        except BaseException:
            self._lost(process)
            raise
        return process

    def _lost(self, process: _Process) -> None:
        process.kill()
        self._all.discard(process)


def _checked(reply: Head) -> Head:
    if "wrong" in reply:
        raise InputError(
            reply["wrong"]["what"], allowed=reply["wrong"]["allowed"], remedy=reply["wrong"]["remedy"]
        )
    if "failed" in reply:
        raise OracleUnavailableError(reply["failed"])
    return reply
