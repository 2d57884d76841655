"""Whether a stored verdict, its certificate and the twin say the same."""

import math
from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np

from predicates.case import Case, Outcome
from predicates.margins import COUNTED
from predicates.meant import coupled
from predicates.oracle import Physics, tee_class_of
from predicates.record.inputs import UNKNOWN_INPUT, inputs_of, verdict_iri
from predicates.record.recall import says_otherwise
from predicates.record.stored import StoredVerdict
from sdt_kg.iri import local_name
from sdt_kg.scope import D_ARTIC
from sdt_kg.task import UNKNOWN, Task
from sdt_kg.twin import Twin
from services.embodiment.certify.asked import OFF
from services.embodiment.certify.certificate import Certificate, Figures
from services.embodiment.certify.held.holds import HOLDS
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.handles import DRIVE
from services.embodiment.recheck.embodiment import Certifier
from services.embodiment.recheck.models import models_differ

SAME_FIGURE = 1e-6
"""Relative, or absolute below 1: what may differ by the last bits of another processor."""

AT_LEAST = frozenset({"margin", "engaged"})
"""Tolerances that demand the more, the larger they are; of the others it is the other way round."""

MOST_DEMANDED = 0.1
"""[m] More than anybody keeps: checking it would only take long."""

OF_THE_CASE = ("environment", "state", "robot", "task", "tee_class")
"""Inputs of a verdict that the twin and the task give."""


def loosened(tolerances: Tolerances) -> Iterator[str]:
    """Which tolerances allow what this version never does; a stricter contact may have been asked for."""
    ours = Tolerances()
    for field in fields(Tolerances):
        value, bound = getattr(tolerances, field.name), getattr(ours, field.name)
        if field.name == "resolution":
            kept, allowed = value == bound, f"{bound:g}"
        elif field.name in AT_LEAST:
            kept, allowed = bound <= value <= MOST_DEMANDED, f"{bound:g} to {MOST_DEMANDED:g}"
        else:
            kept, allowed = 0 <= value <= bound, f"0 to {bound:g}"
        if not kept:  # also what is not a number
            yield f"the certificate's tolerance '{field.name}' is {value:g}, allowed is {allowed}"


def twin_differs(checker: Certifier) -> Iterator[str]:
    """In what the twin is not in the state that the certificate is about."""
    twin, certificate = checker.twin, checker.certificate
    if dict(twin.state) != certificate.state:
        yield "the twin is in another state than the one in which the certified motion begins"


def claim_differs(stored: StoredVerdict, certificate: Certificate) -> Iterator[str]:
    """In what a stored verdict contradicts itself or its certificate."""
    if verdict_iri(stored.inputs) != stored.iri:
        yield "the verdict's IRI is not the hash of its inputs: one of them was changed"
    all_hold = stored.satisfies_request and stored.causes and stored.can_perform
    refused = stored.outcome is Outcome.NOT_CERTIFIED and stored.can_perform and not all_hold
    if (stored.outcome is not Outcome.CERTIFIED or stored.diagnoses) and not refused:
        yield f"the verdict says {stored.outcome.value}, and has a certificate"
    if not all_hold and not refused:
        yield "the verdict does not say that all three predicates hold"
    for name, said, certified in (
        ("environment", stored.environment, certificate.environment),
        ("robot", stored.robot, certificate.robot),
    ):
        if said != certified:
            yield f"the verdict's {name} is {_name(said)}, its certificate's {_name(certified)}"
    yield from models_differ(stored, certificate.models, "certificate")
    yield from says_otherwise(stored)
    yield from _acts_otherwise(stored, certificate)
    if OFF in stored.figures and certificate.asked is None:
        yield "the verdict is about a motion that was asked for, and its certificate has none"
    held = {name: stored.figures[name] for name in certificate.figures if name in stored.figures}
    yield from figures_differ(certificate.figures, held, "the certificate", "the verdict")


def _acts_otherwise(stored: StoredVerdict, certificate: Certificate) -> Iterator[str]:
    """In what a verdict names another gripper than its certificate, or notes another drive than it has."""
    acts, drive = certificate.motion.gripper or None, dict(stored.inputs).get("embodiment.drive")
    if stored.gripper not in {None, acts}:
        yield f"the verdict's gripper is {stored.gripper}, its certificate's {acts}"
    for note in stored.notes:
        if note.startswith(DRIVE) and note != f"{DRIVE}{drive}":
            yield f"the verdict notes '{note}', and its drive is {drive}"


def inputs_differ(stored: StoredVerdict, checker: Certifier, physics: Physics) -> Iterator[str]:
    """Which inputs of the verdict are not those that the twin and the certificate give."""
    said, certificate = dict(stored.inputs), checker.certificate
    held = checker.twin.container(certificate.container)
    if stored.container not in {held.iri, *(each.iri for each in coupled(checker.twin, held))}:
        yield (
            f"the verdict's container is {_name(stored.container)}, "
            f"its certificate's {_name(certificate.container)}, and they do not move together"
        )
        return
    task = Task(stored.verb, stored.container) if stored.verb is not None else UNKNOWN
    case = Case(checker.twin, robot=certificate.robot, task=task)
    found = dict(inputs_of(case, physics, checker))
    names = (*OF_THE_CASE, "embodiment.drive", "embodiment.tolerances")
    for name in names:
        if said.get(name) != found[name]:
            yield f"the verdict's input '{name}' is {said.get(name)}, and rechecked is {found[name]}"
    if said.get("body_motion") not in {UNKNOWN_INPUT, *_as_given(checker, physics)}:
        yield "the verdict is about a body motion that was given, and its certificate has another one"
    if not checker.starts_as(said.get("embodiment.start")):
        yield f"the verdict's start is {said.get('embodiment.start')}, its certificate's {certificate.start}"
    yield from _held_otherwise(stored, certificate)
    yield from moved_differs(stored, checker.twin)


def _held_otherwise(stored: StoredVerdict, certificate: Certificate) -> Iterator[str]:
    """In what a certificate holds the container as the verdict's inputs do not allow."""
    said = dict(stored.inputs)
    if "embodiment.holds" in said and HOLDS in certificate.figures:
        yield "the verdict is about one hold, and its certificate has several"
    if "embodiment.handles" in said and stored.container != certificate.container:
        yield (
            f"the verdict is about handles of {_name(stored.container)} itself, "
            f"and its certificate holds {_name(certificate.container)}"
        )


def moved_differs(stored: StoredVerdict, twin: Twin) -> Iterator[str]:
    """Which joints a verdict has elsewhere than the twin in the state that was asked about."""
    start = twin.entities.coupling.start()
    moved = {joint: at for joint, at in twin.state.items() if at != start[joint]}
    for joint in sorted({*stored.moved, *moved}):
        said, found = stored.moved.get(joint), moved.get(joint)
        if said != found:
            where = ["where the kitchen starts" if at is None else f"at {at:g}" for at in (said, found)]
            yield f"the verdict has {local_name(joint)} {where[0]}, its state {where[1]}"


def others_differ(
    stored: StoredVerdict, certificate: Certificate, found: Figures, physics: Physics
) -> Iterator[str]:
    """Which figures of a verdict, beyond its certificate's, are not found again where the same Φ looks.

    Where forces count, what the robot bears is not checked again, and its figures are left out.
    """
    if dict(stored.inputs).get("physics") != physics.version:
        return
    more, again = (
        {n: each[n] for n in each if n not in certificate.figures} for each in (stored.figures, found)
    )
    if tee_class_of(physics) is not D_ARTIC:
        more = {name: more[name] for name in more if name in again}
    yield from figures_differ(more, again, "the verdict", "the recheck")


def _as_given(checker: Certifier, physics: Physics) -> Iterator[str]:
    """What a verdict's inputs say of the certified motion, and of it without what it carries."""
    motion = checker.certificate.motion
    yield dict(inputs_of(Case(checker.twin, body_motion=motion), physics, None))["body_motion"]
    for rows in (len(motion.times), 0):
        none = np.zeros((rows, 0))
        bare = replace(motion, kitchen_joints=(), kitchen_q=none, kitchen_v=none)
        yield dict(inputs_of(Case(checker.twin, body_motion=bare), physics, None))["body_motion"]


def figures_differ(one: Figures, other: Figures, whose: str, others: str) -> Iterator[str]:
    """Which figures differ by more than rounding; counts of computations are no claims."""
    for name in sorted(name for name in {*one, *other} if not name.startswith(COUNTED)):
        if name not in one or name not in other:
            has, lacks = (whose, others) if name in one else (others, whose)
            yield f"{has} has the figure '{name}', {lacks} has none"
            continue
        (value, unit), (value_2, unit_2) = one[name], other[name]
        close = math.isclose(value, value_2, rel_tol=SAME_FIGURE, abs_tol=SAME_FIGURE)
        if unit != unit_2 or not close:
            yield f"'{name}' is {value:.9g} {unit} in {whose}, {value_2:.9g} {unit_2} in {others}"


def _name(iri: str | None) -> str:
    return "nothing" if iri is None else local_name(iri)
