"""What is guessed of a robot by looking: parked arms and pairs that touch; and what the guess is worth."""

import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.describe import guessed
from sdt_kg.load import bundled, load_twin
from sdt_kg.urdf import read_mechanism
from services.describing.describe import describe
from services.describing.touching import touching
from services.embodiment.body.demands import Margins, rules
from services.embodiment.body.limb import make_limb
from services.embodiment.body.world import World
from services.physics.model import Scene
from tests.services.conftest import Done
from tests.small import FOLDER

pytestmark = pytest.mark.oracle


@pytest.fixture(scope="module")
def mine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bundled Stretch as a robot of one's own, described."""
    path = tmp_path_factory.mktemp("mine") / "mine.urdf"
    shutil.copy(bundled("robot", "stretch"), path)
    path.with_suffix(".ttl").write_text(describe(path).text, encoding="utf-8")
    return path


def test_a_described_robot_opens_what_the_annotated_one_opens(mine: Path, sdt: Callable[..., Done]) -> None:
    words = "--kitchen", "b", "--robot", str(mine), "--drive", "omni"
    for container in ("iai_fridge_door", "sink_area_left_middle_drawer_main"):
        assert sdt("achieve", *words, "--task", f"open:{container}").code == 0


def test_a_parked_arm_is_free_within_limits_and_not_in_front(mine: Path) -> None:
    twin = load_twin("b", [mine])
    world = World(Scene(twin, twin.robots[0]))
    (gripper,) = world.scene.annotation.grippers
    limb = make_limb(world, gripper)
    demands = rules(world, limb, Margins(0.001, 0.001))
    alone = type(demands)(np.full_like(demands.environment, -1.0), demands.pairs, demands.own)
    assert world.free(limb.q(limb.parked), alone)
    assert (limb.lower < limb.parked).all()
    assert (limb.parked < limb.upper).all()
    hand = limb.tool(limb.parked)[1]
    assert abs(hand[0]) < 0.2  # x = 0.15 m is the front of its base
    assert np.linalg.norm(hand[:2]) < 0.3


def test_parts_of_a_telescope_may_touch_and_wheels_their_base_but_no_hand_the_mast(mine: Path) -> None:
    twin = load_twin("b", [mine])
    pairs = twin.robot(twin.robots[0]).allowed_contacts
    assert frozenset(("link_arm_l4", "link_arm_l2")) in pairs
    assert not any("link_mast" in pair and any("gripper" in body for body in pair) for pair in pairs)
    text = mine.with_suffix(".ttl").read_text(encoding="utf-8")
    assert "# check: parts of a telescope touch where it is drawn in" in text
    assert "# check: the fingers of one gripper close upon each other" in text


def test_each_allowed_pair_has_its_reason() -> None:
    mechanism = read_mechanism(bundled("robot", "stretch"))
    why = touching(mechanism, guessed(mechanism))
    assert len(why) > 5
    assert all(reason.startswith(("touch ", "parts of a telescope")) for reason in why.values())


SPAN = '<limit lower="-3.1" upper="3.1" velocity="1" effort="1"/>'


@pytest.mark.parametrize(("offset", "allowed"), [(0.2, False), (0.05, True)])
def test_a_hand_that_bends_back_onto_its_arm_collides_and_one_in_its_fork_does_not(
    tmp_path: Path, offset: float, allowed: bool
) -> None:
    box = '<collision><geometry><box size="0.18 0.18 0.18"/></geometry></collision>'
    joints = "".join(
        f'<joint name="j{k}" type="revolute"><parent link="b{k}"/><child link="b{k + 1}"/>'
        f'<origin xyz="{offset / 2} 0 0"/><axis xyz="{axis}"/>{SPAN}</joint>'
        for k, axis in enumerate(("0 0 1", "0 1 0"))
    )
    arm = f'<link name="b0">{box}</link><link name="b1"/><link name="b2">'
    arm += box.replace("<collision>", f'<collision><origin xyz="{offset / 2} 0 0"/>') + "</link>"
    (tmp_path / "arm.urdf").write_text(f'<robot name="arm">{arm}{joints}</robot>', encoding="utf-8")
    mechanism = read_mechanism(tmp_path / "arm.urdf")
    robot = replace(guessed(mechanism), held=(), acceleration={"j0": 1.0, "j1": 1.0})
    assert (frozenset(("b0", "b2")) in touching(mechanism, robot)) is allowed


def test_describe_says_what_it_guessed(tmp_path: Path, sdt: Callable[..., Done]) -> None:
    path = tmp_path / "my.urdf.xacro"
    shutil.copy(bundled("robot", "stretch"), path)
    done = sdt("robot", "describe", str(path))
    assert done.code == 0
    assert (tmp_path / "my.ttl").is_file()
    assert (
        "check: the base is taken to be sdt:Differential: wheels 'link_right_wheel', 'link_left_wheel'"
        in done.out
    )
    assert "check: the arm of gripper 'gripper' is parked" in done.out
    assert re.search(
        "check: nobody sees contact of [0-9]+ pairs .*: .*link_arm_l0 with link_arm_l4", done.out
    )
    assert sdt("doctor", "--kitchen", "b", "--robot", str(path)).code == 0


def test_of_a_kitchen_no_annotation_is_written(tmp_path: Path, sdt: Callable[..., Done]) -> None:
    path = tmp_path / "b.urdf"
    shutil.copy(bundled("kitchen", "b"), path)
    done = sdt("robot", "describe", str(path))
    assert (done.code, list(tmp_path.iterdir())) == (2, [path])
    named = (
        "fridge_area_lower_drawer_main, iai_fridge_door, kitchen_island_left_lower_drawer_main and 14 more"
    )
    assert f"{path} looks like a kitchen: it has no gripper, and containers ({named})" in done.err
    assert f"sdt containers {path}" in done.err


def test_a_robot_without_a_gripper_is_described_all_the_same(
    tmp_path: Path, sdt: Callable[..., Done]
) -> None:
    path = tmp_path / "bare.urdf"
    path.write_text('<robot name="bare"><link name="base"/></robot>', encoding="utf-8")
    done = sdt("robot", "describe", str(path))
    assert (done.code, path.with_suffix(".ttl").is_file()) == (0, True)
    assert "check: no gripper was found" in done.out


def test_describe_says_what_nothing_can_collide_with(tmp_path: Path, sdt: Callable[..., Done]) -> None:
    path = tmp_path / "seen.urdf"
    text = (FOLDER / "pr2.urdf").read_text(encoding="utf-8")
    head, lift, rest = re.split('(<link name="carriage">.*?</link>)', text, maxsplit=1, flags=re.DOTALL)
    path.write_text(head + lift.replace("collision>", "visual>") + rest, encoding="utf-8")
    done = sdt("robot", "describe", str(path))
    assert "no collision geometry, which nothing can collide with: carriage" in done.out


def test_a_robot_whose_arm_has_no_speed_gets_a_verdict_that_says_so(
    tmp_path: Path, sdt: Callable[..., Done]
) -> None:
    path = tmp_path / "slow.urdf"
    text = bundled("robot", "stretch").read_text(encoding="utf-8")
    path.write_text(re.sub('velocity="[^"]*"', 'velocity="0"', text), encoding="utf-8")
    path.with_suffix(".ttl").write_text(describe(path).text, encoding="utf-8")
    words = "--kitchen", "b", "--robot", str(path), "--drive", "omni", "--budget", "2"
    done = sdt("achieve", *words, "--task", "open:sink_area_left_middle_drawer_main")
    assert done.code == 1
    assert "would move a gripper, but have no velocity limit above 0 in the URDF" in done.out
