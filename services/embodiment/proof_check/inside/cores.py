"""Boxes inside the robot against what is solid around it: where both meet, no certificate can be.

Collision shapes contain the real ones, so that they meet proves nothing. The robot's annotation gives
*cores*, boxes that its bodies contain; the kitchen's boxes, cylinders and spheres are taken as they are
declared, meshes are not used. A core is solid for those that joints farther out carry, too. A point that
lies in a core, wherever the joints are in a box of positions, and in such a solid, refutes the box.

With the joints between both moved one after the other from the last one inwards, the point as the core
sees it moves along each axis of the core by no more than a `Swing` says.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.iri import Iri, body_iri, joint_iri
from sdt_kg.mechanism import Geometry, ShapeType
from sdt_kg.state import State
from services.embodiment.proof_check.inside.boxes import Core, within
from services.embodiment.proof_check.interval import Interval, apply, cross, exact
from services.embodiment.proof_check.mechanics import HERE, Chain, Link, Placement, Swing, Tree, placement
from services.physics.geometry.floor import BELOW, LEVEL, SIZE, standing
from services.physics.tree import exempt_pairs

Array = NDArray[np.float64]
Slack = Callable[[tuple[Link, ...]], Array]
"""How far joints of the kitchen may be from where they are said to be [rad or m], shape (n,)."""

ROUNDING = 1e-7  # [m] what quaternions and axes of not quite unit length can be off by
FLOOR = "floor"
"""In place of the IRI of a body, which never is one word."""
ROUNDS, MORE_ROUNDS = 12, 96
"""Of projections between a core and a solid, more where these end near; any point they lead to is checked."""
LEAP, NEARBY = 6, 1e-3
"""Projections after which the way that is left is taken at once; a step is no smaller share of it."""
NEARLY = 0.005  # [m] outside of the core


@dataclass(frozen=True, slots=True, eq=False)
class Solids:
    """Boxes, each inside something that no robot can be in.

    Attributes:
        bodies: IRI of the body of each.
        at: Placements in the frame in which they stand, shapes (S, 3, 3) and (S, 3).
        half: Half extents, less what certification tolerates [m], shape (S, 3).
    """

    bodies: tuple[Iri, ...]
    at: Placement
    half: Array


@dataclass(frozen=True, slots=True, eq=False)
class Around:
    """Solids that stand still in one frame.

    Attributes:
        carrier: Index of the chain's link whose frame it is; −1 is the world.
        keeps: Which core certification keeps apart from which of them, shape (C, S).
    """

    carrier: int
    solids: Solids
    keeps: NDArray[np.bool_]


def _all(parts: list[Solids]) -> Solids:
    """All of them, in their order."""
    turns, places = [one.at.rotation for one in parts], [one.at.translation for one in parts]
    bodies = tuple(body for one in parts for body in one.bodies)
    return Solids(
        bodies,
        Placement(_joined(turns, (3, 3)), _joined(places, (3,))),
        np.concatenate([np.zeros((0, 3)), *(one.half for one in parts)]),
    )


def _joined(parts: list[Interval], shape: tuple[int, ...]) -> Interval:
    none = np.zeros((0, *shape))
    return Interval(
        np.concatenate([none, *(one.lo for one in parts)]), np.concatenate([none, *(one.hi for one in parts)])
    )


class Surroundings:
    """What is solid around the robot, for any state of the kitchen; bodies that stay are measured once."""

    def __init__(self, kitchen: Tree) -> None:
        self._kitchen = kitchen
        below = placement(BELOW)
        at = Placement(below.rotation, exact(np.array([BELOW.position])))
        self._floor = _solids(FLOOR, at, np.array(SIZE) / 2 - ROUNDING)
        self._chains: dict[str, Chain] = {}
        self._seen: dict[tuple[str, bytes, bytes], Solids] = {}

    def at(self, state: State, slack: Slack) -> Solids:
        """What is below the floor, and boxes inside the kitchen's declared shapes in a state.

        Args:
            state: Of the kitchen.
            slack: How far joints may be from there.
        """
        name, found = self._kitchen.mechanism.name, [self._floor]
        for body in self._kitchen.mechanism.bodies:
            geometries = [one for one in body.collision if one.shape is not ShapeType.MESH]
            if not geometries:
                continue
            if body.name not in self._chains:
                self._chains[body.name] = self._kitchen.chain(self._kitchen.path(body.name), HERE, 0.0)
            chain = self._chains[body.name]
            q = np.array([[state[joint_iri(name, link.name)] for link in chain.links]]).reshape(1, -1)
            iri, off = body_iri(name, body.name), slack(chain.links)
            key = body.name, q.tobytes(), off.tobytes()
            if key not in self._seen:
                self._seen[key] = _placed(iri, chain, q, geometries, off)
            found.append(self._seen[key])
        return _all(found)


def kept_apart(
    cores: tuple[Core, ...], solids: Solids, tree: Tree, annotation: RobotAnnotation
) -> NDArray[np.bool_]:
    """Which core certification keeps apart from which solid around the robot: some stand on the ground."""
    on_floor = standing(tree.mechanism, annotation)
    stands = [body_iri(tree.mechanism.name, core.body) in on_floor for core in cores]
    turned = np.maximum(np.abs(solids.at.rotation.lo), np.abs(solids.at.rotation.hi))[:, 2]
    top = solids.at.translation.lo[:, 2] + (turned * solids.half).sum(axis=1)
    return ~np.outer(stands, top <= LEVEL)


def own_solids(cores: tuple[Core, ...], tree: Tree, annotation: RobotAnnotation) -> tuple[Around, ...]:
    """Cores as solids, by the link that carries them, for those of links farther out."""
    exempt = exempt_pairs(tree.mechanism, annotation)
    bodies = [body_iri(tree.mechanism.name, core.body) for core in cores]
    found: list[Around] = []
    for link in sorted({core.link for core in cores}):
        here = [k for k, core in enumerate(cores) if core.link == link]
        keeps = np.array(
            [
                [core.link > link and frozenset((body, bodies[k])) not in exempt for k in here]
                for core, body in zip(cores, bodies, strict=True)
            ]
        )
        if keeps.any():
            each = [_solids(bodies[k], cores[k].middle, cores[k].half - ROUNDING) for k in here]
            found.append(Around(link, _all(each), keeps))
    return tuple(found)


def pierced(
    cores: tuple[Core, ...], c: int, chain: Chain, around: tuple[Around, ...], boxes: tuple[Array, Array]
) -> Array:
    """How deep a point of a solid lies in core c in all of each box of positions [m], shape (L,).

    A lower bound; not above 0 where no such point was found.

    Args:
        cores: Boxes inside bodies of the arm.
        c: Index of the one that is meant.
        chain: The arm.
        around: What is solid.
        boxes: Middles and half widths of the positions of the chain's joints, shapes (L, n).
    """
    depth = np.full(len(boxes[0]), -np.inf)
    for one in around:
        if one.keeps[c].any():
            seen = slice(one.carrier + 1, cores[c].link + 1)
            moved = boxes[0][:, seen], boxes[1][:, seen]
            depth = np.maximum(depth, _pierced(cores[c], chain.links[seen], one.solids, one.keeps[c], moved))
    return depth


def _pierced(
    core: Core,
    links: tuple[Link, ...],
    solids: Solids,
    keeps: NDArray[np.bool_],
    boxes: tuple[Array, Array],
) -> Array:
    """The same, of the solids in one frame, from which these links lead to the core."""
    middle, half = boxes
    origins, axes, at = Chain(links, core.middle).frames(middle)
    turns = np.array([link.turns for link in links], dtype=np.bool_)
    moved = _moved(at.translation, origins, axes, links, half)
    swing = Swing(origins, axes, half, turns)
    met = _near(at, core.half, solids) & keeps
    points, near = np.zeros((*met.shape, 3)), np.full(met.shape, -np.inf)
    where, those = np.nonzero(met)
    points[met], near[met] = _points(at.some(where), core.half, solids, those, moved[where, None], ROUNDS)
    depth, rows, best = np.full(len(middle), -np.inf), np.flatnonzero(met.any(axis=1)), near.argmax(axis=1)
    depth[rows] = _depth(
        core, at.some(rows), _some(swing, rows), solids, (points[rows, best[rows]], best[rows])
    )
    for s in np.flatnonzero(met.any(axis=0)):
        left = np.flatnonzero((depth <= 0) & (near[:, s] > -NEARLY))
        if len(left):
            there, which, still = at.some(left), np.full(len(left), s), _some(swing, left)
            less = np.minimum(moved[left], max(float(core.half.min()) - NEARLY, 0.0))
            found, _ = _points(there, core.half, solids, which, less[:, None], MORE_ROUNDS)
            depth[left] = _depth(core, there, still, solids, (found, which))
            if (depth[left] <= 0).any():  # less deep where it moves less
                less = still.seen(exact(found), there)
                found, _ = _points(there, core.half, solids, which, less, MORE_ROUNDS)
                depth[left] = np.maximum(depth[left], _depth(core, there, still, solids, (found, which)))
    return depth


def _near(at: Placement, half: Array, solids: Solids) -> NDArray[np.bool_]:
    """Which solids may come as near as `NEARLY` to a core, shape (L, S): no face of one of them divides both.

    Where one does, no point can be found. In floats.
    """
    turn, other = _middle(at.rotation)[:, None], _middle(solids.at.rotation)[None]
    between = np.matmul(turn.swapaxes(-1, -2), other)
    way = (_middle(solids.at.translation)[None] - _middle(at.translation)[:, None])[..., None]
    own, its = (np.abs(np.matmul(one.swapaxes(-1, -2), way))[..., 0] for one in (turn, other))
    size = np.abs(between)
    own -= half + np.matmul(size, solids.half[None, :, :, None])[..., 0]
    its -= solids.half + np.matmul(half, size)
    return np.maximum(own.max(axis=-1), its.max(axis=-1)) < 2 * NEARLY  # √3 · NEARLY, across a corner


def _some(swing: Swing, chosen: NDArray[np.intp]) -> Swing:
    """Those boxes of several."""
    return Swing(swing.origins[chosen], swing.axes[chosen], swing.half[chosen], swing.turns)


def _depth(
    core: Core, at: Placement, swing: Swing, solids: Solids, found: tuple[Array, NDArray[np.intp]]
) -> Array:
    """How deep points (L, 3) of solids (L,) stay in a core [m], shape (L,); −inf where one is of none."""
    point, which = found
    local = apply(solids.at.rotation[which].T, exact(point) - solids.at.translation[which])
    inside = (local.magnitude().hi + ROUNDING <= solids.half[which]).all(axis=1)
    seen = apply(at.rotation.T, exact(point) - at.translation).magnitude().hi
    deep = (core.half - seen - swing.seen(exact(point), at)).min(axis=1) - ROUNDING
    return np.where(inside, deep, -np.inf)


def _moved(point: Interval, origins: Interval, axes: Interval, links: tuple[Link, ...], half: Array) -> Array:
    """How far points (L, 3) move at most, as the last link sees them [m], shape (L,)."""
    arms = cross(point[:, None] - origins, axes).norm().hi
    arms = np.where(np.array([link.turns for link in links]), arms, 1.0)
    return (arms * half).sum(axis=1) * (1 + 1e-12)


def _points(  # noqa: PLR0913, PLR0917  # where a box is, what it may meet, and how far it is looked
    at: Placement, half: Array, solids: Solids, which: NDArray[np.intp], moved: Array, rounds: int
) -> tuple[Array, Array]:
    """A point of a solid in each box (L, 3), and how deep it lies there (L,); to be checked.

    The solids are those of `which`, shape (L,); it is looked for where a box is smaller by `moved`, shape
    (L, 1) or (L, 3). In floats.
    """
    turn, place = _middle(at.rotation), _middle(at.translation)
    other, there = _middle(solids.at.rotation)[which], _middle(solids.at.translation)[which]
    own = np.maximum(half - moved, 0.0)
    room = solids.half[which] * (1 - 1e-9) - 2 * ROUNDING
    # Seen from the solid, whose box is then along the axes.
    turn = np.matmul(other.swapaxes(1, 2), turn)
    place = np.matmul((place - there)[:, None], other)[:, 0]
    point, last = place, np.zeros(len(place))
    for n in range(rounds):
        before = point
        seen = np.matmul((point - place)[:, None], turn)[:, 0]
        point = np.matmul(turn, np.clip(seen, -own, own)[..., None])[..., 0] + place
        point = np.clip(point, -room, room)
        step = np.linalg.norm(point - before, axis=1)
        if (
            n % LEAP == LEAP - 1 and n + 1 < rounds
        ):  # between two faces each step is a share of the one before
            far = np.where(step < last, step / np.maximum(last - step, NEARBY * last + ROUNDING), 0.0)
            point = point + (point - before) * far[:, None]
        last = step
    seen = np.matmul((point - place)[:, None], turn)[:, 0]
    return np.matmul(other, point[..., None])[..., 0] + there, (half - np.abs(seen)).min(axis=1)


def _placed(iri: Iri, chain: Chain, q: Array, geometries: list[Geometry], slack: Array) -> Solids:
    """Boxes inside the shapes of a body, however the joints before it differ by so much, shape (n,)."""
    found = list[Solids]()
    for geometry in geometries:
        half = within(geometry)
        whole = Chain(chain.links, chain.end @ placement(geometry.pose))
        origins, axes, at = whole.frames(q)
        less = ROUNDING
        if chain.links:
            arms = cross(at.translation[:, None] - origins, axes).norm().hi + float(np.linalg.norm(half))
            turns = np.array([link.turns for link in chain.links])
            less += float((np.where(turns, arms, 1.0) * slack).sum())
        found.append(_solids(iri, at, half - less))
    return _all(found)


def _solids(iri: Iri, at: Placement, half: Array) -> Solids:
    rotation, translation = (
        Interval(one.lo.reshape(size), one.hi.reshape(size))
        for one, size in ((at.rotation, (1, 3, 3)), (at.translation, (1, 3)))
    )
    return Solids((iri,), Placement(rotation, translation), half[None]) if (half > 0).all() else NOTHING


def _middle(one: Interval) -> Array:
    return (one.lo + one.hi) / 2


NOTHING = Solids((), Placement(exact(np.zeros((0, 3, 3))), exact(np.zeros((0, 3)))), np.zeros((0, 3)))
