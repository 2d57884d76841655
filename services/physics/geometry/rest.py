"""How a kitchen's parts were fitted together: what moves in what, how deep they are in each other at rest."""

from collections.abc import Iterator, Sequence

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file
from numpy.typing import NDArray

from sdt_kg.iri import Iri, body_iri, joint_iri
from sdt_kg.mechanism import JointType, Limits, Mechanism
from services.physics.geometry.bodies import BodyShape, with_piece
from services.physics.geometry.pieces import Piece, bent, beyond
from services.physics.geometry.shapes import corners
from services.physics.tree import Array, Model

ALLOWANCE = 0.01
"""[m] How deep a moved shape may be in another, more than the model's rest allows it: the doors of
the bundled kitchens and of their sources turn up to 9 mm into the edges of their neighbours. A state in
which it is deeper is no beginning: from one to the next a body would pass through another step by step."""

ROUNDED = 0.001
"""[m] How far a shape that stands before a front may reach into it, as drawn."""

FLUSH = 1e-6
"""[m] Depth up to which shapes lie on each other, not in each other."""

ENCLOSED = 0.5
"""[1] Share of a body that has to lie in what bears it and is not its joint's parent: the drawer below the
fridge of kitchen `b` has 0.53."""


FRAME = 0.05
"""[m] How far from a container at rest triangles of a bent mesh may be that still belong to its cabinet: the
frame before a drawer. A whole room may be one mesh."""


HINGE = 0.1
"""[m] How far from its hinge a door may turn into what is beside it: doors are less thick."""

ALONG = 1 - 1e-9
"""[1] Cosine to an axis from which on a direction is along it."""

RAILS = 0.02
"""[m] How far from the sides of what slides it may slide in what is beside it: rails are less thick."""


class Rest:
    """The kitchen with every joint at its start position, in which its parts were fitted together.

    Args:
        model: Of the kitchen.
        shapes: Of its bodies, and the floor as the last.
        put: Fixed bodies that were put there later, and joints whose frames were: with what these carry they
            are apart from the rest. How deep they are in it says nothing of how deep they may be.
    """

    def __init__(self, model: Model, shapes: Sequence[BodyShape], put: frozenset[Iri] = frozenset()) -> None:
        self._floor, self._put = shapes[-1], _put_with(model.part.mechanism, put)
        q = np.array([_start(joint.limits) for joint in model.part.joints])
        pin.forwardKinematics(model.model, model.data, model.coupling.positions(q))
        self._joints = model.part.joints
        self._frames = [frame.copy() for frame in model.data.oMi]
        self._placed = {id(each): placed(self._frames[each.joint] * each.pose) for each in shapes}
        self._bodies: dict[Iri, list[BodyShape]] = {}
        for each in shapes:
            self._bodies.setdefault(each.body, []).append(each)
        self._known: dict[tuple[Iri, int], BodyShape | None] = {}
        self._away: dict[tuple[Iri, int], BodyShape | None] = {}
        self._cores: dict[int, tuple[BodyShape, ...]] = {}
        self._in: dict[tuple[int, int], bool] = {}
        self._low: dict[int, float] = {}
        self._housed: dict[tuple[Iri, Iri], bool] = {}

    def depth(self, one: BodyShape, other: BodyShape) -> float:
        """[m] How deep the shapes are in each other as they were fitted, 0 where they are apart."""
        if not self._fitted(one, other):
            return 0.0
        return max(0.0, -gap_between(one, self._placed[id(one)], other, self._placed[id(other)]))

    def touch(self, one: BodyShape, other: BodyShape) -> bool:
        """Whether the shapes touch as they were fitted."""
        if not self._fitted(one, other):
            return False
        return gap_between(one, self._placed[id(one)], other, self._placed[id(other)]) <= 0

    def _fitted(self, one: BodyShape, other: BodyShape) -> bool:
        """Whether both were put where they are together, if at all."""
        return self._put.get(one.body) == self._put.get(other.body)

    def _sunk(self, one: BodyShape) -> bool:
        """Whether something that one's joint moves reaches below the floor: there the floor is elsewhere."""
        if one.joint not in self._low:
            at = self._frames[one.joint]
            moved = [each for shapes in self._bodies.values() for each in shapes if each.joint == one.joint]
            low = min(at.act(e.centre)[2] - np.abs(at.rotation[2] @ e.rotation) @ e.half for e in moved)
            self._low[one.joint] = float(low)
        return self._low[one.joint] < -ALLOWANCE

    def stopping(self, one: BodyShape, other: BodyShape) -> BodyShape | None:
        """What of another shape may stop a moved one; None where it moves in or on all of it.

        It does on shapes beside its body at rest, of its joint's parent or mount. Of a parent that is much
        more than a cabinet, a whole room, the rest stops it; so do triangles of a bent mesh that are farther
        from it, for the mesh may be the whole room. What is fixed to the parent bears it only where it
        houses it: a box that stands before a drawer does not. The floor stops what was not drawn below it.
        """
        if other is self._floor:
            return None if self._sunk(one) else other
        key = (one.body, id(other))
        if key not in self._known:
            self._known[key] = self._not_beside(other, one) if self._bears(other.body, one) else other
        return self._known[key]

    def cores(self, one: BodyShape, other: BodyShape) -> tuple[BodyShape, ...]:
        """What of a moved shape another one stops that is beside it: what is far from its hinge or rails.

        At its hinge a door turns into the edges of its cabinet, on rails a drawer slides in its cabinet. With
        its face a door stops at a wall beside it, and with its back a drawer at a pipe in its cabinet. What
        slides is borne by what it is in at rest: the bar of a drawer in a dishwasher goes through a board.
        """
        sliding = self._joints[one.joint - 1].type is JointType.PRISMATIC
        borne = other is self._floor or (sliding and self._pierced(one, other))
        return () if borne else self._cores_of(one)

    def _pierced(self, one: BodyShape, other: BodyShape) -> bool:
        """Whether anything that one's joint moves is in the other shape, as they were fitted together."""
        key = (one.joint, id(other))
        if key not in self._in:
            moved = (each for shapes in self._bodies.values() for each in shapes if each.joint == one.joint)
            self._in[key] = any(self.depth(each, other) > FLUSH for each in moved)
        return self._in[key]

    def _cores_of(self, one: BodyShape) -> tuple[BodyShape, ...]:
        if id(one) not in self._cores:
            sliding = self._joints[one.joint - 1].type is JointType.PRISMATIC
            parts = self._between_rails(one) if sliding else self._off_hinge(one)
            cores = tuple(with_piece(one, each) for each in parts)
            for each in cores:
                self._placed_as(one, each)
            self._cores[id(one)] = cores
        return self._cores[id(one)]

    def _off_hinge(self, one: BodyShape) -> Iterator[Piece]:
        """The parts of the shape that are farther than `HINGE` from the axis, on each of its four sides."""
        axis = np.array(self._joints[one.joint - 1].axis)
        axis /= np.linalg.norm(axis)
        out = sum(self._box(self._bodies[one.body], one)) / 2
        out -= (out @ axis) * axis
        if not out.any():
            out = np.eye(3)[np.argmin(np.abs(axis))]
            out -= (out @ axis) * axis
        out /= np.linalg.norm(out)
        side = np.cross(axis, out)
        yield from filter(None, (_cut(one, way, HINGE) for way in (out, -out, side, -side)))

    def _between_rails(self, one: BodyShape) -> Iterator[Piece]:
        """The part of the shape that is farther than `RAILS` from the sides of the box about its body."""
        low, high = self._box(self._bodies[one.body], one)
        axes, piece = self._axes(one), one.piece
        for k in np.flatnonzero(np.abs(axes @ np.array(self._joints[one.joint - 1].axis)) < ALONG):
            for way, least in ((axes[k], low[k] + RAILS), (-axes[k], RAILS - high[k])):
                within = _cut(with_piece(one, piece), way, least)
                if within is None:
                    return
                piece = within
        yield piece

    def _not_beside(self, other: BodyShape, one: BodyShape) -> BodyShape | None:
        """The shape without what of it is beside one's body."""
        below, above = self._box([other], one)
        if not self._beside(below[None], above[None], one)[0]:
            return other
        return self.away(other, one) if isinstance(other.piece.shape, coal.BVHModelBase) else None

    def away(self, mesh: BodyShape, one: BodyShape) -> BodyShape | None:
        """What of a bent mesh is farther than `FRAME` from another shape's body; None if nothing is.

        Of a mesh on which that body does not hang, what stands before it too.
        """
        key = (one.body, id(mesh))
        if key not in self._away:
            triangles = corners(mesh.piece.shape)
            seen = self._frames[one.joint].actInv(self._frames[mesh.joint]) * mesh.pose
            turned = (triangles @ seen.rotation.T + seen.translation) @ self._axes(one).T
            box = turned.min(axis=1), turned.max(axis=1)
            apart = self._off(*box, one) > FRAME
            if not self._bears(mesh.body, one):
                apart |= self._before(*box, one)
            part = with_piece(mesh, bent(triangles[apart])) if apart.any() else None
            self._away[key] = self._placed_as(mesh, part)
        return self._away[key]

    def _placed_as(self, whole: BodyShape, part: BodyShape | None) -> BodyShape | None:
        """The part, known to be where the whole is."""
        if part is not None:
            self._placed[id(part)] = self._placed[id(whole)]
        return part

    def _beside(self, below: Array, above: Array, one: BodyShape) -> NDArray[np.bool_]:
        """Which boxes along one's joint, corners of shape (N, 3), are beside its body: near, not in front."""
        return (self._off(below, above, one) <= ALLOWANCE) & ~self._before(below, above, one)

    def _before(self, below: Array, above: Array, one: BodyShape) -> NDArray[np.bool_]:
        """Which of such boxes are where one's body goes, as a whole."""
        low, high = self._box(self._bodies[one.body], one)
        joint = self._joints[one.joint - 1]
        way = self._axes(one) @ np.array(joint.axis)
        if joint.type is not JointType.PRISMATIC:
            way = np.cross(way, (low + high) / 2)
        k = int(np.argmax(np.abs(way)))
        forth, back = below[:, k] >= high[k] - ROUNDED, above[:, k] <= low[k] + ROUNDED
        if way[k] < 0:
            forth, back = back, forth
        start = _start(joint.limits)
        return (forth & (joint.limits.upper > start)) | (back & (joint.limits.lower < start))

    def _off(self, below: Array, above: Array, one: BodyShape) -> Array:
        """How far such boxes are from that about one's body, shape (N,) [m]."""
        low, high = self._box(self._bodies[one.body], one)
        off: Array = np.linalg.norm(np.maximum(np.maximum(low - above, below - high), 0.0), axis=1)
        return off

    def _bears(self, body: Iri, one: BodyShape) -> bool:
        """Whether one's body hangs on the other, or is housed by what is fixed to that."""
        return one.parent == body or (body in one.mount and self._houses(body, one))

    def _houses(self, body: Iri, one: BodyShape) -> bool:
        """Whether a body overlaps one's, and a box about it has most of that about one's in it."""
        own, others, key = self._bodies[one.body], self._bodies[body], (one.body, body)
        if key not in self._housed:
            (low, high), (below, above) = self._box(own, one), self._box(others, one)
            shared = np.clip(np.minimum(high, above) - np.maximum(low, below), 0.0, None)
            most = bool(np.prod(shared) > ENCLOSED * np.prod(high - low))
            self._housed[key] = most and any(self.depth(a, b) > 0 for a in own for b in others)
        return self._housed[key]

    def _axes(self, one: BodyShape) -> Array:
        """Directions along which boxes about one's body are taken, rows in its joint's frame, shape (3, 3).

        They are the frame's own but where something slides along none of them: then one is its axis.
        """
        joint = self._joints[one.joint - 1]
        axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
        k = int(np.argmax(np.abs(axis)))
        if joint.type is not JointType.PRISMATIC or abs(axis[k]) >= ALONG:
            return np.eye(3)
        across = np.cross(axis, np.eye(3)[k - 1])
        across /= np.linalg.norm(across)
        axes = np.empty((3, 3))
        axes[k], axes[k - 2], axes[k - 1] = axis, across, np.cross(axis, across)
        return axes

    def _box(self, shapes: Sequence[BodyShape], one: BodyShape) -> tuple[Array, Array]:
        """Corners of the box about some shapes along `_axes` of one's joint, shape (3,) [m]."""
        axes = self._axes(one)
        seen = [self._frames[one.joint].actInv(self._frames[each.joint]) for each in shapes]
        middle = np.array([axes @ at.act(each.centre) for at, each in zip(seen, shapes, strict=True)])
        turned = (axes @ at.rotation @ each.rotation for at, each in zip(seen, shapes, strict=True))
        half = np.array([np.abs(turn) @ each.half for turn, each in zip(turned, shapes, strict=True)])
        return (middle - half).min(axis=0), (middle + half).max(axis=0)


def _put_with(mechanism: Mechanism, put: frozenset[Iri]) -> dict[Iri, frozenset[Iri]]:
    """Of bodies that were put where they are: all by which they were, of others nothing."""
    name, found = mechanism.name, dict[Iri, frozenset[Iri]]()
    for joint in mechanism.joints:  # parents before children
        own = put & {joint_iri(name, joint.name), body_iri(name, joint.child)}
        if all_ := own | found.get(body_iri(name, joint.parent), frozenset()):
            found[body_iri(name, joint.child)] = all_
    return found


def _cut(one: BodyShape, way: Array, least: float) -> Piece | None:
    """The part of a shape that is farther along a direction of its joint's frame than that [m]."""
    rotation, origin = one.pose.rotation, one.pose.translation
    return beyond(one.piece, rotation.T @ way, least - float(origin @ way))


def gap_between(
    one: BodyShape, one_at: coal.Transform3s, other: BodyShape, other_at: coal.Transform3s
) -> float:
    """Distance of two shapes [m], negative where they penetrate."""
    # Request and result of its own for each call: a cached guess gives wrong answers.
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    return float(coal.distance(one.piece.shape, one_at, other.piece.shape, other_at, request, result))


def _start(limits: Limits) -> float:
    return 0.0 if limits.lower <= 0 <= limits.upper else limits.lower


def placed(pose: pin.SE3) -> coal.Transform3s:
    """The pose as coal takes it."""
    return coal.Transform3s(pose.rotation, pose.translation)
