"""Pairs of a robot's bodies that touch wherever it moves, or as parts of one telescope."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.describe.tree import Tree
from sdt_kg.iri import local_name
from sdt_kg.mechanism import Body, Joint, JointType, Mechanism
from services.physics.geometry.hulls import FINE
from services.physics.geometry.shapes import solids
from services.physics.tree import Array, Model, build, exempt_pairs, se3

SAMPLES = 200
"""Configurations tried. A pair that is apart in one is not listed: more can only shorten the list."""

CLOSE = 2
"""Joints between a wrist or elbow and the fork that it turns in, at most."""

MOST = 0.7
"""Share of configurations in which such a pair touches that also does at 0: by construction, if so often."""

NEARLY_ALL = 0.9
"""The same where it does not at 0."""

STROKE = 21
"""Positions of a telescope, from one end to the other."""

NEAR = 0.001
"""[m] Bodies nearer than this count as touching: no search could pass between them."""

ALWAYS = "touch in every sampled configuration"

SEED = 0

Pair = frozenset[str]


def touching(mechanism: Mechanism, robot: RobotAnnotation) -> dict[Pair, str]:
    """Pairs whose contact a guess allows, and why: to be checked.

    They touch in every sampled configuration; or, parted by a joint or two, as a wrist in its fork, in nearly
    all, or with joints at 0 and in most: a hand that bends back onto its arm does in many, not at 0; or in
    one as parts of a telescope. Held joints stay where they are. Pairs whose contact is allowed anyhow are
    left out.
    """
    look, tree = _Look(build(mechanism), _pieces(mechanism)), Tree(mechanism)
    exempt = {frozenset(map(local_name, pair)) for pair in exempt_pairs(mechanism, robot)}
    pairs = {frozenset(pair) for pair in combinations(look.pieces, 2)} - exempt
    why = {
        pair: "parts of a telescope touch where it is drawn in" for pair in _sliding(look, robot, tree, pairs)
    }
    at_rest = set(look.touching(_at_rest(look.model), pairs))
    near = {pair for pair in pairs if _parted(tree, robot, pair) <= CLOSE}
    for pair, share in _shares(look, robot, pairs, near).items():
        said = f"{share:.0%}".replace("%", " %") + " of the sampled configurations"
        if share == 1:
            why[pair] = ALWAYS
        elif share >= NEARLY_ALL or pair in at_rest:
            why[pair] = f"touch{' at 0 and' if pair in at_rest else ''} in {said}, two joints apart at most"
    return why


def _shares(look: "_Look", robot: RobotAnnotation, pairs: set[Pair], near: set[Pair]) -> dict[Pair, float]:
    """In which share of configurations pairs touch that always do, and those of `near` that mostly do."""
    counts, rng, always = dict.fromkeys(pairs, 0), np.random.default_rng(SEED), pairs
    for k in range(SAMPLES):
        found = set(look.touching(_random(look.model, robot, rng), always | near))
        always = always & found
        for pair in found:
            counts[pair] += 1
        near = {pair for pair in near if counts[pair] + SAMPLES - 1 - k >= MOST * SAMPLES}
    return {pair: counts[pair] / SAMPLES for pair in always | near}


def _sliding(look: "_Look", robot: RobotAnnotation, tree: Tree, pairs: set[Pair]) -> set[Pair]:
    """Pairs of a telescope's parts that touch somewhere on its way."""
    found: set[Pair] = set()
    for telescope in robot.coupled:
        parts = pairs & set(map(frozenset, combinations(_parts(tree, telescope), 2)))
        for share in np.linspace(0.0, 1.0, STROKE):
            found |= set(look.touching(_drawn(look.model, telescope, float(share)), parts - found))
    return found


def _parted(tree: Tree, robot: RobotAnnotation, pair: Pair) -> int:
    """How many joints that planning moves lie between two bodies."""
    one, other = ({joint.name for joint in tree.ancestors(body)} for body in pair)
    return len((one ^ other) & robot.acceleration.keys())


@dataclass(frozen=True, slots=True)
class _Pieces:
    """Convex pieces of one body.

    Attributes:
        poses: body_T_piece.
        centres, radii: Of spheres that hold them, in the body's frame, shapes (K, 3) and (K,) [m].
    """

    shapes: list[coal.CollisionGeometry]
    poses: list[pin.SE3]
    centres: Array
    radii: Array


@dataclass(frozen=True, slots=True)
class _Look:
    """A robot alone, its meshes as fine pieces."""

    model: Model
    pieces: dict[str, _Pieces]

    def touching(self, positions: Array, pairs: Iterable[Pair]) -> Iterator[Pair]:
        """Those of the pairs that are nearer than NEAR at these positions of the independent joints."""
        model = self.model
        model.placements.move(model.coupling.positions(positions))
        world_T_body = {name: _placement(model, name) for name in self.pieces}
        for pair in pairs:
            one, other = pair
            if _near(self.pieces[one], world_T_body[one], self.pieces[other], world_T_body[other]):
                yield pair


def _pieces(mechanism: Mechanism) -> dict[str, _Pieces]:
    return {body.name: _of_body(body) for body in mechanism.bodies if body.collision}


def _of_body(body: Body) -> _Pieces:
    shapes = [(shape, se3(each.pose)) for each in body.collision for shape in solids(each, FINE)]
    boxes = [shape.aabb_local for shape, _ in shapes]
    middles = [pose.act((box.min_ + box.max_) / 2) for box, (_, pose) in zip(boxes, shapes, strict=True)]
    radii = [float(np.linalg.norm(box.max_ - box.min_)) / 2 for box in boxes]
    return _Pieces(
        [shape for shape, _ in shapes], [pose for _, pose in shapes], np.array(middles), np.array(radii)
    )


def _random(model: Model, robot: RobotAnnotation, rng: np.random.Generator) -> Array:
    return np.array(
        [
            _rest(joint) if joint.name in robot.held else rng.uniform(*_range(joint))
            for joint in model.part.joints
        ]
    )


def _at_rest(model: Model) -> Array:
    return np.array([_rest(joint) for joint in model.part.joints])


def _drawn(model: Model, telescope: tuple[str, ...], share: float) -> Array:
    """Everything at rest, the telescope so far out."""
    return np.array(
        [
            joint.limits.lower + share * (joint.limits.upper - joint.limits.lower)
            if joint.name in telescope
            else _rest(joint)
            for joint in model.part.joints
        ]
    )


def _rest(joint: Joint) -> float:
    return min(max(0.0, joint.limits.lower), joint.limits.upper)


def _range(joint: Joint) -> tuple[float, float]:
    if joint.type is JointType.CONTINUOUS:
        return -np.pi, np.pi
    return joint.limits.lower, joint.limits.upper


def _parts(tree: Tree, telescope: tuple[str, ...]) -> Iterator[str]:
    """Bodies that the telescope's joints move against each other, and only they."""
    joints = [tree.mechanism.joint(name) for name in telescope]
    roots = {tree.rigid_root(joint.parent) for joint in joints} | {joint.child for joint in joints}
    return (body.name for body in tree.mechanism.bodies if tree.rigid_root(body.name) in roots)


def _placement(model: Model, body: str) -> pin.SE3:
    joint, joint_T_body = model.part.attached[body]
    return model.placements.world_T_joint[joint] * joint_T_body


def _near(one: _Pieces, world_T_one: pin.SE3, other: _Pieces, world_T_other: pin.SE3) -> bool:
    a, b = (
        of.centres @ pose.rotation.T + pose.translation
        for of, pose in ((one, world_T_one), (other, world_T_other))
    )
    away = np.linalg.norm(a[:, None] - b, axis=2) - one.radii[:, None] - other.radii - NEAR
    close = np.argwhere(away <= 0)
    for i, k in close[np.argsort(away[tuple(close.T)])].tolist():
        # A request of its own for each call: a cached guess from another pair gives wrong answers.
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        request.security_margin = NEAR
        here, there = _transform(world_T_one * one.poses[i]), _transform(world_T_other * other.poses[k])
        if coal.collide(one.shapes[i], here, other.shapes[k], there, request, result):
            return True
    return False


def _transform(pose: pin.SE3) -> coal.Transform3s:
    return coal.Transform3s(pose.rotation, pose.translation)
