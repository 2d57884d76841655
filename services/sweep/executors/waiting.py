"""What is not handed out yet: what is alike stays together, and the last pieces are small."""

from collections import deque
from collections.abc import Callable, Collection, Hashable, Sequence
from itertools import takewhile
from operator import eq
from typing import Final, Generic, TypeVar

T = TypeVar("T")

MOST_TOGETHER: Final = 32
"""[1] Items in one piece at most: more than a kitchen has containers, so that a group stays whole."""
PIECES: Final = 2
"""[1] Into which each worker's share of what waits is cut: the later ones balance the earlier."""


class Waiting(Generic[T]):
    """Items by what they have in common, which a worker loads once for all of a piece.

    Args:
        workers: How many share the items.
        alike: What an item has in common with those that are to stay with it; of tuples those are nearest
            that begin alike.
        most: Items in one piece at most.
    """

    def __init__(self, workers: int, alike: Callable[[T], Hashable], most: int = MOST_TOGETHER) -> None:
        self._workers, self._alike, self._most = workers, alike, most
        self._groups: dict[Hashable, deque[T]] = {}

    def __len__(self) -> int:
        return sum(map(len, self._groups.values()))

    @property
    def is_full(self) -> bool:
        """Whether there is a piece for each worker, and one more."""
        return len(self) >= MOST_TOGETHER * (self._workers + 1)

    def add(self, item: T) -> None:
        """One more waits."""
        self._groups.setdefault(self._alike(item), deque()).append(item)

    def back(self, items: Sequence[T]) -> None:
        """What was left of a piece waits again, and is next."""
        if items:
            key = self._alike(items[0])
            group = self._groups.pop(key, deque[T]())
            group.extendleft(reversed(items))
            self._groups = {key: group, **self._groups}

    def firsts(self) -> list[T]:
        """The next of each group."""
        return [group[0] for group in self._groups.values()]

    def next(self, last: Hashable = None, elsewhere: Collection[Hashable] = ()) -> T:
        """With what `piece` begins."""
        return self._groups[self._key(last, elsewhere)][0]

    def _key(self, last: Hashable, elsewhere: Collection[Hashable]) -> Hashable:
        def nearness(key: Hashable) -> tuple[int, int]:
            return _shared(key, last), -max((_shared(key, other) for other in elsewhere), default=0)

        return last if last in self._groups else max(self._groups, key=nearness)

    def piece(self, last: Hashable = None, elsewhere: Collection[Hashable] = ()) -> list[T]:
        """What one worker does next: a whole group as long as there are more of them than workers.

        Args:
            last: What it did last was alike in this: more of the same comes first, then what is nearest.
            elsewhere: Likewise of the other workers: theirs comes last.
        """
        groups = self._groups
        key = self._key(last, elsewhere)
        group = groups[key]
        share = -(-len(self) // (PIECES * self._workers))
        count = len(group) if len(groups) > self._workers else share
        taken = [group.popleft() for _ in range(min(count, len(group), self._most))]
        if not group:
            del groups[key]
        return taken


def _shared(one: Hashable, other: Hashable) -> int:
    """How many members of two tuples are the same, from the first on; of anything else, whether it is."""
    if isinstance(one, tuple) and isinstance(other, tuple):
        return sum(takewhile(bool, map(eq, one, other)))
    return int(one == other)
