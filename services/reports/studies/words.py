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
    """Outcome in two or three words; a refusal says on what its first failure rests."""
    if verdict.outcome is Outcome.CERTIFIED:
        return "certified"
    if verdict.outcome is Outcome.ABSTAINED:
        return "abstained"
    return f"{failed(verdict)}, {ground(verdict)}"


def ground(verdict: Verdict) -> str:
    """On what the first failure rests.

    `proved`, `measured` of a motion that was given or made, or `not proved`: a search that gave up.
    """
    kind = failed(verdict)
    own = [each for each in verdict.diagnoses if each.kind.value.replace("_", " ") == kind]
    if any(each.proof for each in own):
        return "proved"
    return "not proved" if all(each.search is not None for each in own) else "measured"


def cell(verdict: Verdict, clip: str = "") -> Cell:
    """The verdict as a field of a table."""
    return Cell(said(verdict), color(verdict), clip, reasons(verdict))


def reasons(verdict: Verdict) -> str:
    """Every reason in one line; empty for what is certified."""
    return "; ".join(each.reason for each in verdict.diagnoses)
