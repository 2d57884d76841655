"""What a check finds, and the diagnoses made of it: the first and the worst of each kind."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from predicates.case import Code, Diagnosis, Evidence, Kind
from predicates.margins import NearestPair

ROUNDING = 1e-6  # relative: what is worse by less is as bad as the first


@dataclass(frozen=True, slots=True)
class Violation:
    """One rule that is broken at one time.

    Attributes:
        rule: Kind of violation; the first and the worst of each rule become diagnoses.
        excess: How bad it is, comparable within the rule.
        code: By what programs tell it from others, if one does something with it.
    """

    rule: str
    reason: str
    evidence: Evidence
    excess: float
    code: Code | None = None

    @property
    def time(self) -> float:
        """When it happens; before everything else where it has no time."""
        return -float("inf") if self.evidence.time is None else self.evidence.time


@dataclass(slots=True)
class Findings:
    """Violations, and the figures of what was kept.

    Attributes:
        figures: Name → (value, unit).
        nearest: What comes nearest, one sentence for each kind of pair; what was not seen; what moves besides
            who holds.
        nearest_pairs: Name of a figure → between which two bodies that smallest distance is, and when.
        slack: Kind of pair → distance beyond what has to be kept, at least [m].
    """

    violations: list[Violation] = field(default_factory=list)
    figures: dict[str, tuple[float, str]] = field(default_factory=dict)
    nearest: list[str] = field(default_factory=list)
    nearest_pairs: dict[str, NearestPair] = field(default_factory=dict)
    slack: dict[str, float] = field(default_factory=dict)

    def add(self, found: "Findings") -> None:
        """All that another check found as well."""
        self.violations.extend(found.violations)
        self.figures.update(found.figures)
        self.nearest.extend(found.nearest)
        self.nearest_pairs.update(found.nearest_pairs)
        self.slack.update(found.slack)

    def with_survey(self, surveyed: "Findings") -> None:
        """The survey's violations as well; its collisions in place of ours of the same scope."""
        scopes = {each.evidence.scope for each in surveyed.violations if each.evidence.scope}
        self.violations = [
            each
            for each in self.violations
            if not (each.rule.startswith("collision: ") and each.evidence.scope in scopes)
        ]
        self.violations.extend(surveyed.violations)

    def diagnoses(self) -> tuple[Diagnosis, ...]:
        """The first and the worst violation of each rule, rules in the order of their checks."""
        by_rule: dict[str, list[Violation]] = {}
        for violation in self.violations:
            by_rule.setdefault(violation.rule, []).append(violation)
        return tuple(each for group in by_rule.values() for each in _first_and_worst(group))


def _first_and_worst(group: list[Violation]) -> Iterator[Diagnosis]:
    """The first violation of a rule, and the worst, if that is another one; each says when that is."""
    first = min(group, key=lambda violation: (violation.time, -violation.excess))
    worst = max(group, key=lambda violation: (violation.excess, -violation.time))
    if worst.excess <= first.excess + ROUNDING * abs(first.excess):
        yield _diagnosis(first, "at" if first.time > 0 else "")
    else:
        yield _diagnosis(first, "first at")
        yield _diagnosis(worst, "at worst at")


def _diagnosis(violation: Violation, when: str) -> Diagnosis:
    """With these words before its time, where it has one."""
    at = violation.evidence.time
    told = f" ({when} {at:.3f} s)" if when and at is not None else ""
    return Diagnosis(Kind.EMBODIMENT, violation.reason + told, violation.evidence, code=violation.code)
