"""Grasps that are bred: they are kept at every value of the container, and open what no listed grasp does."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Outcome
from sdt_kg.annotation import Drive
from services.app import Policy, load
from services.embodiment.body import ik
from services.embodiment.body.track import EXACT
from services.embodiment.hold.bred import ENOUGH, LOOKED_AT, Breeder
from services.embodiment.hold.grasp import Grasp
from services.embodiment.hold.handle import Bar
from services.embodiment.hold.holding import STEPS, Searcher
from services.embodiment.hold.parts import around, parts
from services.embodiment.hold.pool import FIRST_BRED, anyhow
from services.embodiment.hold.sets import ANY_MOST, BEYOND, FREE_MOST, grasp_set, grasp_settings
from tests.services.embodiment.front import free_grasp, front
from tests.soak.doors import BAR as BAR_WIDTH
from tests.soak.doors import STAND_OFF
from tests.soak.judge import Result, result

pytestmark = pytest.mark.oracle

FRONT, OPEN = 16, 1.45
"""A door that tips over, 0.63 m before the robot and 0.49 m beside it; [rad]."""
HIGH = 311  # a door with an upright bar, 1.305 to 1.417 m above the floor; the tool of Stretch comes to 1.362
UNDER = 140  # a door that tips over; its bar is then 0.1 m above the floor, under the door
RIGHT = 1  # of the grippers
BAR = Bar(1, np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([-1.0, 0.0, 0.0]), 0.2, 0.012, 0.012)


def breeder(folder: Path, base: tuple[float, float, float]) -> Breeder:
    one = front(folder, FRONT, "tiago_dual", 61, gripper=RIGHT, last=OPEN)
    return Breeder(one.searcher(base), one.fitter, np.random.default_rng(0), lambda: False)


def met(one: Searcher, grasp: Grasp, index: int) -> np.ndarray:
    """Postures with the tool in the grasp at a waypoint, of some hundred seeds."""
    xs = np.concatenate([one.seeds(index, np.random.default_rng(k)) for k in range(4)])
    r, p = grasp.tool(one.problem.handle_r[index], one.problem.handle_p[index])
    target = np.repeat(r[None], len(xs), axis=0), np.repeat(p[None], len(xs), axis=0)
    return xs[ik.solve_many(xs, *target, one.limb.chain, one.weight, one.lower, one.upper, STEPS, EXACT)]


def test_bred_grasps_can_be_had_at_every_value_where_the_base_stands(tmp_path: Path) -> None:
    found = breeder(tmp_path, (0.0, 0.0, 0.0))
    opened = next(one for one in found.litters() if one)
    one = found.searcher
    for index in np.linspace(0, 60, LOOKED_AT).astype(int).tolist():
        had = [(grasp, x) for grasp, _ in opened[:5] for x in met(one, grasp, index)]
        assert had
        for grasp, x in had:
            r, p = one.limb.tool(x)
            target_r, target_p = grasp.tool(one.problem.handle_r[index], one.problem.handle_p[index])
            np.testing.assert_allclose(r, target_r, atol=1e-6)
            np.testing.assert_allclose(p, target_p, atol=1e-6)
            assert (x[:3] == 0.0).all()


def test_bred_grasps_are_tried_when_a_few_are_free_and_others_bred_from_these(tmp_path: Path) -> None:
    litters = breeder(tmp_path, (0.0, 0.0, 0.0)).litters()
    few, many = len(next(litters)), len(next(litters))
    assert ENOUGH[0] <= few < ENOUGH[1] <= many


def test_nothing_is_bred_where_some_value_is_out_of_reach(tmp_path: Path) -> None:
    assert [*breeder(tmp_path, (-0.4, 0.0, 0.0)).litters()] == [[]]


def test_a_free_grasp_without_roll_closes_across_the_bar_and_lies_on_it() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        genes = rng.uniform(-FREE_MOST, FREE_MOST)
        rolled = free_grasp(BAR, genes, 1, 7)
        straight = free_grasp(BAR, genes * (1, 1, 0, 1, 1), 1, 7)
        np.testing.assert_allclose(rolled.rotation.T @ rolled.rotation, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(rolled.rotation[:, 0], straight.rotation[:, 0], atol=1e-12)
        assert abs(straight.rotation[:, 1] @ BAR.along) < 1e-12
        turned = np.arccos(np.clip(rolled.rotation[:, 1] @ straight.rotation[:, 1], -1, 1))
        assert turned == pytest.approx(abs(genes[2]), abs=1e-6)
        away = rolled.translation - (rolled.translation @ BAR.along) * BAR.along
        assert np.linalg.norm(away) == pytest.approx(abs(genes[4]), abs=1e-12)


def test_a_free_grasp_may_have_the_bar_beside_the_hand_that_lies_along_it() -> None:
    genes = np.array([0.0, np.pi / 2, 0.0, 0.0, 0.02])
    grasp = free_grasp(BAR, genes, 1, 7)
    assert abs(grasp.rotation[:, 0] @ BAR.along) == pytest.approx(1.0)
    beside = grasp.rotation.T @ (BAR.centre - grasp.translation)
    np.testing.assert_allclose(np.abs(beside), (0.0, 0.0, 0.02), atol=1e-12)


def test_a_free_grasp_may_have_the_tool_beyond_the_end_of_the_bar() -> None:
    beyond = free_grasp(BAR, np.array([0.0, 0.0, 0.0, 1.0, 0.0]), 1, 7).translation
    assert beyond @ BAR.along == pytest.approx(BAR.length / 2 + BEYOND)


def test_a_free_grasp_with_the_numbers_of_a_listed_one_is_that_one() -> None:
    listed = next(iter(grasp_set(BAR)))
    free = free_grasp(BAR, np.zeros(5), -1, listed.index)
    np.testing.assert_allclose(free.rotation, listed.rotation, atol=1e-12)
    np.testing.assert_allclose(free.translation, listed.translation, atol=1e-12)
    assert repr(FREE_MOST.tolist()) in grasp_settings()
    assert repr(ANY_MOST.tolist()) in grasp_settings()


def test_the_parts_of_a_handle_are_its_bar_and_the_posts_that_carry_it(tmp_path: Path) -> None:
    one = front(tmp_path, UNDER, "pr2", 5)
    bar, *posts = parts(one.world, one.problem.mechanics.container.handle, one.fitter.bar)
    assert bar is one.fitter.bar
    assert len(posts) == 2
    for post in posts:
        assert abs(post.along @ bar.outward) == pytest.approx(1.0)
        assert (post.length, post.depth, post.width) == pytest.approx(
            (STAND_OFF - BAR_WIDTH / 2, *2 * [BAR_WIDTH])
        )
        assert abs((post.centre - bar.centre) @ bar.along) == pytest.approx(bar.length / 2 - BAR_WIDTH / 2)
    whole = around((bar, *posts))
    assert whole.centre is bar.centre
    assert whole.length > bar.length


def test_a_handle_of_one_shape_has_no_part_but_its_bar() -> None:
    assert around((BAR,)).length == pytest.approx(BAR.length)


def test_any_part_of_a_handle_may_be_bred_from_and_is_held_as_certification_demands(tmp_path: Path) -> None:
    one = front(tmp_path, UNDER, "pr2", 5)
    every = parts(one.world, one.problem.mechanics.container.handle, one.fitter.bar)
    free = one.searcher((0.0, 0.0, 0.0))
    bred = Breeder(free, one.fitter, np.random.default_rng(0), lambda: False, anyhow(every))
    next(bred.litters())
    assert len(bred.looked_at) == anyhow(every).grasps
    away = {
        np.argmin([np.linalg.norm(g.translation - part.centre) for part in every]) for g, _ in bred.looked_at
    }
    assert {1, 2} <= away


def test_a_bar_of_which_only_the_lower_end_is_in_reach_is_held_there(tmp_path: Path) -> None:
    assert result(tmp_path, HIGH, "stretch", Drive.OMNI, 20.0) is Result.CERTIFIED


def test_stretch_opens_the_oven_with_a_bred_grasp() -> None:
    service = load("b", ["stretch"], policy=Policy(Drive.OMNI))
    (verdict,) = service.achieve("open:oven_area_oven_door")
    assert verdict.outcome is Outcome.CERTIFIED
    assert verdict.can_perform is not None
    (told,) = (each for each in verdict.can_perform.notes if each.startswith("grasp "))
    assert int(told.split()[1]) >= FIRST_BRED
