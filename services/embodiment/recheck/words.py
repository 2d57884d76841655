"""What a record says in words, and which bodies are nearest in it, beside what is found again.

Words decide nothing, and what they say of a search nothing finds again; of two pairs that are as near,
another processor may find the other. So a difference is named, and is no reason why a verdict would not hold.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence

from predicates.case import Answer
from predicates.margins import NearestPair
from predicates.record.inputs import UNKNOWN_INPUT
from predicates.record.stored import StoredVerdict
from sdt_kg.annotation import Drive
from sdt_kg.iri import Iri, local_name
from sdt_kg.twin import Twin
from services.embodiment.handles import DRIVE, GIVEN


def words_differ(
    stored: StoredVerdict, answers: Sequence[Answer | None], twin: Twin, robot: Iri, *, same: bool
) -> Iterator[str]:
    """In what a verdict's notes, nearest bodies and reasons are not those that are found again.

    Notes are of its models and of the predicates, which are asked again.

    Args:
        stored: The verdict.
        answers: What the predicates say of its motion now.
        twin: What they were asked of.
        robot: Whose verdict it is.
        same: Whether the Φ that judged was this version's: others may say it otherwise.
    """
    given = [each for each in answers if each is not None]
    notes = {note for each in given for note in each.notes} if same else set[str]()
    yield from _notes_differ(stored, notes | _of_models(stored, twin, robot), same=same)
    pairs = {name: pair for each in given for name, pair in each.nearest_pairs.items()}
    yield from _pairs_differ(stored.nearest_pairs, pairs)
    if same:
        reasons = {each.reason for answer in given for each in answer.diagnoses}
        told = {each.reason for each in stored.diagnoses}
        yield from (f"the verdict does not give the reason: {each}" for each in sorted(reasons - told))
        yield from (f"a reason of the verdict is not found again: {each}" for each in sorted(told - reasons))


def words_beside_proof(stored: StoredVerdict, twin: Twin, robot: Iri) -> Iterator[str]:
    """Notes and reasons of a verdict that its proof does not show, since it is not in words."""
    yield from _notes_differ(stored, _of_models(stored, twin, robot), same=True)
    for each in sorted({each.reason for each in stored.diagnoses}):
        yield f"in the verdict's words, which were not compared with the proof: {each}"


def _pairs_differ(said: Mapping[str, NearestPair], found: Mapping[str, NearestPair]) -> Iterator[str]:
    """Of which smallest distances a verdict names other bodies than are found; earlier ones named none."""
    for name, pair in said.items():
        again = found.get(name)
        if again is None or {*again.links} != {*pair.links}:
            here = "of no bodies" if again is None else f"that of {_both(again)}"
            yield f"'{name}' is that of {_both(pair)} in the verdict, {here} in the recheck"


def _both(pair: NearestPair) -> str:
    return " and ".join(map(local_name, pair.links))


def _notes_differ(stored: StoredVerdict, found: Collection[str], *, same: bool) -> Iterator[str]:
    said = dict(stored.inputs)
    known = {*found, f"{DRIVE}{said.get('embodiment.drive')}"}
    known |= {GIVEN} if said.get("body_motion", UNKNOWN_INPUT) != UNKNOWN_INPUT else set()
    yield from (f"the verdict does not note: {each}" for each in sorted({*found} - {*stored.notes}))
    rest = sorted({*stored.notes} - known)
    if rest:
        why = "" if same else ", since another version judged"
        yield f"notes of the verdict that were not checked{why}: {'; '.join(rest)}"


def _of_models(stored: StoredVerdict, twin: Twin, robot: Iri) -> set[str]:
    """What every verdict about these models, and a base that moves so, notes of them."""
    models = (twin.mechanism(each).notes for each in (twin.environment, robot))
    annotation, drive = twin.robot(robot), dict(stored.inputs).get("embodiment.drive")
    moves = next((each for each in Drive if each.value == drive), annotation.drive)
    return {*(note for each in models for note in each), *annotation.notes_of(moves)}
