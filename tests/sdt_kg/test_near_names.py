"""Which known names an unknown one is told to be near to."""

import pytest

from sdt_kg.errors import UnknownEntityError


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


def test_three_names_are_proposed_at_most_the_nearest_first() -> None:
    known = ("door_5", "door_44", "doar", "door_333")
    assert UnknownEntityError("joint", "door", known).near == ["door_5", "doar", "door_44"]
