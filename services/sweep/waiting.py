"""What is not handed out yet: what is alike stays together, and the last pieces are small."""

from collections import deque
from collections.abc import Callable, Hashable, Sequence
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
        alike: What an item has in common with those that are to stay with it.
    """

    def __init__(self, workers: int, alike: Callable[[T], Hashable]) -> None:
        self._workers, self._alike = workers, alike
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

    def piece(self) -> list[T]:
        """What one worker does next: a whole group as long as there are more of them than workers."""
        key, group = next(iter(self._groups.items()))
        share = -(-len(self) // (PIECES * self._workers))
        count = len(group) if len(self._groups) > self._workers else share
        taken = [group.popleft() for _ in range(min(count, len(group), MOST_TOGETHER))]
        if not group:
            del self._groups[key]
        return taken
