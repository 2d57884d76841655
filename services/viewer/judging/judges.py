"""The processes that judge, as sessions ask them: a pool whose questions and answers are values of ours."""

import math
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from services.judging.problems import Problem
from services.judging.workers.jobs import Done, Handler, Job, NoMemory, Task, Waiter
from services.judging.workers.pool import Pool
from services.viewer.judging.question import Answered, Asked, Place, Question

PICKLED: Final = "python/pickle"
"""Encoding of payloads: between processes of ours alone, arrays as they are."""
NEVER: Final = math.inf
"""[s] Deadline of a question: who asks sees how long it takes, and may stop it."""


@dataclass(frozen=True, slots=True)
class Setup:
    """What each process gets ready for: picklable, and makes the process's handler."""

    first: Place

    def __call__(self) -> Handler:
        """Load the place, and judge a first case."""
        from services.viewer.judging.judge import warmed  # noqa: PLC0415 - loads what only a judge needs

        return warmed(self.first)


@dataclass(frozen=True, slots=True)
class Ticket:
    """A question on its way.

    Attributes:
        asked: What was asked.
    """

    asked: Asked
    _job: Job
    _waiter: Waiter

    @property
    def began(self) -> float | None:
        """When a process took it up, on the monotonic clock [s]; None while it waits."""
        return self._job.began

    def give_up(self) -> None:
        """Nobody waits any longer."""
        self._waiter.leave()


class Judges:
    """Some processes that judge.

    Args:
        count: Processes.
        first: What each of them gets ready for when it begins.
    """

    def __init__(self, count: int, first: Place) -> None:
        self._pool = Pool(Setup(first), count, NoMemory())
        self._pool.warm(seconds=0)

    def submit(self, asked: Asked, done: Callable[[Answered], None]) -> Ticket:
        """The ticket of a question; `done` is called from another thread, once, unless it is given up."""

        def answered(outcome: Done | Problem) -> None:
            done(outcome if isinstance(outcome, Problem) else pickle.loads(outcome.payload))  # noqa: S301 - ours

        waiter = Waiter(NEVER, answered)
        task = Task("", type(asked).__name__, pickle.dumps(asked), PICKLED, NEVER)
        return Ticket(asked, self._pool.submit(task, waiter, urgent=isinstance(asked, Question)), waiter)

    @property
    def ready(self) -> bool:
        """Whether some process has everything loaded and compiled."""
        return self._pool.ready

    def wait(self, seconds: float) -> None:
        """The first process has everything loaded and compiled, or so long is over."""
        self._pool.warm(1, seconds)

    def close(self) -> None:
        """No process is left."""
        self._pool.close()
