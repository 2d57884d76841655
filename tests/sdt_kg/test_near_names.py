"""Which known names an unknown one is told to be near to."""

import pytest

from sdt_kg.errors import ALIKE, UnknownEntityError


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("pr3", ["pr2"]),
        ("p2", ["pr2"]),
        ("rp2", ["pr2"]),
        ("prr2", ["pr2"]),
        ("pr", ["pr2"]),
        ("tiago", ["tiago_dual"]),
        ("oven", ["oven_area_oven_door"]),
        ("artic", ["d_artic"]),
        ("strech", ["stretch"]),
        ("c", []),
        ("bb", []),
        ("pan", []),
        ("door", []),
        ("drive", []),
        ("trial", []),
    ],
)
def test_for_a_short_name_only_what_it_begins_or_is_but_for_a_slip_is_proposed(
    name: str, near: list[str]
) -> None:
    known = ("a", "b", "d_artic", "oven_area_oven_door", "pr2", "stretch", "tiago_dual")
    error = UnknownEntityError("thing", name, known)
    assert error.near == near
    assert ("did you mean" in str(error)) == bool(near), "else all are listed"
    assert ("allowed: a, b, d_artic" in str(error)) != bool(near)


def test_that_a_name_is_a_joint_s_is_no_likeness() -> None:
    stretch = ("camera_joint", "caster_joint", "joint_lift", "joint_wrist_roll")
    assert UnknownEntityError("joint", "torso_lift_joint", stretch).near == ["joint_lift"]
    assert UnknownEntityError("joint", "panda_3_joint", stretch).near == []
    assert UnknownEntityError("joint", "wrist_rol", stretch).near == ["joint_wrist_roll"]
    assert UnknownEntityError("joint", "torso_lift_joint", stretch, alike=ALIKE).near == []
    assert UnknownEntityError("joint", "lift_jnt", ("lift_joint", "tilt_joint"), alike=ALIKE).near == [
        "lift_joint"
    ]
    both = ("door_joint", "door")
    assert UnknownEntityError("joint or container", "dooor_joint", both).near == ["door", "door_joint"]


def test_three_names_are_proposed_at_most_the_nearest_first() -> None:
    known = ("door_5", "door_44", "doar", "door_333")
    assert UnknownEntityError("joint", "door", known).near == ["door_5", "doar", "door_44"]
