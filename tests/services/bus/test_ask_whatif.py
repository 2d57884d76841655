"""`sdt ask TWIN whatif`: answer, words and exit code of `sdt whatif`, and what it cannot be asked."""

import json

import pytest

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


def test_what_whatif_cannot_be_asked_here_is_said_before_it_is_sent(sdt, bus: tuple[str, Server]) -> None:
    none = sdt("ask", "b", "whatif", TASK, "--turn", "--connect", bus[0])
    assert (none.code, "whatif asks about no other world" in none.err) == (Exit.BAD_INPUT, True)
    other = sdt("ask", "b", "achieve", TASK, "--edit", "drive:fixed", "--connect", bus[0])
    assert (other.code, "--edit says nothing to achieve" in other.err) == (Exit.BAD_INPUT, True)
    kinds = sdt("ask", "b", "whatif", TASK, "--edit", "help", "--connect", bus[0])
    assert (kinds.code, "box:NAME=" in kinds.out, "mesh:" in kinds.out) == (Exit.DONE, True, False)


def test_a_file_that_an_edit_names_is_not_read(connection: Connection) -> None:
    with pytest.raises(RequestError, match="names a file"):
        connection.whatif(TASK, ["mesh:m=/etc/m.stl@1,0,0"])
    with pytest.raises(RequestError, match="no robot named"):
        connection.whatif(TASK, ["robot:/etc/robot.urdf"])
