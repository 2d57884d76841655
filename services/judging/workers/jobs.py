"""A question on its way to a worker process, and who waits for its answer."""

import logging
import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Protocol

from services.judging.problems import Problem
from services.telemetry.metrics import Judged
from services.telemetry.origin import NOBODY, Origin

log = logging.getLogger(__name__)

Kept = tuple[str, bytes]
"""IRI of a verdict, and its graph as N-Quads."""
Quads = Callable[[str], bytes | None]
"""What is stored under a verdict's IRI, as N-Quads."""


@dataclass(frozen=True, slots=True)
class Task:
    """What a worker is sent.

    Attributes:
        seconds: That are left until the deadline.
        states: The kitchen's present state as texts; the request's own come after it.
        origin: The request that it is done for.
    """

    twin: str
    verb: str
    payload: bytes
    encoding: str
    seconds: float
    states: tuple[str, ...] = ()
    origin: Origin = NOBODY


@dataclass(frozen=True, slots=True)
class Done:
    """What a worker sends back at the end: the reply's payload, what is to be stored and to be counted."""

    payload: bytes
    encoding: str
    records: tuple[Kept, ...] = ()
    judged: tuple[Judged, ...] = ()


@dataclass(frozen=True, slots=True)
class Unfit:
    """What a worker sends back that can answer nothing, and ends: the next question finds another."""

    problem: Problem


@dataclass(frozen=True, slots=True)
class Wanted:
    """What a worker asks on the way: the quads stored under a verdict's IRI."""

    iri: str


class Handler(Protocol):
    """What a worker does with a task; made once in the worker's process."""

    def __call__(self, task: Task, recall: Quads) -> Done | Problem:
        """Answer the task; `recall` asks the parent for a verdict's stored N-Quads.

        Raises:
            OtherModelsError: The worker has read other models than are served.
        """
        ...


class Keeper(Protocol):
    """What workers' verdicts are kept in."""

    def recall(self, iri: str) -> bytes | None:
        """The verdict's graph as N-Quads, if it is kept."""
        ...

    def keep(self, kept: Iterable[Kept]) -> None:
        """The verdicts are stored; what was there already stays as it is."""
        ...


class NoMemory:
    """Of an oracle: it makes no verdicts."""

    def recall(self, iri: str) -> None:
        """Nothing."""
        del iri

    def keep(self, kept: Iterable[Kept]) -> None:
        """Nothing is ever given to be kept."""
        del kept


@dataclass(slots=True, eq=False)
class Waiter:
    """Somebody who waits for a job.

    Attributes:
        deadline: On the monotonic clock [s].
        answered: Called exactly once, from a thread of the pool.
    """

    deadline: float
    answered: Callable[[Done | Problem], None]
    _claimed: threading.Lock = field(default_factory=threading.Lock)
    _over: bool = False

    def answer(self, outcome: Done | Problem) -> bool:
        """Give the answer, unless one was given; whether it was this one."""
        with self._claimed:
            if self._over:
                return False
            self._over = True
        try:
            self.answered(outcome)
        except Exception:  # logged: the thread that answers works for others too
            log.exception("an answer could not be given")
        return True

    def leave(self) -> None:
        """Nobody waits here any longer: `answered` is not called, and what is done for nobody ends soon."""
        with self._claimed:
            self._over = True
        self.deadline = time.monotonic()

    @property
    def over(self) -> bool:
        """Whether it was answered, or left."""
        return self._over


@dataclass(slots=True, eq=False)
class Job:
    """A task on its way through the pool, for one waiter or for several that ask the same.

    Attributes:
        urgent: Whether it goes before those that are not.
        asked: When it came, on the monotonic clock [s].
        began: When a process took it up; None while it waits.
    """

    task: Task
    waiters: list[Waiter]
    urgent: bool = False
    cancelled: threading.Event = field(default_factory=threading.Event)
    asked: float = field(default_factory=time.monotonic)
    began: float | None = None
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _finished: bool = False

    def __lt__(self, other: "Job") -> bool:
        """Whether it is taken up before the other: urgent first, then as they came."""
        return (not self.urgent, self.asked) < (not other.urgent, other.asked)

    def join(self, waiter: Waiter) -> bool:
        """Whether the waiter came in time to wait for this job too."""
        with self._lock:
            if self._finished or self.over:
                return False
            self.waiters.append(waiter)
            return True

    def answer(self, outcome: Done | Problem) -> None:
        """Answer whoever still waits; nobody joins any more."""
        with self._lock:
            self._finished = True
        for waiter in self.waiters:
            waiter.answer(outcome)

    @property
    def deadline(self) -> float:
        """[s] When the last waiter has gone."""
        return max(waiter.deadline for waiter in tuple(self.waiters))

    @property
    def over(self) -> bool:
        """Whether nobody waits any more."""
        return all(waiter.over for waiter in tuple(self.waiters))


@dataclass(slots=True)
class Counts:
    """What the pool has done so far."""

    answered: int = 0
    crashed: int = 0
    refused: int = 0
    replaced: int = 0
