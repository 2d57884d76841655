"""Usage mode 4: the same question in two worlds, and the smallest change that turns the answer.

The worlds are whatever the caller can judge: another robot, a half-open door, an obstacle, a limit.
"""

import math
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Generic, Protocol, TypeVar

from predicates.case import Answer, Diagnosis, Outcome, Verdict
from predicates.record.report import answers


class Judged(Protocol):
    """What came of a question: a verdict, or what was kept of one."""

    @property
    def outcome(self) -> Outcome | None:
        """What the Law says; None where there is no such world."""
        ...


V = TypeVar("V", bound=Judged)

Judge = Callable[[float], V]
"""The verdict after this share of a change: 0 is the world as it is, 1 the whole change."""


@dataclass(frozen=True, slots=True)
class Contrast:
    """A question in the world as it is and in another one.

    Attributes:
        actual: The verdict as things are.
        counterfactual: The verdict if they were otherwise.
    """

    actual: Verdict
    counterfactual: Verdict

    @property
    def turned(self) -> bool:
        """Whether the outcome is another one."""
        return self.actual.outcome is not self.counterfactual.outcome

    def turned_predicates(self) -> tuple[tuple[str, bool | None, bool | None], ...]:
        """Name, answer before, answer after, of each predicate that answers otherwise; None: not run."""
        pairs = zip(answers(self.actual).items(), answers(self.counterfactual).values(), strict=True)
        found = ((name, _holds(before), _holds(after)) for (name, before), after in pairs)
        return tuple(each for each in found if each[1] is not each[2])

    def gone(self) -> tuple[Diagnosis, ...]:
        """Reasons that hold only as things are."""
        return _only(self.actual, self.counterfactual)

    def new(self) -> tuple[Diagnosis, ...]:
        """Reasons that hold only in the other world."""
        return _only(self.counterfactual, self.actual)


@dataclass(frozen=True, slots=True)
class Tried(Generic[V]):
    """One verdict on the way."""

    share: float
    verdict: V


@dataclass(frozen=True, slots=True)
class Turn(Generic[V]):
    """The smallest share of a change that turns the outcome, see `turns`, or that none was found.

    Attributes:
        before: The largest share tried below the turn.
        after: The smallest share tried at which the outcome has turned; None: not found.
        tried: All that was judged, by share. Between neighbours of the first scan an outcome
            may turn and turn back unseen: what is found is minimal among what was tried.
    """

    before: Tried[V]
    after: Tried[V] | None
    tried: tuple[Tried[V], ...]

    @property
    def gap(self) -> float:
        """[1] Between the two shares: the answer is exact to within this; 1 where none was found."""
        return 1.0 if self.after is None else self.after.share - self.before.share


def smallest_turn(judge: Judge[V], scan: int, tolerance: float) -> Turn[V]:
    """The smallest share at which the outcome turns, exact to within the tolerance.

    Shares k / scan are judged in order until one turns; then the interval before it is halved.

    Args:
        judge: Called with shares in [0, 1].
        scan: Steps of the first scan, at least 1.
        tolerance: Of the share, above 0.
    """
    return nearest_turns([judge], judge(0.0), scan, tolerance)[0]


def nearest_turns(
    judges: Sequence[Judge[V]],
    actual: V,
    scan: int,
    tolerance: float,
    late: Callable[[], bool] = lambda: False,
) -> tuple[Turn[V], ...]:
    """For each direction of change the smallest share that turns the outcome, if none turns it sooner.

    Shares k / scan are judged in all directions in turn until one turns; then, where one did, the
    interval before it is halved. A direction that did not turn by then is not followed further.

    Args:
        judges: One for each direction.
        actual: The verdict at share 0.
        scan: Steps of the first scan, at least 1.
        tolerance: Of the share, above 0.
        late: Whether to stop; then gaps are what they are.
    """
    tried = [[Tried(0.0, actual)] for _ in judges]
    for step in range(1, scan + 1):
        for judge, own in zip(judges, tried, strict=True):
            if not late():
                own.append(Tried(step / scan, judge(step / scan)))
        if any(_turned(own[-1], actual) for own in tried):
            break
    for judge, own in zip(judges, tried, strict=True):
        if _turned(own[-1], actual):
            own.extend(_halved(judge, own[-2], own[-1], actual, tolerance, late))
            own.sort(key=lambda each: each.share)
    return tuple(_turn(own, actual) for own in tried)


def _halved(  # noqa: PLR0913, PLR0917 - an interval, and when to stop
    judge: Judge[V], low: Tried[V], high: Tried[V], actual: V, tolerance: float, late: Callable[[], bool]
) -> list[Tried[V]]:
    """What is tried between a share at which the outcome is as it is and one at which it is another."""
    tried: list[Tried[V]] = []
    while high.share - low.share > tolerance and not late():
        share = (low.share + high.share) / 2
        tried.append(Tried(share, judge(share)))
        if _turned(tried[-1], actual):
            high = tried[-1]
        else:
            low = tried[-1]
    return tried


def between(tried: Collection[float], upto: float, step: float) -> list[float]:
    """Multiples of a step below a share, of which none was tried, the smallest first.

    Args:
        tried: Shares that are known.
        upto: The share below which there is something to look for.
        step: Of shares, above 0; multiples of a power of 1/2 are exact.
    """
    shares = (step * k for k in range(1, math.ceil(upto / step)))
    return [each for each in shares if each < upto and each not in tried]


def widest_gap(tried: Iterable[float], upto: float) -> float:
    """[1] How far neighbours among shares that were tried are apart at most, from 0 to one share."""
    ends = [0.0, *sorted(each for each in tried if each < upto), upto]
    return max(after - before for before, after in pairwise(ends))


def turns(actual: Judged, other: Judged) -> bool:
    """Whether what was certified no longer is, or what was not now is: an abstention turns no refusal."""
    return (actual.outcome is Outcome.CERTIFIED) is not (other.outcome is Outcome.CERTIFIED)


def _turned(one: Tried[V], actual: V) -> bool:
    return turns(actual, one.verdict)


def _turn(tried: list[Tried[V]], actual: V) -> Turn[V]:
    """Of what was tried in one direction, by share."""
    first = next((k for k, each in enumerate(tried) if _turned(each, actual)), None)
    if first is None:
        return Turn(tried[-1], None, tuple(tried))
    return Turn(tried[first - 1], tried[first], tuple(tried))


def _holds(answer: Answer | None) -> bool | None:
    return None if answer is None else answer.holds


def _only(of: Verdict, other: Verdict) -> tuple[Diagnosis, ...]:
    """Diagnoses of one verdict whose reason the other does not name."""
    reasons = {(each.kind, each.reason) for each in other.diagnoses}
    return tuple(each for each in of.diagnoses if (each.kind, each.reason) not in reasons)
