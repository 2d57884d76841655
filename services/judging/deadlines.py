"""Whoever waits is answered at the deadline, whatever the one who works for him is doing."""

import threading
import time

from services.judging.jobs import Waiter
from services.judging.problems import ProblemType, problem

TICK = 0.01
"""[s] How late a deadline may be noticed."""


class Deadlines:
    """A thread that answers waiters whose time is up.

    Attributes:
        missed: How many it answered.
    """

    def __init__(self) -> None:
        self.missed = 0
        self._waiters: set[Waiter] = set()
        self._lock = threading.Lock()
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="deadlines", daemon=True)
        self._thread.start()

    def watch(self, waiter: Waiter) -> None:
        """Answer the waiter at its deadline, unless somebody else does before."""
        with self._lock:
            self._waiters.add(waiter)

    def close(self) -> None:
        """Nobody is watched any more; who still waits is told that the server is stopping."""
        self._stopping.set()
        self._thread.join()
        for waiter in self._waiters:
            waiter.answer(problem(ProblemType.UNAVAILABLE, "the server is stopping"))

    def _watch(self) -> None:
        while not self._stopping.wait(TICK):
            now = time.monotonic()
            with self._lock:
                late = [each for each in self._waiters if not each.over and now > each.deadline]
                self._waiters = {each for each in self._waiters if not each.over and now <= each.deadline}
            for waiter in late:
                self.missed += 1
                waiter.answer(problem(ProblemType.DEADLINE, "ask again with a later deadline"))
