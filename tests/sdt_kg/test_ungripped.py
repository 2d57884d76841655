"""Where no gripper is found, describing a robot says what to repair: shapes, axes, or names."""

import pytest

from sdt_kg.describe import guessed
from sdt_kg.urdf import read_mechanism
from tests.sdt_kg.conftest import Write, joint, limit, link

PALM = '<box size="0.06 0.14 0.06"/>'
BAR = '<box size="0.08 0.012 0.02"/>'


def hand(left: str, right: str, shape: str, inside: str = "", names: str = "finger") -> tuple[str, ...]:
    """A hand on a wrist, whose two fingers slide along these axes."""
    shapes = [shape] if shape else []
    ends = [
        (
            link(f"{side}_{names}", *shapes),
            joint(
                f"{side}_joint",
                "prismatic",
                "gripper_wrist",
                f"{side}_{names}",
                f'<origin xyz="0.08 {at} 0"/><axis xyz="{axis}"/>{limit(0, 0.04)}{more}',
            ),
        )
        for side, at, axis, more in (("left", 0.006, left, ""), ("right", -0.006, right, inside))
    ]
    wrist = joint("wrist", "revolute", "base", "gripper_wrist", limit(-1, 1))
    return link("base", PALM), link("gripper_wrist", PALM), wrist, *(part for end in ends for part in end)


def told(write: Write, parts: tuple[str, ...]) -> str:
    robot = guessed(read_mechanism(write(*parts)))
    assert not robot.grippers
    (note,) = (note for note in robot.notes if "no gripper was found" in note)
    assert note.endswith("and describe the robot again, or add sdt:hasGripper as robots/README.md says")
    return note


def test_fingers_that_close_on_each_other_are_a_gripper(write: Write) -> None:
    (gripper,) = guessed(read_mechanism(write(*hand("0 1 0", "0 -1 0", BAR)))).grippers
    assert gripper.fingers == ("left_finger", "right_finger")


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        (
            hand("0 1 0", "0 -1 0", ""),
            "'left_finger', 'right_finger' would be fingers, but have no collision geometry to hold anything "
            "with. Give them one and",
        ),
        (
            hand("0 1 0", "0 -1 0", BAR, '<mimic joint="left_joint" multiplier="-1"/>'),
            "'left_finger', 'right_finger' would be fingers, but do not close on each other as their joints "
            "move. Repair axes, limits or mimic of these and",
        ),
        (
            (link("base"), link("cup", BAR), joint("j", "fixed", "base", "cup")),
            "A suction cup or a hook is none",
        ),
    ],
    ids=["without shape", "side by side", "suction"],
)
def test_what_is_missing_is_told(write: Write, parts: tuple[str, ...], said: str) -> None:
    assert said in told(write, parts)
