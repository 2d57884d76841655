"""What a cell of the matrix says: reasons in their order, and how it was judged otherwise than most."""

import pytest

from services.http.pages.feasibility.cells import Found, _in_order, unlike

OF = "https://example.org/id/verdict/ab/diagnosis/"


def test_reasons_are_in_the_verdict_s_order() -> None:
    rows = [f"{OF}10 the tenth", f"{OF}2 a second reason\nof two lines", f"{OF}1 the first"]
    assert _in_order("\x1e".join(rows)) == "the first\na second reason\nof two lines\nthe tenth"
    assert not _in_order("")


@pytest.mark.parametrize(
    ("differs", "said"),
    [
        ([], ""),
        (["physics", "embodiment"], "judged by another version of sdt than most here"),
        (["tolerances", "seed"], "judged with other tolerances and seed than most here"),
        (["physics", "seed"], "judged by another version of sdt, with other seed than most here"),
    ],
)
def test_a_cell_that_was_judged_otherwise_says_so_in_words(differs: list[str], said: str) -> None:
    assert unlike(differs) == said


def found(outcome: str, embodiment: str, budget: str = "20 s", *, proved: bool = False) -> Found:
    inputs = {"physics": "kinematics 4, pin 4.1.0", "embodiment": embodiment, "embodiment.budget": budget}
    return Found("v", "r", "c", "omni", outcome, "", proved, "", inputs)


def test_a_cell_shows_what_the_newest_version_says() -> None:
    older, newer = "whole body 9, pin 4.1.0", "whole body 10, pin 4.1.0"
    in_order = [
        found("Certified", older),
        found("NotCertified", newer),
        found("NotCertified", newer, "60 s"),
        found("Abstained", newer),
        found("NotCertified", newer, proved=True),
        found("Certified", newer),
    ]
    assert sorted(reversed(in_order), key=lambda each: each.rank) == in_order
