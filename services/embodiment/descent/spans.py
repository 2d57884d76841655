"""Holds and the spans of the container's way over which a descent keeps each of them.

A hold that was found at one value is followed both ways, each posture from the last, with depths in the
residual still. More are looked for where the fewest reach.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from services.embodiment.descent.depths import BUFFER, Depths
from services.embodiment.descent.pinch import Pose, led
from services.embodiment.descent.posture import Descent, Posture
from services.embodiment.ways.timing import Followed

Array = NDArray[np.float64]

PIECES = 64  # into which the way is cut
STEPS = 15  # of a descent from one value to the next
TOGETHER = 2e-5  # [m, rad · ANGLE] that the tool may be off
JUMP = 0.3  # [rad or m] largest change of a variable from one value to the next
STARTS = 40  # at one value, until a hold is found
TRIED = 1.5  # [1] holds that a look counts as, so that others have their turn
AMID = 0.25, 0.5, 0.75  # [1] of the way from one value to the next at which a spline is looked at
LESS = 0.5 * BUFFER  # [m] of what is kept beyond certification may be lacked there
ELSEWHERE = 3  # every third look is at the first of the values where the fewest reach, others at the last


@dataclass(frozen=True, slots=True, eq=False)
class Hold:
    """A hold, and postures that keep it.

    Attributes:
        tool: Its pose in the frame of the handle's joint.
        shares: By which its finger joints are closed, shape (F,).
        number: Of the start that led to it.
        first: Index of the first value at which it is kept.
        xs: There and at the values after it, shape (K, n).
    """

    tool: Pose
    shares: Array
    number: int
    first: int
    xs: Array

    @property
    def last(self) -> int:
        """Index of the last value at which it is kept."""
        return self.first + len(self.xs) - 1

    def at(self, index: int) -> Array:
        """The posture at a value."""
        return self.xs[index - self.first]


class Spans:
    """The holds of one hand, on a grid of values.

    Attributes:
        values: From the container's first to its last, shape (PIECES + 1,).
        holds: Those that were found.
    """

    def __init__(self, descent: Descent, values: Array) -> None:
        self.descent, self.values = descent, values
        self.holds: list[Hold] = []
        self._tried = Counter[int]()

    @property
    def depths(self) -> Depths:
        """What its shapes lack."""
        return self.descent.depths

    def cover(self) -> NDArray[np.int64]:
        """How many holds reach to each value."""
        count = np.zeros(len(self.values), np.int64)
        for hold in self.holds:
            count[hold.first : hold.last + 1] += 1
        return count

    def grow(self, starts: int, late: Callable[[], bool]) -> None:
        """Adds holds where fewest reach, until one is and some reach everywhere, or for so many starts."""
        until = self.descent.starts + starts
        while self.descent.starts < until and not late():
            index = self._next()
            self._tried[index] += 1
            some = min(STARTS, until - self.descent.starts)
            found = self.descent.found(float(self.values[index]), some, late)
            if found is None:
                continue
            self.holds.append(self._followed(found, index))
            if self.cover().all():
                return

    def leave(self, holds: set[Hold]) -> None:
        """These are taken no more."""
        self.holds = [one for one in self.holds if one not in holds]

    def cut(self, hold: Hold, value: float) -> None:
        """A hold is taken no more about a value, but before and after it."""
        self.leave({hold})
        share = (value - self.values[0]) / (self.values[-1] - self.values[0])
        at = min(int(share * PIECES), hold.last - 1)
        for first, last in ((hold.first, at), (at + 1, hold.last)):
            if first < last:
                some = hold.xs[first - hold.first : last - hold.first + 1]
                self.holds.append(replace(hold, first=first, xs=some))

    def _next(self) -> int:
        """Where the fewest holds reach, looks there counted too."""
        score = self.cover() + TRIED * np.array([self._tried[k] for k in range(len(self.values))])
        fewest = np.flatnonzero(score == score.min())
        return int(fewest[0 if self._tried.total() % ELSEWHERE == ELSEWHERE - 1 else -1])

    def _followed(self, posture: Posture, index: int) -> Hold:
        """The hold of a posture, as far as it can be kept."""
        r, p = self.descent.handle(float(self.values[index]))
        tool_r, tool_p = self.depths.limb.tool(posture.x)
        tool, shares = (r.T @ tool_r, r.T @ (tool_p - p)), posture.shares
        back = self._kept(posture.x, tool, shares, range(index - 1, -1, -1))
        on = self._kept(posture.x, tool, shares, range(index + 1, len(self.values)))
        xs = np.stack([*back[::-1], posture.x, *on])
        return Hold(tool, shares, self.descent.starts, index - len(back), xs)

    def _kept(self, x: Array, tool: Pose, shares: Array, indices: range) -> list[Array]:
        """Postures from x on at these values, until one is not free or too far from the last."""
        found: list[Array] = []
        for index in indices:
            value = float(self.values[index])
            aim = in_world(tool, self.descent.handle(value))
            y, _ = self.descent.kept(x, shares, aim, value, STEPS)
            off = float(np.abs(led(y, self.depths.limb, aim)[0]).max())
            jumps = float(np.abs(y - x).max()) > JUMP
            if off > TOGETHER or jumps or not self.descent.free(y, shares, value):
                break
            found.append(y)
            x = y
        return found

    def between(self, hold: Hold, values: Array) -> Array:
        """Postures that keep a hold at other values within its span, shape (K, n)."""
        grid = self.values[hold.first : hold.last + 1]
        order = np.argsort(grid)
        xs = np.stack([np.interp(values, grid[order], column[order]) for column in hold.xs.T], axis=1)
        for k, value in enumerate(values.tolist()):
            aim = in_world(hold.tool, self.descent.handle(value))
            xs[k], _ = self.descent.kept(xs[k], hold.shares, aim, value, STEPS)
        return xs

    def amid(self, hold: Hold, values: Array, xs: Array) -> float | None:
        """A value between two of these at which a spline through postures that keep a hold is not free."""
        path, span = Followed.through(values, xs), values[-1] - values[0]
        between = (values[:-1, None] + np.diff(values)[:, None] * np.array(AMID)).ravel()
        some, _ = path.spline.at((between - values[0]) / span)
        for x, value in zip(some, between.tolist(), strict=True):
            if self.depths.residual(x, hold.shares, value)[0].max(initial=0.0) > LESS:
                return value
        return None


def in_world(tool: Pose, handle: Pose) -> Pose:
    """World pose of a tool that is held in a handle's frame."""
    return handle[0] @ tool[0], handle[0] @ tool[1] + handle[1]
