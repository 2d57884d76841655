"""A titled card of rows, and a grid of cells; light and dark notebooks both read them."""

import html
from collections.abc import Iterable, Sequence
from enum import Enum

CARD = "border:1px solid #8a8a90;border-radius:4px;padding:6px 12px;display:inline-block;max-width:60em"
CELL = "text-align:left;vertical-align:top;padding:1px 12px 1px 0"


class Badge(Enum):
    """Colours behind one or two words, ink and ground; each pair has a contrast above 4.5."""

    GOOD = ("#ffffff", "#297a4f")
    WARN = ("#1c1c1e", "#edb86b")
    BAD = ("#ffffff", "#b23a2a")
    NONE = ("#1c1c1e", "#cccccf")


def card(
    title: str, rows: Iterable[tuple[str, str]], badge: tuple[str, Badge] | None = None, more: str = ""
) -> str:
    """A card.

    Args:
        title: What it is about.
        rows: Name and words; all is escaped.
        badge: A word or two beside the title, and its colours.
        more: HTML below the rows.
    """
    mark = ""
    if badge is not None:
        ink, ground = badge[1].value
        style = f"color:{ink};background:{ground};border-radius:3px;padding:1px 7px;margin-left:8px"
        mark = f'<span style="{style}">{html.escape(badge[0])}</span>'
    lines = "".join(
        f'<tr><th style="{CELL}">{html.escape(name)}</th><td style="{CELL}">{html.escape(words)}</td></tr>'
        for name, words in rows
    )
    return (
        f'<div style="{CARD}"><strong>{html.escape(title)}</strong>{mark}<table>{lines}</table>{more}</div>'
    )


def grid(columns: Sequence[str], rows: Iterable[Sequence[object]], summary: str = "") -> str:
    """A table of cells; with a summary it is folded below it."""
    head = "".join(f'<th style="{CELL}">{html.escape(each)}</th>' for each in columns)
    body = "".join(
        "<tr>" + "".join(f'<td style="{CELL}">{html.escape(_shown(each))}</td>' for each in row) + "</tr>"
        for row in rows
    )
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    return f"<details><summary>{html.escape(summary)}</summary>{table}</details>" if summary else table


def _shown(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
