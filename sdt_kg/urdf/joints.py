"""Joints as a URDF has them → joints as D_artic wants them, each change noted on the joint."""

import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Final

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import TURNED, Joint, JointType, Limits, Mimic, Pose

AXIS_TOLERANCE: Final = 1e-9
"""[1] An axis whose length differs from 1 by less is taken as it is; eight written digits do not reach it."""


def checked(joint: Joint, source: Path) -> Joint:
    """The joint, with a unit axis.

    Raises:
        UrdfError: Zero axis, inverted limits, negative speed or effort.
    """
    if joint.type is JointType.FIXED:
        return joint
    where = f"{source}: joint '{joint.name}'"
    limits = joint.limits
    if limits.lower > limits.upper:
        raise UrdfError(
            f"{where} has lower limit {limits.lower:g} above upper limit {limits.upper:g}",
            allowed="lower ≤ upper",
            remedy="swap them",
        )
    if limits.velocity < 0 or limits.effort < 0:
        raise UrdfError(f"{where} has a negative velocity or effort limit", allowed="0 or above")
    length = math.sqrt(sum(part * part for part in joint.axis))
    if length == 0:
        raise UrdfError(f"{where} has axis 0 0 0", allowed="any other direction")
    if abs(length - 1) <= AXIS_TOLERANCE:
        return joint
    x, y, z = joint.axis
    note = f"axis ({x:g}, {y:g}, {z:g}) had length {length:.9g} and was normalised"
    return replace(joint, axis=(x / length, y / length, z / length), notes=(*joint.notes, note))


def within_soft_limits(joint: Joint, soft: Limits | None, source: Path) -> Joint:
    """The joint, ended where its safety controller turns back what comes beyond, slowed where it slows it.

    Raises:
        UrdfError: No position is within both limits, or the controller speeds up what comes near.
    """
    limits = joint.limits
    if soft is None or joint.type not in {JointType.REVOLUTE, JointType.PRISMATIC}:
        return joint
    remedy = "mend <safety_controller>, or leave it out"
    if not soft.gain > 0:
        raise UrdfError(
            f"{source}: joint '{joint.name}' has k_position {soft.gain:g}",
            allowed="0 (it is not slowed) or above",
            remedy=remedy,
        )
    lower, upper = max(limits.lower, soft.lower), min(limits.upper, soft.upper)
    if lower > upper:
        raise UrdfError(
            f"{source}: joint '{joint.name}' has the soft limits {soft.lower:g} to {soft.upper:g}",
            allowed=f"a part of {limits.lower:g} to {limits.upper:g}",
            remedy=remedy,
        )
    notes = joint.notes
    if (lower, upper) != (limits.lower, limits.upper):
        notes += (f"ended by its safety controller, short of {limits.lower:g} to {limits.upper:g}",)
    reached = soft.lower >= limits.lower or soft.upper <= limits.upper
    gain = soft.gain if reached else math.inf
    return replace(joint, limits=replace(limits, lower=lower, upper=upper, gain=gain), notes=notes)


def resolved(joints: Iterable[Joint], source: Path) -> list[Joint]:
    """The joints, each mimic naming an independent joint: a chain of mimics becomes one step.

    Raises:
        UrdfError: A mimic that names no joint, itself, or a circle.
    """
    by_name = {joint.name: joint for joint in joints}
    return [_resolved(joint, by_name, source) for joint in by_name.values()]


def _resolved(joint: Joint, by_name: dict[str, Joint], source: Path) -> Joint:
    mimic = joint.mimic
    if mimic is None or joint.type is JointType.FIXED:
        return replace(joint, mimic=None)
    seen = {joint.name}
    while True:
        target = by_name.get(mimic.joint)
        if target is None or target.name in seen:
            raise UrdfError(
                f"{source}: joint '{joint.name}' mimics '{mimic.joint}', "
                + ("which does not exist" if target is None else "which mimics it in turn"),
                allowed="another joint of the same file",
            )
        seen.add(target.name)
        if target.mimic is None or _stands(target):
            break
        step = target.mimic
        mimic = Mimic(
            step.joint, mimic.multiplier * step.multiplier, mimic.multiplier * step.offset + mimic.offset
        )
    if mimic is joint.mimic:
        return joint
    note = f"mimics '{joint.mimic.joint if joint.mimic else ''}', which mimics '{mimic.joint}': joined"
    return replace(joint, mimic=mimic, notes=(*joint.notes, note))


def _stands(joint: Joint) -> bool:
    """Whether a joint cannot move, whatever it mimics."""
    return joint.type is JointType.FIXED or joint.limits.lower == joint.limits.upper


def with_fixed(joints: Iterable[Joint]) -> list[Joint]:
    """The joints, those that cannot move made fixed: equal limits, or a mimic of what does not move."""
    frozen: dict[str, float] = {}
    done: list[Joint] = []
    listed = list(joints)
    for joint in listed:
        if joint.type is JointType.FIXED:
            frozen[joint.name] = 0.0
        elif joint.limits.lower == joint.limits.upper:
            frozen[joint.name] = joint.limits.lower
    for joint in listed:
        if joint.type is JointType.FIXED:
            done.append(joint)
        elif joint.name in frozen:
            at = frozen[joint.name]
            note = f"{joint.type.value} joint with equal limits {at:g}..{at:g}: imported as fixed"
            done.append(_fixed(joint, at, note))
        elif joint.mimic is not None and (joint.mimic.joint in frozen or joint.mimic.multiplier == 0):
            at = joint.mimic.multiplier * frozen.get(joint.mimic.joint, 0.0) + joint.mimic.offset
            why = "which cannot move" if joint.mimic.joint in frozen else "with multiplier 0"
            note = f"mimics '{joint.mimic.joint}', {why}: imported as fixed at {at:g}"
            done.append(_fixed(joint, at, note))
        else:
            done.append(joint)
    return done


def _fixed(joint: Joint, position: float, note: str) -> Joint:
    return Joint(
        name=joint.name,
        type=JointType.FIXED,
        parent=joint.parent,
        child=joint.child,
        origin=_moved(joint, position),
        notes=(*joint.notes, note),
    )


def _moved(joint: Joint, position: float) -> Pose:
    """Pose of the child in the parent with the joint at that position."""
    if position == 0:
        return joint.origin
    parent_T_joint = joint.origin
    step = tuple(part * position for part in joint.axis)
    if joint.type is JointType.PRISMATIC:
        offset = parent_T_joint.matrix()[:3, :3] @ step
        x, y, z = (float(a + b) for a, b in zip(parent_T_joint.position, offset, strict=True))
        return Pose((x, y, z), parent_T_joint.orientation)
    half = position / 2
    x, y, z = (part * math.sin(half) for part in joint.axis)
    return Pose(parent_T_joint.position, _product(parent_T_joint.orientation, (x, y, z, math.cos(half))))


def _product(
    first: tuple[float, float, float, float], second: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    """Quaternion product xyzw."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def turned(joints: Iterable[Joint]) -> list[Joint]:
    """The joints, those with limits like [-π/2, 0] turned to [0, π/2] about the opposite axis.

    Eq. (8) takes 0.9 of the upper limit for open, which is closed where that limit is 0. Nothing
    moves otherwise: only the sign of the position changes, here and in what mimics the joint.
    """
    listed = list(joints)
    flipped = {
        joint.name
        for joint in listed
        if joint.type in (JointType.REVOLUTE, JointType.PRISMATIC)
        and joint.limits.upper <= 0
        and joint.limits.lower < 0
    }
    return [_turned(joint, flipped) for joint in listed]


def _turned(joint: Joint, flipped: set[str]) -> Joint:
    mimic = joint.mimic
    if mimic is not None and mimic.joint in flipped:
        mimic = replace(mimic, multiplier=-mimic.multiplier)
    if joint.name not in flipped:
        return joint if mimic is joint.mimic else replace(joint, mimic=mimic)
    if mimic is not None:
        mimic = replace(mimic, multiplier=-mimic.multiplier, offset=-mimic.offset)
    limits = joint.limits
    note = (
        f"limits [{limits.lower:g}, {limits.upper:g}]: {TURNED}, so that positions are "
        f"[{-limits.upper + 0.0:g}, {-limits.lower:g}] and count the other way"
    )
    x, y, z = joint.axis
    return replace(
        joint,
        axis=(0.0 - x, 0.0 - y, 0.0 - z),
        limits=replace(limits, lower=0.0 - limits.upper, upper=0.0 - limits.lower),
        mimic=mimic,
        notes=(*joint.notes, note),
    )
