"""Table 1: containers that each robot can open, all closed at first, paper set-up (omnidirectional base)."""

import pytest

CERTIFIED = {
    ("a", "pr2"): 22,
    ("a", "tiago_dual"): 22,
    ("a", "stretch"): 19,
    ("b", "pr2"): 16,
    ("b", "tiago_dual"): 16,
    ("b", "stretch"): 15,
}
TOTAL = {"a": 27, "b": 17}


@pytest.mark.oracle
@pytest.mark.slow
@pytest.mark.parametrize(("kitchen", "robot"), CERTIFIED)
def test_table1_each_cell_is_at_least_the_papers(table1, kitchen, robot) -> None:
    certified, total = table1.result.cells()[kitchen][robot]
    assert total == TOTAL[kitchen]
    assert certified >= CERTIFIED[kitchen, robot]


@pytest.mark.oracle
@pytest.mark.slow
def test_table1_every_refusal_says_why(table1) -> None:
    refused = [each.verdict for each in table1.result.results if each.verdict["outcome"] != "certified"]
    assert [each["container"] for each in refused if not each["diagnoses"]] == []
    reasons = [each for one in refused for each in one["diagnoses"]]
    assert [each["reason"] for each in reasons if not each["evidence"]] == []
    searched = [each for one in refused for each in one["diagnoses"] if not each["proof"]]
    assert [each["reason"] for each in searched if each["kind"] == "embodiment" and not each["search"]] == []
