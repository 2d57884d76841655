"""How outcomes are called and marked, the same on every page: by a word and a sign, and by colour as well."""

from dataclasses import dataclass
from enum import Enum
from typing import Final


@dataclass(frozen=True, slots=True)
class Mark:
    """One way in which a case can stand.

    Attributes:
        key: Class in the style sheet; word in JSON and CSV.
        word: As people read it.
        sign: One character, so that nobody needs the colour.
        means: One sentence.
    """

    key: str
    word: str
    sign: str
    means: str


class Standing(Enum):
    """How a case stands: certified, one of the four kinds of failure, or not judged."""

    CERTIFIED = Mark("certified", "certified", "✓", "All three predicates hold, checked by a second code.")
    SEMANTIC = Mark("semantic", "semantic", "≠", "The final state does not meet the request, Eq. (5).")
    CAUSAL = Mark("causal", "causal", "↛", "The motion does not cause the final state, Eq. (6).")
    EMBODIMENT = Mark(
        "embodiment", "embodiment", "✕", "The robot cannot perform it, or no way was found, Eq. (7)."
    )
    OUT_OF_SCOPE = Mark(
        "out_of_scope", "out of scope", "∅", "Outside the class D_artic: nothing is claimed either way."
    )
    OUTDATED = Mark(
        "outdated", "outdated", "↺", "Judged by another version of sdt, and so no answer any more: ask again."
    )
    NOT_JUDGED = Mark("not_judged", "not judged", "?", "Nobody has asked yet.")
    WAITING = Mark("waiting", "waiting", "…", "Asked for; others are judged before it.")
    BEING_JUDGED = Mark("being_judged", "being judged", "…", "An oracle is at it.")
    NO_VERDICT = Mark("no_verdict", "no verdict", "!", "It was asked, and there is no verdict: see why.")


OF_CLASS: Final = {
    "SemanticFailure": Standing.SEMANTIC,
    "CausalFailure": Standing.CAUSAL,
    "EmbodimentFailure": Standing.EMBODIMENT,
    "OutOfScope": Standing.OUT_OF_SCOPE,
}
"""Local name of a diagnosis's class → how the case stands."""
VERDICT_STANDINGS: Final = (
    Standing.CERTIFIED, Standing.OUT_OF_SCOPE, Standing.CAUSAL, Standing.EMBODIMENT, Standing.SEMANTIC,
)  # fmt: skip
"""Of several kinds the first marks the case: what the motion ends in follows from what stopped it."""
MARKS: Final = {each.value.key: each.value for each in Standing}
LEGEND: Final = tuple(each.value for each in (Standing.CERTIFIED, *OF_CLASS.values(), Standing.NOT_JUDGED))


def standings(outcome: str, kinds: str) -> list[Standing]:
    """How a case stands whose verdict has this outcome and diagnoses of these classes.

    Args:
        outcome: Local name: Certified, NotCertified, Abstained.
        kinds: Local names of the classes of its diagnoses, with blanks between.
    """
    if outcome == "Certified":
        return [Standing.CERTIFIED]
    found = {OF_CLASS[each] for each in kinds.split() if each in OF_CLASS}
    return [each for each in VERDICT_STANDINGS if each in found]
