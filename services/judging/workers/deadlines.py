"""Whoever waits is answered at the deadline, whatever the one who works for him is doing."""

import threading
import time

from services.judging.problems import ProblemType, problem
from services.judging.workers.jobs import Waiter

SWEEP = 0.05
"""[s] How often waiters that were answered before their time are let go of."""


class Deadlines:
    """A thread that answers waiters whose time is up, when it is up.

    Attributes:
        missed: How many it answered.
    """

    def __init__(self) -> None:
        self.missed = 0
        self._waiters: set[Waiter] = set()
        self._changed = threading.Condition()
        self._next = float("inf")  # when the thread looks again, on the monotonic clock [s]
        self._stopping = False
        self._thread = threading.Thread(target=self._watch, name="deadlines", daemon=True)
        self._thread.start()

    def watch(self, waiter: Waiter) -> None:
        """Answer the waiter at its deadline, unless somebody else does before."""
        with self._changed:
            self._waiters.add(waiter)
            if waiter.deadline < self._next:
                self._changed.notify()

    def close(self) -> None:
        """Nobody is watched any more; who still waits is told that the server is stopping."""
        with self._changed:
            self._stopping = True
            self._changed.notify()
        self._thread.join()
        for waiter in self._waiters:
            waiter.answer(problem(ProblemType.UNAVAILABLE, "the server is stopping"))

    def _watch(self) -> None:
        while True:
            late = self._slept()
            if self._stopping:
                return
            for waiter in late:
                if waiter.answer(problem(ProblemType.DEADLINE, "ask again with a later deadline")):
                    self.missed += 1

    def _slept(self) -> list[Waiter]:
        """Those whose time is up after a sleep until the first deadline."""
        with self._changed:
            now = time.monotonic()
            self._next = min((each.deadline for each in self._waiters), default=now + SWEEP)
            self._next = min(self._next, now + SWEEP)
            if self._next > now and not self._stopping:
                self._changed.wait(self._next - now)
            now = time.monotonic()
            waiting = [each for each in self._waiters if not each.over]
            self._waiters = {each for each in waiting if now < each.deadline}
            return [each for each in waiting if now >= each.deadline]
