"""What hangs beside the arm, a head or another arm, is moved out of the way where nothing else will do."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Outcome, Verdict
from sdt_kg.annotation import Drive
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from services.app import Policy, Service, load
from services.embodiment.body.limb import hanging, make_limb
from services.embodiment.body.world import World
from services.embodiment.hold.handle import Mechanics
from services.embodiment.search import proving
from services.embodiment.search.beside import freed
from services.embodiment.search.plan import Planner
from services.embodiment.search.several import Legs
from services.embodiment.setting import Setting
from services.physics.model import Scene
from tests.services.embodiment.prove.standing import with_held_head
from tests.services.embodiment.standing_front import (
    HERE,
    body_of,
    check_by_other_code,
    check_given_again,
    fixtures,
)
from tests.services.embodiment.test_descended_refused import planner_of

IN_THE_WAY = 552
"""A door that a TIAGo++ whose head looks ahead was not found to open in 20 s."""
HEADS = {
    "pr2": ("head_pan_joint", "head_tilt_joint"),
    "tiago_dual": ("head_1_joint", "head_2_joint"),
    "stretch": ("joint_head_pan", "joint_head_tilt"),
}
POSTURES = 20
BUDGET = 8.0  # [s]
LITTLE = 1.0  # [s] the same, where nothing is found

path, service, found = fixtures(IN_THE_WAY)


@pytest.mark.oracle
def test_its_head_is_moved_and_the_motion_is_certified(found: Verdict) -> None:
    body = body_of(found)
    own = [body.joints.index(name) for name in HEADS["tiago_dual"]]
    np.testing.assert_array_equal(body.q[0, own], 0.0)
    assert np.ptp(body.q[:, own], axis=0).max() > 0.1
    assert found.can_perform is not None
    (said,) = (each for each in found.can_perform.notes if each.startswith("besides gripper"))
    assert HEADS["tiago_dual"][0] in said


@pytest.mark.oracle
def test_who_shares_no_code_with_it_finds_no_rule_broken(found: Verdict, path: Path) -> None:
    check_by_other_code(body_of(found), path)


@pytest.mark.oracle
def test_it_is_certified_again_when_somebody_gives_it(found: Verdict, service: Service) -> None:
    check_given_again(body_of(found), service)


@pytest.mark.oracle
def test_a_held_head_stays_where_it_is(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proving, "GRASPS", 0.0)
    robot = with_held_head(tmp_path, "tiago_dual")
    (verdict,) = load(path, [robot], policy=Policy(Drive.FIXED, HERE, LITTLE)).achieve("open:front_door")
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    moved = next(one.reason for one in verdict.diagnoses if "move out of the way" in one.reason)
    assert moved.endswith(
        "arm_left_1_joint, arm_right_1_joint, arm_left_2_joint, arm_left_3_joint and 10 more"
    )


ARMS = {
    "pr2": [
        f"{side}_{name}_joint"
        for side in "rl"
        for name in (
            "shoulder_pan",
            "shoulder_lift",
            "upper_arm_roll",
            "elbow_flex",
            "forearm_roll",
            "wrist_flex",
            "wrist_roll",
        )
    ],
    "tiago_dual": [f"arm_{side}_{k}_joint" for side in ("left", "right") for k in range(1, 8)],
    "stretch": [],
}


@pytest.mark.parametrize("robot", HEADS)
def test_what_hangs_beside_an_arm_is_the_head_and_the_other_one(robot: str) -> None:
    twin = load_twin("b", [robot])
    names = {joint_iri(robot, name) for name in (*HEADS[robot], *ARMS[robot])}
    scene = Scene(twin, twin.robots[0])
    heads = {joint_iri(robot, name) for name in HEADS[robot]}
    for arms, expected in ((False, heads), (True, names)):
        found = hanging(scene, arms=arms)
        assert {*found} == expected
        assert len(found) == len(expected)


def test_a_held_head_hangs_nowhere(tmp_path: Path) -> None:
    twin = load_twin("b", [with_held_head(tmp_path, "pr2")])
    scene = Scene(twin, twin.robots[0])
    assert hanging(scene, arms=False) == ()
    assert {*hanging(scene, arms=True)} == {joint_iri("pr2", name) for name in ARMS["pr2"]}


@pytest.mark.parametrize("robot", HEADS)
def test_it_does_not_move_the_tool_but_what_it_carries(robot: str) -> None:
    twin = load_twin("b", [robot])
    world = World(Scene(twin, twin.robots[0]))
    gripper, beside = world.scene.annotation.grippers[0], hanging(world.scene, arms=True)
    usual, limb = make_limb(world, gripper), make_limb(world, gripper, dict.fromkeys(beside, 0.1))
    n, rng = len(usual.lower), np.random.default_rng(0)
    every = [world.scene.coordinate[joint] for joint in beside]
    own = [k for k in every if k not in usual.variables]
    assert limb.variables.tolist() == [*usual.variables.tolist(), *own]
    assert len(own) == len(HEADS[robot]) + len(ARMS[robot]) / 2
    np.testing.assert_array_equal(limb.aside, [np.nan] * n + [0.1] * len(own))
    for x in limb.drawn(rng, POSTURES, limb.lower, limb.upper):
        for one, other in zip(usual.tool(x[:n]), limb.tool(x), strict=True):
            np.testing.assert_allclose(one, other, atol=1e-12)
        np.testing.assert_allclose(usual.tool_jacobian(x[:n]), limb.tool_jacobian(x)[:, :n], atol=1e-12)
        np.testing.assert_array_equal(limb.tool_jacobian(x)[:, n:], 0.0)
        q = usual.q(x[:n])
        q[own] = x[n:]
        np.testing.assert_allclose(world.scene.coupling.positions(q), limb.q(x), atol=1e-12)


def test_it_is_aside_in_some_random_postures_and_anywhere_in_others() -> None:
    twin = load_twin("b", ["pr2"])
    world = World(Scene(twin, twin.robots[0]))
    beside = dict.fromkeys(hanging(world.scene, arms=True), 0.25)
    limb = make_limb(world, world.scene.annotation.grippers[0], beside)
    xs = limb.drawn(np.random.default_rng(0), 200, limb.lower, limb.upper)
    aside = (xs == 0.25).any(axis=1)
    assert 60 < aside.sum() < 140
    np.testing.assert_array_equal((xs[aside] == 0.25).sum(axis=1), np.isfinite(limb.aside).sum())


@pytest.fixture(scope="module")
def setting(tmp_path_factory: pytest.TempPathFactory) -> Setting:
    return planner_of(IN_THE_WAY, tmp_path_factory.mktemp("front"), HERE, BUDGET).setting


def test_where_it_is_aside_the_container_passes_it(setting: Setting) -> None:
    world, mechanics = setting.world, Mechanics(setting.world, setting.container)
    head, other = freed(setting, mechanics)
    assert [*head.kits.beside] == [joint_iri("tiago_dual", name) for name in HEADS["tiago_dual"]]
    assert not head.proves
    assert not other.proves
    assert [*freed(other, mechanics)] == []
    scene, beside = world.scene, other.kits.beside
    q = scene.q(HERE, {})
    for joint, at in beside.items():
        q[scene.coordinate[joint]] = at
    values = np.linspace(setting.container.lower, setting.container.open_from, 100)
    moved = mechanics.put(scene.coupling.positions(q), values)
    assert world.contact(moved, setting.kits.outside()) is None
    kit = setting.kits.of(scene.annotation.grippers[0])
    assert world.contact(moved, kit.opened) is None


def test_parked_amid_the_way_it_stands_aside_and_at_its_begin_ahead(setting: Setting) -> None:
    _, other = freed(setting, Mechanics(setting.world, setting.container))
    planner = Planner(other, np.inf, 0, lambda *_: None)
    legs = Legs(planner, "left", setting.container.open_from)
    first, later = (legs.at((value, 1.0), np.inf).setting for value in (planner.mechanics.start, 0.5))
    at = [setting.world.scene.coordinate[joint] for joint in other.kits.beside]
    parked = setting.world.scene.q(HERE, {})[at]
    for part, expected in ((first, parked), (later, [*other.kits.beside.values()])):
        np.testing.assert_array_equal(part.world.scene.q(HERE, {})[at], expected)
        assert part.kits.beside == other.kits.beside
