"""Stored proofs against their verdicts and the twin; `proof_check` says whether they hold."""

from collections.abc import Iterator

from predicates.case import Outcome
from predicates.record.inputs import (
    TURNED,
    UNKNOWN_INPUT,
    goal_of,
    pose_text,
    state_hash,
    task_text,
    verdict_iri,
)
from predicates.record.recall import says_otherwise
from predicates.record.stored import StoredVerdict
from sdt_kg.annotation import Drive
from sdt_kg.iri import local_name
from sdt_kg.state import Interval, Region
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.proof.claim import Claim
from services.embodiment.proof_check.proof.content import Proof
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.embodiment.recheck.claim import moved_differs
from services.embodiment.recheck.embodiment import faces, is_at
from services.embodiment.recheck.models import TwinOf, at_hand, models_differ
from services.embodiment.recheck.words import words_beside_proof
from services.policy import MOST_CONTACT, told_contact, told_friction

ROUNDING = 1e-9  # [rad or m] of a goal's middle


def proof_again(content: bytes, twin_of: TwinOf, stored: StoredVerdict | None) -> tuple[list[str], list[str]]:
    """Why a proof does not hold, or does not say what its verdict says; and what was checked how.

    Raises:
        InputError: It is no proof, or its models cannot be had.
    """
    proof = read_proof(content)
    claim = proof.claim
    reasons = [] if stored is None else [*_claim_differs(stored, claim)]
    if reasons:
        return reasons, []
    twin, source = at_hand(twin_of, claim.models, claim.state)
    robot, _ = claim.models[1]
    container = twin.container(claim.container)
    checked = check(twin, robot, container, content)
    reasons = list(checked.reasons)
    if stored is not None and not reasons:
        reasons += _question_differs(stored, proof, twin)
        for one in (claim, *(each.claim for each in proof.others)):
            held = twin.container(one.container).by_handle(one.handle)
            reasons += _policy_differs(dict(stored.inputs), one, twin, held)
    notes = [source, checked.statement, *checked.assumptions]
    notes += [f"boxes refuted one by one: {checked.leaves}"] if checked.leaves else []
    if stored is not None:
        notes += words_beside_proof(stored, twin, robot)
    return reasons, [*notes, *_notes(stored)]


def about(content: bytes) -> str:
    """What a proof is about, in words.

    Raises:
        InputError: It is none.
    """
    claim = read_proof(content).claim
    (environment, _), (robot, _) = claim.models
    return f"no motion of {local_name(claim.container)}, {local_name(robot)} in {local_name(environment)}"


def _claim_differs(stored: StoredVerdict, claim: Claim) -> Iterator[str]:
    """In what a stored verdict contradicts itself or its proof."""
    if verdict_iri(stored.inputs) != stored.iri:
        yield "the verdict's IRI is not the hash of its inputs: one of them was changed"
    if stored.outcome is not Outcome.NOT_CERTIFIED or stored.can_perform is not False:
        yield f"the verdict says {stored.outcome.value}, and has a proof that nothing can be certified"
    proved = any(each.proof for each in stored.diagnoses)
    if not claim.partial and not proved:
        yield "the verdict has a proof, and none of its diagnoses says so"
    if claim.partial and proved:
        yield "the verdict says that nothing can be certified, and its proof is about less"
    (environment, _), (robot, _) = claim.models
    for name, said, proved in (
        ("environment", stored.environment, environment),
        ("robot", stored.robot, robot),
        ("container", stored.container, claim.container),
    ):
        if said != proved:
            yield f"the verdict's {name} is {said and local_name(said)}, its proof's {local_name(proved)}"
    yield from models_differ(stored, claim.models, "proof")
    yield from says_otherwise(stored)


def _question_differs(stored: StoredVerdict, proof: Proof, twin: Twin) -> Iterator[str]:
    """In what the verdict's state and request are not those about which the proof says something."""
    said, claim = dict(stored.inputs), proof.claim
    low, high = claim.span
    if said.get("state") != state_hash(twin.state):
        yield "the verdict's input 'state' is not the state of its proof"
    yield from moved_differs(stored, twin)
    if claim.timing is not None and said.get("motion", UNKNOWN_INPUT) == UNKNOWN_INPUT:
        yield "the proof is about times, and the verdict about no motion that has any"
    at = claim.state[twin.container(claim.container).joint]
    goal = goal_of(said.get("final", ""))
    if goal is not None and low < high:
        given = said.get("motion", UNKNOWN_INPUT) != UNKNOWN_INPUT
        for one in (proof, *(each for each in proof.others if each.claim.container == claim.container)):
            yield from _beyond_goal(one, at, goal, twin.container(claim.container), given)
    if stored.verb is None or stored.container is None:
        return
    asked = task_text(Task(stored.verb, stored.container))
    if said.get("task") not in {asked, UNKNOWN_INPUT}:
        yield f"the verdict's input 'task' is {said.get('task')}, and it says {asked}"
    passed = low >= at if stored.verb is Verb.OPEN else high <= at
    if low < high and not passed:
        passes = f"{low:.4g} to {high:.4g}, and it is at {at:.4g}"
        yield f"the proof is not about how it would {stored.verb.value}: it is about {passes}"


def _beyond_goal(proof: Proof, at: float, goal: Region, container: Container, given: bool) -> Iterator[str]:
    """Whether the proof is about more than the way to the middle of a goal, or beyond where it begins.

    A motion that was given ends anywhere in the goal, and has to be followed to its end.
    """
    interval = dict(goal.intervals).get(container.joint, Interval(at, at))
    near = min(max(at, interval.lower), interval.upper)
    end = (interval.lower + interval.upper) / 2
    if given:
        end = near = max(interval.lower, interval.upper, key=lambda each: abs(each - at))
    low, high = proof.claim.span
    if not min(at, end) - ROUNDING <= low <= high <= max(at, end) + ROUNDING:
        yield (
            f"the proof is about more than the way to the verdict's goal, from {at:.4g} to {end:.4g}: "
            f"it is about {low:.4g} to {high:.4g}"
        )
    for value in sorted({each for one in proof.refutations for each in one.values}):
        if not min(at, near) - ROUNDING <= value <= max(at, near) + ROUNDING:
            yield f"the verdict's goal begins at {near:.5g}, so {value:.5g} need not be passed"


def _policy_differs(said: dict[str, str], claim: Claim, twin: Twin, container: Container) -> Iterator[str]:
    """In what the verdict's base policy and tolerances are not the proof's."""
    if said.get("embodiment.drive") != claim.drive.value:
        yield f"the verdict's drive is {said.get('embodiment.drive')}, its proof's {claim.drive.value}"
    tolerances = said.get("embodiment.tolerances", "")
    contact = told_contact(tolerances) or 0.0
    # what refutes every hold refutes those of nearer fingers, or that need no more friction, as was asked
    asked = repr(Tolerances.within(min(contact, MOST_CONTACT), told_friction(tolerances)))
    if tolerances != (asked if claim.tolerances == Tolerances() else repr(claim.tolerances)):
        yield "the verdict's tolerances are not its proof's"
    if claim.drive is Drive.FIXED and not _starts_as(
        said.get("embodiment.start", ""), claim, twin, container
    ):
        yield f"the verdict's start is {said.get('embodiment.start')}, its proof's {claim.start}"


def _starts_as(text: str, claim: Claim, twin: Twin, container: Container) -> bool:
    """Whether the proof's base pose is what the verdict's input `start` says."""
    x, y, yaw = claim.start
    if not text.endswith(TURNED):
        return text == pose_text(x, y, yaw)
    return is_at(claim.start, text) and is_turned(claim, twin, container)


def is_turned(claim: Claim, twin: Twin, container: Container) -> bool:
    """Whether a proof's base pose is turned to the handle."""
    statement = Statement(twin, claim.models[1][0], container, claim.drive, claim.start, claim.tolerances)
    return faces(claim.start, statement.handle_origin())


def _notes(stored: StoredVerdict | None) -> list[str]:
    if stored is None:
        return ["there is no verdict with it: what its inputs claimed was not compared"]
    if dict(stored.inputs).get("motion", UNKNOWN_INPUT) != UNKNOWN_INPUT:
        return [
            "a motion of the container was asked for; that it passes the refuted values, or has the times "
            "that are too short, was not compared"
        ]
    return []
