"""Mechanism: a tree of bodies and joints as values, between URDF, graph and physics.

`sdt_kg.urdf` makes it from a file, `sdt_kg.triples` writes it to a graph and reads it back,
`services.physics.model` builds Pinocchio's model from it. Equality is exact.
"""

import math
import re
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

_FIXED_AT = re.compile(r"equal limits (\S+)\.\.\S+: imported as fixed$|imported as fixed at (\S+)$")
TURNED = "axis turned"
"""In the note of a joint whose positions are those of its file with the other sign."""
FAR = 30.0
"""[m] From one part of a kitchen to the next; of one in centimetres or inches, some are farther apart."""
LEARNED = "learned from an observed track"
"""In the note of a joint that a kitchen's files do not have so."""

ROUNDED = 1e-6
"""[1] Share of the largest principal moment by which the least may be below 0: files round them."""

SLIGHT = 1e-6
"""[kg m²] The same, of whatever size they are: what a gram has at 3 cm. TIAGo++'s antennas have such."""


class JointType(Enum):
    """Joint types of D_artic; `continuous` has no position limits."""

    FIXED = "fixed"
    PRISMATIC = "prismatic"
    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"


@dataclass(frozen=True, slots=True)
class Pose:
    """Position [m] and unit quaternion xyzw of a child frame in its parent frame."""

    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)

    def matrix(self) -> NDArray[np.float64]:
        """Homogeneous transform, shape (4, 4): maps child coordinates to parent coordinates."""
        x, y, z, w = self.orientation
        parent_T_child = np.eye(4)
        parent_T_child[:3, :3] = (
            (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
        )
        parent_T_child[:3, 3] = self.position
        return parent_T_child


class ShapeType(Enum):
    """Collision shapes. Cylinder and capsule lie along z; a capsule's length excludes its caps."""

    BOX = "box"
    SPHERE = "sphere"
    CYLINDER = "cylinder"
    CAPSULE = "capsule"
    MESH = "mesh"


@dataclass(frozen=True, slots=True)
class Geometry:
    """One collision shape of a body.

    Attributes:
        shape: What it is.
        pose: Pose in the body's frame.
        size: Box: x, y, z; sphere: radius; cylinder, capsule: radius, length [m]; mesh: scale x, y, z.
        mesh_file: Absolute path of a mesh, else empty.
        mesh_hash: SHA-256 of the mesh file, else empty.
    """

    shape: ShapeType
    pose: Pose
    size: tuple[float, ...]
    mesh_file: str = ""
    mesh_hash: str = ""


@dataclass(frozen=True, slots=True)
class Inertia:
    """Mass [kg], centre of mass frame, and ixx, ixy, ixz, iyy, iyz, izz [kg m²] in that frame."""

    mass: float
    pose: Pose
    moments: tuple[float, float, float, float, float, float]

    @property
    def possible(self) -> bool:
        """Whether a body can have such moments: no principal one is below 0, but for rounding."""
        xx, xy, xz, yy, yz, zz = self.moments
        principal = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        return bool(principal[0] >= -ROUNDED * np.abs(principal).max() - SLIGHT)


@dataclass(frozen=True, slots=True)
class Body:
    """A link: rigid, with collision shapes."""

    name: str
    inertia: Inertia | None = None
    collision: tuple[Geometry, ...] = ()


@dataclass(frozen=True, slots=True)
class Mimic:
    """Position of the mimicking joint = multiplier · position of `joint` + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds of a joint in rad or m and seconds; `inf` where the model gives none.

    Attributes:
        acceleration: `inf` on import: URDF has none; annotation gives it (see `Annotation`).
        gain: Of a safety controller: the joint moves towards a position limit at most this fast for
            each rad or m that is left [1/s]. 0 is none, as in URDF.
    """

    lower: float = -math.inf
    upper: float = math.inf
    velocity: float = math.inf
    acceleration: float = math.inf
    effort: float = math.inf
    gain: float = math.inf


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint from a parent body to a child body.

    Attributes:
        origin: Pose of the joint frame (the child's frame at position 0) in the parent's frame.
        axis: Unit vector in the joint frame; motion is about (along) it.
        notes: What import changed or noticed, one sentence each (equal limits made fixed, axis
            normalised or turned …).
    """

    name: str
    type: JointType
    parent: str
    child: str
    origin: Pose = field(default_factory=Pose)
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    limits: Limits = field(default_factory=Limits)
    mimic: Mimic | None = None
    notes: tuple[str, ...] = ()

    @property
    def turned(self) -> str:
        """The note of an import that turned the axis, so that positions count the other way; else empty."""
        return next((note for note in self.notes if TURNED in note), "")

    @property
    def learned(self) -> tuple[str, ...]:
        """The notes that say from what it is learned, and how certain that is."""
        return tuple(note for note in self.notes if LEARNED in note)

    @property
    def fixed_at(self) -> float:
        """Position [rad or m], to six digits, at which an import made it fixed; else 0."""
        found = (_FIXED_AT.search(note) for note in self.notes)
        return next((float(each[1] or each[2]) for each in found if each), 0.0)


SHOWN_NAME = 200
"""[characters] Of a name that is refused."""


@dataclass(frozen=True, slots=True)
class Mechanism:
    """A kinematic tree.

    Attributes:
        name: Name of the model: a bundled name or the stem of its file.
        root: Name of the root body.
        bodies: In file order.
        joints: Parents before children.
        notes: What import noticed about the model as a whole, one sentence each.
    """

    name: str
    root: str
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    notes: tuple[str, ...] = ()

    def carriers(self) -> dict[str, str]:
        """Body → the one above it, or itself, that a joint moves; the root where none does."""
        found = {self.root: self.root}
        for joint in self.joints:
            found[joint.child] = found[joint.parent] if joint.type is JointType.FIXED else joint.child
        return found

    def joint(self, name: str) -> Joint:
        """Joint of that name; KeyError is a bug of ours, input is checked where it enters."""
        return next(joint for joint in self.joints if joint.name == name)

    @property
    def oversized(self) -> tuple[str, ...]:
        """That it is too large for a kitchen, if it is: its lengths may not be in metres."""
        away = {joint: math.hypot(*joint.origin.position) for joint in self.joints}
        joint = max(away, key=away.__getitem__, default=None)
        if joint is None or away[joint] <= FAR:
            return ()
        read = "lengths are read in metres, and these may be millimetres, centimetres or inches"
        return (f"joint '{joint.name}' lies {away[joint]:.4g} m from '{joint.parent}': {read}",)

    def unseen(self) -> str | None:
        """A name that has what cannot be seen, quoted, if there is one: a line break may forge a verdict."""
        names = (self.name, *(each.name for each in (*self.bodies, *self.joints)))
        hidden = (name for name in names if not name.isprintable() or name != name.strip())
        return next((repr(name[:SHOWN_NAME]) for name in hidden), None)
