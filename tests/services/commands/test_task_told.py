"""`sdt task` and `sdt why` count rules as people do."""

import re
from pathlib import Path

from services.why.words import not_reached
from tests.small import FOLDER


def test_one_rule_that_was_not_judged_is_told_as_one(sdt, tmp_path: Path) -> None:
    kept, models = str(tmp_path / "kept.trig"), [str(FOLDER / f"{name}.urdf") for name in ("a", "pr2")]
    asked = ("task", "close_all", "--kitchen", models[0], "--robot", models[1])
    done = sdt(*asked, "--save", kept)
    assert "\n  1 rule was not judged: the sequence did not get there\n" in done.out
    result = sdt(*asked, "--json").json["result"]
    story = sdt("why", result, "--store", kept).out
    assert "\n1 rule was not judged: the sequence did not get there\n" in story
    assert re.search(r"\n\d steps?, 1 rule\n", story)


def test_rules_that_were_not_judged_are_counted() -> None:
    said = "not judged: the sequence did not get there"
    told = [list(not_reached(count)) for count in range(3)]
    assert told == [[], [f"1 rule was {said}"], [f"2 rules were {said}"]]
