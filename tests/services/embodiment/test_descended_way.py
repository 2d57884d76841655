"""What a way in holds by descent is made of: waypoints, cuts, and room to back off."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from services.embodiment.body.world import Rules
from services.embodiment.descent import descended
from services.embodiment.descent.changes import SHARES
from services.embodiment.descent.descended import FINER, LEAVES, Descended
from services.embodiment.descent.spans import PIECES, Hold, Spans
from services.embodiment.hold.holding import WAYPOINTS, Holding, Problem
from services.embodiment.search.plan import LAST, Planner
from services.embodiment.search.planned import Planned
from services.embodiment.ways.approach import LEAVE, Approacher
from services.embodiment.ways.way import Approach, Blocked
from tests.services.embodiment.test_descended_refused import BUDGET, HERE, NO_HAND_FITS, planner_of

pytestmark = pytest.mark.oracle
Array = NDArray[np.float64]


@pytest.fixture
def planner(tmp_path: Path) -> Planner:
    return planner_of(NO_HAND_FITS, tmp_path, HERE, BUDGET)


def planned(planner: Planner) -> Planned:
    """The first motion in holds by descent."""
    planner.descended = descended = Descended(planner)
    found = next(descended.plans(*LAST), None)
    assert found is not None
    return found


def hold(first: int, last: int) -> Hold:
    tool = np.eye(3), np.zeros(3)
    return Hold(tool, np.ones(1), 7, first, np.arange(first, last + 1)[:, None] * np.ones(4))


@pytest.mark.parametrize(
    ("value", "parts"), [(0.5, [(5, 32), (33, 60)]), (0.08, [(6, 60)]), (0.94, [(5, 59)])]
)
def test_a_hold_is_cut_about_a_value(value: float, parts: list[tuple[int, int]]) -> None:
    spans = Spans(None, np.linspace(2.0, 4.0, PIECES + 1))  # no descent is asked
    whole, other = hold(5, 60), hold(0, 3)
    spans.holds = [whole, other]
    spans.cut(whole, 2.0 + 2.0 * (value + 0.001))
    assert spans.holds[0] is other
    assert [(one.first, one.last) for one in spans.holds[1:]] == parts
    for one in spans.holds[1:]:
        assert one.number == whole.number
        for k in range(one.first, one.last + 1):
            np.testing.assert_array_equal(one.at(k), whole.at(k))


def test_where_a_spline_touches_something_it_is_led_through_more_waypoints(
    planner: Planner, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, looked = Spans.amid, list[int]()

    def amid(self: Spans, one: Hold, values: Array, xs: Array) -> float | None:
        looked.append(len(values))
        return float(values[1]) if len(values) == WAYPOINTS else real(self, one, values, xs)

    monkeypatch.setattr(Spans, "amid", amid)
    found = planned(planner)
    assert looked[:2] == [*FINER[:2]]
    assert len(found.holding.xs) in FINER[1:]
    values = found.assembler.problem.values
    assert len(values) == len(found.holding.xs)
    for k in (0, len(values) // 2, -1):
        r, p = found.holding.grasp.tool(
            found.assembler.problem.handle_r[k], found.assembler.problem.handle_p[k]
        )
        there = found.assembler.limb.tool(found.holding.xs[k])
        np.testing.assert_allclose(there[1], p, atol=1e-4)
        np.testing.assert_allclose(there[0], r, atol=1e-3)
    follow = dict(found.body.phases)
    samples = follow["let go"] - follow["follow"]
    assert samples == 2 * (len(values) - 1)


def test_a_hold_that_a_spline_never_keeps_is_cut(planner: Planner, monkeypatch: pytest.MonkeyPatch) -> None:
    cut, real = list[Hold](), Spans.cut

    def noted(self: Spans, one: Hold, value: float) -> None:
        cut.append(one)
        real(self, one, value)

    def amid(self: Spans, one: Hold, values: Array, _xs: Array) -> float | None:
        return None if cut else float(values[len(values) // 2])

    monkeypatch.setattr(Spans, "cut", noted)
    monkeypatch.setattr(Spans, "amid", amid)
    found = planned(planner)
    assert len(cut) == 1
    assert found.body.times[-1] > 0


def test_where_there_is_less_room_the_open_hand_backs_off_less(
    planner: Planner, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = Approacher._leaves

    def near(self: Approacher, x: Array, *way: Any) -> Iterator[Array]:
        if way[-1] < LEAVES[1]:
            yield from real(self, x, *way)

    monkeypatch.setattr(Approacher, "_leaves", near)
    found = planned(planner)
    ends = [found.assembler.limb.tool(found.approach.reach[k])[1] for k in (0, -1)]
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(LEAVES[-1], abs=1e-3)
    assert LEAVES[0] == LEAVE
    name = found.body.gripper
    attempt = next(one for one in planner.attempts if one.limb.gripper.name == name)
    usual = attempt.approacher.approach(found.holding, attempt.searcher.problem, attempt.rng)
    assert isinstance(found.approach, Approach)
    assert isinstance(usual, Blocked)
    assert usual.stage == "leave"


def test_fingers_open_in_place_only_where_that_touches_nothing(planner: Planner) -> None:
    found = planned(planner)
    name = found.body.gripper
    attempt = next(one for one in planner.attempts if one.limb.gripper.name == name)
    world, approacher, grasp = attempt.searcher.world, attempt.approacher, found.holding.grasp
    x, rules = found.holding.xs[0], attempt.searcher.rules
    assert approacher.swings(x, grasp.fingers, grasp.opened, rules)
    assert approacher.swings(x, grasp.opened, grasp.fingers, rules)
    rests = [approacher.hand.configuration(dict(each)) for each in (grasp.fingers, grasp.opened)]
    q = attempt.limb.q(np.stack([x, x]), np.stack(rests))
    panel = world.shapes_of(["https://example.org/id/front/body/front_door"])
    tips = world.shapes_of(attempt.limb.fingers)
    pairs = np.array([(tip, shape) for tip in tips for shape in panel])
    least = [world.distances(pairs, *world.frames(each)).min() for each in q]
    environment = rules.environment.copy()
    environment[np.ix_(tips - world.split, panel)] = np.mean(least)  # one end keeps that, the other does not
    asked = Rules(environment, rules.pairs, rules.own)
    assert abs(least[0] - least[1]) > 1e-4
    assert not approacher.swings(x, grasp.fingers, grasp.opened, asked)
    assert not approacher.swings(x, grasp.opened, grasp.fingers, asked)


def test_a_hand_that_has_no_room_to_open_wide_opens_less(
    planner: Planner, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, wide = Approacher.lets_go, list[tuple[tuple[str, float], ...]]()

    def narrow(self: Approacher, holding: Holding, problem: Problem) -> bool:
        widest = self.hand.opening(SHARES[0])
        wide.extend([holding.grasp.opened] if holding.grasp.opened == widest else [])
        return holding.grasp.opened != widest and real(self, holding, problem)

    monkeypatch.setattr(Approacher, "lets_go", narrow)
    found = planned(planner)
    assert wide
    assert found.holding.grasp.opened not in wide


def test_it_goes_straight_to_the_next_hold_only_where_fingers_may_open_as_wide_as_that_asks(
    planner: Planner, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = [name for name, _ in planned(planner).body.phases]
    assert "leave" in names
    assert "return" not in names
    monkeypatch.setattr(Approacher, "swings", lambda _self, _x, _begin, _end, rules=None: rules is not None)
    assert "return" in [name for name, _ in planned(planner).body.phases]


@pytest.mark.parametrize("refused", [True, False])
def test_a_gripper_goes_on_after_a_turn_whose_motion_was_refused(
    planner: Planner, monkeypatch: pytest.MonkeyPatch, *, refused: bool
) -> None:
    search = next(one for one in Descended(planner)._begun() if one.contact is None)
    search.spans.holds = [hold(0, PIECES - 1)]  # no turn reaches farther

    def grow(self: Spans, starts: int, _late: object) -> None:
        self.descent.starts += starts

    monkeypatch.setattr(Spans, "grow", grow)
    monkeypatch.setattr(descended, "plans", lambda _hands, _late: iter([None] if refused else []))
    list(search.turn())
    assert search.idle == (0 if refused else 1)
