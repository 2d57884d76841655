"""A state names a container: of two doors that move together it is that one which is open."""

from pathlib import Path

import pytest

from sdt_kg.load import load_twin
from services.requests import parse_state

DOOR = """<link name="{0}_door"/><link name="{0}_handle"/>
<joint name="{0}_handle_joint" type="fixed"><parent link="{0}_door"/><child link="{0}_handle"/></joint>
<joint name="{0}_door_joint" type="revolute"><parent link="world"/><child link="{0}_door"/><axis xyz="0 0 1"/>
<limit lower="0" upper="1.4" velocity="1" effort="1"/>{1}</joint>"""
OPPOSITE = '<mimic joint="a_door_joint" multiplier="-1" offset="1.4"/>'


@pytest.mark.parametrize(
    ("text", "at"),
    [
        ("a_door=open", (1.4, 0.0)),
        ("b_door=open", (0.0, 1.4)),
        ("a_door=closed", (0.0, 1.4)),
        ("b_door=closed", (1.4, 0.0)),
        ("a_door_joint=open", (1.4, 0.0)),
    ],
)
def test_of_two_doors_the_named_one_is_open(tmp_path: Path, text: str, at: tuple[float, float]) -> None:
    doors = DOOR.format("a", "") + DOOR.format("b", OPPOSITE)
    (tmp_path / "pair.urdf").write_text(f'<robot name="pair"><link name="world"/>{doors}</robot>')
    twin = load_twin(tmp_path / "pair.urdf")
    state = parse_state(twin, [text])
    assert tuple(state[twin.container(each).joint] for each in ("a_door", "b_door")) == pytest.approx(at)
