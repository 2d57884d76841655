"""Processes that judge, each behind a thread; the jobs of all people who look wait in one line."""

import itertools
import logging
import queue
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from typing import Final

from services.viewer.judging.question import Answered, Job, PathsAsked, Question, Trouble, Warmed

WAITING: Final = 64
"""Jobs that may wait; one more is refused."""
PATIENCE: Final = 2.0
"""[s] A job that nobody waits for may go on so long before its process is replaced."""
POLL: Final = 0.02
"""[s] How often a lane looks whether it is still waited for."""
END: Final = 2.0
"""[s] A process may take to end by itself."""

_ORDER: Final = {Question: 0, PathsAsked: 1, Warmed: 2}
_log = logging.getLogger("sdt.view")


@dataclass(eq=False)
class Ticket:
    """A job, and whether somebody still waits for its answer.

    Attributes:
        began: When a process took it up, on the monotonic clock; None while it waits.
    """

    job: Job
    done: Callable[[Answered], None]
    began: float | None = None
    _given_up: threading.Event = field(default_factory=threading.Event)

    def give_up(self) -> None:
        """Nobody waits any longer; `done` is not called."""
        self._given_up.set()

    @property
    def given_up(self) -> bool:
        """Whether nobody waits."""
        return self._given_up.is_set()

    def answer(self, answered: Answered) -> None:
        """Tell who waits."""
        if not self.given_up:
            self.done(answered)


class Judges:
    """Some processes that judge.

    Args:
        count: Processes.
        first: What each of them gets ready for when it begins.
    """

    def __init__(self, count: int, first: Warmed) -> None:
        self._line: queue.PriorityQueue[tuple[int, int, Ticket | None]] = queue.PriorityQueue()
        self._number = itertools.count()
        self._lanes = [_Lane(self._line, first) for _ in range(count)]
        for lane in self._lanes:
            lane.start()

    def submit(self, job: Job, done: Callable[[Answered], None]) -> Ticket:
        """The ticket of a job; `done` is called from another thread, once, unless the ticket is given up."""
        ticket = Ticket(job, done)
        if self._line.qsize() >= WAITING:
            ticket.answer(Trouble(f"{WAITING} questions wait already; allowed: fewer; ask again in a while"))
            return ticket
        self._line.put((_ORDER[type(job)], next(self._number), ticket))
        return ticket

    @property
    def ready(self) -> bool:
        """Whether some process has everything loaded and compiled."""
        return any(lane.ready.is_set() for lane in self._lanes)

    def wait(self, seconds: float) -> bool:
        """Whether the first process has everything loaded and compiled, after so long at most."""
        return self._lanes[0].ready.wait(seconds)

    def close(self) -> None:
        """No process is left."""
        for lane in self._lanes:
            lane.stopping.set()
        for _ in self._lanes:
            self._line.put((-1, next(self._number), None))
        for lane in self._lanes:
            lane.join(2 * END)

    def pids(self) -> list[int]:
        """Process ids, for tests."""
        return [lane.process.pid for lane in self._lanes if lane.process is not None]


class _Lane(threading.Thread):
    """A thread with one process; it is begun anew when it dies or nobody waits for it any longer."""

    def __init__(self, line: "queue.PriorityQueue[tuple[int, int, Ticket | None]]", first: Warmed) -> None:
        super().__init__(daemon=True, name="sdt-view-judge")
        self._line, self._first = line, first
        self.process: subprocess.Popen[bytes] | None = None
        self._channel: Connection | None = None
        self.stopping, self.ready = threading.Event(), threading.Event()

    def run(self) -> None:
        self._begin()
        self._answered(Ticket(self._first, lambda _: None))
        self.ready.set()
        while not self.stopping.is_set():
            _, _, ticket = self._line.get()
            if ticket is None:
                break
            if not ticket.given_up:
                ticket.answer(self._answered(ticket))
        self._end()

    def _answered(self, ticket: Ticket) -> Answered:
        assert self._channel is not None, "begun"
        ticket.began = time.monotonic()
        try:
            self._channel.send(ticket.job)
            while not self._channel.poll(POLL):
                late = time.monotonic() - ticket.began > PATIENCE
                if self.stopping.is_set() or (ticket.given_up and late):
                    self._again()
                    return None
            return self._channel.recv()
        except (EOFError, ConnectionError, OSError):
            _log.warning("a process that judges has ended; another one is begun")
            self._again()
            return Trouble("the process that judged has ended; allowed: memory and time enough; ask again")

    def _again(self) -> None:
        self._end()
        if not self.stopping.is_set():
            self._begin()

    def _begin(self) -> None:
        ours, theirs = socket.socketpair()
        command = [sys.executable, "-m", "services.viewer.judging.judge", str(theirs.fileno())]
        self.process = subprocess.Popen(command, pass_fds=(theirs.fileno(),), stdin=subprocess.DEVNULL)  # noqa: S603 - ours
        theirs.close()
        self._channel = Connection(ours.detach())

    def _end(self) -> None:
        if self._channel is not None:
            self._channel.close()
        if self.process is not None:
            self.process.kill()
            self.process.wait(END)
        self.process = self._channel = None
