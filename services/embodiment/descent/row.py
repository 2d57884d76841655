"""As few holds as lead all the way, each from where the one before is left: of one hand, or of several.

Another hand takes over where the container rests: the one that held it lets go and parks, then it comes.
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, zip_longest
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from services.embodiment.descent.changes import Changes
from services.embodiment.descent.spans import PIECES, Hold, Spans
from services.embodiment.search.leg import Leg, Onwards, joined, orders
from services.embodiment.search.planned import Planned

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

    @property
    def changes(self) -> Changes:
        """Ways to them, and from one to another."""
        ...

    def leg(self, part: "Part", end: int, *, parks: bool) -> Leg | None:
        """One part of the way, in one hold, left to park or only to go on; None if no motion is found."""
        ...


@dataclass(frozen=True, slots=True)
class Part:
    """A hold of one hand that the way goes on with at a value, by its index.

    Attributes:
        come: How one comes to it from the hold before; None: from parked.
    """

    hand: Handed
    hold: Hold
    begin: int
    come: Onwards | None = None


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
    begun = {hold for hand, hold in every if hold.first == 0 and hand.changes.back(hold, 0) is not None}
    waiting = deque([Part(hand, hold, 0)] for hand, hold in every if hold in begun)
    while waiting:
        way = waiting.popleft()
        if way[-1].hold.last == PIECES:
            return way
        for hand, hold in every:
            on = None if hold in begun else _changed(way[-1], hand, hold, late)
            if on is not None:
                begun.add(hold)
                waiting.append([*way, on])
    return None


def _changed(part: Part, hand: Handed, other: Hold, late: Late) -> Part | None:
    """How it goes on with another hold, at a value after its begin: straight there, or by parking."""
    first, end = max(part.begin + 1, other.first), min(part.hold.last + 1, other.last)
    if first < end and hand is part.hand and other.last > part.hold.last:
        for index in dict.fromkeys((end - 1, (first + end - 1) // 2, first)):
            come = None if late() else hand.changes.between(part.hold, other, index)
            if come is not None:
                return Part(hand, other, index, come)
    for index in dict.fromkeys(chain.from_iterable(range(first, end, stride) for stride in STRIDES)):
        if late():
            return None
        left = part.hand.changes.back(part.hold, index)
        if left is not None and hand.changes.back(other, index) is not None:
            return Part(hand, other, index)
    return None


def _legs(way: list[Part]) -> list[Leg] | None:
    """All parts of a way; a hold of which one is not found is taken no more."""
    legs = list[Leg]()
    for part, other in zip_longest(way, way[1:]):
        end, parks = (PIECES, True) if other is None else (other.begin, other.come is None)
        leg = part.hand.leg(part, end, parks=parks)
        if leg is None:
            part.hand.spans.leave({part.hold})
            return None
        legs.append(leg)
    return legs
