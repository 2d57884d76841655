"""Reasons stand in the order in which a verdict has them, whatever the order of rows."""

from services.http.pages.feasibility.cells import _in_order

OF = "https://example.org/id/verdict/ab/diagnosis/"


def test_reasons_are_in_the_verdict_s_order() -> None:
    rows = [f"{OF}10 the tenth", f"{OF}2 a second reason\nof two lines", f"{OF}1 the first"]
    assert _in_order("\x1e".join(rows)) == "the first\na second reason\nof two lines\nthe tenth"
    assert not _in_order("")
