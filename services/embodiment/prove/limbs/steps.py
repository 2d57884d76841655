"""Steps up a lift: limbs are in the way in each part of it at another value, and from one to the next."""

import heapq
from collections.abc import Callable, Iterator
from itertools import chain, count, pairwise

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.places import at_value
from services.embodiment.proof_check.proof.content import LEAF, Refutation, Steps
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.steps import LIFT, piece
from services.embodiment.prove.limbs.met import CODES, Asked, Met

Array = NDArray[np.float64]
Place = tuple[int, int]
"""Which part of the lift, or between which, from below; and which value."""

PARTS = 16  # of the lift
PIECE = 0.006  # [rad or m] of the way from one value to the next: thin panels are made thinner by as much
UP, ALONG = 1, 8  # what a part of the lift costs, and the way from a value to the next one


class Climb:
    """Looks for steps along which limbs are in the way of one container.

    Args:
        statement: What is to be refuted, with a fixed base.
        bodies: To which limbs go.
        values: Of the container at which is looked, in order [rad or m].
        arm: One gripper's, for its joints alone.
        late: Whether time is up.
    """

    def __init__(
        self,
        statement: Statement,
        bodies: tuple[str, ...],
        values: list[float],
        arm: Arm,
        late: Callable[[], bool],
    ) -> None:
        self._statement, self._arm, self._late = statement, arm, late
        self._values = [value for value in values if statement.passing.is_passed(value)]
        self._bodies = bodies
        self._box = arm.chain.ranges()
        self._edges = np.linspace(self._box[0][LIFT], self._box[1][LIFT], PARTS + 1)
        self._asked: dict[tuple[float, float, str], Asked | None] = {}
        self._parts: dict[Place, Met | None] = {}
        self._ways: dict[Place, tuple[Met, ...] | None] = {}
        self._found: list[Place] | None = None

    def refutations(self, arm: Arm) -> Iterator[Refutation]:
        """The refutation of one gripper, if there are steps; they are looked for once."""
        if self._found is None:
            self._found = self._steps()
        if self._found and at_value(self._statement, arm, self._values[0]).codes + len(self._bodies) <= CODES:
            yield self._refutation(arm, self._found)

    def _steps(self) -> list[Place]:
        """Which value for each part of the lift, from the lowest on; none without a way up, or time."""
        ties, best = count(), dict[Place, int]()
        heap = [(0, next(ties), (0, k), (-1, -1)) for k in range(len(self._values))]
        came = dict[Place, Place]()
        while heap and not self._late():
            cost, _, here, before = heapq.heappop(heap)
            if here in best:
                continue
            best[here], came[here] = cost, before
            part, value = here
            if part == PARTS:
                return self._back(came, here)
            if self._part(here) is not None:
                heapq.heappush(heap, (cost + UP, next(ties), (part + 1, value), here))
            for other in (value - 1, value + 1):
                known = not part or not 0 <= other < len(self._values) or (part, other) in best
                if not known and self._way((part, min(value, other))) is not None:
                    heapq.heappush(heap, (cost + ALONG, next(ties), (part, other), here))
        return []

    def _refutation(self, arm: Arm, found: list[Place]) -> Refutation:
        """The steps as a refutation of one gripper; its codes are its own."""
        ways = [[*self._ordered(k + 1, a, b)] for k, ((_, a), (_, b)) in enumerate(pairwise(found))]
        parts = [met for at in found if (met := self._parts[at]) is not None]
        used = sorted({met.body for met in (*parts, *chain(*ways))})
        values, tree = tuple(self._values[value] for _, value in found), bytearray()
        for value, met, way in zip(values, parts, [[], *ways], strict=True):
            codes = at_value(self._statement, arm, value).codes
            tree += b"".join(bytes([used.index(one.body)]) + one.tree for one in way)
            tree += bytes([LEAF + codes + used.index(met.body)]) + met.tree
        steps = Steps(values, tuple(map(len, ways)))
        names = tuple(link.name for link in arm.chain.links)
        box = tuple(zip(*(ends.tolist() for ends in arm.chain.ranges()), strict=True))
        about = arm.gripper, values[0], names, box, bytes(tree)
        return Refutation(*about, beside=tuple(used), parked=True, steps=steps)

    def _ordered(self, part: int, first: int, last: int) -> Iterator[Met]:
        """What is in the way from one value to another, in the order in which it is passed."""
        between = range(first, last) if first < last else range(first - 1, last - 1, -1)
        for k in between:
            ways = self._ways[part, k]
            assert ways is not None
            yield from ways if first < last else ways[::-1]

    def _back(self, came: dict[Place, Place], here: Place) -> list[Place]:
        """Each part's value on the way up that ended here."""
        found = list[Place]()
        while (before := came[here])[0] >= 0:
            if before[0] < here[0]:
                found.append(before)
            here = before
        return found[::-1]

    def _part(self, at: Place) -> Met | None:
        """What is in the way in a part of the lift at a value."""
        if at not in self._parts:
            part, value = at
            self._parts[at] = self._met(self._values[value], 0.0, self._edges[part], self._edges[part + 1])
        return self._parts[at]

    def _way(self, at: Place) -> tuple[Met, ...] | None:
        """What is in the way from a value to the next, piece by piece, with the lift between two parts."""
        if at not in self._ways:
            part, value = at
            low, high = self._values[value], self._values[value + 1]
            ends = np.linspace(low, high, int(np.ceil((high - low) / PIECE)) + 1).tolist()
            found, lift = list[Met](), self._edges[part]
            for one in pairwise(ends):
                met = self._met(*piece(one), lift, lift)
                if met is None:
                    break
                found.append(met)
            self._ways[at] = tuple(found) if len(found) == len(ends) - 1 else None
        return self._ways[at]

    def _met(self, value: float, wide: float, low: float, high: float) -> Met | None:
        """A limb that is in the way with the lift in a range, the container so near to a value."""
        box = self._box[0].copy(), self._box[1].copy()
        box[0][LIFT], box[1][LIFT] = low, high
        found = (one.in_the_way(box) for one in self._limbs(value, wide))
        return next((met for met in found if met is not None), None)

    def _limbs(self, value: float, wide: float) -> Iterator[Asked]:
        """All that share the lift, with the container so near to a value; made as they are asked."""
        for body in self._bodies:
            key = value, wide, body
            if key not in self._asked:
                one = self._statement.beside(self._arm, body, value, parked=True, wide=wide)
                self._asked[key] = Asked(body, one) if one.shared > LIFT else None
            if (asked := self._asked[key]) is not None:
                yield asked
