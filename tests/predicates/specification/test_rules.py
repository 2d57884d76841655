"""Rules along a motion that a person can follow: one joint of the small kitchen, two samples, a bump."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Kind
from predicates.specification.comparing import only_compares, predicates_in
from predicates.specification.leg import Leg
from predicates.specification.model import (
    Demand,
    KeepsDistance,
    NeverBeyond,
    OpensBefore,
    QueryRule,
    Scope,
    StaysClosed,
)
from predicates.specification.queries import InGraph
from predicates.specification.rules import Approach, RuleAnswer, Standing, checked, first_broken
from sdt_kg.history.events import events_along
from sdt_kg.history.trajectory import Grasp, Trajectory
from sdt_kg.iri import Iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from tests.small import small_twin

TWIN = small_twin()
LOW, HIGH, DOOR = (TWIN.container(name) for name in ("low_drawer", "high_drawer", "side_door"))
FOLDING = TWIN.container("folding_door")


def leg(number: int, joints: dict[Iri, tuple[list[float], list[float]]], twin=TWIN) -> Leg:
    """Joint → positions and velocities at samples one second apart."""
    q, v = (np.array([each[k] for each in joints.values()]).T for k in (0, 1))
    times, still = np.arange(len(q), dtype=float), np.zeros((len(q), 3))
    none = np.zeros((len(q), 0))
    motion = BodyMotion("r", "", (), times, still, none, none, still, tuple(joints), q, v)
    return Leg.of(number, twin, motion)


OPENS = leg(1, {LOW.joint: ([0.0, 0.46], [0.0, 0.0])})
BUMP = leg(1, {LOW.joint: ([0.0, 0.0], [0.4, -0.4])})  # at both samples closed, 0.1 m between them


@dataclass(frozen=True)
class Far:
    """A robot which is told to be somewhere."""

    answer: Approach

    def keeps(self, leg: Leg, body: Iri, distance: float) -> Approach:
        return self.answer


def ask(rule, *legs: Leg, approach: Approach | None = None) -> RuleAnswer:
    return checked(rule, legs, Far(approach or Approach(keeps=True)), InGraph(TWIN))


def query(sparql: str, demand: Demand = Demand.NEVER, over: Scope = Scope.STATES) -> QueryRule:
    return QueryRule("it", sparql, over, demand)


def test_a_container_that_opens_between_two_samples_does_not_stay_closed() -> None:
    found = ask(StaysClosed(LOW), BUMP)
    assert (found.standing, found.step, found.time) == (Standing.BROKEN, 1, 0.5)
    assert found.diagnosis is not None
    assert found.diagnosis.kind is Kind.SEMANTIC
    assert not found.diagnosis.proof, "another motion might keep it"
    assert found.diagnosis.evidence is not None
    assert found.diagnosis.evidence.value == pytest.approx(0.1)
    assert found.diagnosis.evidence.bound == 0.01
    assert found.state is not None
    assert found.state[LOW.joint] == pytest.approx(0.1)
    assert ask(StaysClosed(HIGH), BUMP).standing is Standing.KEPT


def test_never_beyond_is_about_the_extremum_and_not_about_the_samples() -> None:
    assert ask(NeverBeyond(LOW, 0.1), BUMP).standing is Standing.KEPT
    assert ask(NeverBeyond(LOW, 0.0999), BUMP).standing is Standing.BROKEN


def test_a_container_that_follows_another_joint_is_measured_by_its_own() -> None:
    turning = leg(1, {FOLDING.active_joint: ([0.0, 0.3], [0.0, 0.0])})
    assert ask(NeverBeyond(FOLDING, 0.6), turning).standing is Standing.KEPT
    assert ask(NeverBeyond(FOLDING, 0.59), turning).standing is Standing.BROKEN
    assert ask(StaysClosed(FOLDING), turning).standing is Standing.BROKEN


def test_what_moves_with_a_follower_that_alone_is_listed_moves(tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "services" / "dynamics" / "pair.urdf").read_text()
    own = text[text.index('<link name="lower_drawer">') : text.index("</robot>")]
    third = own.replace("lower_drawer", "third_drawer").replace('multiplier="0.5"', 'multiplier="0.25"')
    (tmp_path / "pair.urdf").write_text(text.replace("</robot>", third + "</robot>"))
    twin = load_twin(tmp_path / "pair.urdf")
    lower, upper, third_drawer = (
        twin.container(name) for name in ("lower_drawer", "upper_drawer", "third_drawer")
    )
    one = leg(1, {lower.joint: ([0.0, 0.1], [0.0, 0.0])}, twin)
    assert one.positions(upper)[-1] == pytest.approx(0.2)
    assert one.positions(third_drawer)[-1] == pytest.approx(0.05)
    for container, bound in ((upper, 0.19), (third_drawer, 0.04)):
        answer = ask(NeverBeyond(container, bound), one)
        assert answer.standing is Standing.BROKEN
        assert answer.diagnosis is not None
    about = {event.about for event in events_along(twin, one.trajectory)}
    assert about >= {lower.iri, upper.iri, third_drawer.iri}


def test_a_container_that_is_open_at_first_breaks_at_once() -> None:
    twin = TWIN.at({HIGH.joint: 0.3})
    found = ask(StaysClosed(HIGH), leg(1, {LOW.joint: ([0.0, 0.46], [0.0, 0.0])}, twin))
    assert (found.standing, found.time) == (Standing.BROKEN, 0.0)


def test_order_counts_across_steps() -> None:
    after = TWIN.at({LOW.joint: 0.46})
    second = leg(2, {HIGH.joint: ([0.0, 0.46], [0.0, 0.0])}, after)
    assert ask(OpensBefore(LOW, HIGH), OPENS, second).standing is Standing.KEPT
    found = ask(OpensBefore(HIGH, LOW), OPENS, second)
    assert (found.standing, found.step) == (Standing.BROKEN, 1)


def test_a_distance_that_is_neither_kept_nor_missed_is_claimed_by_nobody() -> None:
    rule = KeepsDistance(f"{TWIN.environment}/body/wall", 0.1)
    near = Approach(keeps=False, value=0.05, time=0.25, link="r/body/hand")
    assert ask(rule, OPENS, approach=near).standing is Standing.BROKEN
    assert ask(rule, OPENS, approach=Approach(keeps=None, time=0.25)).standing is Standing.UNBOUNDED
    assert ask(rule, OPENS).standing is Standing.KEPT


def test_a_distance_is_not_bounded_on_the_way_back_between_two_steps() -> None:
    rule = KeepsDistance(f"{TWIN.environment}/body/wall", 0.1)
    second = leg(2, {HIGH.joint: ([0.0, 0.46], [0.0, 0.0])}, TWIN.at({LOW.joint: 0.46}))
    found = ask(rule, OPENS, second)
    assert found.standing is Standing.UNBOUNDED
    assert found.diagnosis is not None
    assert "way back between two steps" in found.diagnosis.reason
    near = Approach(keeps=False, value=0.05, time=0.25, link="r/body/hand")
    assert ask(rule, OPENS, second, approach=near).standing is Standing.BROKEN


HALF_OPEN = "ASK { ?joint sdt:position ?at FILTER (?at > 0.0999 && ?at < 0.11) }"


def test_a_query_that_compares_is_known_between_samples() -> None:
    assert ask(query(HALF_OPEN), BUMP).standing is Standing.BROKEN
    found = ask(query(HALF_OPEN), OPENS)
    assert found.standing is Standing.BROKEN, "passed through between samples at 0 and at 0.46 m"
    assert found.state is not None
    assert 0.0999 < found.state[LOW.joint] < 0.11
    assert ask(query(HALF_OPEN.replace("0.0999", "0.1001")), BUMP).standing is Standing.KEPT
    assert ask(query("ASK { ?joint sdt:position 0.25e0 }"), OPENS).standing is Standing.BROKEN, "one value"


@pytest.mark.parametrize(
    "where",
    [
        "FILTER (?at<0.10001&&?at>0.1)",  # nothing between < and > is an IRI
        "# a line ends with\rFILTER (?at > 0.1 && ?at < 0.10001)",
    ],
)
def test_no_number_of_a_query_is_overlooked(where: str) -> None:
    found = ask(query(f"ASK {{ <{LOW.joint}> sdt:position ?at {where} }}"), OPENS)
    assert found.standing is Standing.BROKEN, "passed through between samples"


def test_a_position_of_zero_is_neither_true_nor_passed_over() -> None:
    twin = TWIN.at({joint: 0.1 for joint in TWIN.state} | {LOW.joint: 0.5, FOLDING.joint: 0.2})
    shuts = leg(1, {LOW.joint: ([0.5, 0.0], [0.0, 0.0])}, twin)
    somewhere = query(f"ASK {{ <{LOW.joint}> sdt:position ?at FILTER (?at) }}", Demand.ALWAYS)
    assert ask(somewhere, shuts).standing is Standing.BROKEN


def test_a_query_that_computes_is_not_told_as_kept() -> None:
    sparql = "ASK { ?joint sdt:position ?at FILTER (?at * 2 > 0.5 && ?at < 0.26) }"
    assert ask(query(sparql), OPENS).standing is Standing.UNBOUNDED, "true on the way, at no sample"
    turning = leg(1, {FOLDING.active_joint: ([0.0, 0.3], [0.0, 0.0])})
    assert ask(query(HALF_OPEN), turning).standing is Standing.UNBOUNDED, "two joints move"


def test_keeps_is_the_opposite_of_avoids_and_reaches_is_about_the_end() -> None:
    low_is_low = f"ASK {{ <{LOW.joint}> sdt:position ?at FILTER (?at < 0.2) }}"
    assert ask(query(low_is_low, Demand.ALWAYS), BUMP).standing is Standing.KEPT
    assert ask(query(low_is_low, Demand.ALWAYS), OPENS).standing is Standing.BROKEN
    assert ask(query(low_is_low, Demand.AT_THE_END), BUMP).standing is Standing.KEPT
    assert ask(query(low_is_low, Demand.AT_THE_END), OPENS).standing is Standing.BROKEN


def test_events_between_samples_count() -> None:
    opened = f"ASK {{ ?event a sdt:NoLongerClosed ; sdt:about <{LOW.iri}> }}"
    found = ask(query(opened, over=Scope.EVENTS), BUMP)
    assert (found.standing, found.step) == (Standing.BROKEN, 1)
    assert found.time == pytest.approx((1 - 0.9**0.5) / 2, abs=1e-8), "0.4 t (1 - t) is 0.01 m then"
    assert ask(query(opened.replace("low", "high"), over=Scope.EVENTS), BUMP).standing is Standing.KEPT
    for tells in ("sdt:time", "sdt:step", "?any"):
        when = f"ASK {{ ?event a sdt:Opened ; {tells} ?when FILTER (?when < 0.1) }}"
        assert ask(query(when, over=Scope.EVENTS), BUMP).standing is Standing.UNBOUNDED


BOTH = leg(1, {LOW.joint: ([0.0, 0.5], [0.0, 0.0]), HIGH.joint: ([0.0, 0.46], [0.0, 0.0])})
"""Both open between two samples, LOW before HIGH."""


def test_what_begins_between_the_same_two_samples_is_told_in_its_order() -> None:
    alone = (
        "ASK {{ ?one a sdt:Opened ; sdt:about <{}> "
        "FILTER NOT EXISTS {{ ?other a sdt:Opened ; sdt:about <{}> }} }}"
    )
    for first, then, standing in ((LOW, HIGH, Standing.BROKEN), (HIGH, LOW, Standing.KEPT)):
        assert ask(query(alone.format(first.iri, then.iri), over=Scope.EVENTS), BOTH).standing is standing
    earlier = (
        "ASK {{ ?one a sdt:Opened ; sdt:about <{}> ; sdt:step ?s . "
        "?other a sdt:Opened ; sdt:about <{}> ; sdt:step ?t FILTER (?s < ?t) }}"
    )
    for first, then, standing in ((LOW, HIGH, Standing.BROKEN), (HIGH, LOW, Standing.KEPT)):
        assert ask(query(earlier.format(first.iri, then.iri), over=Scope.EVENTS), BOTH).standing is standing
    assert ask(OpensBefore(LOW, HIGH), BOTH).standing is Standing.KEPT
    assert ask(OpensBefore(HIGH, LOW), BOTH).standing is Standing.BROKEN


def test_a_handle_that_is_let_go_and_taken_anew_is_grasped_twice() -> None:
    times, still, none = np.arange(4.0), np.zeros((4, 3)), np.zeros((4, 0))
    q = np.array([[0.0], [0.2], [0.2], [0.46]])
    robot, phases = (
        "https://example.org/id/r",
        (("follow", 0), ("let go", 1), ("follow 2", 2), ("follow on", 3)),
    )
    motion = BodyMotion(robot, "", (), times, still, none, none, still, (LOW.joint,), q, 0 * q, phases=phases)
    twice = Leg.of(1, TWIN, motion)
    sure = (twice.trajectory.times[0], *twice.trajectory.times[[*twice.trajectory.again]])
    assert sure == (0.0, 2.0), "the last phase is only called nearly so"
    again = "ASK { ?one a sdt:Grasped . ?other a sdt:Grasped FILTER (?one != ?other) }"
    found = ask(query(again, over=Scope.EVENTS), twice)
    assert (found.standing, found.time) == (Standing.BROKEN, 2.0)
    back = Trajectory.from_bytes(twice.trajectory.to_bytes())
    assert (back.grasp, back.again, back.iri) == (
        Grasp(robot, 0),
        twice.trajectory.again,
        twice.trajectory.iri,
    )


def test_which_of_several_handles_is_grasped_is_not_told() -> None:
    """Of two drawers that move together either may be held."""
    pair = load_twin(Path(__file__).parents[2] / "services" / "dynamics" / "pair.urdf")
    lower, upper = (pair.container(f"{name}_drawer") for name in ("lower", "upper"))
    both = held(leg(1, {upper.joint: ([0.0, upper.upper], [0.0, 0.0])}, pair))
    for asked, standing in (
        (f"a sdt:Grasped ; sdt:about <{lower.handle}>", Standing.BROKEN),
        (f"a sdt:Grasped ; sdt:about <{pair.container('left_leaf').handle}>", Standing.UNBOUNDED),
        (f"sdt:about <{pair.container('left_leaf').handle}>", Standing.UNBOUNDED),
        (f"a sdt:Opened ; sdt:about <{upper.iri}>", Standing.BROKEN),
        (f"a sdt:Closed ; sdt:about <{upper.iri}>", Standing.KEPT),
    ):
        rule = query(f"ASK {{ ?e {asked} }}", over=Scope.EVENTS)
        found = checked(rule, [both], Far(Approach(keeps=True)), InGraph(pair))
        assert found.standing is standing, asked


def test_a_motion_that_does_not_tell_when_it_holds_is_not_said_to_hold_nothing() -> None:
    other = query(f"ASK {{ ?e a sdt:Grasped ; sdt:about <{HIGH.handle}> }}", over=Scope.EVENTS)
    assert ask(other, OPENS).standing is Standing.UNBOUNDED
    assert ask(other, held(OPENS)).standing is Standing.KEPT


def held(leg: Leg) -> Leg:
    """The leg, whose handle is held from the first sample on."""
    motion = replace(leg.motion, robot="https://example.org/id/r", phases=(("follow", 0),))
    return Leg.of(leg.number, leg.twin, motion)


def test_what_begins_at_once_is_in_no_order() -> None:
    both = leg(1, {each.joint: ([0.0, 0.46], [0.0, 0.0]) for each in (LOW, HIGH)})
    for first, then in ((LOW, HIGH), (HIGH, LOW)):
        assert ask(OpensBefore(first, then), both).standing is Standing.BROKEN


def test_the_first_of_several_broken_rules_is_named() -> None:
    answers = [
        ask(NeverBeyond(LOW, 0.2), OPENS),
        ask(query(f"ASK {{ <{LOW.joint}> sdt:position 0.0e0 }}"), OPENS),
    ]
    found = first_broken(answers)
    assert found is answers[1]


@pytest.mark.parametrize(
    "sparql",
    [
        "ASK { ?j sdt:position ?p FILTER (?p-1 > 0) }",
        "ASK { ?j sdt:position ?p FILTER (ABS(?p) > 1) }",
        "ASK { ?j sdt:position ?p FILTER (xsd:integer(?p) = 1) }",
        "ASK { ?j sdt:position ?p FILTER (?p > '0.4'^^xsd:double) }",
        "SELECT (SUM(?p) AS ?all) { ?j sdt:position ?p }",
        "SELECT (COUNT(*) AS ?all) { GRAPH ?g { ?j sdt:position ?p } }",
        "ASK { ?j sdt:position/sdt:name ?p }",
    ],
)
def test_what_may_compute_is_not_trusted(sparql: str) -> None:
    assert not only_compares(sparql)


def test_what_only_compares_is() -> None:
    assert only_compares(
        "# why\nSELECT * { ?c a sdt:Door ; sdt:hasJoint ?j . ?j sdt:position ?p FILTER (?p >= 0.5) }"
    )


def test_numbers_are_those_of_the_predicates_that_a_query_names() -> None:
    sparql = "ASK { ?j sdt:position ?p FILTER NOT EXISTS { ?j sdt:openFrom ?f } OPTIONAL { ?j a ?k } }"
    named = predicates_in(sparql)
    assert named is not None
    assert sorted(each.rsplit("#", 1)[1] for each in named) == ["openFrom", "position", "type"]
    assert predicates_in("ASK { ?j ?any ?p }") is None
    nested = "ASK { { SELECT ?j { ?j sdt:closedTo ?x } } MINUS { ?j sdt:upperLimit ?u } }"
    assert len(predicates_in(nested) or ()) == 2
