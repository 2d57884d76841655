"""`sdt task` and `sdt why` count rules as people do."""

from pathlib import Path

from tests.small import FOLDER


def test_one_rule_that_was_not_judged_is_told_as_one(sdt, tmp_path: Path) -> None:
    kept, models = str(tmp_path / "kept.trig"), [str(FOLDER / f"{name}.urdf") for name in ("a", "pr2")]
    asked = ("task", "close_all", "--kitchen", models[0], "--robot", models[1])
    done = sdt(*asked, "--save", kept)
    assert "\n  1 rule was not judged: the sequence did not get there\n" in done.out
    result = sdt(*asked, "--json").json["result"]
    assert "\n1 was not judged: the sequence did not get there\n" in sdt("why", result, "--store", kept).out
