"""Artefact and twin → whether what was claimed holds."""

import re
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Final

from predicates.case import Answer, Artefact, ArtefactKind, Case, Outcome, Verdict
from predicates.law import law
from predicates.oracle import Physics, tee_class_of
from predicates.record.inputs import NEAREST, START_INPUT, UNKNOWN_INPUT, goal_of, inputs_of
from predicates.record.stored import StoredVerdict
from predicates.specification.step import reaches
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name
from sdt_kg.scope import D_ARTIC
from sdt_kg.state import Region
from sdt_kg.task import UNKNOWN, Task, Unknown
from sdt_kg.twin import Container
from services.embodiment.certify.certificate import SCHEMA, Certificate, read_certificate
from services.embodiment.certify.held.holds import HOLDS
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.proof.written import is_proof
from services.embodiment.recheck.claim import (
    claim_differs,
    figures_differ,
    inputs_differ,
    loosened,
    others_differ,
    twin_differs,
)
from services.embodiment.recheck.embodiment import Certifier, is_at
from services.embodiment.recheck.models import (
    OtherClassError,
    OtherModelsError,
    TwinOf,
    at_hand,
    check_class,
)
from services.embodiment.recheck.proofs import about, proof_again
from services.embodiment.recheck.words import words_differ
from services.physics.oracle import Kinematics

DIGEST: Final = re.compile(rb"[0-9a-f]{64}")
COMPRESSED: Final = b"\x78\xda"
"""How bytes begin that zlib has compressed as well as it can: a proof's."""


@dataclass(frozen=True, slots=True)
class Rechecked:
    """What a recheck found.

    Attributes:
        of: IRI of the verdict, or name of the file.
        about: In words.
        kind: What was checked: a certificate, a proof, or a task's result; None where it cannot even be read.
        reasons: Why it does not hold; empty if it does.
        notes: What was checked how, and what was not.
        seconds: Of checking.
        about_others: Whether it is about models, or relative to a class, of another content than those at
            hand: what it claims was not checked, and nothing speaks against it.
    """

    of: str
    about: str
    kind: str | None
    reasons: tuple[str, ...]
    notes: tuple[str, ...]
    seconds: float
    about_others: bool = False

    @property
    def holds(self) -> bool:
        """Whether it was checked, and nothing speaks against it."""
        return not self.reasons


@dataclass(slots=True)
class Trial:
    """What is found on the way."""

    of: str
    about: str = ""
    kind: str | None = None
    reasons: list[str] = field(default_factory=list[str])
    notes: list[str] = field(default_factory=list[str])
    about_others: bool = False
    began: float = field(default_factory=time.perf_counter)

    def found(self, differences: Iterable[str]) -> bool:
        """Whether there are any; they are noted."""
        before = len(self.reasons)
        self.reasons += differences
        return len(self.reasons) > before

    def failed(self, error: InputError) -> None:
        """What could not be read or had is a reason."""
        self.about_others = isinstance(error, OtherModelsError | OtherClassError)
        self.reasons.append(str(error))

    def ended(self) -> Rechecked:
        seconds, found = time.perf_counter() - self.began, (tuple(self.reasons), tuple(self.notes))
        return Rechecked(self.of, self.about, self.kind, *found, seconds, self.about_others)


def recheck_verdict(
    stored: StoredVerdict, artefact: Artefact, twin_of: TwinOf, physics: Physics | None = None
) -> Rechecked:
    """Whether a stored verdict says what its artefact shows, and the artefact holds.

    A part that cannot be read, and models that are gone, are reasons why it does not; with models or a class
    D of another content it is not checked.

    Args:
        stored: The verdict.
        artefact: What it came with.
        twin_of: The models that it is about.
        physics: Φ of the class that it is relative to; None: of D_artic.
    """
    trial = Trial(stored.iri, kind=artefact.kind.value)
    verb = "motion of" if stored.verb is None else stored.verb.value
    trial.about = (
        f"{verb} {_name(stored.container)}, {_name(stored.robot)} in {local_name(stored.environment)}"
    )
    try:
        if artefact.kind is ArtefactKind.PROOF:
            reasons, trial.notes = proof_again(artefact.content, twin_of, stored)
            trial.found(reasons)
            return trial.ended()
        certificate = read_certificate(artefact.content)
        if not trial.found(claim_differs(stored, certificate)):
            check_class(stored)
            task = UNKNOWN if stored.verb is None else Task(stored.verb, stored.container or UNKNOWN)
            _certify_again(trial, certificate, task, twin_of, stored, physics or Kinematics())
    except InputError as error:
        trial.failed(error)
    return trial.ended()


def is_artefact(content: bytes) -> bool:
    """Whether the bytes are a certificate's or proof's, whole or damaged, as far as their beginning tells."""
    schema, _, rest = content.partition(b"\n")
    digest = rest.partition(b"\n")[0]
    if schema and (SCHEMA.encode("ascii").startswith(schema[: len(SCHEMA)]) or DIGEST.fullmatch(digest)):
        return True
    begins_as_one = content[:1] == COMPRESSED[:1] or content[1:2] == COMPRESSED[1:]
    return begins_as_one and not _is_text(content)


def _is_text(content: bytes) -> bool:
    """Whether the bytes are UTF-8; what is compressed is not."""
    try:
        content.decode()
    except UnicodeDecodeError:
        return False
    return True


def recheck_artefact(name: str, content: bytes, twin_of: TwinOf) -> Rechecked:
    """Whether an artefact holds that comes without its verdict."""
    trial = Trial(name)
    try:
        if is_proof(content):
            trial.kind, trial.about = ArtefactKind.PROOF.value, about(content)
            reasons, trial.notes = proof_again(content, twin_of, None)
            trial.found(reasons)
            return trial.ended()
        certificate = read_certificate(content)
        trial.kind = ArtefactKind.CERTIFICATE.value
        robot, kitchen = local_name(certificate.robot), local_name(certificate.environment)
        trial.about = f"motion of {local_name(certificate.container)}, {robot} in {kitchen}"
        _certify_again(trial, certificate, UNKNOWN, twin_of, None, Kinematics())
    except InputError as error:
        trial.failed(error)
    return trial.ended()


def _certify_again(  # noqa: PLR0913, PLR0917 - one trial
    trial: Trial,
    certificate: Certificate,
    task: Task | Unknown,
    twin_of: TwinOf,
    stored: StoredVerdict | None,
    physics: Physics,
) -> None:
    """The Law about the stored motion, by the certifier alone; and the same figures as before."""
    if trial.found(loosened(certificate.tolerances)):
        return
    twin, source = at_hand(twin_of, certificate.models, certificate.state)
    trial.notes.append(source)
    checker = Certifier(twin, certificate)
    if trial.found(twin_differs(checker)):
        return
    if stored is not None and trial.found(inputs_differ(stored, checker, physics)):
        return
    goal = None if stored is None else goal_of(dict(stored.inputs).get("final", ""))
    final = UNKNOWN if goal is None else goal
    case = Case(twin, certificate.robot, task, body_motion=certificate.motion, final=final)
    about = None if stored is None else stored.container
    container = twin.container(about or certificate.container)
    answers, reasons = _judged_again(case, container, physics, checker)
    holding = (True,) * 3 if stored is None else (stored.satisfies_request, stored.causes, stored.can_perform)
    performed = answers[-1]
    if performed is None or holding != tuple(None if each is None else each.holds for each in answers):
        trial.reasons += reasons or ["the predicates that hold are not those of which the verdict says so"]
        return
    trial.found(figures_differ(certificate.figures, performed.figures, "the certificate", "the recheck"))
    if stored is not None:
        found = {
            name: figure for each in answers if each is not None for name, figure in each.figures.items()
        }
        trial.found(others_differ(stored, certificate, found, physics))
    if tee_class_of(physics) is not D_ARTIC and HOLDS in performed.figures:
        trial.reasons.append(
            f"{container.name} is let go on the way, and where forces count it might move then"
        )
    trial.notes += [*_notes(checker, stored, physics), *_refused(stored)]
    trial.notes += _said_otherwise(certificate.nearest, performed.notes)
    if stored is not None:
        same = dict(stored.inputs).get("physics") == physics.version
        trial.notes += words_differ(stored, answers, twin, certificate.robot, same=same)


def _judged_again(
    case: Case, container: Container, physics: Physics, checker: Certifier
) -> tuple[tuple[Answer | None, ...], list[str]]:
    """The three answers about the motion, and why they are not all yes."""
    if case.task is UNKNOWN and isinstance(case.final, Region):
        answers = reaches(case.final, container, case, physics, checker)
        return answers, [each.reason for answer in answers for each in answer.diagnoses]
    for each in law(case, physics, checker):
        if _is_about(each, container.iri):
            reasons = [one.reason for one in each.diagnoses]
            return (each.satisfies_request, each.causes, each.can_perform), reasons
    return (None,) * 3, [f"the motion meets no request about {container.name}"]


def _is_about(verdict: Verdict, container: Iri) -> bool:
    task = verdict.case.task
    return isinstance(task, Task) and task.container == container


def _notes(checker: Certifier, stored: StoredVerdict | None, physics: Physics) -> list[str]:
    """What was not checked, or is not as this version would have it."""
    certificate, notes = checker.certificate, list[str]()
    if certificate.tolerances != Tolerances():
        notes.append(f"held to its own tolerances, not to this version's: {certificate.tolerances}")
    if stored is None:
        return [*notes, "there is no verdict with it: what its inputs claimed was not compared"]
    said = dict(stored.inputs)
    if said.get("physics") != physics.version:
        notes.append(f"judged with {said.get('physics')}, rechecked with {physics.version}")
    text, start = said.get(START_INPUT, ""), certificate.start
    if NEAREST in text and start is not None and not is_at(start, text):
        notes.append(
            "the robot starts beside the kitchen's start: that it touches something there, parked, was "
            "checked, not that no free pose is nearer to it"
        )
    if tee_class_of(physics) is not D_ARTIC:
        notes.append("forces at the handle were bounded again; what the robot bears was not checked again")
    if said.get("motion", UNKNOWN_INPUT) not in {UNKNOWN_INPUT, _asked(checker, physics)}:
        notes.append(
            "a motion of the container was asked for; that the body motion keeps its times was not compared"
        )
    return notes


def _said_otherwise(said: tuple[str, ...], found: tuple[str, ...]) -> Iterator[str]:
    """In what a certificate's sentences are not those of the recheck."""
    for each in (one for one in found if one not in said):
        yield f"the certificate does not say: {each}"
    for each in (one for one in said if one not in found):
        yield f"the certificate says, and it is not found again: {each}"


def _refused(stored: StoredVerdict | None) -> Iterator[str]:
    """What was not checked of a verdict that is not certified, and has a certificate of CanPerform."""
    if stored is not None and stored.outcome is Outcome.NOT_CERTIFIED:
        yield "not certified, as the verdict says: what holds is that the robot can move so"
        if any(each.proof for each in stored.diagnoses):
            yield "that another motion would not do either, as the verdict has it, was not checked"


def _asked(checker: Certifier, physics: Physics) -> str:
    """What a verdict's inputs say of the motion that was compared with the certificate's."""
    asked = checker.certificate.asked
    if asked is None:
        return UNKNOWN_INPUT
    return dict(inputs_of(Case(checker.twin, motion=asked), physics, None))["motion"]


def _name(iri: Iri | None) -> str:
    return "nothing" if iri is None else local_name(iri)
