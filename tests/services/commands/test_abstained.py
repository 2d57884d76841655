"""Where a verdict abstained: why is told, with an exit code of its own."""

from pathlib import Path
from typing import Any

import pytest

from predicates.case import Outcome
from services.app import Policy
from services.codesign.entries import Found, How
from services.codesign.smallest.families import Family
from services.codesign.smallest.sought import Question, Sought, Trial, Turned
from services.codesign.smallest.told import turned_json
from services.commands.exits import Exit
from services.commands.worlds.answer import exit_of, print_answer
from services.commands.worlds.turn import ends_with

OUT = {"kind": "semantic", "reason": "the joint follows another", "proof": False, "search": None}
CAUSE = {"kind": "causal", "reason": "nothing to cause", "proof": True, "search": None}


SMALL = Path(__file__).resolve().parents[2] / "small" / "b.urdf"


def test_outside_of_a_class_only_what_is_missing_is_told(sdt) -> None:
    asked = ("achieve", "--kitchen", str(SMALL), "--robot", "pr2", "--task", "open:oven_door")
    done = sdt(*asked, "--tee", "d_artic_dyn")
    assert done.code == Exit.ABSTAINED
    reasons = [line.strip() for line in done.out.splitlines() if "out_of_scope" in line]
    assert reasons == [
        "out_of_scope: outside D_artic_dyn: oven_door_joint hasForceModel: nothing is known of the forces of "
        "this joint: give it one sdt:hasForceModel, measured"
    ]
    assert "none" not in done.out, "a line that says no more than the reason"
    rows = sdt("scope", str(SMALL), "--explain", "--json").json["containers"]
    lacks = [lack["path"] for each in rows if each["class"] == "D_artic_dyn" for lack in each["lacks"]]
    assert lacks == ["hasForceModel", "hasForceModel"]


def told(outcome: str) -> dict[str, Any]:
    names = {"task": "open", "container": "drawer", "robot": "pr2", "kitchen": "k"}
    return names | {"outcome": outcome, "diagnoses": [OUT, CAUSE]}


def contrast(outcome: str) -> dict[str, Any]:
    edits = {"edits": ["robot:stretch"], "turned": False, "predicates": [], "no_longer": [], "now": []}
    return edits | {"actual": told(outcome), "counterfactual": told(outcome)}


def test_two_abstained_worlds_say_why_and_end_with_the_code_of_abstained(
    capsys: pytest.CaptureFixture[str],
) -> None:
    print_answer(contrast("abstained"))
    out = capsys.readouterr().out
    assert "as it is: semantic: the joint follows another" in out
    assert "otherwise: semantic: the joint follows another" in out
    assert exit_of(contrast("abstained")) is Exit.ABSTAINED
    assert exit_of(contrast("not_certified")) is Exit.NO


def turn(actual: str, turned: str | None) -> dict[str, Any]:
    found = {"found": turned is not None, "edits": ["move:drawer=0.2"], "not_yet": ["move:drawer=0.1"]}
    tried = [{"share": 1.0, "outcome": "abstained", "edits": ["move:drawer=0.4"]}]
    sizes = {"tried": tried, "tolerance": 0.01, "apart_at_most": 0.1}
    return contrast(actual) | found | sizes | {"counterfactual": None if turned is None else told(turned)}


@pytest.mark.parametrize(
    ("actual", "turned", "code"),
    [
        ("certified", "not_certified", Exit.DONE),
        ("not_certified", "certified", Exit.DONE),
        ("abstained", "certified", Exit.DONE),
        ("certified", "abstained", Exit.ABSTAINED),
        ("certified", None, Exit.NO),
        ("not_certified", None, Exit.NO),
        ("abstained", None, Exit.ABSTAINED),
    ],
)
def test_a_turn_ends_with_whether_it_was_found_unless_nothing_is_claimed(
    actual: str, turned: str | None, code: Exit, capsys: pytest.CaptureFixture[str]
) -> None:
    said = turn(actual, turned)
    assert exit_of(said) is code
    print_answer(said)
    assert ("as it is: semantic: the joint follows" in capsys.readouterr().out) == (actual == "abstained")


@pytest.mark.parametrize(
    ("actual", "turns", "code"),
    [
        (Outcome.CERTIFIED, [Outcome.NOT_CERTIFIED, Outcome.ABSTAINED, None], Exit.DONE),
        (Outcome.CERTIFIED, [Outcome.ABSTAINED, None], Exit.ABSTAINED),
        (Outcome.NOT_CERTIFIED, [None, None], Exit.NO),
        (Outcome.ABSTAINED, [None], Exit.ABSTAINED),
    ],
)
def test_turns_that_nobody_named_end_likewise(
    actual: Outcome, turns: list[Outcome | None], code: Exit
) -> None:
    family = Family("which robot", ("robot:a",))
    tried = [
        () if each is None else (Trial("robot:a", Found("", each, How.LAW, {}), turns=True),)
        for each in turns
    ]
    sought = tuple(Sought(family, each) for each in tried)
    asked = Question("b", "pr2", "open:x", (), Policy())
    said = turned_json(Turned(asked, Found("", actual, How.LAW, {}), sought, 0.0, 0.0))
    assert ends_with(said) is code
