"""A verdict as HTML for the page's panel: text is escaped, colours keep WCAG AA contrast on both themes."""

from collections.abc import Iterable
from html import escape
from typing import Final

from services.viewer.judging.question import Judged
from services.why import PREDICATES, Section

BADGES: Final = {
    "certified": ("CERTIFIED", "#14602a"),
    "not_certified": ("NOT CERTIFIED", "#a11212"),
    "abstained": ("ABSTAINED", "#5a4a00"),
}
SAID: Final = {
    True: ("&#10003; yes", "#14602a"),
    False: ("&#10007; no", "#a11212"),
    None: ("not asked", "#444"),
}
FOLDED: Final = ("Asked", "Answers", "Margins", "Notes", "Versions and inputs", "To check again")
STYLE: Final = "font-size:0.85em;line-height:1.4;color:#1a1a1a;overflow-wrap:anywhere;padding:0 0.8em"


def status(text: str, *, trouble: bool = False) -> str:
    """What goes on, or what cannot be done; names of files and links are not read as HTML or Markdown."""
    error = "<b>error:</b> " if trouble else ""
    return f"<div id='sdt-status' role='status' style='{STYLE}'>{error}{escape(text)}</div>"


def headline(judged: Judged, stale: bool) -> str:
    """Outcome, question and the three predicates."""
    text, colour = BADGES[judged.outcome]
    title = judged.sections[0].title.removesuffix(text).strip()
    rows = "".join(
        f"<tr><td style='padding-right:0.6em'><b>{name}</b></td>"
        f"<td style='white-space:nowrap;color:{SAID[holds][1]}'><b>{SAID[holds][0]}</b></td></tr>"
        f"<tr><td colspan=2 style='padding-bottom:0.4em'>{escape(meaning)}</td></tr>"
        for (name, meaning), holds in zip(PREDICATES.items(), judged.holds, strict=True)
    )
    old = (
        "<p style='background:#fff3c4;color:#4a3800;padding:0.4em;margin:0.4em 0'>"
        "Something was changed since: this verdict is about what was asked before.</p>"
        if stale
        else ""
    )
    return (
        f"<div id='sdt-verdict' style='{STYLE}'>{old}"
        f"<p style='background:{colour};color:#fff;padding:0.4em 0.6em;font-weight:bold;margin:0.3em 0' "
        f"role='status'>{text}</p><p style='margin:0.3em 0'>{escape(title)}</p>"
        f"<table style='border-spacing:0'>{rows}</table></div>"
    )


def story(judged: Judged) -> str:
    """What the outcome means, the reasons, and the rest folded."""
    means = "".join(f"<p>{escape(line)}</p>" for line in judged.sections[0].lines)
    by_title = {section.title: section for section in judged.sections[1:]}
    reasons = _section(by_title["Reasons"]) if "Reasons" in by_title else ""
    folded = "".join(
        f"<details><summary style='padding:0.35em 0'><b>{escape(title)}</b></summary>"
        f"{_lines(by_title[title].lines)}</details>"
        for title in FOLDED
        if title in by_title
    )
    return f"<div id='sdt-story' style='{STYLE}'>{reasons}{means}{folded}</div>"


def nothing_yet() -> str:
    """What stands where a verdict will be."""
    return (
        f"<div id='sdt-verdict' style='{STYLE}'><p>Choose kitchen, robot and container, then <b>Check</b>: "
        "can this robot do it here? The answer is a motion that was certified, or the reasons why not.</p>"
        "<p>Red lines show how each handle moves that can be opened from the present state.</p></div>"
    )


def _section(section: Section) -> str:
    return f"<p style='margin-bottom:0.2em'><b>{escape(section.title)}</b></p>{_lines(section.lines)}"


def _lines(lines: Iterable[str]) -> str:
    indents = ((0.9 if line.startswith("  ") else 0.0, line.strip()) for line in lines)
    return "".join(
        f"<p style='margin:0.15em 0;padding-left:{indent}em'>{escape(line)}</p>" for indent, line in indents
    )
