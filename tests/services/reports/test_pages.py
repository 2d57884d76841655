"""Tables and figures say the same on a page, in a spreadsheet and in a paper."""

import base64
import csv

import numpy as np
import pytest

from services.embodiment.certify.sweep.pieces import Pieces
from services.reports.pages.figure import MIME, Figure, drawn
from services.reports.pages.table import Cell, Table
from services.reports.studies.course import on_curve

TABLE = Table(
    "t",
    "Doors & <drawers>",
    ("door_name", "width", "certified"),
    (("a_b", 0.1 + 0.2, Cell(True, "certified", "pr2: open a_b")), ("50 %", None, Cell("no → yes"))),
)


def test_csv_keeps_numbers_in_full() -> None:
    rows = list(csv.reader(TABLE.csv().splitlines()))
    assert rows == [
        ["door_name", "width", "certified"],
        ["a_b", str(0.1 + 0.2), "yes"],
        ["50 %", "", "no → yes"],
    ]


def test_latex_has_a_column_for_each_head_and_no_sign_that_breaks_it() -> None:
    text = TABLE.latex()
    assert r"\caption{Doors \& <drawers>}" in text
    assert r"door\_name & width & certified \\" in text
    assert r"a\_b & 0.3 & yes \\" in text
    assert r"50 \% &  & no $\rightarrow$ yes \\" in text
    assert r"\begin{tabular}{lll}" in text


def test_html_escapes_and_points_to_the_clip() -> None:
    text = TABLE.html()
    assert "Doors &amp; &lt;drawers&gt;" in text
    assert 'data-clip="pr2: open a_b"' in text


def test_a_table_without_rows_says_so() -> None:
    assert "none" in Table.of("t", "Nothing", []).html()


def figure() -> Figure:
    with drawn(1.0) as drawing:
        drawing.add_subplot().plot([0, 1], [0, 1])
    return Figure("f", "A line", drawing)


def test_a_figure_is_the_same_file_each_time_it_is_drawn() -> None:
    shown = figure()._repr_mimebundle_()[MIME]
    assert figure().saved("svg").decode() == shown["svg"]
    assert shown["svg"].lstrip().startswith("<?xml")
    assert base64.b64decode(shown["pdf"]).startswith(b"%PDF")


@pytest.mark.parametrize(
    ("order", "time", "size", "drawn_at"), [(1, 0.5, 0.5, -0.5), (2, 1.0, 1.0, -1.0), (2, 1.0, 3.0, 3.0)]
)
def test_what_a_limit_tells_of_a_size_is_marked_where_the_curve_is(
    order: int, time: float, size: float, drawn_at: float
) -> None:
    # Down with -1 rad/s2 for a second, then up with 3: where they meet, both are told of the same moment.
    pieces = Pieces(
        np.array([0.0, 1.0]),
        np.ones(2),
        np.array([[[0], [-0.5]], [[0], [-1]], [[-0.5], [1.5]], [[0], [0.0]]]),
    )
    assert on_curve(pieces, order, 0, time, size) == drawn_at
