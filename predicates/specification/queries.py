"""Rules that are SPARQL, asked of every state on the way or of the events so far.

A query which only compares positions (no arithmetic, no functions) can change its answer only where
a moving joint passes a number that the graph or the query holds. If one joint moves, the answer is
therefore known for the whole motion from one state in each gap between such numbers, and one at each.
Any other query is asked at samples and extrema only: a break is a break, but nothing bounds it
between them, and it is told so.
"""

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Final

import numpy as np
import pyoxigraph as ox

from predicates.case import Diagnosis, Evidence, Kind, Quantity
from predicates.specification.comparing import numbers_in, only_asks_for, only_compares, predicates_in
from predicates.specification.cubic import Array
from predicates.specification.leg import Leg
from predicates.specification.model import Demand, QueryRule, Scope
from predicates.specification.rules import RuleAnswer, Standing, text
from sdt_kg.history.events import EventType, events_along
from sdt_kg.history.records import event_triples, first_triples
from sdt_kg.history.trajectory import Trajectory
from sdt_kg.iri import ID, PREFIXES, SDT, Iri
from sdt_kg.store import Solutions, value_of
from sdt_kg.twin import Twin

RUN: Final = ID + "task-run"
"""Whose events they are, and whose containers sdt:openAtFirst names."""

EXACT: Final = "in every gap between the numbers that the query can compare with, and at each"
SAMPLED: Final = "at samples and extrema of the spline"
NO_GRASPS: Final = frozenset(SDT + each.value for each in EventType if each is not EventType.GRASPED)
BY_EVENTS: Final = "after every event, and before the first"

Asked = tuple[float, Twin]
"""Time [s], and the state at that time."""


class InGraph:
    """Answers by the twin's own graph; what does not change is read once."""

    def __init__(self, twin: Twin) -> None:
        entities = twin.entities
        self._numbers: dict[Iri, set[float]] = {}
        for _, predicate, term in chain.from_iterable(map(entities.store.triples, entities.graphs)):
            value = value_of(term)
            if isinstance(value, int | float) and not isinstance(value, bool):
                self._numbers.setdefault(predicate, set()).add(float(value))

    def answer(self, rule: QueryRule, legs: Sequence[Leg]) -> RuleAnswer:
        """What became of the rule."""
        if rule.over is Scope.EVENTS:
            return _over_events(rule, legs)
        if rule.demand is Demand.AT_THE_END:
            last = legs[-1]
            final = last.trajectory.at(last.twin, -1)
            return _reached(rule, last, yes=_yes(final, rule.sparql))
        bounded = True
        for leg in legs:
            asked, exact = self._asked(rule, leg)
            bounded = bounded and exact
            for time, twin in asked:
                if _yes(twin, rule.sparql) is (rule.demand is Demand.NEVER):
                    return _broken(rule, leg, time, twin, EXACT if exact else SAMPLED)
        if bounded:
            return RuleAnswer(text(rule), Standing.KEPT, EXACT)
        reason = f"'{text(rule)}' is not broken {SAMPLED}, and nothing bounds this query between them"
        return RuleAnswer(text(rule), Standing.UNBOUNDED, SAMPLED, Diagnosis(Kind.SEMANTIC, reason))

    def _asked(self, rule: QueryRule, leg: Leg) -> tuple[Iterator[Asked], bool]:
        """States to ask about, in the order of time, and whether they stand for all others."""
        positions = leg.trajectory.positions
        moving = np.flatnonzero(np.ptp(positions, axis=0) > 0)
        followers = leg.twin.entities.coupling.followers
        joints = [leg.trajectory.joints[k] for k in moving]
        coupled = {iri for iri, each in followers.items() if each.active in joints} | (
            followers.keys() & set(joints)
        )
        if len(joints) > 1 or coupled or not only_compares(rule.sparql):
            times = leg.trajectory.times.tolist()
            return ((time, leg.trajectory.at(leg.twin, k)) for k, time in enumerate(times)), False
        if not joints:
            return iter([(float(leg.trajectory.times[0]), leg.twin)]), True
        others = [at for joint, at in leg.twin.state.items() if joint != joints[0]]
        # 0 by itself is false, every other number true
        marks = np.unique([0.0, *self._comparable(rule.sparql), *others, *numbers_in(rule.sparql)])
        return _cells(leg, joints[0], positions[:, moving[0]], marks), True

    def _comparable(self, sparql: str) -> set[float]:
        """Numbers of the graph that the query can lay hands on: of its predicates, or else all."""
        named = predicates_in(sparql)
        of = self._numbers.keys() if named is None else self._numbers.keys() & named
        return set[float]().union(*(self._numbers[each] for each in of))


def _cells(leg: Leg, joint: Iri, values: Array, marks: Array) -> Iterator[Asked]:
    """One state for each mark that the joint passes, and for each gap between marks that it is in.

    From one sample of a leg to the next the joint only rises or only falls, so that what it passes
    lies between the two. The time is that of the sample at which it has been there at the latest.
    """
    times, seen = leg.trajectory.times, set[tuple[int, int]]()
    for k, end in enumerate(values.tolist()):
        begin = float(values[max(k - 1, 0)])
        low, high = min(begin, end), max(begin, end)
        passed = marks[(marks > low) & (marks < high)]
        way = np.unique([low, *passed.tolist(), high])
        way = np.sort(np.append(way, (way[:-1] + way[1:]) / 2))
        for value in sorted(way.tolist(), reverse=end < begin):
            cell = int((marks < value).sum()), int((marks <= value).sum())
            if cell not in seen:
                seen.add(cell)
                one = Trajectory((joint,), times[:1], np.array([[value]]))
                yield float(times[k]), one.at(leg.twin, 0)


def _over_events(rule: QueryRule, legs: Sequence[Leg]) -> RuleAnswer:
    """The rule about each beginning of the sequence of events, or about all of it."""
    store = legs[0].twin.entities.store.dump(legs[0].twin.entities.graphs)
    merged = ox.Store()
    merged.extend(ox.Quad(each.subject, each.predicate, each.object) for each in store)
    opened = [each.iri for each in legs[0].twin.containers() if _is_open_at_first(legs[0], each.iri)]
    _say(merged, first_triples(RUN, opened))
    sure = only_asks_for(rule.sparql, NO_GRASPS) or not any(map(_grasps_unknown, legs))
    clock = not _knows_no_clock(rule.sparql)
    exact, how = sure and not clock, f"{BY_EVENTS}, their times to within a sample" if clock else BY_EVENTS
    wrong = rule.demand is Demand.NEVER
    last, before, number = legs[-1], 0, 0
    if rule.demand is not Demand.AT_THE_END and _ask(merged, rule.sparql) is wrong:
        return _broken(rule, legs[0], float(legs[0].trajectory.times[0]), legs[0].twin, how)
    for leg in legs:
        events = events_along(leg.twin, leg.trajectory)
        run = f"{RUN}/{leg.number}"
        for sample in sorted({each.sample for each in events if each.sample is not None}):
            group = [each for each in events if each.sample == sample]
            _say(merged, event_triples(f"{run}/{number}", group, leg.trajectory.iri, before))
            number += 1
            if rule.demand is not Demand.AT_THE_END and _ask(merged, rule.sparql) is wrong:
                time = float(leg.trajectory.times[sample])
                return _broken(rule, leg, time, leg.trajectory.at(leg.twin, sample), how)
        before += len(leg.trajectory.times)
    if rule.demand is Demand.AT_THE_END and not _ask(merged, rule.sparql):
        return _reached(rule, last, yes=False)
    if exact:
        return RuleAnswer(text(rule), Standing.KEPT, how)
    why = "asks when, and times of events are those of samples"
    if not sure:
        why = "may ask when which handle is grasped, and that is not told of all motions"
    reason = f"'{text(rule)}' is not broken, but {why}"
    return RuleAnswer(text(rule), Standing.UNBOUNDED, how, Diagnosis(Kind.SEMANTIC, reason))


def _knows_no_clock(sparql: str) -> bool:
    """Whether the query can tell only the order of events: their times and counts are those of samples."""
    named = predicates_in(sparql)
    if named is None or named & {SDT + "time", SDT + "sample"}:
        return False
    return SDT + "step" not in named or (only_compares(sparql) and not numbers_in(sparql))


def _grasps_unknown(leg: Leg) -> bool:
    """Whether it is not told when a handle is held, or which of several that move together."""
    followers, every = leg.twin.entities.coupling.followers, leg.twin.containers()
    joints = leg.trajectory.joints
    active = {followers[joint].active if joint in followers else joint for joint in joints}
    handles = sum(1 + len(each.more_handles) for each in every if each.active_joint in active)
    return leg.trajectory.grasp is None or handles > 1


def _is_open_at_first(leg: Leg, container: Iri) -> bool:
    each = leg.twin.container(container)
    return bool(each.is_open(leg.twin.state[each.joint]))


def _say(store: ox.Store, triples: Iterator[tuple[Iri, Iri, ox.NamedNode | ox.Literal]]) -> None:
    store.extend(ox.Quad(ox.NamedNode(s), ox.NamedNode(p), o) for s, p, o in triples)


def _yes(twin: Twin, sparql: str) -> bool:
    """Whether the query answers yes, or with a row, in this state."""
    return _is_yes(twin.entities.store.query(sparql, twin.graphs()))


def _ask(store: ox.Store, sparql: str) -> bool:
    return _is_yes(store.query(sparql, prefixes=PREFIXES))


def _is_yes(found: Solutions) -> bool:
    """A yes, or a row, whatever it holds."""
    return bool(found) if isinstance(found, ox.QueryBoolean) else next(iter(found), None) is not None


def _reached(rule: QueryRule, leg: Leg, *, yes: bool) -> RuleAnswer:
    how = "of the state at the end" if rule.over is Scope.STATES else "of all events"
    if yes:
        return RuleAnswer(text(rule), Standing.KEPT, how)
    time = float(leg.trajectory.times[-1])
    return _broken(rule, leg, time, leg.trajectory.at(leg.twin, -1), how)


def _broken(rule: QueryRule, leg: Leg, time: float, twin: Twin, how: str) -> RuleAnswer:
    """With the moment as evidence: 1 where the query answers yes, 0 where it answers no."""
    value, bound = (1.0, 0.0) if rule.demand is Demand.NEVER else (0.0, 1.0)
    evidence = Evidence(Quantity.COUNT, value, bound, "1", time=time)
    said = "answers yes" if rule.demand is Demand.NEVER else "answers no"
    reason = f"step {leg.number} breaks '{text(rule)}': the query {said}"
    diagnosis = Diagnosis(Kind.SEMANTIC, reason, evidence)
    return RuleAnswer(text(rule), Standing.BROKEN, how, diagnosis, leg.number, time, twin.state)
