"""What is solid around the robot: boxes inside the kitchen, and inside its own bodies; and the floor."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.iri import Iri, body_iri, joint_iri
from sdt_kg.mechanism import Geometry, ShapeType
from sdt_kg.state import State
from services.embodiment.proof_check.geometry.interval import Interval, cross, exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Link, Placement, Tree, placement
from services.embodiment.proof_check.inside.boxes import Core, within
from services.physics.geometry.floor import BELOW, LEVEL, SIZE, standing
from services.physics.tree import exempt_pairs

Array = NDArray[np.float64]
Slack = Callable[[tuple[Link, ...]], Array]
"""How far joints of the kitchen may be from where they are said to be [rad or m], shape (n,)."""

ROUNDING = 1e-7  # [m] what quaternions and axes of not quite unit length can be off by
WORLD = -1
"""In place of the index of a link: the frame that no joint moves."""
FLOOR = "floor"
"""In place of the IRI of a body, which never is one word."""


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
        carrier: Index of the chain's link whose frame it is, or `WORLD`.
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


NOTHING = Solids((), Placement(exact(np.zeros((0, 3, 3))), exact(np.zeros((0, 3)))), np.zeros((0, 3)))
