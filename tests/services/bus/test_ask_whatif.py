"""`sdt ask TWIN whatif`: answer, words and exit code of `sdt whatif`, and what it cannot be asked."""

import csv
import json
import re

import pytest

from sdt_kg.errors import InputError
from services.bus.client import Connection
from services.bus.server import Server
from services.commands.exits import Exit
from services.judging.problems import RequestError

pytestmark = pytest.mark.oracle

CONTAINER = "iai_fridge_door"
TASK = f"open:{CONTAINER}"
CASE = ("--kitchen", "b", "--robot", "pr2", "--task", TASK)


def test_another_world_is_told_in_the_same_words(sdt, bus: tuple[str, Server]) -> None:
    edits = ("--edit", f"jam:{CONTAINER}", "--edit", "drive:fixed")
    there = sdt("ask", "b", "whatif", TASK, *edits, "--connect", bus[0])
    here = sdt("whatif", *CASE, *edits)
    assert (there.code, here.code) == (Exit.ABSTAINED, Exit.ABSTAINED)
    assert there.out == here.out
    assert "the outcome turns" in there.out


def test_the_smallest_share_is_told_in_the_same_words(sdt, bus: tuple[str, Server]) -> None:
    edit = ("--edit", f"move:{CONTAINER}=1.5", "--turn")
    there = sdt("ask", "b", "whatif", TASK, *edit, "--connect", bus[0])
    here = sdt("whatif", *CASE, *edit)
    assert (there.code, there.out) == (Exit.DONE, here.out)


def test_another_robot_that_is_certified_ends_with_done(sdt, bus: tuple[str, Server]) -> None:
    asked = ("ask", "b", "whatif", TASK, "--edit", "robot:stretch", "--json", "--connect", bus[0])
    done = sdt(*asked)
    found = json.loads(done.out)
    assert (done.code, found["counterfactual"]["outcome"]) == (Exit.DONE, "certified")
    assert [found[world]["robot"] for world in ("actual", "counterfactual")] == ["pr2", "stretch"]


def test_a_grid_is_told_in_the_same_words(sdt, bus: tuple[str, Server]) -> None:
    edits = ("--grid", "--edit", f"jam:{CONTAINER} | drive:fixed")
    there = sdt("ask", "b", "whatif", TASK, *edits, "--connect", bus[0], "--seed", "3")
    here = sdt("whatif", *CASE, *edits, "--seed", "3")
    assert (there.code, here.code) == (Exit.DONE, Exit.DONE)
    assert same(there.out) == same(here.out)
    assert "what turns:" in there.out
    asked = ("ask", "b", "whatif", TASK, *edits, "--connect", bus[0])
    rows = list(csv.DictReader(sdt(*asked, "--csv").out.splitlines()))
    assert [each["edits"] for each in rows] == ["as it is", f"jam:{CONTAINER}", "drive:fixed"]
    assert [each["outcome"] for each in json.loads(sdt(*asked, "--json").out)["cells"]] == [
        each["outcome"] for each in rows
    ]


def same(told: str) -> list[str]:
    """The words of a grid without the time, and without where outcomes are from: servers keep verdicts."""
    return [line for line in told.splitlines() if not re.search(r"cases in|^ +\d+  |without a search", line)]


def test_the_smallest_change_that_nobody_named_is_told_in_the_same_words(
    sdt, bus: tuple[str, Server]
) -> None:
    how = ("--state", f"{CONTAINER}=open", "--turn", "--within", "3")
    there = sdt("ask", "b", "whatif", TASK, *how, "--connect", bus[0])
    here = sdt("whatif", *CASE, *how)
    assert (there.code, here.code) == (Exit.NO, Exit.NO)
    asked = [[line for line in done.out.splitlines() if line.endswith("?")] for done in (there, here)]
    assert asked[0][:5] == asked[1][:5]
    assert there.out.splitlines()[:2] == here.out.splitlines()[:2]
    assert f"not_certified  {TASK}  pr2 in b" in there.out
    assert "0 of " in there.out


def test_python_asks_for_the_smallest_change_and_for_a_grid(connection: Connection) -> None:
    found = connection.whatif(TASK, (), "pr2", f"{CONTAINER}=open", turn=True, within=1.0)
    assert {each["family"] for each in found["families"]} >= {"which robot", "which drive"}
    grid = connection.whatif("open", [f"jam:{CONTAINER}"], "pr2", "all=open", grid=True)
    assert {each["why"].partition(":")[0] for each in grid["cells"] if each["edits"] == "as it is"} == {
        "nothing to cause"
    }
    for wrong in ({"within": 0.0}, {"grid": True, "turn": True}):
        with pytest.raises(InputError, match=r"within|two questions"):
            connection.whatif(TASK, ["drive:fixed"], **wrong)


def test_what_whatif_cannot_be_asked_is_said_before_it_is_sent(sdt, bus: tuple[str, Server]) -> None:
    for nothing in ((), ("--grid",)):
        none = sdt("ask", "b", "whatif", TASK, *nothing, "--connect", bus[0])
        assert (none.code, "whatif asks about no other world" in none.err) == (Exit.BAD_INPUT, True)
    two = sdt("ask", "b", "whatif", TASK, "--grid", "--turn", "--edit", "drive:fixed", "--connect", bus[0])
    assert (two.code, "a grid and a turn are two questions" in two.err) == (Exit.BAD_INPUT, True)
    other = sdt("ask", "b", "achieve", TASK, "--edit", "drive:fixed", "--connect", bus[0])
    assert (other.code, "--edit says nothing to achieve" in other.err) == (Exit.BAD_INPUT, True)
    kinds = sdt("ask", "b", "whatif", TASK, "--edit", "help", "--connect", bus[0])
    assert (kinds.code, "box:NAME=" in kinds.out, "mesh:" in kinds.out) == (Exit.DONE, True, False)


def test_a_file_that_an_edit_names_is_not_read(connection: Connection) -> None:
    with pytest.raises(RequestError, match="names a file"):
        connection.whatif(TASK, ["mesh:m=/etc/m.stl@1,0,0"])
    with pytest.raises(RequestError, match="no robot named"):
        connection.whatif(TASK, ["robot:/etc/robot.urdf"])


@pytest.mark.parametrize("asked", [("whatif", TASK, "--turn"), ("construct", "CONSTRUCT WHERE {}")])
def test_csv_is_of_answers_with_rows(sdt, asked: tuple[str, ...]) -> None:
    done = sdt("ask", "b", *asked, "--csv")
    assert done.code == Exit.BAD_INPUT
    assert "--csv says nothing to" in done.err
