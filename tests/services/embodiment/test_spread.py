"""Holdings that many postures find together: they hold the handle all along, and touch nothing."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Outcome
from sdt_kg.annotation import Drive
from services.app import Policy, load
from services.embodiment.body.track import JUMP
from services.embodiment.hold.fit import Fitter, Opened
from services.embodiment.hold.handle import Bar
from services.embodiment.hold.holding import SEEDS
from services.embodiment.hold.sampling import FULL, LOOKED_AT, QUICK, Effort, Sampler
from services.embodiment.hold.sets import FIRST_WIDE, grasp_set, wide_set
from services.embodiment.hold.spread import Spreader
from tests.services.embodiment.front import front

pytestmark = pytest.mark.oracle

FRONT = 14
"""A door of 0.47 m, its hinge on the left, its handle 1.65 m high, 0.58 m before the robot."""
OPEN = 1.472  # [rad]
BARELY = 42
"""A front of whose grasps some leave a finger less than 3 mm over the bar."""
NO_ROOM = 12
"""A seed of the search with which the first holding that is found leaves no room to fold the arm."""


def searched(folder: Path, base: tuple[float, float, float], effort: Effort = FULL) -> Spreader:
    return spread(folder, base, effort)[0]


def spread(
    folder: Path, base: tuple[float, float, float], effort: Effort = FULL
) -> tuple[Spreader, Fitter, list[Opened]]:
    one = front(folder, FRONT, "pr2", 61, last=OPEN)
    opened = one.fitter.wide(lambda: False)
    sampler = Sampler(one.searcher(base), one.fitter, opened, np.random.default_rng(0), lambda: False)
    return Spreader(sampler, effort), one.fitter, opened


def test_a_base_that_stands_is_not_moved_by_rounding(tmp_path: Path) -> None:
    base = 0.013, -0.017, 0.1
    found = next(searched(tmp_path, base, QUICK).holdings())
    assert (found.xs[:, :3] == base).all()


@pytest.mark.parametrize("effort", [QUICK, FULL], ids=["quick", "full"])
def test_a_holding_keeps_its_grasp_its_limits_and_its_distance(tmp_path: Path, effort: Effort) -> None:
    spreader = searched(tmp_path, (0.0, 0.0, 0.0), effort)
    found = next(spreader.holdings())
    one, problem = spreader.searcher, spreader.searcher.problem
    target_r, target_p = found.grasp.tool(problem.handle_r, problem.handle_p)
    for x, r, p in zip(found.xs, target_r, target_p, strict=True):
        tool_r, tool_p = found.limb.tool(x)
        np.testing.assert_allclose(tool_r, r, atol=1e-6)
        np.testing.assert_allclose(tool_p, p, atol=1e-6)
    assert (found.xs[:, :3] == 0.0).all()
    assert (found.xs[:, 3:] >= one.lower[3:]).all()
    assert (found.xs[:, 3:] <= one.upper[3:]).all()
    assert np.abs(np.diff(found.xs, axis=0)).max() < JUMP
    q = problem.mechanics.put_each(found.limb.q(found.xs, found.rest), problem.values)
    assert one.world.contact(q, one.rules) is None


@pytest.mark.parametrize("effort", [QUICK, FULL], ids=["quick", "full"])
def test_nothing_is_held_where_some_value_is_out_of_reach(tmp_path: Path, effort: Effort) -> None:
    assert [*searched(tmp_path, (-1.0, 0.0, 0.0), effort).holdings()] == []


def test_a_hand_is_closed_only_in_grasps_that_a_posture_was_found_for(tmp_path: Path) -> None:
    spreader, fitter, opened = spread(tmp_path, (0.0, 0.0, 0.0))
    next(spreader.holdings())
    closed = [one for one in opened if fitter.known(one) is not None]
    assert 0 < len(closed) < len(opened) / 2


def test_where_little_is_looked_at_postures_of_the_last_value_are_enough(tmp_path: Path) -> None:
    spreader = searched(tmp_path, (0.0, 0.0, 0.0), QUICK)
    next(spreader.holdings())
    assert 0 < spreader.searcher.tally.seeds < LOOKED_AT * QUICK.first * SEEDS


def test_grasps_whose_fingers_do_not_reach_over_the_bar_do_not_fit(tmp_path: Path) -> None:
    one = front(tmp_path, BARELY, "stretch", 61)
    opened = one.fitter.wide(lambda: False)
    sampler = Sampler(
        one.searcher((0.0, 0.0, 0.0)), one.fitter, opened, np.random.default_rng(0), lambda: False
    )
    fit = [sampler.fits(k) for k in range(len(opened))]
    closed = [one.fitter.fitted(each) for each in opened]
    assert fit == [each is not None and one.fitter.engaged(each[0]) for each in closed]
    assert 0 < sum(fit) < sum(each is not None for each in closed)


def test_the_wide_set_has_other_numbers_and_closes_across_the_bar() -> None:
    bar = Bar(1, np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([-1.0, 0.0, 0.0]), 0.2, 0.012, 0.012)
    wide = [*wide_set(bar)]
    assert min(one.index for one in wide) == FIRST_WIDE > max(one.index for one in grasp_set(bar))
    assert len({one.index for one in wide}) == len(wide)
    for one in wide:
        np.testing.assert_allclose(one.rotation.T @ one.rotation, np.eye(3), atol=1e-12)
        assert abs(one.rotation[:, 1] @ bar.along) < 1e-12
    assert max(abs(one.rotation[:, 0] @ bar.along) for one in wide) > np.sin(np.radians(79))


def test_where_there_is_no_room_to_come_to_one_holding_others_are_looked_for() -> None:
    service = load("a", ["pr2"], policy=Policy(Drive.OMNI, seed=NO_ROOM))
    (verdict,) = service.achieve("open:cabinet7_door_bottom_left")
    assert verdict.outcome is Outcome.CERTIFIED
