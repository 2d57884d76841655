"""Boxes about collision shapes, and about the fingers of a gripper wherever their joints are."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import chain, pairwise, product

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Gripper
from sdt_kg.mechanism import Geometry, Joint, JointType, Mechanism, ShapeType
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.geometry.interval import Interval, apply, exact
from services.embodiment.proof_check.geometry.levers import levers
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Placement, Tree, placement
from services.physics.geometry.shapes import PADDING, surface

Array = NDArray[np.float64]

SIGNS = np.array([*product((-1.0, 1.0), repeat=3)])
"""Of a box's corners, as seen from its middle, shape (8, 3)."""
SOLVED = 1e-5  # [m] more than the distance of two shapes is off by
CELLS = 256  # into which the positions of the finger joints of one finger are divided


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """A box about a shape: where its middle sits in a body, and its half extents [m], shape (3,)."""

    middle: Placement
    half: Array


def box_about(geometry: Geometry) -> Box:
    """A box that contains a collision shape; of a mesh, every hull of its parts as well."""
    at = placement(geometry.pose)
    if geometry.shape is ShapeType.MESH:
        bounds = [one.aabb_local for one in surface(geometry)]
        low = np.min([one.min_ for one in bounds], axis=0) - 2 * PADDING
        high = np.max([one.max_ for one in bounds], axis=0) + 2 * PADDING
        shift = Placement(HERE.rotation, exact((low + high) / 2))
        return Box(at @ shift, (high - low) / 2 + PADDING)
    size = geometry.size
    if geometry.shape is ShapeType.BOX:
        return Box(at, np.array(size) / 2)
    radius = size[0]
    along = radius
    if geometry.shape is not ShapeType.SPHERE:
        along = size[1] / 2 + (radius if geometry.shape is ShapeType.CAPSULE else 0.0)
    return Box(at, np.array([radius, radius, along]))


def boxes_of(tree: Tree, body: str) -> list[Box]:
    """A box about each shape of a body."""
    (found,) = (one for one in tree.mechanism.bodies if one.name == body)
    return [box_about(geometry) for geometry in found.collision]


def extents(at: Placement, half: Array) -> Interval:
    """Half extents along the outer axes of boxes at placements, shape (…, 3)."""
    return apply(at.rotation.magnitude(), exact(half))


def tool_in(tree: Tree, gripper: Gripper) -> Placement:
    """carrier_T_tool: where the tool sits in the body that a joint moves."""
    at = HERE
    for joint in tree.path(gripper.tool_body, tree.carrier(gripper.tool_body)):
        at = at @ placement(joint.origin)
    return at @ placement(gripper.tool)


Corners = tuple[Array, Array]


def finger_box(mechanism: Mechanism, gripper: Gripper, tolerances: Tolerances) -> Corners | None:
    """Corners of a box in the tool's frame that holds all fingers, wherever their joints are [m].

    None where there is none: no finger has a shape, or a finger hangs elsewhere than on the tool's link, or
    behind a joint without limits.
    """
    found = finger_shapes(mechanism, gripper, tolerances)
    return None if found is None else hull(found)


def hull(boxes: Sequence[Corners]) -> Corners:
    """Corners of the box about boxes."""
    return np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)


def finger_shapes(
    mechanism: Mechanism, gripper: Gripper, tolerances: Tolerances
) -> tuple[Corners, ...] | None:
    """The same of each shape of the fingers; None where `finger_box` is."""
    alone = (replace(gripper, fingers=(body,)) for body in gripper.fingers)
    each = [_shapes_of(mechanism, finger, tolerances) for finger in alone]
    known = [shapes for shapes in each if shapes is not None]
    found = tuple(chain.from_iterable(known))
    return found if found and len(known) == len(each) else None


@lru_cache(maxsize=64)
def _shapes_of(mechanism: Mechanism, finger: Gripper, tolerances: Tolerances) -> tuple[Corners, ...] | None:
    """The same of the only body of a gripper's fingers, which may have no shape."""
    tree, (body,) = Tree(mechanism), finger.fingers
    carrier = tree.carrier(finger.tool_body)
    path = tree.path(body, carrier)
    if not path or path[0].parent != carrier:
        return None
    boxes = boxes_of(tree, body)
    if not boxes:
        return ()
    joints = [joint for joint in path if joint.type is not JointType.FIXED]
    ends = [tree.limits(tree.mechanism.joint(source_of(tree, joint)[0])) for joint in joints]
    if not np.isfinite(ends).all():
        return None
    links, found = tree.chain(path, HERE, 0.0), list[Corners]()
    q, spread = _cells(tree, joints, tolerances)
    origins, axes, end = links.frames(q)
    tool_T_body = tool_in(tree, finger).inverse() @ end
    for box in boxes:
        reach = _moved(links, origins, axes, end @ box.middle, box.half, spread)
        at = tool_T_body @ box.middle
        around = extents(at, box.half).hi + reach[:, None]
        low, high = at.translation.lo - around, at.translation.hi + around
        found.append((low.min(axis=0), high.max(axis=0)))
    whole = all(np.isfinite(corner).all() for box in found for corner in box)
    return tuple(found) if whole else None


def widened(box: tuple[Array, Array], near: float, tolerances: Tolerances, slips: bool) -> Array:
    """Corners of a box about what is in or near one of the tool's frame at the grasp, shape (8, 3).

    Args:
        box: Its corners [m].
        near: How near that is [m].
        tolerances: By how much the tool may slip and turn.
        slips: Whether it may have done so.
    """
    wide = near
    if slips:
        far = float(np.linalg.norm(np.maximum(np.abs(box[0]), np.abs(box[1])))) + tolerances.contact
        wide += tolerances.tool_position + 2 * float(np.sin(tolerances.tool_angle / 2)) * far
    ends = np.stack((box[0] - wide, box[1] + wide))
    return np.array([[ends[pick[k], k] for k in range(3)] for pick in product((0, 1), repeat=3)])


def _moved(  # noqa: PLR0913, PLR0917  # a chain's frames, and a box behind them
    chain: Chain, origins: Interval, axes: Interval, at: Placement, half: Array, spread: Array
) -> Array:
    """How far points of a box move at most inside each cell [m], shape (L,)."""
    if not chain.links:
        return np.zeros(len(at.translation.lo))
    last = len(chain.links)
    ends = Interval(
        np.concatenate((origins.lo, at.translation.lo[:, None]), axis=1),
        np.concatenate((origins.hi, at.translation.hi[:, None]), axis=1),
    )
    still = Interval(
        np.concatenate((axes.lo, np.zeros((len(axes.lo), 1, 3))), axis=1),
        np.concatenate((axes.hi, np.zeros((len(axes.hi), 1, 3))), axis=1),
    )
    arms = levers(ends, still, last, (*chain.links, chain.links[-1]))[:, :last]
    turns = np.array([link.turns for link in chain.links])
    arms = arms + np.where(turns, np.linalg.norm(half), 0.0)
    return (arms * spread).sum(axis=1) * (1 + 1e-12)


def _cells(tree: Tree, joints: list[Joint], tolerances: Tolerances) -> tuple[Array, Array]:
    """Positions of the joints amid each cell, and how far they are from there at most, shape (L, n)."""
    resolved = [source_of(tree, joint) for joint in joints]
    sources = list({name: None for name, _, _ in resolved})
    count = max(1, int(CELLS ** (1 / max(1, len(sources)))))
    grids: list[list[tuple[float, float]]] = []
    for name in sources:
        lower, upper = tree.limits(tree.mechanism.joint(name))
        lower, upper = lower - tolerances.position, upper + tolerances.position
        edges = np.linspace(lower, upper, count + 1)
        grids.append([((a + b) / 2, (b - a) / 2 * (1 + 1e-9)) for a, b in pairwise(edges)])
    middles, widths = [], []
    for cell in product(*grids):
        at = dict(zip(sources, cell, strict=True))
        middles.append([m * at[name][0] + offset for name, m, offset in resolved])
        widths.append(
            [
                abs(m) * at[name][1]
                + (0.0 if name == joint.name else tolerances.coupling + tolerances.position)
                for joint, (name, m, offset) in zip(joints, resolved, strict=True)
            ]
        )
    shape = (len(middles), len(joints))
    return np.array(middles).reshape(shape), np.array(widths).reshape(shape)


def source_of(tree: Tree, joint: Joint) -> tuple[str, float, float]:
    """Joint that is mimicked in the end, multiplier and offset."""
    multiplier, offset = 1.0, 0.0
    while joint.mimic is not None:
        offset += multiplier * joint.mimic.offset
        multiplier *= joint.mimic.multiplier
        joint = tree.mechanism.joint(joint.mimic.joint)
    return joint.name, multiplier, offset
