"""A body motion as cubic pieces of all the scene's coordinates, and whether it is one of that scene."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from predicates.case import Code, Evidence, Quantity
from sdt_kg.errors import MotionError, UnknownEntityError
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.likely import told_likely
from sdt_kg.mechanism import JointType
from sdt_kg.motion import ANOTHER, BodyMotion, check_body_motion
from sdt_kg.numbers import told_apart
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.sweep.kinematics import joint_axes, unit_of
from services.embodiment.certify.sweep.pieces import Pieces, hermite, positions
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


SIX_DIGITS = 5e-6
"""[1] What is told to six digits is farther from what it was by no more than this share."""

MOST_SAMPLES = 200_000
"""[1] Of a body motion: a usual robot's are checked in 3 GB, and their certificate can be read again."""


def of_another_robot(scene: Scene, motion: BodyMotion) -> Findings:
    """Whether the motion is of this robot; if it is not, nothing else can be said of it."""
    if motion.robot == scene.robot_iri:
        return Findings()
    own = {joint.name for joint in scene.robot.joints}
    foreign = [name for name in motion.joints if name not in own]
    shared = len(motion.joints) - len(foreign)
    robot = local_name(scene.robot_iri)
    named = local_name(motion.robot)
    whose = f"of another robot than {robot}" if named == ANOTHER else f"said to be of {named}, not of {robot}"
    reason = f"the motion is {whose}: {robot} has {shared} of its {len(motion.joints)} joints"
    reason += f", no {' or '.join(foreign[:2])}" if foreign else ""
    before = _prefix(foreign, own)
    reason += f"; without '{before}' before them they are its own" if before else ""
    if others := told_likely(motion.joints, (robot, named)):
        reason += f"; {others}"
    evidence = Evidence(Quantity.COUNT, float(shared), float(len(motion.joints)), "1", entity=scene.robot_iri)
    return Findings([Violation("robot", reason, evidence, 0.0)])


def _prefix(foreign: Sequence[str], own: set[str]) -> str:
    """What all these names have before one that is known; '' where they have not."""
    ends = [max((each for each in own if name.endswith(each)), key=len, default=name) for name in foreign]
    before = {name.removesuffix(end) for name, end in zip(foreign, ends, strict=True)}
    return before.pop() if len(before) == 1 else ""


def whole_motion(scene: Scene, motion: BodyMotion, tolerances: Tolerances) -> tuple[Pieces, Findings]:
    """All coordinates along the motion: what it does not list is parked, or as the twin's state says.

    A listed joint that mimics another which is not listed moves that one.

    Raises:
        MotionError: Shapes do not fit, times do not increase, a value is no number of a motion, or a joint of
            the robot is fixed.
        UnknownEntityError: The robot or the kitchen has no such joint.
    """
    _check_arrays(motion)
    motion, findings = without_fixed(scene, motion, tolerances)
    robot = [joint_iri(scene.robot.mechanism.name, name) for name in motion.joints]
    own = _coordinates(scene, robot, motion.kitchen_joints)
    count = len(motion.times)
    q = np.tile(scene.q(motion.base[0], {}), (count, 1))
    v = np.zeros_like(q)
    kitchen = (motion.kitchen_q, motion.kitchen_v) if motion.kitchen_joints else (np.zeros((count, 0)),) * 2
    q[:, scene.base], v[:, scene.base] = motion.base, motion.base_v
    q[:, own], v[:, own] = np.hstack((motion.q, kitchen[0])), np.hstack((motion.v, kitchen[1]))
    coupling, given = scene.coupling, set(own.tolist())
    for k in own:
        source, multiplier = int(coupling.source[k]), coupling.multiplier[k]
        if source not in given and multiplier != 0:
            q[:, source] = (q[:, k] - coupling.offset[k]) / multiplier
            v[:, source] = v[:, k] / multiplier
    whole, rates = coupling.positions(q), coupling.rates(v)
    pieces = hermite(motion.times, whole, rates)
    off = hermite(motion.times, whole[:, own] - q[:, own], rates[:, own] - v[:, own])
    for i in np.flatnonzero(off.c.any(axis=(0, 1))):
        findings.add(_same(scene, int(own[i]), off.columns(np.array([i])), tolerances))
    findings.add(_together(scene, pieces, tolerances))
    return pieces, findings


def without_fixed(scene: Scene, motion: BodyMotion, tolerances: Tolerances) -> tuple[BodyMotion, Findings]:
    """The motion without those kitchen joints that cannot move, and which of them it moves all the same."""
    kitchen, findings = scene.kitchen.mechanism, Findings()
    if scene.coordinate.keys() >= {*motion.kitchen_joints}:
        return motion, findings
    fixed = {
        joint_iri(kitchen.name, each.name): each.fixed_at
        for each in kitchen.joints
        if each.type is JointType.FIXED
    }
    kept = [i for i, joint in enumerate(motion.kitchen_joints) if joint not in fixed]
    for i, joint in enumerate(motion.kitchen_joints):
        at = fixed.get(joint, 0.0)
        moved, most = np.abs(motion.kitchen_q[:, i] - at), tolerances.position + SIX_DIGITS * abs(at)
        if joint in fixed and moved.max() > most:
            for n in {int(np.argmax(moved > most)), int(np.argmax(moved))}:
                value, time = float(moved[n]), float(motion.times[n])
                evidence = Evidence(Quantity.POSITION, value, 0.0, "1", joint, time=time)
                where = f" at {at:g}" if at else ""
                reason = f"{local_name(joint)} moves by {value:.4g}, and it is fixed{where}"
                findings.violations.append(
                    Violation("kitchen stands still: fixed joint", reason, evidence, value)
                )
    if len(kept) == len(motion.kitchen_joints):
        return motion, findings
    joints = tuple(motion.kitchen_joints[i] for i in kept)
    q, v = motion.kitchen_q[:, kept], motion.kitchen_v[:, kept]
    return replace(motion, kitchen_joints=joints, kitchen_q=q, kitchen_v=v), findings


def _check_arrays(motion: BodyMotion) -> None:
    check_body_motion(motion)
    if len(motion.times) > MOST_SAMPLES:
        raise MotionError(
            f"a body motion of {len(motion.times)} samples",
            allowed=f"up to {MOST_SAMPLES}",
            remedy="leave samples out: with their velocities, the others say as much",
        )


def _coordinates(scene: Scene, robot: Sequence[Iri], kitchen: Sequence[Iri]) -> Indices:
    """Those of joints of the robot and of the kitchen, neither of which moves what is the other's."""
    fixed, (first, *_, last) = _fixed(scene), scene.base.tolist()
    for names, known in ((robot, scene.names[last + 1 :]), (kitchen, scene.names[:first])):
        for name in names:
            if name in fixed:
                raise MotionError(
                    f"joint '{local_name(name)}' of the robot is fixed",
                    allowed="joints that move",
                    remedy="leave it out",
                )
            if name not in known:
                whose = "joint" if names is robot else "joint of the kitchen"
                raise UnknownEntityError(whose, local_name(name), map(local_name, known))
    names = [*robot, *kitchen]
    if len(set(names)) < len(names):
        raise MotionError("a body motion lists a joint twice", allowed="each joint once")
    return np.array([scene.coordinate[name] for name in names], dtype=np.intp)


def _fixed(scene: Scene) -> set[Iri]:
    """Joints of the robot that do not move."""
    own = scene.robot.mechanism
    return {joint_iri(own.name, each.name) for each in own.joints if each.type is JointType.FIXED}


def _same(scene: Scene, k: int, off: Pieces, tolerances: Tolerances) -> Findings:
    """A joint that is listed is where those that it mimics have it, between samples too."""
    source = local_name(scene.names[scene.coupling.source[k]])
    reason = f"{local_name(scene.names[k])} does not follow {source}, which it mimics"
    return _apart(scene, k, reason, off, tolerances.coupling)


def _together(scene: Scene, pieces: Pieces, tolerances: Tolerances) -> Findings:
    """Joints that share one motor move equally, fingers to within what springs give, between samples too."""
    findings, annotation = Findings(), scene.annotation
    groups = [(group, tolerances.coupling) for group in annotation.coupled]
    for gripper in annotation.grippers:
        if np.isfinite(gripper.difference):
            fingers = tuple(finger.joint for finger in gripper.finger_joints)
            groups.append((fingers, gripper.difference + tolerances.coupling))
    for group, most in groups:
        own = [scene.coordinate[joint_iri(scene.robot.mechanism.name, name)] for name in group]
        for one, other in combinations(own, 2):
            between = replace(pieces, c=pieces.c[:, :, [one]] - pieces.c[:, :, [other]])
            if not between.c.any():
                continue
            names = f"{local_name(scene.names[one])} and {local_name(scene.names[other])}"
            reason = f"{names} share one motor and do not move equally"
            findings.add(_apart(scene, one, reason, between, most))
    return findings


def _apart(scene: Scene, k: int, reason: str, between: Pieces, most: float) -> Findings:
    """Where the difference of two coordinates, of which k is one, is too large: first and worst."""
    findings, (values, s) = Findings(), positions(between)
    times = (between.start[None, :, None] + s).ravel()
    order = np.argsort(times, kind="stable")
    times, off = times[order], np.abs(values).ravel()[order]
    for n in (int(np.argmax(off > most)), int(np.argmax(off))):
        if off[n] > most:
            unit = unit_of(scene, k)
            value, time = float(off[n]), float(times[n])
            evidence = Evidence(Quantity.POSITION, value, most, unit, scene.names[k], time=time)
            findings.violations.append(Violation("coupled joints", reason, evidence, value))
    return findings


def start(
    scene: Scene, pieces: Pieces, base: tuple[float, float, float] | None, tolerances: Tolerances
) -> Findings:
    """The kitchen begins in the twin's state and, where a start pose is given, the robot parked there.

    Finger joints may be anywhere. The base, and the robot's joints without limits, may have wound up.
    """
    findings, q, turns = Findings(), pieces.c[0, 0], joint_axes(scene)[1]
    parked = scene.q(q[scene.base] if base is None else base, {})
    off = q - parked
    endless = turns & np.isinf(scene.bounds.lower) & np.isinf(scene.bounds.upper)
    endless[: scene.base[0]] = False  # where a container is after a turn, Φ has to say
    off[endless] = (off[endless] + np.pi) % (2 * np.pi) - np.pi
    own = (joint_iri(scene.robot.mechanism.name, name) for name in scene.annotation.finger_joints)
    fingers = {scene.coordinate[joint] for joint in own}
    for k in range(len(q)):
        robot = k >= scene.base[0]
        if (robot and base is None) or int(scene.coupling.source[k]) in fingers:
            continue
        turning = bool(turns[k])
        most = tolerances.start_angle if turning else tolerances.start_position
        if abs(off[k]) > most:
            unit, whose = ("rad" if turning else "m"), ("parked" if robot else "the kitchen's state")
            name = local_name(scene.names[k])
            at, demanded = told_apart(float(q[k]), float(parked[k]), 4)
            reason = f"{name} starts at {at} {unit} and not at {demanded} {unit} ({whose})"
            time = float(pieces.start[0])
            evidence = Evidence(
                Quantity.POSITION, float(q[k]), float(parked[k]), unit, scene.names[k], time=time
            )
            # Of the base all that is off is told: who shifts it has to know by how much in each direction.
            rule = f"start: {name}" if k in scene.base else f"start: {whose}"
            code = Code.ROBOT_ELSEWHERE if robot else Code.KITCHEN_ELSEWHERE
            findings.violations.append(Violation(rule, reason, evidence, abs(float(off[k])), code))
    return findings


def rests(scene: Scene, pieces: Pieces, tolerances: Tolerances) -> Findings:
    """Everything stands still at the first and the last sample, so that the final state is one that stays."""
    findings = Findings()
    ends = np.array([0, len(pieces.start) - 1])
    times = np.array([0.0, pieces.duration[-1]])
    _, speeds, _ = pieces.at(ends, times)
    for n, when in enumerate(("begins", "ends")):
        k = int(np.argmax(np.abs(speeds[n])))
        speed = float(abs(speeds[n, k]))
        if speed > tolerances.rest:
            unit = f"{unit_of(scene, k)}/s"
            reason = f"the motion {when} while {local_name(scene.names[k])} moves at {speed:.4g} {unit}"
            time = float(pieces.start[ends[n]] + times[n])
            evidence = Evidence(Quantity.VELOCITY, speed, tolerances.rest, unit, scene.names[k], time=time)
            findings.violations.append(Violation(f"rest: {when}", reason, evidence, speed))
    return findings
