"""A first annotation: it loads, its grippers are near the hand-made ones, and it says what to check."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.describe import describe
from sdt_kg.describe.tree import Tree
from sdt_kg.load import bundled, load_twin
from tests.sdt_kg.conftest import Write, joint, limit, link


@pytest.fixture(params=["pr2", "tiago_dual", "stretch"])
def described(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[str, Path]:
    path = tmp_path / "mine.urdf"
    shutil.copy(bundled("robot", request.param), path)
    path.with_suffix(".ttl").write_text(describe(path, lambda _: []), encoding="utf-8")
    return request.param, path


def test_the_grippers_are_near_the_hand_made_ones(described: tuple[str, Path]) -> None:
    robot, path = described
    twin, ours = load_twin("b", [path]), load_twin("b", [robot])
    guessed, known = twin.robot(twin.robots[0]).grippers, ours.robot(ours.robots[0]).grippers
    assert len(guessed) == len(known)
    tree = Tree(ours.mechanism(ours.robots[0]))
    for one, other in zip(guessed, known, strict=True):
        assert set(one.fingers) >= set(other.fingers)
        assert {finger.joint for finger in one.finger_joints} == {
            finger.joint for finger in other.finger_joints
        }
        root = tree.mechanism.root
        root_T_one = tree.frame(one.tool_body, root, {}) @ one.tool.matrix()
        root_T_other = tree.frame(other.tool_body, root, {}) @ other.tool.matrix()
        assert (
            np.linalg.norm(root_T_one[:3, 3] - root_T_other[:3, 3]) < 0.06
        )  # along the fingers; across them it is exact
        assert root_T_one[:3, 0] @ root_T_other[:3, 0] > np.cos(np.radians(15))
        assert abs(root_T_one[:3, 1] @ root_T_other[:3, 1]) > np.cos(np.radians(15))


def test_joints_that_move_no_gripper_are_held(described: tuple[str, Path]) -> None:
    _, path = described
    twin = load_twin("b", [path])
    held = twin.robot(twin.robots[0]).held
    assert any("wheel" in name for name in held)
    assert not any("finger" in name or "wrist" in name or "arm_" in name for name in held)


def test_everything_that_was_guessed_says_check(described: tuple[str, Path]) -> None:
    _, path = described
    twin = load_twin("b", [path])
    notes = twin.robot(twin.robots[0]).notes
    assert len([note for note in notes if note.startswith("check: ")]) == 7


def test_pairs_that_always_touch_are_written(tmp_path: Path) -> None:
    path = tmp_path / "mine.urdf"
    shutil.copy(bundled("robot", "stretch"), path)
    text = describe(path, lambda mechanism: [("link_mast", mechanism.root)])
    path.with_suffix(".ttl").write_text(text, encoding="utf-8")
    twin = load_twin("b", [path])
    pairs = twin.robot(twin.robots[0]).allowed_contacts
    assert frozenset(("link_mast", twin.mechanism(twin.robots[0]).root)) in pairs


def test_a_robot_without_fingers_is_told_so(write: Write) -> None:
    path = write(
        link("base"), link("arm", '<box size="1 1 1"/>'), joint("j", "revolute", "base", "arm", limit(0, 1))
    )
    text = describe(path, lambda _: [])
    assert "check: no gripper was found" in text
    assert "hasGripper <" not in text


def test_fingers_close_until_their_tips_meet(write: Write) -> None:
    def finger(side: int) -> str:
        return joint(
            f"finger{side}", "prismatic", "palm", f"f{side}",
            f'<origin xyz="0.1 {0.05 * side} 0"/><axis xyz="0 {side} 0"/>{limit(-0.06, 0.0)}',
        )  # fmt: skip

    path = write(
        link("palm", '<box size="0.1 0.1 0.1"/>'),
        *(link(f"f{side}", '<box size="0.08 0.02 0.02"/>') for side in (1, -1)),
        finger(1), finger(-1),
        name="hand.urdf",
    )  # fmt: skip
    path.with_suffix(".ttl").write_text(describe(path, lambda _: []), encoding="utf-8")
    twin = load_twin("b", [path])
    (gripper,) = twin.robot(twin.robots[0]).grippers
    assert gripper.opening == pytest.approx(0.08, abs=1e-4)
    assert [finger.open for finger in gripper.finger_joints] == [0.0, 0.0]
    assert [finger.closed for finger in gripper.finger_joints] == pytest.approx([-0.04, -0.04], abs=1e-5)
    assert gripper.tool.position == pytest.approx((0.14, 0, 0), abs=0.03)


def test_a_gripper_opens_no_wider_than_a_handle_needs(tmp_path: Path) -> None:
    path = tmp_path / "mine.urdf"
    shutil.copy(bundled("robot", "stretch"), path)
    path.with_suffix(".ttl").write_text(describe(path, lambda _: []), encoding="utf-8")
    twin = load_twin("b", [path])
    (gripper,) = twin.robot(twin.robots[0]).grippers
    assert gripper.opening == pytest.approx(0.09, abs=2e-3)
    assert all(-0.05 < each.open < 0.5 for each in gripper.finger_joints)  # their limit is 0.6 rad
