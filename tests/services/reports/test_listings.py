"""Every colour of a code listing of a report keeps WCAG AA on the ground that it stands on."""

import re

import nbformat

from services.reports.run.catalogue import notebook
from services.reports.run.export import page
from tests.services.pages.test_contrast import AA_TEXT, ratio

UNSEEN = {".w"}
"""Of white space, which has no strokes."""


def sheet() -> str:
    cell = nbformat.v4.new_code_cell("# a comment\n@decorated\ndef f(): return 1 in (2, 'x')")
    node = nbformat.v4.new_notebook(cells=[cell])
    return re.findall(r"<style>(.*?)</style>", page(notebook("feasibility"), node, {}), re.DOTALL)[0]


def in_full(colour: str) -> str:
    """`#a2f` as `#aa22ff`."""
    return colour if len(colour) == 7 else "#" + "".join(2 * each for each in colour[1:])


def test_every_colour_of_a_listing_is_readable_on_its_ground() -> None:
    style = sheet()
    (ground,) = re.findall(r"^\.sdt-code pre, pre \{[^}]*background: (#[0-9a-f]{6})", style, re.MULTILINE)
    rules = re.findall(r"^\.highlight (\.\w+) \{[^}]*?(?<!-)color: (#[0-9A-Fa-f]+)", style, re.MULTILINE)
    colours = {name: in_full(colour.lower()) for name, colour in rules if name not in UNSEEN}
    assert {".c1", ".k", ".nd", ".ow", ".s1"} <= colours.keys()
    assert {
        name: ratio(each, ground) for name, each in colours.items() if ratio(each, ground) < AA_TEXT
    } == {}


def test_a_report_looks_alike_in_the_dark_scheme() -> None:
    style = sheet()
    assert ":root { color-scheme: light; }" in style
    assert "prefers-color-scheme" not in style
    assert "light-dark(" not in style
