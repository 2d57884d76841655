"""A first annotation: it loads, its grippers are near the hand-made ones, and it says what to check."""

import itertools
import shutil
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.annotation import Drive, RobotAnnotation
from sdt_kg.describe import guessed, turtle
from sdt_kg.describe.tree import Tree
from sdt_kg.load import bundled, load_twin
from sdt_kg.urdf import read_mechanism
from tests.sdt_kg.conftest import Write, joint, limit, link


def guess(path: Path) -> RobotAnnotation:
    return guessed(read_mechanism(path))


def annotate(path: Path) -> Path:
    path.with_suffix(".ttl").write_text(turtle(guess(path), path.name), encoding="utf-8")
    return path


@pytest.fixture(params=["pr2", "tiago_dual", "stretch"])
def described(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[str, Path]:
    path = tmp_path / "mine.urdf"
    shutil.copy(bundled("robot", request.param), path)
    return request.param, annotate(path)


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
        assert np.linalg.norm(root_T_one[:3, 3] - root_T_other[:3, 3]) < 0.01
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
    assert len(notes) > 5
    assert all(note.startswith("check: ") for note in notes)


def test_a_robot_without_fingers_is_told_so(write: Write) -> None:
    path = write(
        link("base"), link("arm", '<box size="1 1 1"/>'), joint("j", "revolute", "base", "arm", limit(0, 1))
    )
    text = turtle(guess(path), path.name)
    assert "check: no gripper was found" in text
    assert "the longest row of joints ends in 'arm'" in text
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
    annotate(path)
    twin = load_twin("b", [path])
    (gripper,) = twin.robot(twin.robots[0]).grippers
    assert gripper.opening == pytest.approx(0.08, abs=1e-4)
    assert [finger.open for finger in gripper.finger_joints] == [0.0, 0.0]
    assert [finger.closed for finger in gripper.finger_joints] == pytest.approx([-0.04, -0.04], abs=1e-5)
    assert gripper.tool.position == pytest.approx((0.12, 0, 0), abs=1e-4)  # 20 mm behind the tips


def test_a_gripper_opens_no_wider_than_a_handle_needs(tmp_path: Path) -> None:
    path = tmp_path / "mine.urdf"
    shutil.copy(bundled("robot", "stretch"), path)
    annotate(path)
    twin = load_twin("b", [path])
    (gripper,) = twin.robot(twin.robots[0]).grippers
    assert gripper.opening == pytest.approx(0.09, abs=2e-3)
    assert all(-0.05 < each.open < 0.5 for each in gripper.finger_joints)  # their limit is 0.6 rad


WHEEL = '<cylinder radius="0.1" length="0.05"/>'


def wheel(name: str, x: float, y: float, parent: str = "base", rpy: str = "1.5708 0 0") -> str:
    inside = f'<origin xyz="{x} {y} 0" rpy="{rpy}"/><axis xyz="0 0 1"/>{limit(0, 0)}'
    return link(name, WHEEL) + joint(f"{name}_joint", "continuous", parent, name, inside)


def steered(name: str, x: float, y: float, kind: str = "continuous") -> str:
    inside = f'<origin xyz="{x} {y} 0"/><axis xyz="0 0 1"/>{limit(-0.5, 0.5)}'
    return (
        link(f"{name}_fork")
        + joint(f"{name}_fork_joint", kind, "base", f"{name}_fork", inside)
        + wheel(name, 0, 0, f"{name}_fork")
    )


BODY = link("base", '<box size="0.5 0.4 0.1"/>')
BESIDE = wheel("left", 0, 0.25), wheel("right", 0, -0.25)
CORNERS = [(x, y) for x in (0.2, -0.2) for y in (0.2, -0.2)]
DRIVES = {
    "two wheels beside": (BESIDE, Drive.DIFFERENTIAL, "turn about one line"),
    "wheels without shapes": (
        [
            wheel(f"wheel_{k}", 0, y)
            .replace(WHEEL, "")
            .replace("<collision><geometry></geometry></collision>", "")
            for k, y in enumerate((0.25, -0.25))
        ],
        Drive.DIFFERENTIAL,
        "'wheel_0', 'wheel_1' turn about one line",
    ),
    "casters too": ((*BESIDE, steered("caster", 0.2, 0)), Drive.DIFFERENTIAL, "turn about one line"),
    "four that do not steer": (
        [wheel(f"w{k}", *at) for k, at in enumerate(CORNERS)],
        Drive.DIFFERENTIAL,
        "if they roll sideways too, it is sdt:Omni",
    ),
    "mecanum": ([wheel(f"mecanum_{k}", *at) for k, at in enumerate(CORNERS)], Drive.OMNI, "named as ones"),
    "three about": (
        [wheel("w0", 0.2, 0, rpy="0 1.5708 0"), wheel("w1", -0.1, 0.2, rpy="1.5708 0 0.5")],
        Drive.OMNI,
        "several directions",
    ),
    "all steer": ([steered(f"w{k}", *at) for k, at in enumerate(CORNERS)], Drive.OMNI, "'w0_fork_joint'"),
    "a car": (
        (*BESIDE, steered("w0", 0.3, 0.2, "revolute"), steered("w1", 0.3, -0.2, "revolute")),
        Drive.FIXED,
        "no drive here is a car's",
    ),
    "wheels across": (
        (wheel("front", 0.25, 0, rpy="0 1.5708 0"), wheel("back", -0.25, 0, rpy="0 1.5708 0")),
        Drive.FIXED,
        "sdt:baseBody",
    ),
    "wheels aslant": (
        (wheel("left", 0, 0.25, rpy="1.5708 0 0.1"), wheel("right", 0, -0.25, rpy="1.5708 0 0.1")),
        Drive.FIXED,
        "sdt:baseBody",
    ),
    "none": ((), Drive.FIXED, "no wheel was found"),
    "fixed ones": (
        [wheel("left_wheel", 0, 0.25).replace('"continuous"', '"fixed"')],
        Drive.FIXED,
        "'left_wheel' are named as wheels, and fixed: if it drives on them, say how",
    ),
}


@pytest.mark.parametrize("wheels", DRIVES)
def test_the_drive_follows_from_the_wheels(write: Write, wheels: str) -> None:
    parts, drive, said = DRIVES[wheels]
    robot = guess(write(BODY, *parts))
    assert robot.drive is drive
    assert any(note.startswith("check: the base") and said in note for note in robot.notes)


def test_a_robot_with_another_up_is_told_to_lie_on_its_side(write: Write) -> None:
    sides = (wheel(f"{side}_wheel", 0, 0, rpy="0 0 0") for side in ("left", "right"))
    notes = guess(write(BODY, *sides)).notes
    assert any("'left_wheel', 'right_wheel' turn about an upright line" in note for note in notes)


def test_a_base_frame_at_the_axles_stands_a_wheel_above_the_floor(write: Write) -> None:
    assert guess(write(BODY, *BESIDE)).base_height == pytest.approx(0.1, abs=1e-4)


AHEAD = wheel("left", 0.1, 0.25), wheel("right", 0.1, -0.25)


def test_a_base_whose_root_is_not_amid_its_wheels_is_that_of_a_link_there(write: Write) -> None:
    at = '<origin xyz="0.1 0 0.05"/>'
    robot = guess(write(BODY, *AHEAD, link("axle"), joint("axle_joint", "fixed", "base", "axle", at)))
    assert (robot.drive, robot.base_body) == (Drive.DIFFERENTIAL, "axle")
    assert robot.base_height == pytest.approx(0.15, abs=1e-4)  # a wheel's radius, and its own height


def test_a_base_with_no_link_amid_its_wheels_is_asked_for_one(write: Write) -> None:
    robot = guess(write(BODY, *AHEAD))
    assert (robot.drive, robot.base_body) == (Drive.FIXED, "base")
    assert any("0.100 m before the root frame" in note for note in robot.notes)


@pytest.mark.parametrize("rpy", ["3.14159265 0 0", "0.02 0 0", "0 0.02 0", "0 0 0.02"])
def test_a_link_amid_the_wheels_that_lies_aslant_is_no_base(write: Write, rpy: str) -> None:
    # An inertial sensor is mounted upside down, and the robot would be with it.
    at = f'<origin xyz="0.1 0 0.05" rpy="{rpy}"/>'
    robot = guess(write(BODY, *AHEAD, link("imu"), joint("imu_joint", "fixed", "base", "imu", at)))
    assert (robot.drive, robot.base_body) == (Drive.FIXED, "base")


@pytest.mark.parametrize(("given", "speed"), [(0.4, 0.4), (100.0, 0.2)])  # 100 stands for no limit
def test_joints_that_stand_for_the_drive_give_its_speed_and_are_held(
    write: Write, given: float, speed: float
) -> None:
    planar = ""
    for name, kind, parent, child, axis in (
        ("x", "prismatic", "world", "along", "1 0 0"),
        ("y", "prismatic", "along", "aside", "0 1 0"),
        ("yaw", "revolute", "aside", "base", "0 0 1"),
    ):
        planar += joint(name, kind, parent, child, f'<axis xyz="{axis}"/>{limit(-9.0, 9.0, given)}')
    robot = guess(write(link("world"), link("along"), link("aside"), BODY, planar, *BESIDE))
    assert robot.drive is Drive.OMNI
    assert robot.base_body == "world"
    assert {"x", "y", "yaw"} <= set(robot.held)
    assert (robot.base_limits.linear_velocity, robot.base_limits.angular_velocity) == (speed, speed)


def arm(*ends: str) -> tuple[str, ...]:
    """Three joints in a row, then a palm with these."""
    names = ("base", "upper", "lower", "palm")
    parts = [BODY]
    for k, (parent, child) in enumerate(itertools.pairwise(names)):
        parts.append(link(child, '<box size="0.1 0.1 0.1"/>'))
        inside = f'<origin xyz="0.2 0 0"/><axis xyz="0 0 1"/>{limit(-1.0, 1.0)}'
        parts.append(joint(f"j{k}", "revolute", parent, child, inside))
    return (*parts, *ends)


def slides(name: str, side: int, axis: int, ends: tuple[float, float] = (0.0, 0.04), mimic: str = "") -> str:
    inside = f'<origin xyz="0.1 {0.01 * side} 0"/><axis xyz="0 {axis} 0"/>{limit(*ends)}{mimic}'
    return link(name, '<box size="0.1 0.02 0.02"/>') + joint(
        f"{name}_slide", "prismatic", "palm", name, inside
    )


def test_what_hangs_on_fixed_joints_of_an_arm_stands_on_the_floor(write: Write) -> None:
    # Baxter's pedestal hangs on its torso, which a fixed joint of each arm's chain carries.
    pedestal = link("pedestal", '<box size="0.6 0.6 0.8"/>')
    pedestal += joint("pedestal_mount", "fixed", "base", "pedestal", '<origin xyz="0 0 -0.45"/>')
    root = link("world") + joint("mount", "fixed", "world", "base")
    path = write(root, *arm(slides("part_17", 1, 1), slides("part_18", -1, -1)), pedestal)
    assert guess(path).base_height == pytest.approx(0.85)


def test_fingers_are_found_at_the_end_of_an_arm_whatever_they_are_named(write: Write) -> None:
    path = write(*arm(slides("part_17", 1, 1), slides("part_18", -1, -1)))
    (gripper,) = guess(path).grippers
    assert gripper.fingers == ("part_17", "part_18")
    assert gripper.opening == pytest.approx(0.08)


def test_fingers_may_count_the_same_way(write: Write) -> None:
    path = write(*arm(slides("part_17", 1, 1), slides("part_18", -1, 1, (-0.04, 0.0))))
    (gripper,) = guess(path).grippers
    assert [(finger.open, finger.closed) for finger in gripper.finger_joints] == [
        (0.04, pytest.approx(0.0, abs=1e-6)),
        (-0.04, pytest.approx(0.0, abs=1e-6)),
    ]


def test_a_finger_may_follow_a_joint(write: Write) -> None:
    mimic = '<mimic joint="part_17_slide" multiplier="1"/>'
    path = write(*arm(slides("part_17", 1, 1), slides("part_18", -1, -1, mimic=mimic)))
    robot = guess(path)
    (gripper,) = robot.grippers
    assert [finger.joint for finger in gripper.finger_joints] == ["part_17_slide"]
    assert not any("follows" in note for note in robot.notes)


def test_what_follows_a_finger_beyond_its_own_limits_is_told(write: Write) -> None:
    mimic = '<mimic joint="part_17_slide" multiplier="-1"/>'
    shell = link("shell") + joint("shell_joint", "prismatic", "part_17", "shell", limit(0, 0.05) + mimic)
    notes = guess(write(*arm(slides("part_17", 1, 1), slides("part_18", -1, -1)), shell)).notes
    said = "check: 'shell_joint' follows 'part_17_slide' from -0.04 to "
    assert sum(note.startswith(said) and "beyond its own limits 0 to 0.05" in note for note in notes) == 1


@pytest.mark.parametrize(("kind", "ends"), [("continuous", (0.0, 0.0)), ("revolute", (-9.0, 9.0))])
def test_a_motor_goes_as_far_as_the_fingers_that_follow_it(
    write: Write, kind: str, ends: tuple[float, float]
) -> None:
    mimic = '<mimic joint="motor_joint" multiplier="-0.01" offset="0.04"/>'
    fingers = (slides(f"finger_{side}", side, side, mimic=mimic) for side in (1, -1))
    motor = joint("motor_joint", kind, "palm", "motor", f'<axis xyz="1 0 0"/>{limit(*ends)}')
    (gripper,) = guess(write(*arm(*fingers, link("motor"), motor))).grippers
    (finger,) = gripper.finger_joints
    assert (finger.joint, finger.open, finger.closed) == ("motor_joint", 0.0, pytest.approx(4.0, abs=1e-5))


def test_a_motor_without_an_end_moves_no_gripper_that_could_be_told(write: Write) -> None:
    mimic = '<mimic joint="motor_joint" multiplier="0"/>'
    fingers = (slides(f"finger_{side}", side, side, mimic=mimic) for side in (1, -1))
    motor = joint("motor_joint", "continuous", "palm", "motor", f'<axis xyz="1 0 0"/>{limit(0.0, 0.0)}')
    robot = guess(write(*arm(*fingers, link("motor"), motor)))
    assert any("no gripper was found" in note for note in robot.notes)


def test_a_wrist_that_fingers_follow_is_no_finger_joint(write: Write) -> None:
    fingers = (slides(f"finger_{side}", side, side, mimic='<mimic joint="j2"/>') for side in (1, -1))
    robot = guess(write(*arm(*fingers)))
    assert not robot.grippers
    assert any("no gripper was found" in note for note in robot.notes)


def test_a_single_finger_closes_on_a_body_that_stands_still(write: Write) -> None:
    still = link("fixed_jaw", '<box size="0.1 0.02 0.02"/>')
    still += joint("jaw_mount", "fixed", "palm", "fixed_jaw", '<origin xyz="0.1 -0.01 0"/>')
    robot = guess(write(*arm(slides("moving_jaw", 1, 1), still)))
    (gripper,) = robot.grippers
    assert gripper.fingers == ("fixed_jaw", "moving_jaw")
    assert any("'fixed_jaw' of gripper 'gripper' stands still" in note for note in robot.notes)


def test_a_single_finger_without_another_is_asked_about_by_name(write: Write) -> None:
    robot = guess(write(*arm(slides("moving_jaw", 1, 1))))
    assert not robot.grippers
    assert any("'moving_jaw_slide' moves a single finger" in note for note in robot.notes)


def test_joints_without_speed_are_held_and_named(write: Write) -> None:
    fingers = slides("part_17", 1, 1), slides("part_18", -1, -1)
    robot = guess(
        write(*(part.replace('velocity="1.0"', 'velocity="0"') for part in arm(*fingers)[:-2]), *fingers)
    )
    assert set(robot.held) == {"j0", "j1", "j2"}
    assert any(note.startswith("check: 'j0', 'j1', 'j2' would move a gripper") for note in robot.notes)


def test_a_telescope_is_one_motor() -> None:
    robot = guess(bundled("robot", "stretch"))
    assert robot.coupled == (("joint_arm_l3", "joint_arm_l2", "joint_arm_l1", "joint_arm_l0"),)
    assert not guess(bundled("robot", "pr2")).coupled
