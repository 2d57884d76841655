"""Cases, motions and answers ↔ plain values that CBOR carries, exactly."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from predicates.case import Answer, Artefact, ArtefactKind, Case, Diagnosis
from predicates.oracle import Replayed
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import Interval, Region, State
from sdt_kg.task import UNKNOWN, Task, Verb
from sdt_kg.twin import Twin
from services.app import Policy

Plain = dict[str, Any]
Figures = dict[str, tuple[float, str]]
"""Name → value, unit."""
M = TypeVar("M", Motion, BodyMotion)

_DIAGNOSES = TypeAdapter(tuple[Diagnosis, ...])


def twin_key(twin: Twin) -> str:
    """What a twin and its robots are known by on the bus, whatever the state: what all of it follows from."""
    return " ".join(f"{model} {twin.content_hash(model)}" for model in (twin.environment, *twin.robots))


def motion_plain(motion: Motion | BodyMotion) -> Plain:
    """Its fields; arrays stay arrays."""
    return {each.name: getattr(motion, each.name) for each in fields(motion)}


def motion_value(kind: type[M], plain: Mapping[str, Any]) -> M:
    """The motion of these fields.

    Raises:
        InputError: A field is missing.
    """
    known: Plain = {each.name: _tupled(plain[each.name]) for each in fields(kind) if each.name in plain}
    try:
        return kind(**known)
    except TypeError as error:
        raise InputError(f"a {kind.__name__} on the bus: {error}") from None


def case_plain(case: Case) -> Plain:
    """What is known of the case, without its twin."""
    plain: Plain = {}
    if isinstance(case.robot, str):
        plain["robot"] = case.robot
    if isinstance(case.task, Task):
        container = case.task.container
        plain["task"] = [case.task.verb.value, container if isinstance(container, str) else None]
    if isinstance(case.motion, Motion):
        plain["motion"] = motion_plain(case.motion)
    if isinstance(case.body_motion, BodyMotion):
        plain["body_motion"] = motion_plain(case.body_motion)
    return plain


def case_value(twin: Twin, plain: Mapping[str, Any]) -> Case:
    """The case about a twin."""
    case = Case(twin, robot=plain.get("robot", UNKNOWN))
    if "task" in plain:
        verb, container = plain["task"]
        case = replace(case, task=Task(Verb(verb), UNKNOWN if container is None else container))
    if "motion" in plain:
        case = replace(case, motion=motion_value(Motion, plain["motion"]))
    if "body_motion" in plain:
        case = replace(case, body_motion=motion_value(BodyMotion, plain["body_motion"]))
    return case


def answer_plain(answer: Answer) -> Plain:
    """An answer, and what it found out about the case."""
    artefact = answer.artefact
    return {
        "case": case_plain(answer.case),
        "holds": answer.holds,
        "diagnoses": _DIAGNOSES.dump_python(answer.diagnoses, mode="json"),
        "notes": list(answer.notes),
        "seconds": answer.seconds,
        "figures": _figures_plain(answer.figures),
        "artefact": None if artefact is None else [artefact.kind.value, artefact.content],
    }


def answer_value(twin: Twin, plain: Mapping[str, Any]) -> Answer:
    """The answer about a twin."""
    artefact = plain["artefact"]
    return Answer(
        case=case_value(twin, plain["case"]),
        holds=plain["holds"],
        diagnoses=_diagnoses(plain["diagnoses"]),
        notes=tuple(plain["notes"]),
        seconds=dict(plain["seconds"]),
        figures=_figures(plain["figures"]),
        artefact=None if artefact is None else Artefact(ArtefactKind(artefact[0]), artefact[1]),
    )


def replayed_plain(replayed: Replayed) -> Plain:
    """What Φ makes of a motion."""
    return {
        "final": dict(replayed.final),
        "motion": motion_plain(replayed.motion),
        "violations": _DIAGNOSES.dump_python(replayed.violations, mode="json"),
        "notes": list(replayed.notes),
        "figures": _figures_plain(replayed.figures),
    }


def replayed_value(plain: Mapping[str, Any]) -> Replayed:
    """What Φ made of a motion."""
    return Replayed(
        final=State.of(plain["final"]),
        motion=motion_value(Motion, plain["motion"]),
        violations=_diagnoses(plain["violations"]),
        notes=tuple(plain["notes"]),
        figures=_figures(plain["figures"]),
    )


def region_plain(region: Region) -> Plain:
    """Joint → lower, upper."""
    return {joint: [each.lower, each.upper] for joint, each in region.intervals}


def region_value(plain: Mapping[str, Any]) -> Region:
    """The region of joint → lower, upper."""
    return Region(tuple((joint, Interval(lower, upper)) for joint, (lower, upper) in plain.items()))


def policy_plain(policy: Policy) -> Plain:
    """A policy's fields."""
    return {
        "drive": None if policy.drive is None else policy.drive.value,
        "base": None if policy.base is None else list(policy.base),
        "budget": policy.budget,
        "seed": policy.seed,
        "any_start": policy.any_start,
        "contact": policy.contact,
    }


def policy_value(plain: Mapping[str, Any]) -> Policy:
    """The policy of these fields."""
    drive, base = plain["drive"], plain["base"]
    start = None if base is None else (float(base[0]), float(base[1]), float(base[2]))
    return Policy(
        None if drive is None else Drive(drive),
        start,
        plain["budget"],
        plain["seed"],
        any_start=plain["any_start"],
        contact=plain["contact"],
    )


def _figures_plain(figures: Figures) -> Plain:
    return {name: list(figure) for name, figure in figures.items()}


def _figures(plain: Mapping[str, Any]) -> Figures:
    return {name: (float(value), str(unit)) for name, (value, unit) in plain.items()}


def _diagnoses(plain: object) -> tuple[Diagnosis, ...]:
    try:
        return _DIAGNOSES.validate_python(plain)
    except ValidationError as error:
        raise InputError(f"diagnoses on the bus: {error.errors(include_url=False)[0]['msg']}") from None


def _tupled(value: object) -> object:
    """Lists as the tuples that they were."""
    return tuple(_tupled(each) for each in value) if isinstance(value, list) else value
