"""`sdt query --compute`: what is missing is run first, and what was run and left out is said."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.services.conftest import Done

SMALL = Path(__file__).resolve().parents[2] / "small"
KITCHEN, ROBOT = str(SMALL / "b.urdf"), str(SMALL / "pr2.urdf")
CLOSED = "SELECT ?c { ?v law:container ?c ; law:task/law:verb law:Close ; law:causes false }"


def test_rows_and_what_was_computed_come_as_json(sdt: Callable[..., Done], tmp_path: Path) -> None:
    store = str(tmp_path / "store")
    command = ("query", store, CLOSED, "--compute", "--kitchen", KITCHEN, "--robot", ROBOT, "--jobs", "1")
    first = sdt(*command, "--limit", "1", "--json").json
    assert [each["container"] for each in first["computed"]["ran"]] == ["oven_door"]
    assert [each["container"] for each in first["computed"]["left_out"]] == ["top_drawer"]
    assert len(first["rows"]) == 1
    again = sdt(*command)
    assert "computed 1 verdicts" in again.err
    assert "1 were stored" in again.err
    assert sdt("query", store, CLOSED, "--json").json == sdt(*command, "--json").json["rows"]


def test_what_is_about_another_kitchen_of_that_name_is_told(sdt: Callable[..., Done], tmp_path: Path) -> None:
    other, store = tmp_path / "b.urdf", str(tmp_path / "store")
    other.write_text(Path(KITCHEN).read_text(encoding="utf-8").replace('velocity="1"', 'velocity="0.9"'))
    for kitchen, besides in ((KITCHEN, {}), (str(other), {"about_other_models": 2})):
        command = ("query", store, CLOSED, "--compute", "--kitchen", kitchen, "--robot", ROBOT, "--jobs", "1")
        done = sdt(*command, "--json")
        assert done.json["computed"]["besides"] == besides
    assert "2 verdicts there are about other models: a query that names no input counts them too" in done.err


def test_a_kitchen_is_asked_with_verdicts_that_are_not_kept(sdt: Callable[..., Done]) -> None:
    done = sdt("query", KITCHEN, CLOSED, "--compute", "--robot", ROBOT, "--jobs", "1", "--csv")
    assert len(done.out.splitlines()) == 3
    door = "SELECT ?door { ?door a sdt:Door }"
    assert (
        sdt("query", KITCHEN, door, "--compute", "--csv").out
        == "door\nhttps://example.org/id/b/body/oven_door\n"
    )


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((KITCHEN, CLOSED, "--robot", ROBOT), "--robot without --compute"),
        ((KITCHEN, CLOSED, "--compute", "--kitchen", "a"), "is a kitchen, and --kitchen names more"),
        ((KITCHEN, "SELECT * { ?v law:robot", "--compute"), "not SPARQL"),
        ((KITCHEN, "INSERT DATA { id:a a law:Verdict }", "--compute"), "not SPARQL that reads"),
        ((KITCHEN, CLOSED, "--compute", "--robot", "zzz"), "no robot named 'zzz'"),
        (("{folder}/no/such/place.trig", CLOSED, "--compute"), "place.trig"),
    ],
)
def test_nonsense_is_refused(
    sdt: Callable[..., Done], tmp_path: Path, arguments: tuple[str, ...], said: str
) -> None:
    done = sdt("query", *(each.replace("{folder}", str(tmp_path)) for each in arguments))
    assert done.code == 2
    assert said in done.err
    assert "Traceback" not in done.err
