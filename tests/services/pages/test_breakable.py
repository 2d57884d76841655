"""Where a line may end on pages: in long names, never in a number or before its unit."""

import pytest

from services.http.pages.view import breakable

BREAK = "\u200b"


def figures(text: str) -> list[str]:
    """What is kept on one line."""
    parts = str(breakable(text)).split('<span class="figure">')[1:]
    return [each.partition("</span>")[0] for each in parts]


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("r_link and door_1, 6.0 mm at 16.50 s", ["6.0 mm", "16.50 s"]),
        ("x 1.5 m, y -2 m, yaw 0.311 rad", ["1.5 m", "-2 m", "0.311 rad"]),
        ("not in [0.405, 0.45]", ["0.405", "0.45"]),
        ("0.2 m/s, 5e-05 m/s², 2 rad/s2, 90 %, 1°", ["0.2 m/s", "5e-05 m/s²", "2 rad/s2", "90 %", "1°"]),
        ("in 201 boxes", ["201"]),
        ("cabinet10_drawer 3 makes 9f32 of kitchen_2", ["3"]),
        ("https://example.org/id/verdict/11", []),
    ],
)
def test_a_number_and_its_unit_stay_on_one_line(text: str, kept: list[str]) -> None:
    assert figures(text) == kept


def test_a_long_name_may_break_and_nothing_of_a_text_is_lost() -> None:
    assert breakable("a_b/c.d") == f"a_{BREAK}b/{BREAK}c.{BREAK}d"
    shown = str(breakable("<b_1> & 2 m")).replace(BREAK, "")
    assert shown == '&lt;b_1&gt; &amp; <span class="figure">2 m</span>'
