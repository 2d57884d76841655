"""Colours of the style sheet keep WCAG AA, in the light and in the dark scheme."""

import re
from pathlib import Path

import pytest

from services.http.pages.kinds import Standing
from services.http.pages.view import FOLDER

SHEET = (FOLDER / "static" / "pages.css").read_text()
AA_TEXT, AA_PARTS = 4.5, 3.0
"""WCAG 2.2, 1.4.3 and 1.4.11: of text, and of what shows where a control or a focus is."""
GROUNDS = ("paper", "ground")
KINDS = ("certified", "semantic", "causal", "embodiment", "out-of-scope", "open")
TEXTS = [
    *((text, ground) for text in ("ink", "quiet", "link") for ground in GROUNDS),
    ("ink", "code"),
    ("on-button", "button"),
    *((kind, f"{kind}-ground") for kind in KINDS),
    *((kind, "ground") for kind in KINDS),  # badges of a verdict's head
    *(("ink", f"{kind}-ground") for kind in KINDS),
    ("link", "open-ground"),
    ("link", "certified-ground"),
    ("link", "embodiment-ground"),
    ("quiet", "open-ground"),
]
PARTS = [
    *((part, ground) for part in ("focus", "quiet", "button") for ground in GROUNDS),
    *(("focus", f"{kind}-ground") for kind in KINDS),
]


def schemes() -> dict[str, dict[str, str]]:
    light, dark = (dict(re.findall(r"--([\w-]+):\s*(#[0-9a-f]{6})", block)) for block in _blocks())
    return {"light": light, "dark": light | dark}


def _blocks() -> list[str]:
    return re.findall(r":root\s*\{(.*?)\}", SHEET, re.DOTALL)


def luminance(colour: str) -> float:
    parts = [int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    red, green, blue = (
        each / 12.92 if each <= 0.04045 else ((each + 0.055) / 1.055) ** 2.4 for each in parts
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def ratio(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_the_ratio_is_that_of_the_recommendation() -> None:
    assert ratio("#000000", "#ffffff") == pytest.approx(21.0)
    assert ratio("#767676", "#ffffff") == pytest.approx(4.54, abs=0.01)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_pair_of_text_and_ground_is_readable(scheme: str) -> None:
    colours = schemes()[scheme]
    weak = {
        (text, ground): round(ratio(colours[text], colours[ground]), 2)
        for pairs, least in ((TEXTS, AA_TEXT), (PARTS, AA_PARTS))
        for text, ground in pairs
        if ratio(colours[text], colours[ground]) < least
    }
    assert weak == {}


def test_both_schemes_give_every_colour_and_nothing_else_has_one() -> None:
    light, dark = (dict(re.findall(r"--([\w-]+):\s*(#[0-9a-f]{6})", block)) for block in _blocks())
    assert light.keys() == dark.keys()
    rest = re.sub(r":root\s*\{.*?\}", "", SHEET, flags=re.DOTALL)
    assert re.findall(r"#[0-9a-fA-F]{3,8}\b", rest) == []
    used = set(re.findall(r"var\(--([\w-]+)\)", SHEET))
    assert used <= light.keys()


def test_every_standing_has_its_colour_in_the_sheet() -> None:
    for standing in Standing:
        assert f".k-{standing.value.key}" in SHEET
        assert f".fill-{standing.value.key}" in SHEET
    assert Path(FOLDER / "static" / "icon.svg").is_file()
