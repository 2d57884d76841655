r"""Φ′: the twin as it would have to be for an observed motion to be possible.

A proposal changes one joint of the kitchen and nothing else: type, axis, place and limits. The body
that it moves stays where it is in the present state. It is a value; nothing is accepted by making it.
"""

from dataclasses import dataclass, replace

import numpy as np

from predicates.learn.articulation import Articulation
from predicates.learn.fitting.vectors import cross
from predicates.learn.frames import motion_of, pose_of, rejoined, world_T_of
from predicates.learn.track import Array
from sdt_kg.errors import InputError
from sdt_kg.iri import joint_iri, local_name
from sdt_kg.mechanism import LEARNED, Joint, JointType, Limits, Mechanism
from sdt_kg.twin import Container, Twin

UNSURE = 3.0
"""[1] Standard deviations within which the begin of a track is at the limit that it was taken to be at."""

ALONG = 0.5
"""[1] Cosine of the angle up to which a track leads along the twin's own path, or back: of 60 degrees."""

STEP = 0.01
"""[rad or m] Of the learned joint, in which its path is taken to be straight."""


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """One joint of the kitchen as it was learned.

    Attributes:
        container: What the joint moves.
        before, after: The joint.
        learned: What it rests on, in the kitchen's root frame.
        seen: Positions of the new joint that were observed [rad or m]: where Φ′ is supported.
        twin: The twin with the joint replaced, in the state in which the track began.
        assumptions: What the track does not say, one sentence each.
    """

    container: Container
    before: Joint
    after: Joint
    learned: Articulation
    seen: tuple[float, float]
    twin: Twin
    assumptions: tuple[str, ...]


def propose(
    twin: Twin, container: Container, learned: Articulation, unsure: tuple[str, ...] = ()
) -> Proposal:
    """The twin in which the container's own joint is the learned one.

    Args:
        twin: In the state in which the track began.
        container: Whose motion was seen.
        learned: In the kitchen's root frame.
        unsure: What is not certain of it, one sentence each: assumptions, too.

    Raises:
        InputError: What was seen does not move, or the joint is coupled to others.
    """
    kitchen = twin.mechanism(twin.environment)
    joint = kitchen.joint(local_name(container.joint))
    _check(kitchen, joint, learned)
    now = twin.state[container.joint]
    world_T_parent = world_T_of(kitchen, joint.parent, twin.state)
    parent_T_child = joint.origin.matrix() @ motion_of(joint, now)
    closes, guessed = _closes(kitchen, joint, twin, learned)
    axis, seen = _axis(now, learned, world_T_parent, closes)
    frame = _frame(learned, axis, world_T_parent, parent_T_child)
    old_axis = joint.origin.matrix()[:3, :3] @ np.array(joint.axis)
    same_way = joint.type is learned.joint_type and float(axis @ old_axis) > 0
    limits, assumptions = _limits(joint, seen, learned, same_way)
    assumptions = [*unsure, *assumptions, *guessed]
    notes = (*joint.notes, _told(learned, seen, assumptions))
    after = replace(
        joint, type=learned.joint_type, axis=_unit(frame[:3, :3].T @ axis), limits=limits, notes=notes
    )
    # the frame at the present position, moved back by it, is the frame at 0
    after = replace(after, origin=pose_of(frame @ np.linalg.inv(motion_of(after, now))))
    child_T_old: Array = np.asarray(np.linalg.inv(frame) @ parent_T_child, dtype=np.float64)
    words = f"learned: joint '{joint.name}' of {container.name} is {after.type.value}"
    changed = rejoined(twin, after, child_T_old, words)
    return Proposal(container, joint, after, learned, seen, changed, tuple(assumptions))


def _check(kitchen: Mechanism, joint: Joint, learned: Articulation) -> None:
    if learned.joint_type is JointType.FIXED:
        raise InputError("what was seen does not move", allowed="a motion", remedy="nothing can be learned")
    coupled = joint.mimic is not None or any(
        each.mimic is not None and each.mimic.joint == joint.name for each in kitchen.joints
    )
    if coupled:
        raise InputError(
            f"joint '{joint.name}' is coupled to others",
            allowed="a joint that neither mimics nor is mimicked",
            remedy="edit the coupled joints by hand",
        )


def _closes(
    kitchen: Mechanism, joint: Joint, twin: Twin, learned: Articulation
) -> tuple[bool, tuple[str, ...]]:
    """Whether the track leads to where the container is closed, and what had to be assumed.

    At a limit a container can but leave it. Between them it closes where the twin's joint, closing, would
    move the observed point the same way; where that is neither so nor contrary, where it has farther to go.
    """
    now, limits = twin.state[joint_iri(kitchen.name, joint.name)], joint.limits
    slack = _slack(learned)
    if now - limits.lower <= slack or limits.upper - now <= slack:
        return now - limits.lower > limits.upper - now, ()
    world_T_joint = world_T_of(kitchen, joint.parent, twin.state) @ joint.origin.matrix()
    axis = world_T_joint[:3, :3] @ np.array(joint.axis)
    begin, end = learned.point(np.array([0.0, min(STEP, learned.limits[1])]))
    opening = axis if joint.type is JointType.PRISMATIC else cross(axis, begin - world_T_joint[:3, 3])
    scale = float(np.linalg.norm(opening) * np.linalg.norm(end - begin))
    along = float(opening @ (end - begin)) / scale if scale > 0 else 0.0
    if abs(along) >= ALONG:
        return along < 0, ()
    closes = now - limits.lower > limits.upper - now
    return closes, (f"it is taken to have been {'closed' if closes else 'opened'}: the track does not say",)


def _slack(learned: Articulation) -> float:
    """How far a position may be from a limit that it is at [rad or m]."""
    # the least of hundreds of samples at rest is farther out than a limit deviates
    return UNSURE * learned.scale / (learned.radius or 1.0)


def _axis(
    now: float, learned: Articulation, world_T_parent: Array, closes: bool
) -> tuple[Array, tuple[float, float]]:
    """The learned axis in the parent's frame, positive where it opens, and the positions seen."""
    axis = world_T_parent[:3, :3].T @ learned.axis
    low, high = learned.limits
    low = 0.0 if abs(low) < _slack(learned) else low
    return (-axis, (now - high, now - low)) if closes else (axis, (now + low, now + high))


def _frame(learned: Articulation, axis: Array, world_T_parent: Array, parent_T_child: Array) -> Array:
    """The child's new frame in the parent's at the present position: a hinge's lies on its axis."""
    frame = parent_T_child.copy()
    if learned.joint_type is JointType.REVOLUTE:
        centre = world_T_parent[:3, :3].T @ (learned.origin - world_T_parent[:3, 3])
        frame[:3, 3] = centre + axis * float((parent_T_child[:3, 3] - centre) @ axis)
    return frame


def _told(learned: Articulation, seen: tuple[float, float], assumptions: list[str]) -> str:
    """The note by which verdicts tell what they rest on."""
    unit = "m" if learned.joint_type is JointType.PRISMATIC else "rad"
    known = ", ".join(
        f"{name} ± {learned.deviations[name]:.2g} {of}" for name, of in (("axis", "rad"), ("origin", "m"))
    )
    where = f"seen from {seen[0]:.4g} to {seen[1]:.4g} {unit}"
    return "; ".join((f"{LEARNED}: {known} (standard deviations), {where}", *assumptions))


def _limits(
    joint: Joint, seen: tuple[float, float], learned: Articulation, same_way: bool
) -> tuple[Limits, list[str]]:
    """Limits that hold what was seen, and what had to be assumed."""
    old, unit = joint.limits, "m" if learned.joint_type is JointType.PRISMATIC else "rad"
    if same_way:
        low, high = (
            limit if abs(at - limit) <= _slack(learned) else at
            for limit, at in zip((old.lower, old.upper), seen, strict=True)
        )
        wider = replace(old, lower=min(old.lower, low), upper=max(old.upper, high))
        kept = "limits of position are kept: a track does not show where a joint stops"
        wide = (
            f"limits of position are widened to what was seen, {wider.lower:.4g} to {wider.upper:.4g} {unit}"
        )
        return wider, [kept if wider == old else wide]
    assumptions = [
        f"limits of position are what was seen, {seen[0]:.4g} to {seen[1]:.4g} {unit}: it may go farther"
    ]
    if joint.type is not learned.joint_type:
        assumptions.append(
            f"limits of velocity and acceleration keep their numbers, now in {unit}/s, {unit}/s2"
        )
    return replace(old, lower=seen[0], upper=seen[1]), assumptions


def _unit(axis: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in axis / np.linalg.norm(axis))
    return x, y, z
