"""Ways to holds by descent: from parked, and from one hold straight to another."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

from services.embodiment.descent.changes import LOOKS, SAMPLES, WHOLE, Changes
from services.embodiment.descent.descended import Descended
from services.embodiment.descent.row import Part, _changed
from services.embodiment.descent.spans import PIECES, Hold
from services.embodiment.search.plan import LAST, Planner
from services.embodiment.ways.approach import ARM_ITERATIONS, Approacher
from services.embodiment.ways.assemble import Assembler
from services.embodiment.ways.way import Approach, Blocked
from tests.services.embodiment.standing_front import HERE, asked, body_of, check_by_other_code
from tests.services.embodiment.test_descended_refused import BUDGET, NO_HAND_FITS, planner_of
from tests.services.embodiment.test_descended_way import hold, planned
from tests.soak.doors import draw, write

ONE_WILL_DO = 3
"""A front of which holds by descent last all the way."""

Array = NDArray[np.float64]


@dataclass(eq=False)
class Known:
    """Ways of a hand, by which of its holds and where; it counts what it is asked for."""

    parked: set[tuple[Hold, int]] = field(default_factory=set[tuple[Hold, int]])
    straight: set[tuple[Hold, Hold, int]] = field(default_factory=set[tuple[Hold, Hold, int]])
    asked: list[tuple[Hold, Hold, int]] = field(default_factory=list[tuple[Hold, Hold, int]])
    changes: "Known" = field(init=False)

    def __post_init__(self) -> None:
        self.changes = self

    def back(self, one: Hold, index: int) -> str | None:
        return "parked" if (one, index) in self.parked else None

    def between(self, one: Hold, other: Hold, index: int) -> str | None:
        self.asked.append((one, other, index))
        return "straight" if (one, other, index) in self.straight else None


def on(
    hand: Known, part: Hold, other: Hold, begin: int = 0, of: Known | None = None
) -> tuple[int, Any] | None:
    """At which value it goes on from one hold to another, and how."""
    found = _changed(Part(cast(Any, hand), part, begin), cast(Any, of or hand), other, lambda: False)
    return None if found is None else (found.begin, found.come)


def test_it_goes_straight_to_a_hold_that_reaches_farther_and_no_way_leads_to_from_parked() -> None:
    one, other = hold(0, 20), hold(10, PIECES)
    for index in (20, 15, 10):
        assert on(Known(straight={(one, other, index)}), one, other) == (index, "straight")
    assert on(Known(straight={(one, other, 21)}), one, other) is None
    assert on(Known(straight={(one, other, 12)}), one, other, begin=14) is None


def test_else_it_parks_between_them_where_both_have_a_way() -> None:
    one, other = hold(0, 20), hold(10, PIECES)
    assert on(Known(parked={(one, 10), (other, 13), (one, 16), (other, 16)}), one, other) == (16, None)
    assert on(Known(parked={(one, 10), (other, 13)}), one, other) is None


def test_no_straight_way_is_looked_for_to_another_hand_or_to_what_reaches_no_farther() -> None:
    one, other, short = hold(0, 20), hold(10, PIECES), hold(10, 20)
    mine, theirs = Known(parked={(one, 13)}), Known(parked={(other, 13)})
    assert on(mine, one, other, of=theirs) == (13, None)
    assert on(mine, one, short) is None
    assert not mine.asked
    assert not theirs.asked


def test_so_many_straight_ways_are_looked_for_each_once(monkeypatch: pytest.MonkeyPatch) -> None:
    changes, asked = Changes(cast(Any, None), cast(Any, None), lambda: False), list[int]()
    monkeypatch.setattr(Changes, "near", lambda _self, _hold, index: asked.append(index))
    one, other = hold(0, 60), hold(10, PIECES)
    for index in (*range(LOOKS), *range(LOOKS), 50):
        assert changes.between(one, other, index) is None
    assert sorted(asked) == sorted([*range(LOOKS)] * 2)
    changes.turn()
    changes.between(one, other, 50)
    assert asked[-1] == 50


def test_so_many_holds_that_last_all_the_way_are_looked_at_longer_in_a_turn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    changes, asked = Changes(cast(Any, None), cast(Any, None), lambda: False), list[tuple[Hold, int]]()
    monkeypatch.setattr(Changes, "_left", lambda _self, one, _index, samples: asked.append((one, samples)))
    holds = [hold(0, PIECES) for _ in range(WHOLE + 1)]
    for _ in range(2):
        for one in holds:
            assert not changes.longer(one)
    assert [one for one, samples in asked if samples == SAMPLES] == holds[:WHOLE]
    changes.turn()
    for one in holds:
        changes.longer(one)
    assert [one for one, samples in asked if samples == SAMPLES] == holds


@pytest.mark.oracle
def test_a_hold_that_lasts_all_the_way_is_come_to_with_more_samples(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, looked = Approacher._arm, list[int]()

    def hard(self: Approacher, *way: Any) -> tuple[Array, Array] | Blocked:
        looked.append(self.samples)
        return real(self, *way) if self.samples > ARM_ITERATIONS else Blocked("fold")

    monkeypatch.setattr(Approacher, "_arm", hard)
    found = planned(planner_of(ONE_WILL_DO, tmp_path, HERE, BUDGET))
    assert "let go at" not in found.style
    assert looked[-1] == SAMPLES
    assert looked[0] == ARM_ITERATIONS
    assert found.body.phases[-1][0].startswith("follow")


@pytest.mark.oracle
def test_what_no_way_leads_to_from_parked_once_it_is_ajar_is_certified_by_straight_ways(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = Approacher._by

    def shut(self: Approacher, roads: Any, left: Array, problem: Any, rng: Any) -> Approach | Blocked:
        begins = problem.values[0] == problem.mechanics.start
        return real(self, roads, left, problem, rng) if begins else Blocked("fold")

    monkeypatch.setattr(Approacher, "_by", shut)
    path = write(draw(np.random.default_rng(NO_HAND_FITS)), tmp_path, "front")
    (verdict,) = asked(path, BUDGET).achieve("open:front_door")
    body = body_of(verdict)
    names = [name for name, _ in body.phases]
    assert names[:8] == ["drive", "approach", "grasp", "follow", "let go", "leave", "drive 2", "approach 2"]
    assert not any(name.startswith("return") for name in names)
    check_by_other_code(body, path)


@pytest.mark.oracle
def test_a_way_on_which_a_joint_would_leave_its_limits_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    planner: Planner = planner_of(ONE_WILL_DO, tmp_path, HERE, BUDGET)
    monkeypatch.setattr(Assembler, "_outside", lambda _self, _timed: 1e-3)
    assert planner.attempts
    descended = Descended(planner)
    assert next(descended.plans(2, LAST[1]), None) is None
    (search, *_) = (one for one in descended._each if one.spans.holds)
    assert all(search.changes.near(one, one.first) is None for one in search.spans.holds)
    monkeypatch.undo()
    fresh = Changes(search.spans.depths.hand, search._at, planner.late)
    assert any(fresh.near(one, one.first) is not None for one in search.spans.holds)
