"""What a link says of a case is the case."""

from pathlib import Path

import pytest

from sdt_kg.errors import InputError
from sdt_kg.load import load_twin
from services.edits import parse_edit
from services.requests import listed_states, parse_base, parse_friction, parse_state
from services.viewer.choice import Choice, Obstacle, free_name, wanted
from tests.small import FOLDER


def test_a_link_says_to_the_last_digit_where_base_and_doors_are() -> None:
    base, opened = (1 / 3, -12.3456789, 1e-7), {"left door": 0.1 + 0.2, "drawer": 0.25}
    choice = Choice("b", "pr2", container="left door", base=base, opened=opened, friction=0.1 + 0.2)
    said = wanted(choice.link().replace("?", "/").replace("&", ";"))
    assert parse_base(said["base"]) == base
    assert listed_states(said["state"]) == list(choice.place().states)
    assert (said["task"], said["tee"]) == ("open:left door", "D_artic")
    assert parse_friction(said["friction"]) == choice.question().friction == 0.1 + 0.2


def test_a_link_says_nothing_of_fingers_where_nothing_is_asked_of_them() -> None:
    assert "friction" not in Choice("b", "pr2").link()
    for wrong in ("0", "-1", "11", "nan", "much", "0_5"):
        with pytest.raises(InputError, match=r"is no coefficient of friction; allowed: 0\.01 to 10"):
            parse_friction(wrong)


def test_a_link_names_containers_with_a_comma(tmp_path: Path) -> None:
    kitchen = tmp_path / "a.urdf"
    kitchen.write_text((FOLDER / "a.urdf").read_text().replace("low_drawer", "low, left drawer"))
    twin = load_twin(str(kitchen))
    opened = {"low, left drawer": 0.25, "swing_door": 0.5}
    said = wanted(Choice("a", "pr2", opened=opened).link().replace("?", "/").replace("&", ";"))
    state = parse_state(twin, listed_states(said["state"]))
    at = {each.name: state[each.active_joint] for each in twin.containers()}
    assert {name: at[name] for name in opened} == opened


@pytest.mark.parametrize(
    ("text", "states"),
    [
        ("", []),
        ("all=open", ["all=open"]),
        ("a, b=closed , c=1e-3,", ["a, b=closed", "c=1e-3"]),
        ("a=1,b", ["a=1", "b"]),
        ("=1,a=2", ["=1", "a=2"]),
    ],
)
def test_states_are_listed_with_commas(text: str, states: list[str]) -> None:
    assert listed_states(text) == states


@pytest.mark.parametrize(
    ("other", "name"), [("", "obstacle"), ("obstacle", "obstacle2"), ("obstacle_obstacle", "obstacle2")]
)
def test_a_box_has_a_name_that_nothing_in_the_kitchen_has(tmp_path: Path, other: str, name: str) -> None:
    kitchen, text = tmp_path / "a.urdf", (FOLDER / "a.urdf").read_text()
    joint = f'<joint name="j" type="fixed"><parent link="room"/><child link="{other}"/></joint>'
    more = f'<link name="{other}"/>{joint}</robot>' if other else "</robot>"
    kitchen.write_text(text.replace("</robot>", more))
    twin = load_twin(str(kitchen))
    assert free_name(twin) == name
    edit = parse_edit(twin, Obstacle((0.1, 0.1, 0.1), 1.0, 1.0, name=name).edit())
    assert name in {each.name for each in edit.applied(twin).mechanism(twin.environment).bodies}
