"""A state names a container: of two doors that move together that one which is open. It names none twice."""

from pathlib import Path

import pytest

from sdt_kg.errors import InputError
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.requests import parse_state

DOOR = """<link name="{0}_door"/><link name="{0}_handle"/>
<joint name="{0}_handle_joint" type="fixed"><parent link="{0}_door"/><child link="{0}_handle"/></joint>
<joint name="{0}_door_joint" type="revolute"><parent link="world"/><child link="{0}_door"/><axis xyz="0 0 1"/>
<limit lower="0" upper="1.4" velocity="1" effort="1"/>{1}</joint>"""
OPPOSITE = '<mimic joint="a_door_joint" multiplier="-1" offset="1.4"/>'


def pair(folder: Path) -> Twin:
    doors = DOOR.format("a", "") + DOOR.format("b", OPPOSITE)
    (folder / "pair.urdf").write_text(f'<robot name="pair"><link name="world"/>{doors}</robot>')
    return load_twin(folder / "pair.urdf")


@pytest.mark.parametrize(
    ("text", "at"),
    [
        ("a_door=open", (1.4, 0.0)),
        ("b_door=open", (0.0, 1.4)),
        ("a_door=closed", (0.0, 1.4)),
        ("b_door=closed", (1.4, 0.0)),
        ("a_door_joint=open", (1.4, 0.0)),
        ("b_door_joint=open", (0.0, 1.4)),
        ("b_door_joint=0.4", (1.0, 0.4)),
    ],
)
def test_of_two_doors_the_named_one_is_open(tmp_path: Path, text: str, at: tuple[float, float]) -> None:
    twin = pair(tmp_path)
    state = parse_state(twin, [text])
    assert tuple(state[twin.container(each).joint] for each in ("a_door", "b_door")) == pytest.approx(at)


@pytest.mark.parametrize(
    "texts",
    [
        ("a_door=0.3", "a_door=0.5"),
        ("a_door=0.3", "a_door_joint=0.5"),
        ("a_door=open", "b_door=open"),
        ("a_door=0.3", "all=closed"),
        ("a_door=0.3", "b_door_joint=1.4"),
        ("b_door_joint=1.4", "a_door_joint=0.3"),
    ],
)
def test_a_state_that_puts_a_joint_at_two_places_is_refused(tmp_path: Path, texts: tuple[str, str]) -> None:
    with pytest.raises(InputError, match=f"'{texts[0]}' and '{texts[1]}' put one joint at two places"):
        parse_state(pair(tmp_path), texts)


def test_a_joint_may_be_elsewhere_than_all_and_be_told_twice_where_it_is(tmp_path: Path) -> None:
    twin = pair(tmp_path)
    state = parse_state(twin, ["all=closed", "a_door=0.3", "a_door_joint=0.3"])
    assert state[twin.container("a_door").joint] == pytest.approx(0.3)


def test_a_joint_that_follows_may_be_elsewhere_than_all(tmp_path: Path) -> None:
    twin = pair(tmp_path)
    state = parse_state(twin, ["all=closed", "b_door_joint=1.4"])
    assert state[twin.container("a_door").joint] == 0.0


def test_a_door_that_turns_round_and_round_stays_where_all_others_open(tmp_path: Path) -> None:
    """It is out of scope, and is no reason to tell nothing of the others."""
    doors = DOOR.format("a", "") + DOOR.format("b", "").replace("revolute", "continuous")
    (tmp_path / "round.urdf").write_text(f'<robot name="round"><link name="world"/>{doors}</robot>')
    twin = load_twin(tmp_path / "round.urdf")
    for text in ("all=open", "all=half-open:3"):
        state = parse_state(twin, [text])
        assert state[twin.container("a_door").joint] > 0
        assert state[twin.container("b_door").joint] == 0
    with pytest.raises(InputError, match="'b_door=open' has no limit to be at"):
        parse_state(twin, ["b_door=open"])
