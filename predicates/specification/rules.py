"""Rules over all that the steps do to the kitchen, and which is broken first.

A rule about a container's position is checked at the samples and at every extremum of the spline
between them, so that it holds or is broken for the whole motion. A rule about a distance is swept
between samples by whoever fulfils `Clearance`. What cannot be bounded is told as such: nothing that
was merely looked at is told as kept.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Final, Protocol

import numpy as np

from predicates.case import Diagnosis, Evidence, Kind, Quantity
from predicates.meant import unit_of
from predicates.specification.cubic import Array
from predicates.specification.leg import Leg
from predicates.specification.model import (
    Demand,
    KeepsDistance,
    NeverBeyond,
    OpensBefore,
    QueryRule,
    Rule,
    StaysClosed,
)
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.numbers import told_apart
from sdt_kg.state import State
from sdt_kg.twin import Container, Twin

ROUNDING: Final = 1e-9
"""[rad or m] How far beyond a bound a position may be by rounding."""


SWEPT: Final = "swept between samples too, with the certifier's shapes"


class Standing(Enum):
    """What is known of a rule."""

    KEPT = "kept"
    BROKEN = "broken"
    UNBOUNDED = "not bounded"


@dataclass(frozen=True, slots=True)
class RuleAnswer:
    """What became of a rule.

    Attributes:
        rule: In words.
        how: How it was checked, in words.
        diagnosis: Why it is broken, or why nothing is claimed; None where it is kept.
        step: In which step, counted from 1.
        time: In that step's motion [s].
        state: Of the kitchen at that time.
    """

    rule: str
    standing: Standing
    how: str
    diagnosis: Diagnosis | None = None
    step: int | None = None
    time: float | None = None
    state: State | None = None


@dataclass(frozen=True, slots=True)
class Approach:
    """How near a robot comes to a body, as far as a sweep needed to know.

    Attributes:
        keeps: Whether the distance is kept all along; None: neither shown to be kept nor to be missed.
        value: The distance at `time` [m]; None where nothing came near.
        link: IRI of the robot's body that is concerned.
    """

    keeps: bool | None
    value: float | None = None
    time: float | None = None
    link: Iri | None = None


class Clearance(Protocol):
    """Distances along a body motion."""

    def keeps(self, leg: Leg, body: Iri, distance: float) -> Approach:
        """Whether the robot keeps this distance [m] to a body of the kitchen, between samples too."""
        ...


class Queries(Protocol):
    """Answers to rules that are queries."""

    def answer(self, rule: QueryRule, legs: Sequence[Leg]) -> RuleAnswer:
        """What became of the rule."""
        ...


def text(rule: Rule) -> str:
    """The rule in words."""
    match rule:
        case StaysClosed(container):
            return f"{container.name} stays closed"
        case NeverBeyond(container, position):
            return f"{container.name} never beyond {position:g}"
        case KeepsDistance(body, distance):
            return f"robot never nearer than {distance:g} m to {local_name(body)}"
        case OpensBefore(first, then):
            return f"{first.name} opens before {then.name}"
        case QueryRule():
            return f"{rule.demand.value} ({rule.over.value.lower()}): {rule.label}"


def at_the_end(rule: Rule) -> bool:
    """Whether the rule is about where all steps end, not about the way there."""
    return isinstance(rule, QueryRule) and rule.demand is Demand.AT_THE_END


def checked(rule: Rule, legs: Sequence[Leg], clearance: Clearance, queries: Queries) -> RuleAnswer:
    """What becomes of a rule under the motions of one step or more, in order."""
    found = _of_motions(rule, legs, clearance, queries)
    return (_in_doubt(rule, legs, found.how) if found.standing is Standing.KEPT else None) or found


def _of_motions(rule: Rule, legs: Sequence[Leg], clearance: Clearance, queries: Queries) -> RuleAnswer:
    """What becomes of a rule if nothing moves but what the motions move."""
    match rule:
        case StaysClosed(container):
            return _bounded(rule, container, container.closed_to, legs)
        case NeverBeyond(container, position):
            return _bounded(rule, container, position, legs)
        case KeepsDistance():
            return _apart(rule, legs, clearance)
        case OpensBefore():
            return _ordered(rule, legs)
        case QueryRule():
            return queries.answer(rule, legs)


def first_broken(answers: Sequence[RuleAnswer]) -> RuleAnswer | None:
    """The rule that is broken first; one that is broken only at the end comes last."""
    broken = [each for each in answers if each.standing is Standing.BROKEN]
    return min(broken, key=lambda each: (each.step or 0, each.time or 0.0), default=None)


def _in_doubt(rule: Rule, legs: Sequence[Leg], how: str) -> RuleAnswer | None:
    """That it is not known where something is that the rule is about, for want of a check; None if it is."""
    for leg in legs:
        about = _about(rule, leg.twin)
        names = [
            name
            for name in leg.not_checked
            if about is None or leg.twin.container(name).active_joint in about
        ]
        if names:
            reason = (
                f"no motion breaks '{text(rule)}', but in step {leg.number} it is not checked, for want of a "
                f"force model, whether {', '.join(names)} stays where it is"
            )
            diagnosis = Diagnosis(Kind.OUT_OF_SCOPE, reason)
            return RuleAnswer(text(rule), Standing.UNBOUNDED, how, diagnosis, leg.number)
    return None


def _about(rule: Rule, twin: Twin) -> frozenset[Iri] | None:
    """Active joints on which hangs whether the rule is kept; None: it may be any."""
    match rule:
        case StaysClosed(container) | NeverBeyond(container, _):
            return frozenset({container.active_joint})
        case OpensBefore(first, then):
            return frozenset({first.active_joint, then.active_joint})
        case KeepsDistance(body):
            return _above(twin, body)
        case QueryRule():
            return None


def _above(twin: Twin, body: Iri) -> frozenset[Iri]:
    """Active joints of all that carries a body of the kitchen."""
    mechanism, followers = twin.mechanism(twin.environment), twin.entities.coupling.followers
    carrying, name, found = {each.child: each for each in mechanism.joints}, local_name(body), set[Iri]()
    while name in carrying:
        joint = joint_iri(mechanism.name, carrying[name].name)
        found.add(followers[joint].active if joint in followers else joint)
        name = carrying[name].parent
    return frozenset(found)


def _bounded(rule: Rule, container: Container, bound: float, legs: Sequence[Leg]) -> RuleAnswer:
    for leg in legs:
        values = leg.positions(container)
        beyond = np.flatnonzero(values > bound + ROUNDING)
        if beyond.size:
            return _broken(rule, leg, int(beyond[0]), container, (values, bound))
    greatest = max(float(leg.positions(container).max()) for leg in legs)
    most, allowed = told_apart(greatest, bound, 4)
    how = f"at samples and extrema of the spline: at most {most}, bound {allowed}"
    return RuleAnswer(text(rule), Standing.KEPT, how)


def _ordered(rule: OpensBefore, legs: Sequence[Leg]) -> RuleAnswer:
    has_opened = rule.first.is_open(legs[0].positions(rule.first)[0])
    for leg in legs:
        first, then = leg.positions(rule.first), leg.positions(rule.then)
        opens = np.flatnonzero(rule.then.is_open(then))
        opened = np.flatnonzero(rule.first.is_open(first))
        earlier = has_opened or (opens.size and opened.size and opened[0] < opens[0])
        if opens.size and not earlier:
            return _broken(rule, leg, int(opens[0]), rule.then, (then, rule.then.open_from))
        has_opened = bool(has_opened or opened.size)
    how = "by the first sample or extremum of the spline at which each is open"
    return RuleAnswer(text(rule), Standing.KEPT, how)


def _broken(
    rule: Rule, leg: Leg, sample: int, container: Container, measured: tuple[Array, float]
) -> RuleAnswer:
    values, bound = measured
    value, at = float(values[sample]), float(leg.trajectory.times[sample])
    unit = unit_of(leg.twin, container)
    evidence = Evidence(Quantity.POSITION, value, bound, unit, entity=container.joint, time=at)
    told, _ = told_apart(value, bound, 4)
    reason = f"step {leg.number} breaks '{text(rule)}': {container.name} is at {told} {unit}"
    how = "at samples and extrema of the spline"
    diagnosis = Diagnosis(Kind.SEMANTIC, reason, evidence)
    return RuleAnswer(text(rule), Standing.BROKEN, how, diagnosis, leg.number, at, leg.state(sample))


def _apart(rule: KeepsDistance, legs: Sequence[Leg], clearance: Clearance) -> RuleAnswer:
    """Broken by the first step that breaks it; else not bounded if a step, or a way between two, is not."""
    open_questions = list[RuleAnswer]()
    for leg in legs:
        found = _near(rule, leg, clearance)
        if found is not None and found.standing is Standing.BROKEN:
            return found
        open_questions += [] if found is None else [found]
    if open_questions:
        return open_questions[0]
    if len(legs) == 1:
        return RuleAnswer(text(rule), Standing.KEPT, SWEPT)
    reason = f"every step keeps '{text(rule)}', but nothing bounds the robot's way back between two steps"
    return RuleAnswer(text(rule), Standing.UNBOUNDED, SWEPT, Diagnosis(Kind.SEMANTIC, reason))


def _near(rule: KeepsDistance, leg: Leg, clearance: Clearance) -> RuleAnswer | None:
    """None if the robot is shown to keep the distance along a step."""
    found = clearance.keeps(leg, rule.body, rule.distance)
    if found.keeps:
        return None
    value = float("nan") if found.value is None else found.value
    links = None if found.link is None else (found.link, rule.body)
    evidence = Evidence(
        Quantity.DISTANCE, value, rule.distance, "m", rule.body, links, found.time, "environment"
    )
    standing = Standing.UNBOUNDED if found.keeps is None else Standing.BROKEN
    said = "breaks" if standing is Standing.BROKEN else "is not shown to keep"
    told, _ = told_apart(value, rule.distance, 4)
    part = "" if found.link is None else f": {local_name(found.link)} is {told} m from it"
    diagnosis = Diagnosis(Kind.SEMANTIC, f"step {leg.number} {said} '{text(rule)}'{part}", evidence)
    times = leg.trajectory.times
    sample = len(times) - 1 if found.time is None else int(np.searchsorted(times, found.time))
    state = leg.state(min(sample, len(times) - 1))
    return RuleAnswer(text(rule), standing, SWEPT, diagnosis, leg.number, found.time, state)
