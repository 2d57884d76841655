"""Where a verdict abstained: why is told, with an exit code of its own."""

from typing import Any

import pytest

from services.commands.exits import Exit
from services.commands.worlds import exit_of, print_answer

OUT = {"kind": "semantic", "reason": "the joint follows another", "proof": False, "search": None}
CAUSE = {"kind": "causal", "reason": "nothing to cause", "proof": True, "search": None}


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
