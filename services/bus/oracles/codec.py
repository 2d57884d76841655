"""Cases, motions and answers ↔ plain values that CBOR carries, exactly."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, StrictBool, StrictBytes, StrictFloat, StrictStr, TypeAdapter, ValidationError

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

_Figure = tuple[StrictFloat, StrictStr]


class _Case(BaseModel):
    """What is known of a case."""

    robot: StrictStr | None = None
    task: tuple[StrictStr, StrictStr | None] | None = None
    motion: Plain | None = None
    body_motion: Plain | None = None


class _Answer(BaseModel):
    """An answer of CanPerform, as it has to be: `"no"` is no truth, and a text no list of notes."""

    case: _Case
    holds: StrictBool
    diagnoses: list[Plain]
    notes: tuple[StrictStr, ...]
    seconds: dict[StrictStr, StrictFloat]
    figures: dict[StrictStr, _Figure]
    artefact: tuple[StrictStr, StrictBytes] | None


class _Replayed(BaseModel):
    """What Φ makes of a motion, as it has to be."""

    final: dict[StrictStr, StrictFloat]
    motion: Plain
    violations: list[Plain]
    notes: tuple[StrictStr, ...]
    figures: dict[StrictStr, _Figure]


B = TypeVar("B", bound=BaseModel)

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
        InputError: A field is missing, or is of another type than a motion's.
    """
    if not isinstance(plain, Mapping):
        raise InputError(f"a {kind.__name__} on the bus is a {type(plain).__name__}", allowed="its fields")
    for name, value in plain.items():
        if _is_wrong(name, value):
            raise InputError(f"'{name}' of a {kind.__name__} on the bus is a {type(value).__name__}")
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
    """An answer, and what it found out about the case.

    Between which bodies a smallest distance is, who takes the answer finds again (`bound.answer_to`).
    """
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
    """The answer about a twin.

    Raises:
        InputError: It is none.
    """
    said = _said(_Answer, plain)
    try:
        kind, content = said.artefact or (None, b"")
        return Answer(
            case=case_value(twin, said.case.model_dump(exclude_none=True)),
            holds=said.holds,
            diagnoses=_diagnoses(plain["diagnoses"]),
            notes=said.notes,
            seconds=said.seconds,
            figures=said.figures,
            artefact=None if kind is None else Artefact(ArtefactKind(kind), content),
        )
    except ValueError as error:  # a verb, or a kind of artefact
        raise InputError(f"an answer on the bus: {error}") from None


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
    """What Φ made of a motion.

    Raises:
        InputError: It is none.
    """
    said = _said(_Replayed, plain)
    return Replayed(
        final=State.of(said.final),
        motion=motion_value(Motion, said.motion),
        violations=_diagnoses(plain["violations"]),
        notes=said.notes,
        figures=said.figures,
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
        "friction": policy.friction,
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
        friction=plain.get("friction"),
    )


def _figures_plain(figures: Figures) -> Plain:
    return {name: list(figure) for name, figure in figures.items()}


def _said(kind: type[B], plain: object) -> B:
    """What was said, each part of its type.

    Raises:
        InputError: One is not, or is missing.
    """
    try:
        return kind.model_validate(plain)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False, include_context=False)[0]
        where = ".".join(str(each) for each in first["loc"])
        raise InputError(f"'{where}' of an answer on the bus: {first['msg']}") from None


def _is_wrong(name: str, value: object) -> bool:
    """Whether a field of a motion has another type than such a field has."""
    if name in {"of", "robot", "gripper"}:
        return not isinstance(value, str)
    if name in {"joints", "kitchen_joints"}:
        return not isinstance(value, list | tuple) or not all(isinstance(each, str) for each in value)
    if name == "timed":
        return not isinstance(value, bool)
    if name == "phases":
        return not isinstance(value, list | tuple) or not all(_is_phase(each) for each in value)
    return not isinstance(value, np.ndarray) and not (name == "velocities" and value is None)


def _is_phase(value: object) -> bool:
    """Whether it is a name and a number of a sample."""
    return isinstance(value, list | tuple) and [type(each) for each in value] == [str, int]


def _diagnoses(plain: object) -> tuple[Diagnosis, ...]:
    try:
        return _DIAGNOSES.validate_python(plain)
    except ValidationError as error:
        raise InputError(f"diagnoses on the bus: {error.errors(include_url=False)[0]['msg']}") from None


def _tupled(value: object) -> object:
    """Lists as the tuples that they were."""
    return tuple(_tupled(each) for each in value) if isinstance(value, list) else value
