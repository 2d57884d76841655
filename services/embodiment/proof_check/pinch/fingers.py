r"""Where the fingers of one gripper are, in boxes of positions of arm and finger joints.

At the grasp two fingers touch the handle when each is moved along the closing direction by at most `contact`.
With the arm and the finger joints as they are then, both have a point that is as high as one of the handle,
to within that. Later the tool has kept its pose on the handle to within `tool_position` and `tool_angle`, so
at any value of the container *some* positions of the finger joints, those at the grasp, bring both fingers as
near to it as

.. math:: contact + tool\_position + 2 \sin(tool\_angle / 2) \max |p|,

where p is any point of the fingers, seen from the tool. At the value at which the container begins to move
nothing has slipped yet, and `contact` is all.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Gripper
from sdt_kg.mechanism import JointType, ShapeType
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.geometry.interval import Interval, apply, exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Swing, Tree
from services.embodiment.proof_check.geometry.shapes import SOLVED, Box, box_about, finger_box, source_of
from services.embodiment.proof_check.target import UP, Target

Array = NDArray[np.float64]

SUMS = 1e-12  # [rad or m] more than positions that follow others are off by
LEANS = 1e-4  # [1] sine of an angle by which a hinge is taken for upright: URDF often says 1.5708


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A shape of a finger: the box about it, in the finger's frame, and whether it is a cylinder about z."""

    box: Box
    round: bool


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Bodies of a finger that no joint moves against each other.

    Attributes:
        name: Of the body that carries them.
        chain: From the world to it.
        rates: How far each of its n joints moves for a unit of each variable, shape (n, m).
        offsets: Where they are with all variables at 0 [rad or m], shape (n,).
        slacks: How far they may be from there [rad or m], shape (n,).
    """

    name: str
    chain: Chain
    rates: Array
    offsets: Array
    slacks: Array
    pieces: tuple[Piece, ...]

    def joints(self, middle: Array, half: Array) -> tuple[Array, Array]:
        """Middles and half widths of its joints in boxes of the variables (L, m), shape (L, n)."""
        return middle @ self.rates.T + self.offsets, half @ np.abs(self.rates).T + self.slacks + SUMS


@dataclass(frozen=True, slots=True, eq=False)
class Hand:
    """An arm that is anywhere on the floor, and its fingers one by one.

    Attributes:
        names: Of the variables: the arm's joints, then those that move the fingers.
        low, high: Their limits, as far as certification lets them go [rad or m], shape (m,).
        upright: How many of the first joints leave every later one upright, to within `LEANS`.
        leaning: By how much heights depend on the hinges among these all the same [m].
        fingers: Each in its parts.
        driven: Which variables one motor drives, and by how much they may differ [rad or m].
        far: Of any point that a finger may touch, from the tool [m].
    """

    gripper: str
    names: tuple[str, ...]
    low: Array
    high: Array
    upright: int
    leaning: float
    fingers: tuple[tuple[Part, ...], ...]
    driven: tuple[tuple[int, ...], float]
    far: float

    def differ(self, low: Array, high: Array) -> Array:
        """By how much two driven variables differ at least in boxes, beyond what they may, shape (L,)."""
        driven, most = self.driven
        least = np.full(len(low), -np.inf)
        for one, other in permutations(driven, 2):
            least = np.maximum(least, low[:, one] - high[:, other])
        return least - most - SUMS

    def near(self, tolerances: Tolerances, begins: bool) -> float:
        """How near to the handle both fingers are [m], when the container begins to move or later."""
        if begins:
            return tolerances.contact + self.leaning + SOLVED
        turned = 2 * float(np.sin(tolerances.tool_angle / 2)) * (self.far + tolerances.contact)
        return tolerances.contact + tolerances.tool_position + turned + self.leaning + SOLVED


def hand_of(tree: Tree, gripper: Gripper, arm: Arm, tolerances: Tolerances) -> Hand | None:
    """The hand behind an arm; None where it has no two fingers that could hold anything between them."""
    box = finger_box(tree.mechanism, gripper, tolerances)
    found = groups(tree, gripper)
    if box is None or len(found) < 2:
        return None
    links, carrier = arm.chain.links, tree.carrier(gripper.tool_body)
    moving = [joint for body in gripper.fingers for joint in tree.path(body, carrier)]
    names = [source_of(tree, joint)[0] for joint in moving if joint.type is not JointType.FIXED]
    sources = [name for name in dict.fromkeys(names) if name not in {link.name for link in links}]
    limits = np.array([tree.limits(tree.mechanism.joint(name)) for name in sources]).reshape(-1, 2)
    if not np.isfinite(limits).all():
        return None
    variables = (*(link.name for link in links), *sources)
    driven = tuple(variables.index(one.joint) for one in gripper.finger_joints if one.joint in variables)
    return Hand(
        gripper.name,
        variables,
        np.array([*(link.lower for link in links), *(limits[:, 0] - tolerances.position)]),
        np.array([*(link.upper for link in links), *(limits[:, 1] + tolerances.position)]),
        *_upright(arm),
        tuple(
            tuple(_part(tree, arm, (carrier, *one, variables), tolerances) for one in sorted(parts.items()))
            for _, parts in sorted(found.items())
        ),
        (driven, gripper.difference + tolerances.coupling),
        float(np.linalg.norm(np.maximum(np.abs(box[0]), np.abs(box[1])))),
    )


def _upright(arm: Arm) -> tuple[int, float]:
    """How many of the first joints only lift and turn about nearly the vertical, and what that lifts.

    A turn about an axis that leans by e moves a point at a distance r up or down by no more than 2 e r, and
    the axes behind it lean by 2 e more.
    """
    at, leans, lifted = HERE, 0.0, 0.0
    for k, link in enumerate(arm.chain.links):
        at = at @ link.before
        if link.turns:
            axis = apply(at.rotation, exact(link.axis))
            own = float(axis[..., :2].norm().hi)
            if own > LEANS:
                return k, lifted
            lifted += 2 * (1 + LEANS) * (leans + own) * float(arm.reach[k])
            leans += 2 * (1 + LEANS) * own
    return len(arm.chain.links), lifted


def groups(tree: Tree, gripper: Gripper) -> dict[str, dict[str, list[str]]]:
    """Bodies by finger, and by the body that carries them: a finger begins where all have parted.

    One without a shape touches nothing: it is no finger for certification, and parts none.
    """
    shaped = {body.name for body in tree.mechanism.bodies if body.collision}
    paths = {
        body: [joint.child for joint in tree.path(body) if joint.type is not JointType.FIXED]
        for body in gripper.fingers
        if body in shaped
    }
    least = min(map(len, paths.values()), default=0)
    shared = next((k for k in range(least) if len({path[k] for path in paths.values()}) > 1), least)
    found: dict[str, dict[str, list[str]]] = {}
    for body, path in paths.items():
        parts = found.setdefault("".join(path[shared : shared + 1]), {})
        parts.setdefault(tree.carrier(body), []).append(body)
    return found


def _part(
    tree: Tree, arm: Arm, own: tuple[str, str, list[str], tuple[str, ...]], tolerances: Tolerances
) -> Part:
    """One part: `own` are what carries the tool, what carries the part, its bodies, and the variables."""
    (hand, carrier, bodies, variables), count = own, len(arm.chain.links)
    path = tree.path(carrier, hand)
    behind = tree.chain(path, HERE, 0.0)
    joints = [joint for joint in path if joint.type is not JointType.FIXED]
    rates = np.zeros((count + len(joints), len(variables)))
    rates[:count, :count] = np.eye(count)
    offsets, slacks = np.zeros((2, count + len(joints)))
    for k, joint in enumerate(joints, count):
        name, rates_k, offsets[k] = source_of(tree, joint)
        rates[k, variables.index(name)] = rates_k
        slacks[k] = 0.0 if name == joint.name else tolerances.coupling + tolerances.position
    pieces = [piece for body in bodies for piece in _pieces(tree, carrier, body)]
    chain = Chain((*arm.chain.links, *behind.links), behind.end)
    return Part(carrier, chain, rates, offsets, slacks, tuple(pieces))


def _pieces(tree: Tree, carrier: str, body: str) -> Iterator[Piece]:
    """The shapes of a body, in the frame of the one that carries it."""
    at = tree.chain(tree.path(body, carrier), HERE, 0.0).end
    (found,) = (one for one in tree.mechanism.bodies if one.name == body)
    for geometry in found.collision:
        box = box_about(geometry)
        yield Piece(Box(at @ box.middle, box.half), geometry.shape is ShapeType.CYLINDER)


def spans(part: Part, upright: int, middle: Array, half: Array) -> Iterator[tuple[Array, Array]]:
    """Heights below and above which no point of each piece comes, in boxes of the variables, shape (L,) [m].

    Where an upright hinge is, no height depends on: it counts as if it stood still.

    Args:
        part: Whose pieces they are.
        upright: How many of the first joints leave every later one upright.
        middle: Of the boxes, shape (L, m).
        half: Half their widths.
    """
    q, widths = part.joints(middle, half)
    origins, axes, end = part.chain.frames(q)
    turns = np.array([link.turns for link in part.chain.links])
    widths[:, (np.arange(len(turns)) < upright) & turns] = 0.0
    swing, up = Swing(origins, axes, widths, turns, upright), np.tile(UP, (len(q), 1))
    for piece in part.pieces:
        at = end @ piece.box.middle
        away = exact(_reach(piece, at.rotation[:, 2]) + swing.along(up, at, piece.box.half))
        z = at.translation[:, 2]
        yield (z - away).lo, (z + away).hi


def _reach(piece: Piece, up: Interval) -> Array:
    """How far a piece reaches from its middle upwards, the vertical as it sees it (L, 3), shape (L,) [m]."""
    if not piece.round:
        return (up.magnitude() * exact(piece.box.half)).total().hi
    radius, _, length = piece.box.half
    return (up[:, :2].norm() * exact(radius) + up[:, 2].magnitude() * exact(length)).hi


def handle_span(target: Target) -> tuple[float, float]:
    """Heights of the lowest and the highest point of the handle's boxes [m]."""
    lows, highs = [], []
    for box, half in zip(target.boxes, target.half, strict=True):
        reach = exact((box.rotation[2].magnitude() * exact(half)).total().hi)
        lows.append(float((box.translation[2] - reach).lo))
        highs.append(float((box.translation[2] + reach).hi))
    return min(lows), max(highs)
