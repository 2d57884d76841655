"""`sdt ask`: what the shell shows of an answer on the bus, and how it ends."""

import re
from pathlib import Path

import pytest

from sdt_kg.iri import local_name
from services.bus.server import Server
from services.commands.exits import Exit
from tests.small import FOLDER

CONTAINER = "iai_fridge_door"


@pytest.mark.parametrize("form", [(), ("--csv",), ("--json",)])
def test_causes_is_told_and_ends_as_without_a_bus(
    sdt, bus: tuple[str, Server], form: tuple[str, ...]
) -> None:
    to = ("--connect", bus[0], *form)
    there, here = sdt("ask", "b", "causes", "open", *to), sdt("causes", "b", "--task", "open", *form)
    assert (there.code, here.code) == (Exit.DONE, Exit.DONE)
    assert there.out == here.out
    assert CONTAINER in there.out
    for more in (("--tee", "d_artic_dyn"), ("--state", f"{CONTAINER}=open")):
        there = sdt("ask", "b", "causes", f"open:{CONTAINER}", *more, *to)
        here = sdt("causes", "b", "--task", f"open:{CONTAINER}", *more, *form)
        assert (there.code, there.out) == (here.code, here.out), more


def test_requests_that_a_state_meets_are_told_as_without_a_bus(sdt, bus: tuple[str, Server]) -> None:
    for form in ((), ("--json",), ("--csv",)):
        there = sdt("ask", "b", "satisfies", "--state", f"{CONTAINER}=open", *form, "--connect", bus[0])
        assert there.out == sdt("satisfies", "b", "--state", f"{CONTAINER}=open", *form).out


def without_seconds(out: str) -> str:
    return re.sub(r"[\d.]+ s\b", "SECONDS", out)


@pytest.mark.parametrize("form", [(), ("--csv",)])
def test_a_task_with_steps_is_told_as_without_a_bus(
    sdt, bus: tuple[str, Server], form: tuple[str, ...]
) -> None:
    more = ("--seed", "9", *form)  # what others ask stays unanswered
    there = sdt("ask", "b", "task", "open_then_close", *more, "--connect", bus[0])
    here = sdt("task", "open_then_close", "--kitchen", "b", "--robot", "pr2", *more)
    assert (there.code, without_seconds(there.out)) == (here.code, without_seconds(here.out))
    assert "close sink_area_left_middle_drawer_main" in there.out


def test_a_prefix_that_is_not_declared_is_told_as_on_the_shell(sdt, bus: tuple[str, Server]) -> None:
    query = "SELECT ?d { ?d a my:Door }"
    done = sdt("ask", "b", "select", query, "--connect", bus[0])
    assert done.code == Exit.BAD_INPUT
    assert "a prefix that is not declared" in done.err
    assert "put PREFIX NAME: <IRI> at its beginning" in done.err
    assert done.err == sdt("query", "b", query).err


def test_a_verb_without_its_text_and_a_verdict_that_is_not_kept_are_named(
    sdt, bus: tuple[str, Server]
) -> None:
    nothing = sdt("ask", "b", "why", "--connect", bus[0])
    assert (nothing.code, nothing.err) == (
        Exit.BAD_INPUT,
        "error: why asks about nothing; allowed: the IRI of a verdict, or the beginning of its hash: "
        "sdt ask b why TEXT\n",
    )
    unknown = sdt("ask", "b", "why", "https://example.org/id/verdict/x", "--connect", bus[0])
    assert unknown.code == Exit.BAD_INPUT
    assert "no verdict <https://example.org/id/verdict/x> is kept here" in unknown.err


def test_a_verdict_is_told_by_the_beginning_of_its_hash_as_on_the_shell(
    sdt, bus: tuple[str, Server], tmp_path: Path
) -> None:
    to = ("--connect", bus[0])
    (verdict,) = sdt("ask", "b", "achieve", f"open:{CONTAINER}", "--seed", "5", "--json", *to).json
    short = local_name(verdict["iri"])[:12]
    whole = sdt("ask", "b", "why", verdict["iri"], *to)
    assert (whole.code, "CERTIFIED" in whole.out) == (Exit.DONE, True)
    assert sdt("ask", "b", "why", short, *to).out == whole.out
    kept = str(tmp_path / "kept.nq")
    asked = ("--kitchen", "b", "--robot", "pr2", "--task", f"open:{CONTAINER}", "--seed", "5")
    assert sdt("achieve", *asked, "--save", kept).code == Exit.DONE
    for form in ("--json", "--csv"):
        here, there = sdt("why", short, "--store", kept, form), sdt("ask", "b", "why", short, form, *to)
        titles = [line for line in here.out.splitlines() if "title" in line or "Asked" in line]
        assert titles, "sections"
        assert [line for line in there.out.splitlines() if "title" in line or "Asked" in line] == titles


def test_nobody_who_says_how_he_is_is_no_answer(sdt, bus: tuple[str, Server]) -> None:
    nobody = sdt("ask", "c", "health", "--connect", bus[0])
    assert nobody.code == Exit.NO_ORACLE
    assert "no server of 'c' is on the bus" in nobody.err


def test_place_without_a_pose_is_told_and_ends_as_without_a_bus(sdt, bus: tuple[str, Server]) -> None:
    asked = (f"open:{CONTAINER}", "--state", f"{CONTAINER}=open", "--budget", "2")
    there = sdt("ask", "b", "place", *asked, "--robot", "pr2", "--connect", bus[0])
    here = sdt("place", "--kitchen", "b", "--robot", "pr2", "--task", *asked)
    assert (there.code, here.code) == (Exit.NO, Exit.NO)
    assert without_seconds(there.out) == without_seconds(here.out)
    hint = "hint: --state CONTAINER=closed begins where there is something to open\n"
    assert hint in here.err
    assert hint in there.err
    quiet = sdt("place", "--kitchen", "b", "--robot", "pr2", "--task", *asked, "--csv")
    assert hint not in quiet.err


def test_poses_are_told_as_without_a_bus(sdt, bus: tuple[str, Server]) -> None:
    asked = (f"open:{CONTAINER}", "--friction", "0.5", "--budget", "1")
    there = sdt("ask", "b", "place", *asked, "--connect", bus[0])
    here = sdt("place", "--kitchen", "b", "--robot", "pr2", "--task", *asked)
    assert (there.code, here.code) == (Exit.DONE, Exit.DONE)
    firsts = [done.out.splitlines()[0] for done in (there, here)]  # how far a search comes differs
    assert firsts[0] == firsts[1]
    assert "--drive fixed --friction 0.5" in firsts[0]
    assert "map, x to the right, y upwards" in there.out


def test_place_out_of_scope_is_no_no(sdt) -> None:
    asked = ("--kitchen", str(FOLDER / "a.urdf"), "--robot", "pr2", "--task", "open:swing_door")
    assert sdt("place", *asked).code == Exit.ABSTAINED
