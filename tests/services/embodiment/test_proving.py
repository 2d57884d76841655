"""Which proofs the search comes to look for, and what they say of what was searched besides."""

from itertools import count
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.motion import Motion
from services.embodiment.body.demands import Margins
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.handle import Bar, Mechanics, find_bar
from services.embodiment.hold.kit import Kits
from services.embodiment.prove import Proved, Prover
from services.embodiment.search.proving import Proofs
from services.embodiment.setting import Setting
from services.embodiment.ways.roads import Known
from services.physics.model import Scene
from tests.services.embodiment.prove.standing import without_cores
from tests.small import beside
from tests.soak.doors import draw, write

HERE = (0.0, 0.0, 0.0)
FAR = 41  # front whose handle the TIAGo++ touches with the ends of its fingers at best
STANDING = 31  # front whose door comes into the TIAGo++'s column
TIPS, MET = 65, "torso_fixed_link"  # front whose door comes into that body of the TIAGo++
LASTS_NOT = 12  # front that the TIAGo++ holds at each angle, and in no way that lasts
BRED = 96


def setting(folder: Path, number: int, robot: str, drive: Drive) -> Setting:
    twin = beside(write(draw(np.random.default_rng(number)), folder, "front"), robot)
    world, door = World(Scene(twin, twin.robots[0])), twin.container("front_door")
    motion = Motion(door.joint, np.array([0.0, 1.0]), np.array([[0.0], [door.open_from]]))
    own = Kits(world, Margins()), Known(), Tolerances()
    return Setting(world, door, motion, drive, HERE, twin.robots[0], *own)


def proofs(about: Setting) -> Proofs:
    return Proofs(about, lambda _step, _since: None)


def bar_of(about: Setting) -> Bar:
    """Of the handle."""
    bar = find_bar(about.world, Mechanics(about.world, about.container), about.world.scene.q(HERE, {}))
    assert bar is not None
    return bar


def middle(about: Setting) -> np.ndarray:
    """Of the bar, in the frame of its joint [m], shape (3,)."""
    return bar_of(about).centre


@pytest.mark.parametrize("bred", [0, BRED])
def test_of_holds_in_hand_it_is_said_what_was_searched_beyond_them(tmp_path: Path, bred: int) -> None:
    about = setting(tmp_path, FAR, "tiago_dual", Drive.FIXED)
    known = proofs(about)
    known.look(0)
    known.look_at_holds([middle(about)], bred, late=lambda: True)
    assert known.whole is None
    assert known.partial is not None
    assert known.ended
    assert not known.partial.diagnosis.proof
    assert "within 0.02 m" in known.partial.diagnosis.reason
    assert (f"{BRED} bred grasps" in known.partial.diagnosis.reason) is (bred == BRED)


def test_nothing_is_said_of_holds_in_hand_where_listed_grasps_have_it_farther_off(tmp_path: Path) -> None:
    about = setting(tmp_path, FAR, "tiago_dual", Drive.FIXED)
    known = proofs(about)
    known.look(0)
    known.look_at_holds([middle(about) + np.array([0.1, 0.0, 0.0])], BRED, late=lambda: True)
    assert not known.ended


@pytest.mark.parametrize("looks", [1, 1000])
def test_that_no_one_hold_lasts_is_looked_for_until_the_budget_ends(tmp_path: Path, looks: int) -> None:
    known, calls = proofs(setting(tmp_path, LASTS_NOT, "tiago_dual", Drive.FIXED)), count()
    known.look(0)
    known.look_at_holds([], 0, late=lambda: next(calls) >= looks)
    assert (known.partial is not None) is (looks > 1)


@pytest.mark.parametrize(("number", "whole"), [(STANDING, True), (TIPS, True), (TIPS, False)])
def test_a_door_that_comes_into_a_standing_robot_ends_the_search(
    tmp_path: Path, number: int, whole: bool
) -> None:
    robot = "tiago_dual" if whole else without_cores(tmp_path, "tiago_dual", MET)
    known = proofs(setting(tmp_path, number, robot, Drive.FIXED))
    known.look_at_sweep()
    assert known.ended
    assert (known.whole is not None) is whole
    assert (known.partial is not None) is not whole


@pytest.mark.parametrize("found", [True, False])
def test_of_a_grasp_set_more_is_said_than_of_one_hold(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, found: bool
) -> None:
    about = setting(tmp_path, LASTS_NOT, "tiago_dual", Drive.FIXED)
    known, of_one, of_grasps = proofs(about), cast(Proved, object()), cast(Proved, object())
    known.partial = of_one
    monkeypatch.setattr(Prover, "grasped", lambda _self, _late: of_grasps if found else None)
    known.look_at_grasps(bar_of(about))
    assert known.partial is (of_grasps if found else of_one)


def test_of_collision_shapes_more_is_said_than_of_a_grasp_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    about = setting(tmp_path, TIPS, without_cores(tmp_path, "tiago_dual", MET), Drive.FIXED)
    known = proofs(about)
    known.look_at_sweep()
    of_shapes = known.partial
    assert of_shapes is not None
    monkeypatch.setattr(Prover, "grasped", lambda _self, _late: pytest.fail("not asked"))
    known.look_at_grasps(bar_of(about))
    assert known.partial is of_shapes


def test_what_there_is_no_time_to_look_at_is_looked_at_later(tmp_path: Path) -> None:
    known = proofs(setting(tmp_path, STANDING, "tiago_dual", Drive.FIXED))
    known.look_at_sweep(late=lambda: True)
    assert (known.ended, known.is_cut) == (False, True)
    known.look_at_sweep()
    assert (known.ended, known.is_cut) == (True, False)


def test_of_a_robot_that_may_drive_away_that_is_not_asked(tmp_path: Path) -> None:
    known = proofs(setting(tmp_path, STANDING, "tiago_dual", Drive.OMNI))
    known.look_at_sweep()
    assert not known.ended
