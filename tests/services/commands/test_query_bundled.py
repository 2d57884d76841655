"""`sdt query`: the queries that come with the ontology, listed and by name."""

from collections.abc import Callable

import pytest

import ontology
from services.commands.exits import Exit
from tests.services.conftest import Done

Sdt = Callable[..., Done]
DOOR = "container=b/body/iai_fridge_door"


def test_every_query_is_listed_with_its_question(sdt: Sdt) -> None:
    rows = sdt("query", "--list", "--json").json
    assert [each["query"] for each in rows] == sorted(
        each.stem for each in ontology.path("queries").glob("*.rq")
    )
    (asked,) = (each for each in rows if each["query"].startswith("cq10"))
    assert asked["known"] == "nothing, or ?environment"
    assert asked["question"].endswith("?")
    assert "cq10_which_containers_does_a_kitchen_have" in sdt("query", "--list").out


@pytest.mark.parametrize("name", ["joint_of_container", "joint_of"])
def test_a_query_is_asked_by_its_name_or_how_only_it_begins(sdt: Sdt, name: str) -> None:
    (row,) = sdt("query", "b", "-f", name, "--known", DOOR, "--json").json
    assert row["joint"] == "https://example.org/id/b/joint/iai_fridge_door_joint"


def test_a_whole_name_with_which_others_begin_is_meant(sdt: Sdt) -> None:
    assert sdt("query", "b", "-f", "open").code == Exit.DONE


@pytest.mark.parametrize(
    ("name", "said"), [("cq1", "cq10_which_containers_does_a_kitchen_have, cq11_"), ("cq99", "no query that")]
)
def test_a_name_of_several_or_of_none_is_told(sdt: Sdt, name: str, said: str) -> None:
    done = sdt("query", "b", "-f", name)
    assert done.code == Exit.BAD_INPUT
    assert f"there is no file '{name}', and {said}" in done.err


def test_without_anything_to_ask_the_list_is_named(sdt: Sdt) -> None:
    done = sdt("query")
    assert done.code == Exit.BAD_INPUT
    assert "there is nothing to ask" in done.err
    assert "sdt query --list" in done.err
