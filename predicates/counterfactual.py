"""Usage mode 4: the same question in two worlds, and the smallest change that turns the answer.

The worlds are whatever the caller can judge: another robot, a half-open door, an obstacle, a limit.
"""

from collections.abc import Callable
from dataclasses import dataclass

from predicates.case import Answer, Diagnosis, Verdict
from predicates.record.report import answers

Judge = Callable[[float], Verdict]
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
class Tried:
    """One verdict on the way."""

    share: float
    verdict: Verdict


@dataclass(frozen=True, slots=True)
class Turn:
    """The smallest share of a change that turns the outcome, or that none was found.

    Attributes:
        before: The largest share tried below the turn, with the outcome as it is.
        after: The smallest share tried at which the outcome is another; None: not found.
        tried: All that was judged, by share. Between neighbours of the first scan an outcome
            may turn and turn back unseen: what is found is minimal among what was tried.
    """

    before: Tried
    after: Tried | None
    tried: tuple[Tried, ...]

    @property
    def gap(self) -> float:
        """[1] Between the two shares: the answer is exact to within this; 1 where none was found."""
        return 1.0 if self.after is None else self.after.share - self.before.share


def smallest_turn(judge: Judge, scan: int, tolerance: float) -> Turn:
    """The smallest share at which the outcome turns, exact to within the tolerance.

    Shares k / scan are judged in order until one turns; then the interval before it is halved.

    Args:
        judge: Called with shares in [0, 1].
        scan: Steps of the first scan, at least 1.
        tolerance: Of the share, above 0.
    """
    tried = [Tried(0.0, judge(0.0))]
    outcome = tried[0].verdict.outcome
    low, high = tried[0], None
    for step in range(1, scan + 1):
        tried.append(Tried(step / scan, judge(step / scan)))
        if tried[-1].verdict.outcome is not outcome:
            high = tried[-1]
            break
        low = tried[-1]
    while high is not None and high.share - low.share > tolerance:
        share = (low.share + high.share) / 2
        tried.append(Tried(share, judge(share)))
        if tried[-1].verdict.outcome is outcome:
            low = tried[-1]
        else:
            high = tried[-1]
    return Turn(low, high, tuple(sorted(tried, key=lambda each: each.share)))


def _holds(answer: Answer | None) -> bool | None:
    return None if answer is None else answer.holds


def _only(of: Verdict, other: Verdict) -> tuple[Diagnosis, ...]:
    """Diagnoses of one verdict whose reason the other does not name."""
    reasons = {(each.kind, each.reason) for each in other.diagnoses}
    return tuple(each for each in of.diagnoses if (each.kind, each.reason) not in reasons)
