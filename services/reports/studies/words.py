"""A verdict in two or three words and a colour, and its reasons in sentences."""

from predicates.case import Kind, Outcome, Verdict
from services.reports.pages.table import Cell

LETTERS = {
    "certified": "",
    "semantic": "S",
    "causal": "C",
    "embodiment": "E",
    "out of scope": "A",
}
"""What stands in a small field of a figure."""


def failed(verdict: Verdict) -> str:
    """`certified`, `abstained`, or the first kind of failure: what is wrong with the request comes first."""
    if verdict.outcome is Outcome.CERTIFIED:
        return "certified"
    kinds = [each.kind for each in verdict.diagnoses]
    order = (Kind.OUT_OF_SCOPE, Kind.CAUSAL, Kind.SEMANTIC, Kind.EMBODIMENT)
    first = next((kind for kind in order if kind in kinds), Kind.EMBODIMENT)
    return first.value.replace("_", " ")


def is_proved(verdict: Verdict) -> bool:
    """Whether a sound bound excludes every motion of the class."""
    return verdict.outcome is Outcome.NOT_CERTIFIED and any(each.proof for each in verdict.diagnoses)


def color(verdict: Verdict) -> str:
    """Name in `colors.COLORS`."""
    return "proved" if is_proved(verdict) else verdict.outcome.value


def said(verdict: Verdict) -> str:
    """Outcome in two or three words; a refusal says whether it is proved."""
    if verdict.outcome is Outcome.CERTIFIED:
        return "certified"
    if verdict.outcome is Outcome.ABSTAINED:
        return "abstained"
    return f"{failed(verdict)}, {'proved' if is_proved(verdict) else 'not proved'}"


def cell(verdict: Verdict, clip: str = "") -> Cell:
    """The verdict as a field of a table."""
    return Cell(said(verdict), color(verdict), clip, reasons(verdict))


def reasons(verdict: Verdict) -> str:
    """Every reason in one line; empty for what is certified."""
    return "; ".join(each.reason for each in verdict.diagnoses)
