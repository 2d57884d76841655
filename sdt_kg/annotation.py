"""What a robot's or kitchen's `.ttl` adds to its URDF, as values."""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Final

from sdt_kg.mechanism import Geometry, Pose


class Drive(Enum):
    """How a base moves. The base policy decides most verdicts, so every verdict prints it."""

    OMNI = "omni"
    DIFFERENTIAL = "differential"
    FIXED = "fixed"


@dataclass(frozen=True, slots=True)
class FingerJoint:
    """A joint that opens and closes a gripper; positions in rad or m."""

    joint: str
    open: float
    closed: float


@dataclass(frozen=True, slots=True)
class Gripper:
    """One gripper of a robot.

    Attributes:
        name: `left`, `right` or `gripper`.
        tool_body: Link whose frame carries the tool frame.
        tool: Pose of the tool frame in `tool_body`: origin between the finger pads, x the
            approach axis (out of the palm), y the axis along which the fingers close.
        fingers: Links which may touch a handle.
        finger_joints: Joints that open and close it, mimicking ones left out.
        opening: Free width between the finger pads when open [m].
        difference: Between positions of its finger joints at most, where one motor drives them through
            springs [rad or m]; infinite where each moves for itself.
    """

    name: str
    tool_body: str
    tool: Pose
    fingers: tuple[str, ...]
    finger_joints: tuple[FingerJoint, ...]
    opening: float
    difference: float = math.inf


@dataclass(frozen=True, slots=True)
class BaseLimits:
    """Speed and acceleration of the base, linear [m/s, m/s²] and angular [rad/s, rad/s²]."""

    linear_velocity: float
    angular_velocity: float
    linear_acceleration: float
    angular_acceleration: float


FASTEST: Final = BaseLimits(10.0, 4 * math.pi, 100.0, 40 * math.pi)
"""No base moves faster in a kitchen: it is in millimetres or degrees, or stands for no limit at all; ours."""


@dataclass(frozen=True, slots=True)
class RobotAnnotation:
    """What CanPerform needs to know of a robot beyond its URDF.

    Attributes:
        drive: Of the hardware.
        base_body: Link that stands for the base; the world frame at (x, y, yaw) maps to it, with
            `base_height` as z [m].
        parked: Joint name → position when driving; every movable joint not listed stays at 0, or
            at the nearest limit; joints that share a motor are parked alike where all can be.
        held: Movable joints that planning never moves (casters, head, laser …).
        acceleration: Joint name → acceleration limit [rad/s² or m/s²].
        coupled: Groups of joints that share one motor and move equally (Stretch's telescope).
        allowed_contacts: Pairs of links whose contact is not a self-collision, beyond bodies
            joined by one joint or rigidly attached to each other.
        overhang: How far the reference's surface may stick out of our shapes [m]; added to
            every margin.
        notes: Assumptions, one sentence each, printed with verdicts.
        base_notes: Those of how fast the base moves, printed where it may.
        cores: Boxes that lie inside the real bodies: name of the body, box in its frame. Collision
            shapes contain the real ones; a proof of a collision needs what they contain.
    """

    robot: str
    drive: Drive
    base_body: str
    base_height: float
    base_limits: BaseLimits
    grippers: tuple[Gripper, ...]
    parked: dict[str, float]
    held: tuple[str, ...]
    acceleration: dict[str, float]
    coupled: tuple[tuple[str, ...], ...]
    allowed_contacts: frozenset[frozenset[str]]
    overhang: float
    notes: tuple[str, ...] = ()
    base_notes: tuple[str, ...] = ()
    cores: tuple[tuple[str, Geometry], ...] = ()

    def notes_of(self, drive: Drive) -> tuple[str, ...]:
        """Assumptions that mean something where the base moves like this."""
        return self.notes if drive is Drive.FIXED else (*self.notes, *self.base_notes)

    @property
    def finger_joints(self) -> frozenset[str]:
        """Names of the finger joints of all its grippers."""
        return frozenset(one.joint for gripper in self.grippers for one in gripper.finger_joints)


@dataclass(frozen=True, slots=True)
class KitchenAnnotation:
    """What a kitchen's `.ttl` adds: where robots start, and acceleration limits of its joints.

    Attributes:
        start: Base pose x, y [m], yaw [rad] in the root frame; robots are then turned to the handle.
        acceleration: Joint name → acceleration limit [rad/s² or m/s²].
    """

    kitchen: str
    start: tuple[float, float, float]
    acceleration: dict[str, float]
    notes: tuple[str, ...] = ()
