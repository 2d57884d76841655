"""Every input of a verdict, and the IRI that is their hash (ARCHITECTURE, decision 8)."""

import hashlib
from collections.abc import Iterable

from predicates.case import UNKNOWN_INPUT, Case
from predicates.oracle import Embodiment, Physics, tee_class_of
from predicates.scope import tee_class_hash
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from sdt_kg.iri import verdict_iri as iri_of
from sdt_kg.motion import Array, BodyMotion, Motion
from sdt_kg.state import Interval, Region, State
from sdt_kg.task import Task, Unknown
from sdt_kg.twin import Twin

BUDGET_INPUT = "embodiment.budget"
"""Seconds of search that the embodiment oracle was allowed."""

NOT_HASHED = frozenset({BUDGET_INPUT})
"""Inputs which bound how long is searched: a longer search answers the same question."""

START_INPUT = "embodiment.start"
ANY_START = "where and as the motion begins"
"""How that input says that no start was demanded."""
TURNED = ", turned to the handle"
"""How it says that the start's yaw is not given, but follows from the handle."""
NEAREST = ", or the nearest that is free"
"""How it says that a robot which would touch the kitchen there starts elsewhere."""

Inputs = tuple[tuple[str, str], ...]


def pose_text(x: float, y: float, yaw: float) -> str:
    """A base pose [m, m, rad] as that input says it: an arm of few joints tells 1e-6 m and rad apart."""
    return f"{x:.12g}, {y:.12g}, {yaw:.12g}"


def inputs_of(case: Case, physics: Physics, embodiment: Embodiment | None) -> Inputs:
    """Name → value or hash of each input, as asked, before anything is solved."""
    twin, robot = case.twin, case.robot
    inputs = [
        ("environment", model_input(twin, twin.environment)),
        ("state", state_hash(twin.state)),
        ("robot", model_input(twin, robot) if isinstance(robot, str) else UNKNOWN_INPUT),
        ("task", task_text(case.task)),
        ("motion", _motion_hash(case.motion)),
        ("body_motion", _body_motion_hash(case.body_motion)),
        ("final", _final_text(case.final)),
        ("tee_class", tee_class_hash(tee_class_of(physics))),
        ("physics", physics.version),
    ]
    if embodiment is not None and isinstance(robot, str):
        inputs.append(("embodiment", embodiment.version))
        inputs += [(f"embodiment.{name}", value) for name, value in embodiment.settings(twin, robot)]
    return tuple(inputs)


def model_input(twin: Twin, model: Iri) -> str:
    """What the input of a kitchen or robot says: which one, and the hash of its content."""
    return f"{model} {twin.content_hash(model)}"


def verdict_iri(inputs: Inputs) -> Iri:
    """IRI of the verdict: the hash of all inputs that decide it."""
    return iri_of(input_hash(inputs))


def input_hash(inputs: Inputs) -> str:
    """SHA-256 of all inputs that decide what is answered, as hexadecimal."""
    return _digest(f"{name}={value}\n" for name, value in inputs if name not in NOT_HASHED)


def _digest(texts: Iterable[str]) -> str:
    digest = hashlib.sha256()
    for text in texts:
        digest.update(text.encode())
    return digest.hexdigest()


def _array_text(array: Array) -> str:
    return f"{array.shape} {array.astype('<f8').tobytes().hex()}\n"


def state_hash(state: State) -> str:
    """What the input of a state says: the hash of its positions."""
    return _digest(f"{joint} {float(position).hex()}\n" for joint, position in sorted(state.positions))


def task_text(task: Task | Unknown) -> str:
    """What the input of a task says."""
    if isinstance(task, Unknown):
        return UNKNOWN_INPUT
    container = UNKNOWN_INPUT if isinstance(task.container, Unknown) else task.container
    return f"{task.verb.value} {container}"


def _motion_hash(motion: Motion | Unknown) -> str:
    if isinstance(motion, Unknown):
        return UNKNOWN_INPUT
    arrays = [motion.times, motion.values] + ([] if motion.velocities is None else [motion.velocities])
    return _digest([motion.of, str(motion.timed), *map(_array_text, arrays)])


def _body_motion_hash(motion: BodyMotion | Unknown) -> str:
    if isinstance(motion, Unknown):
        return UNKNOWN_INPUT
    names = (motion.robot, motion.gripper, *motion.joints, *motion.kitchen_joints, str(motion.phases))
    arrays = (
        motion.times,
        motion.base,
        motion.q,
        motion.v,
        motion.base_v,
        motion.kitchen_q,
        motion.kitchen_v,
    )
    return _digest([*(f"{name}\n" for name in names), *map(_array_text, arrays)])


def _final_text(final: State | Region | Unknown) -> str:
    if isinstance(final, Unknown):
        return UNKNOWN_INPUT
    if isinstance(final, State):
        return state_hash(final)
    return ", ".join(
        f"{joint} {float(each.lower)!r} to {float(each.upper)!r}" for joint, each in final.intervals
    )


def goal_of(text: str) -> Region | None:
    """The region that the input `final` names; None where none was asked for.

    Raises:
        InputError: It names none, but is the hash of a state, or of a region as earlier versions had it.
    """
    if text == UNKNOWN_INPUT:
        return None
    try:
        parts = (each.split(" ") for each in text.split(", "))
        found = Region(tuple((of, Interval(float(low), float(high))) for of, low, _, high in parts))
    except ValueError:
        found = None
    if found is None or _final_text(found) != text:
        raise InputError(
            f"the verdict's input 'final' is {text}, and not the goal itself",
            allowed="JOINT LOWER to UPPER",
            remedy="ask its question again",
        )
    return found
