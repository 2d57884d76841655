"""A repeated question gets the stored verdict (ARCHITECTURE, decision 8)."""

import math
from collections.abc import Callable

from predicates.case import Answer, Case, Kind, Outcome, Verdict
from predicates.record.inputs import BUDGET_INPUT, Inputs
from predicates.record.stored import StoredVerdict
from sdt_kg.iri import Iri

Recall = Callable[[Iri], StoredVerdict | None]
"""What is stored under a verdict's IRI."""

_KINDS = {
    "satisfies_request": {Kind.SEMANTIC},
    "causes": {Kind.CAUSAL, Kind.OUT_OF_SCOPE},
    "can_perform": {Kind.EMBODIMENT},
}


def nothing_stored(iri: Iri) -> None:
    """No memory: every question is judged anew."""


def answers_again(stored: StoredVerdict, inputs: Inputs) -> bool:
    """Whether the stored verdict answers the question that these inputs ask.

    A refusal that rests on a search answers only for a budget not above its own: a longer search
    may find what a shorter one did not.
    """
    searched = stored.outcome is Outcome.NOT_CERTIFIED and not any(each.proof for each in stored.diagnoses)
    return not searched or budget_of(inputs) <= budget_of(stored.inputs)


def recalled(stored: StoredVerdict, asked: Case, inputs: Inputs) -> Verdict:
    """The stored verdict about the case that is asked again.

    Its seconds are those of the judging. τ and Γ are as asked: what was solved for then is in
    the store.
    """
    return Verdict(
        iri=stored.iri,
        outcome=stored.outcome,
        case=asked,
        satisfies_request=_answer(stored, asked, "satisfies_request", stored.satisfies_request),
        causes=_answer(stored, asked, "causes", stored.causes),
        can_perform=_answer(stored, asked, "can_perform", stored.can_perform),
        diagnoses=stored.diagnoses,
        inputs=inputs,
        seconds=stored.seconds,
        stored=True,
    )


def budget_of(inputs: Inputs) -> float:
    """[s] Seconds that the search was allowed; infinite where it had no bound."""
    text = dict(inputs).get(BUDGET_INPUT)
    return math.inf if text is None else float(text.removesuffix(" s"))


def _answer(stored: StoredVerdict, asked: Case, predicate: str, holds: bool | None) -> Answer | None:
    """One predicate's answer; what the store keeps of all answers together is with the last that ran."""
    if holds is None:
        return None
    diagnoses = tuple(each for each in stored.diagnoses if each.kind in _KINDS[predicate])
    if predicate != ("can_perform" if stored.can_perform is not None else "causes"):
        return Answer(asked, holds, diagnoses)
    return Answer(asked, holds, diagnoses, stored.notes, figures=stored.figures, artefact=stored.artefact)
