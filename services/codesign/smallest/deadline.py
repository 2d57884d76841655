"""When a search for changes stops: by CPU time, so that a busy machine gives the same answer, later."""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

from services.codesign.entries import Found
from services.codesign.judge import Judge
from services.whatif import World


@dataclass(slots=True)
class Deadline:
    """Stop before an edit after which a process would have spent too much, if it took as long as the longest.

    Attributes:
        left: CPU time that each process may spend [s].
        each: Of search in each edited world [s].
        search: Name of the search: a process counts from when it first has to do with it.
    """

    left: float
    each: float
    search: str
    _longest: float = 0.0

    def spent(self) -> float:
        """CPU time that this process has spent on the search [s]."""
        return time.process_time() - _begun(os.getpid(), self.search)

    def is_late(self) -> bool:
        """Whether no further edit is to be tried."""
        return self.spent() + max(self._longest, self.each) > self.left

    def judged(self, before: World, actual: Found, made: Callable[[], World], task: str) -> Found:
        """The outcome in the world that is made; both are timed.

        Args:
            before: The world as it is.
            actual: What was found there.
            made: Makes the other world.
            task: What is asked in both.
        """
        began = self.spent()
        found = Judge(before, made(), {actual.iri: actual}).judged(task, actual)
        seconds = self.spent() - began
        self._longest = max(self._longest, seconds)
        return replace(found, seconds=seconds)


@lru_cache(maxsize=2)
def _begun(process: int, search: str) -> float:
    """CPU time of a process when it was first asked about a search [s]: forked ones have their own."""
    del process, search
    return time.process_time()
