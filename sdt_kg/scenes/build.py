"""Parts that stand in the world, with all joints at 0 → Mechanism."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Body, Geometry, Inertia, Joint, JointType, Limits, Mechanism, Mimic, Pose
from sdt_kg.scenes.planes import LEVEL, floor_of
from sdt_kg.urdf import quaternion
from sdt_kg.urdf.document import reachable
from sdt_kg.urdf.inertias import with_possible
from sdt_kg.urdf.joints import checked, resolved, turned, with_fixed

Matrix = NDArray[np.float64]

FLOOR: Final = "on_floor"
"""What the root is called, behind the scene's own, where that is above the floor."""

HANDLE: Final = "handle"
"""In the name of a shape, in whatever case: it is one of a handle."""


@dataclass(frozen=True, slots=True)
class Part:
    """A link where it stands.

    Attributes:
        frame: world_T_frame, shape (4, 4): at the joint that carries the link.
        shapes: Collision shapes; their poses are in `frame`.
        handle: Those of them that the file calls a handle, as `HANDLE` has it.
    """

    name: str
    frame: Matrix
    inertia: Inertia | None = None
    shapes: tuple[Geometry, ...] = ()
    handle: tuple[Geometry, ...] = ()


@dataclass(frozen=True, slots=True)
class Link:
    """A joint between two parts; the child's frame is the joint's. The axis is in that frame."""

    name: str
    type: JointType
    parent: str
    child: str
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    limits: Limits = field(default_factory=Limits)
    mimic: Mimic | None = None
    notes: tuple[str, ...] = ()


def built(
    name: str, parts: Sequence[Part], links: Sequence[Link], notes: Sequence[str], source: Path
) -> Mechanism:
    """The mechanism, its root the first part; joints parents first, checked as a URDF's are.

    Shapes that are called a handle, of a body that is not, become a body of their own, which is fixed to it:
    scenes have them in the body of the door. Where the floor is below z = 0, the root is a body on it, to
    which the scene is fixed: robots stand at z = 0 of the root.

    Raises:
        UrdfError: A name twice, a joint between parts that do not exist, a loop, or impossible limits.
    """
    parts, links, apart = _with_handles(parts, links)
    parts, links, lifted = _on_floor(parts, links)
    frames = {part.name: part.frame for part in parts}
    twice = sorted(name for name, count in Counter(part.name for part in parts).items() if count > 1)
    if twice:
        raise UrdfError(
            f"{source}: several bodies are named '{twice[0]}'", allowed="each name once, 'world' the root's"
        )
    for link in links:
        if {link.parent, link.child} - set(frames):
            raise UrdfError(
                f"{source}: joint '{link.name}' joins '{link.parent}' and '{link.child}', not both there"
            )
    joints = with_fixed(resolved([checked(_joint(link, frames), source) for link in links], source))
    root = parts[0].name
    ends = [(joint.parent, joint.child) for joint in joints]
    cut_off = sorted(set(frames) - reachable(root, ends))
    if cut_off or len(ends) != len(frames) - 1:
        raise UrdfError(
            f"{source}: bodies form no tree: {', '.join(cut_off[:8]) or 'a loop'}", allowed="a tree"
        )
    bodies, impossible = with_possible(Body(part.name, part.inertia, part.shapes) for part in parts)
    return Mechanism(
        name, root, bodies, _ordered(turned(joints), root), (*notes, *apart, *lifted, *impossible)
    )


def _with_handles(parts: Sequence[Part], links: Sequence[Link]) -> tuple[list[Part], list[Link], list[str]]:
    """Handles as parts, with the joints that fix them, and a note of each."""
    names = {part.name for part in parts}
    found, fixed, notes = list[Part](), list(links), list[str]()
    for part in parts:
        name = f"{part.name}_{HANDLE}"
        if not part.handle or HANDLE in part.name.lower() or name in names:
            found.append(part)
            continue
        rest = tuple(shape for shape in part.shapes if shape not in part.handle)
        found += [replace(part, shapes=rest, handle=()), Part(name, part.frame, None, part.handle)]
        fixed.append(Link(f"{name}_fixed", JointType.FIXED, part.name, name))
        notes.append(f"the shapes of {part.name} that are called a handle are a link of their own, {name}")
    return found, fixed, notes


def _on_floor(
    parts: Sequence[Part], links: Sequence[Link]
) -> tuple[Sequence[Part], Sequence[Link], list[str]]:
    """The scene on a body on its floor, if that is below z = 0, and a note of it."""
    shapes = ((part, one) for part in parts for one in part.shapes)
    height, plane = floor_of((part.name, part.frame @ one.pose.matrix(), one) for part, one in shapes)
    if height >= -LEVEL:
        return parts, links, []
    root = parts[0].name
    ground, frame = f"{root}_{FLOOR}", np.eye(4)
    frame[2, 3] = height
    fixed = Link(f"{ground}_fixed", JointType.FIXED, ground, root)
    where = f"the floor, a plane of '{plane}', is {-height:.3g} m below the scene's z = 0"
    return [Part(ground, frame), *parts], [fixed, *links], [f"{where}: heights are from the floor"]


def _joint(link: Link, frames: dict[str, Matrix]) -> Joint:
    return Joint(
        name=link.name,
        type=link.type,
        parent=link.parent,
        child=link.child,
        origin=pose_of(between(frames[link.parent], frames[link.child])),
        axis=link.axis,
        limits=link.limits,
        mimic=link.mimic,
        notes=link.notes,
    )


def _ordered(joints: Sequence[Joint], root: str) -> tuple[Joint, ...]:
    """Parents before children, else in file order."""
    carried: dict[str, list[Joint]] = {}
    for joint in joints:
        carried.setdefault(joint.parent, []).append(joint)
    done, waiting = list[Joint](), [root]
    while waiting:
        group = carried.get(waiting.pop(), [])
        done += group
        waiting += [joint.child for joint in reversed(group)]
    return tuple(done)


def matrix_of(position: Sequence[float], orientation: Sequence[float] = (0.0, 0.0, 0.0, 1.0)) -> Matrix:
    """Transform of a position [m] and a quaternion xyzw of any length above 0."""
    x, y, z, w = (float(part) / float(np.linalg.norm(orientation)) for part in orientation)
    px, py, pz = (float(part) for part in position)
    return Pose((px, py, pz), (x, y, z, w)).matrix()


def between(world_T_a: Matrix, world_T_b: Matrix) -> Matrix:
    """a_T_b."""
    rotation = world_T_a[:3, :3].T
    a_T_b = np.eye(4)
    a_T_b[:3, :3] = rotation @ world_T_b[:3, :3]
    a_T_b[:3, 3] = rotation @ (world_T_b[:3, 3] - world_T_a[:3, 3])
    return a_T_b


def pose_of(transform: Matrix) -> Pose:
    """Pose of a transform, shape (4, 4)."""
    x, y, z = (float(part) + 0.0 for part in transform[:3, 3])
    return Pose((x, y, z), quaternion(transform[:3, :3]))


def turn(axis: Sequence[float], angle: float) -> Matrix:
    """Rotation about an axis of length 1 through the origin by an angle [rad]."""
    half = angle / 2
    x, y, z = (float(part) * np.sin(half) for part in axis)
    return matrix_of((0.0, 0.0, 0.0), (x, y, z, float(np.cos(half))))


def shift(axis: Sequence[float], by: float = 1.0) -> Matrix:
    """Translation along an axis."""
    return matrix_of([float(part) * by for part in axis])


def listed(what: str, names: Sequence[str]) -> list[str]:
    """A note that something was not carried over, with its names; none if there is nothing."""
    if not names:
        return []
    shown = ", ".join(names[:12]) + (f" … ({len(names)} in all)" if len(names) > 12 else "")
    return [f"not carried over: {what}: {shown}"]
