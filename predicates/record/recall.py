"""A repeated question gets the stored verdict (ARCHITECTURE, decision 8)."""

import math
from collections.abc import Callable, Iterator

from predicates.case import Answer, Case, Kind, Outcome, Verdict
from predicates.record.explained import PREDICATE_TERM
from predicates.record.inputs import BUDGET_INPUT, NOT_HASHED, Inputs
from predicates.record.stored import StoredVerdict
from predicates.scope import tee_class_of_hash
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri

Recall = Callable[[Iri], StoredVerdict | None]
"""What is stored under a verdict's IRI."""

REMEDY = "the store was changed: sdt recheck tells what of it holds; judge again into another store"

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

    Raises:
        InputError: The record is of another question, or contradicts itself.
    """
    if _decisive(stored.inputs) != _decisive(inputs):
        raise InputError(f"the record of {stored.iri} has other inputs than its IRI", remedy=REMEDY)
    check_coherent(stored)
    searched = stored.outcome is Outcome.NOT_CERTIFIED and not any(each.proof for each in stored.diagnoses)
    return not searched or budget_of(inputs) <= budget_of(stored.inputs)


def check_coherent(stored: StoredVerdict) -> None:
    """The outcome is what Eq. (4) makes of the rest, which says what its inputs say.

    Raises:
        InputError: It is not: the record contradicts itself.
    """
    if not _is_coherent(stored):
        what = f"says {stored.outcome.value}, and its answers and diagnoses do not"
        raise InputError(f"the record of {stored.iri} {what}", remedy=REMEDY)
    for what in says_otherwise(stored):
        raise InputError(f"the record of {stored.iri} contradicts itself: {what}", remedy=REMEDY)


def says_otherwise(stored: StoredVerdict) -> Iterator[str]:
    """What a record says of drive, class and answers that its inputs, or its verdict, say otherwise.

    What early versions did not write is not missed.
    """
    inputs = dict(stored.inputs)
    tee = tee_class_of_hash(inputs.get("tee_class", ""))
    for name, said, found in (
        ("drive", stored.drive, inputs.get("embodiment.drive")),
        ("class", stored.tee_class, tee and tee.iri),
    ):
        if None not in {said, found} and said != found:
            yield f"the verdict's {name} is {said}, by its inputs {found}"
    holds = (stored.satisfies_request, stored.causes, stored.can_perform)
    for name, whole in zip(PREDICATE_TERM.values(), holds, strict=True):
        if name in stored.answers and stored.answers[name] is not whole:
            yield f"its answer of {name} is {stored.answers[name]}, and the verdict says {whole}"


def _decisive(inputs: Inputs) -> dict[str, str]:
    """The inputs which the IRI is the hash of."""
    return {name: value for name, value in inputs if name not in NOT_HASHED}


def _is_coherent(stored: StoredVerdict) -> bool:
    """Whether the outcome is what Eq. (4) makes of the rest: certified without a reason against it."""
    holds = stored.satisfies_request is True and stored.causes is True and stored.can_perform is True
    if stored.outcome is Outcome.CERTIFIED:
        return holds and not stored.diagnoses
    return bool(stored.diagnoses)


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
    return Answer(
        asked,
        holds,
        diagnoses,
        stored.notes,
        figures=stored.figures,
        artefact=stored.artefact,
        nearest_pairs=stored.nearest_pairs,
    )
