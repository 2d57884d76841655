"""Ways of an arm to holds by descent, from parked or from another hold, where the base stands.

What a hold lacks most often is a way to it from parked: an open door stands between. From another hold there
may be one, straight or nearly so.
"""

from collections.abc import Callable

from services.embodiment.descent.spans import Hold
from services.embodiment.hold.fit import OPENINGS
from services.embodiment.hold.grasp import Grasp, Hand
from services.embodiment.hold.holding import Holding
from services.embodiment.search.attempt import Attempt
from services.embodiment.search.leg import Back, Onwards
from services.embodiment.ways.approach import ARM_ITERATIONS
from services.embodiment.ways.way import Approach

SHARES = (*OPENINGS, 0.8)
"""[1] by which the fingers are closed when the hand comes near."""
SAMPLES = 2_000
"""[1] Of the arm's way to a hold that lasts all the way: it needs no other, so it is worth them."""
BETWEEN = 100
"""[1] Samples of the arm's way from one hold to another."""
LOOKS, WHOLE = 40, 2
"""[1] Looks in a turn: for such ways, and for longer for one to a hold that lasts all the way."""


class Changes:
    """What is known of one hand's ways to its holds; each is looked for once.

    Args:
        hand: Whose they are.
        at: Who searches with the container at a value, by its index.
        late: Whether time is up.
    """

    def __init__(self, hand: Hand, at: Callable[[int], Attempt], late: Callable[[], bool]) -> None:
        self._looks, self._whole = LOOKS, WHOLE
        self._hand, self._at, self._late = hand, at, late
        self._parked: dict[tuple[Hold, int], Back | None] = {}
        self._longer: set[Hold] = set()
        self._near: dict[tuple[Hold, int], Back | None] = {}
        self._between: dict[tuple[Hold, Hold, int], Onwards | None] = {}

    def turn(self) -> None:
        """Another turn: as much is looked for in it as in each."""
        self._looks, self._whole = LOOKS, WHOLE

    def back(self, hold: Hold, index: int) -> Back | None:
        """How a hold is left at a value to where the arm is parked, fingers opened no wider than they need.

        None if no way is found.
        """
        key = hold, index
        if key not in self._parked:
            self._parked[key] = self._left(hold, index, ARM_ITERATIONS)
        return self._parked[key]

    def longer(self, hold: Hold) -> bool:
        """Whether a way to where a hold begins is found with more samples: once, if a look is left."""
        key = hold, hold.first
        if hold in self._longer or not self._whole or self.back(*key) is not None:
            return False
        self._longer.add(hold)
        self._whole -= 1
        self._parked[key] = self._left(*key, SAMPLES)
        return self._parked[key] is not None

    def near(self, hold: Hold, index: int) -> Back | None:
        """The same, only so far that the open hand is clear of the handle."""
        key = hold, index
        if key not in self._near:
            self._near[key] = self._left(hold, index, 0)
        return self._near[key]

    def between(self, hold: Hold, other: Hold, index: int) -> Onwards | None:
        """The way from one, left at a value, to another there; None if none is found, or no look is left."""
        key = hold, other, index
        if key not in self._between:
            if not self._looks:
                return None
            self._looks -= 1
            left, next_ = self.near(hold, index), self.near(other, index)
            self._between[key] = left.to(next_, BETWEEN, self._late) if left and next_ else None
        return self._between[key]

    def _left(self, hold: Hold, index: int, samples: int) -> Back | None:
        """How a hold is left, and parked with so many samples, if any."""
        attempt = self._at(index)
        approacher, problem = attempt.approacher, attempt.searcher.problem
        approacher.samples = samples
        for share in SHARES:
            if self._late():
                break
            if (share >= hold.shares).any():
                continue
            fingers = self._hand.positions(hold.shares), self._hand.opening(share)
            grasp, closed = Grasp(*hold.tool, hold.number, *fingers), self._hand.closed(hold.shares)
            holding = Holding(attempt.limb, grasp, hold.at(index)[None], closed, "by descent")
            if not approacher.lets_go(holding, problem):
                continue
            if samples:
                approach = approacher.approach(holding, problem, attempt.rng)
            else:
                approach = approacher.nearby(holding, problem)
            if isinstance(approach, Approach) and attempt.assembler.stays(approach):
                return Back(holding, approach, attempt)
        return None
