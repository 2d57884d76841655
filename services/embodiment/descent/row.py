"""As few holds as lead all the way, each from where the one before is left: of one hand, or of several.

Another hand takes over where the container rests: the one that held it lets go and parks, then it comes.
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from services.embodiment.descent.spans import PIECES, Hold, Spans
from services.embodiment.search.planned import Planned
from services.embodiment.search.several import Back, Leg, joined, orders

STRIDES = 24, 12, 6, 3
"""[1] Values from one to the next at which it is looked whether a hold can be left and another be come to.

Where it fails at one it mostly does at those beside it, so those between are looked at later.
"""

Late = Callable[[], bool]


class Handed(Protocol):
    """One hand, and what is known of its holds."""

    @property
    def spans(self) -> Spans:
        """The holds that were found."""
        ...

    def back(self, hold: Hold, index: int) -> Back | None:
        """How a hold is left at a value; None if no way is found."""
        ...

    def leg(self, hold: Hold, begin: int, end: int) -> Leg | None:
        """One part of the way, in one hold; None if no motion is found."""
        ...


@dataclass(frozen=True, slots=True)
class Part:
    """A hold of one hand that the way goes on with at a value, by its index."""

    hand: Handed
    hold: Hold
    begin: int


def cover(hands: Sequence[Handed]) -> NDArray[np.int64]:
    """How many holds of these hands reach to each value."""
    return np.sum([hand.spans.cover() for hand in hands], axis=0)


def plans(hands: Sequence[Handed], late: Late) -> Iterator[Planned]:
    """Plans in the holds that are known; those of a motion that was not certified are taken no more."""
    while cover(hands).all() and not late():
        way = _way(hands, late)
        if way is None:
            return
        if (legs := _legs(way)) is not None:
            for bodies in orders(legs, late):
                yield joined([leg.planned for leg in legs], bodies)
            for part in way:
                part.hand.spans.leave({part.hold})


def _way(hands: Sequence[Handed], late: Late) -> list[Part] | None:
    """As few holds as lead all the way; None if none do."""
    every = [(hand, hold) for hand in hands for hold in hand.spans.holds]
    every.sort(key=lambda one: -one[1].last)
    begun = {hold for hand, hold in every if hold.first == 0 and hand.back(hold, 0) is not None}
    waiting = deque([Part(hand, hold, 0)] for hand, hold in every if hold in begun)
    while waiting:
        way = waiting.popleft()
        if way[-1].hold.last == PIECES:
            return way
        for hand, hold in every:
            at = None if hold in begun else _changed(way[-1], hand, hold, late)
            if at is not None:
                begun.add(hold)
                waiting.append([*way, Part(hand, hold, at)])
    return None


def _changed(part: Part, hand: Handed, other: Hold, late: Late) -> int | None:
    """The first value found after its begin at which a hold can be left and another be come to."""
    first, end = max(part.begin + 1, other.first), min(part.hold.last + 1, other.last)
    for index in dict.fromkeys(chain.from_iterable(range(first, end, stride) for stride in STRIDES)):
        if late():
            return None
        if part.hand.back(part.hold, index) is not None and hand.back(other, index) is not None:
            return index
    return None


def _legs(way: list[Part]) -> list[Leg] | None:
    """All parts of a way; a hold of which one is not found is taken no more."""
    legs, ends = list[Leg](), [*(part.begin for part in way[1:]), PIECES]
    for part, end in zip(way, ends, strict=True):
        leg = part.hand.leg(part.hold, part.begin, end)
        if leg is None:
            part.hand.spans.leave({part.hold})
            return None
        legs.append(leg)
    return legs
