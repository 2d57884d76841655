"""How a kitchen's parts were fitted together: where they are at rest, and how deep in each other."""

from collections.abc import Sequence

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file
from numpy.typing import NDArray

from sdt_kg.iri import Iri
from sdt_kg.mechanism import Joint, JointType, Limits
from services.physics.geometry.bodies import BodyShape, shapes_of
from services.physics.geometry.gap import gap
from services.physics.tree import Array, Model

ALLOWANCE = 0.01
"""[m] How deep a moved shape may be in another, more than the model's rest allows it: the doors of
the bundled kitchens and of their sources turn up to 9 mm into the edges of their neighbours. A state in
which it is deeper is no beginning: from one to the next a body would pass through another step by step."""

ROUNDED = 0.001
"""[m] How far a shape that stands before a front may reach into it, as drawn."""

ALONG = 1 - 1e-9
"""[1] Cosine to an axis from which on a direction is along it."""


class Rest:
    """The kitchen with every joint at its start position, in which its parts were fitted together.

    Args:
        model: Of the kitchen.
        shapes: Of its bodies, and the floor as the last.
        put: Bodies that were put there later: how deep they are in others is not how deep they may be.
        drawn: The same kitchen, of the same bodies, with its frames where they were drawn: how deep its parts
            are in each other is told by these, not by where edits have put them.
    """

    def __init__(
        self,
        model: Model,
        shapes: Sequence[BodyShape],
        put: frozenset[Iri] = frozenset(),
        drawn: Model | None = None,
    ) -> None:
        self.floor, self._put = shapes[-1], put
        self._joints, self._frames = model.part.joints, _frames(model)
        at, as_drawn = (self._frames, shapes) if drawn is None else (_frames(drawn), [*shapes_of(drawn)])
        self._placed = {
            id(each): placed(at[same.joint] * same.pose) for each, same in zip(shapes, as_drawn, strict=True)
        }
        self._axes: dict[int, Array] = {}
        self._boxes: dict[tuple[int, int], tuple[BodyShape, Array, Array]] = {}
        self._abouts: dict[Iri, tuple[Array, Array]] = {}
        self._bodies: dict[Iri, list[BodyShape]] = {}
        self._moved: dict[int, list[BodyShape]] = {}
        for each in shapes:
            self._bodies.setdefault(each.body, []).append(each)
            self._moved.setdefault(each.joint, []).append(each)

    def joint(self, one: BodyShape) -> Joint:
        """What moves it."""
        return self._joints[one.joint - 1]

    def of(self, body: Iri) -> list[BodyShape]:
        """Shapes of a body."""
        return self._bodies[body]

    def moved_with(self, one: BodyShape) -> list[BodyShape]:
        """Shapes that the same joint moves."""
        return self._moved[one.joint]

    def height(self, one: BodyShape) -> float:
        """Of its lowest point above the kitchen's origin [m], as a box."""
        at = self._frames[one.joint]
        return float(at.act(one.centre)[2] - np.abs(at.rotation[2] @ one.rotation) @ one.half)

    def seen(self, other: BodyShape, one: BodyShape) -> pin.SE3:
        """Where another shape is in the frame of one's joint."""
        return self._frames[one.joint].actInv(self._frames[other.joint]) * other.pose

    def placed_as(self, whole: BodyShape, part: BodyShape) -> BodyShape:
        """The part, known to be where the whole is."""
        self._placed[id(part)] = self._placed[id(whole)]
        return part

    def depth(self, one: BodyShape, other: BodyShape) -> float:
        """[m] How deep the shapes are in each other as they were fitted, 0 where they are apart."""
        return max(0.0, -self._gap(one, other))

    def touch(self, one: BodyShape, other: BodyShape, near: float = 0.0) -> bool:
        """Whether the shapes touch as they were fitted, or are so near each other [m]."""
        return self._gap(one, other) <= near

    def _gap(self, one: BodyShape, other: BodyShape) -> float:
        """[m] Between the shapes as they were fitted; without end where one was put there later."""
        if not self._put.isdisjoint((one.body, other.body)):
            return np.inf
        return gap_between(one, self._placed[id(one)], other, self._placed[id(other)])[0]

    def is_ahead(self, one: BodyShape, other: BodyShape) -> bool:
        """Whether the other shape reaches farther than one's body to where that goes."""
        (low, high), (below, above) = self.about(one), self.box([other], one)
        return bool(self._goes(one, above > high + ROUNDED, below < low - ROUNDED))

    def is_through(self, one: BodyShape, other: BodyShape, *, within: bool) -> bool:
        """Whether a shape is on both sides of another along its joint's axis; `within` its outline, if so."""
        (low, high), (below, above) = self.box([one], one), self.box([other], one)
        along = np.arange(3) == np.argmax(np.abs(self.axes(one) @ np.array(self.joint(one).axis)))
        inside = (low >= below - ROUNDED) & (high <= above + ROUNDED) | (not within)
        beyond = (low < below - ROUNDED) & (high > above + ROUNDED)
        return bool(np.where(along, beyond, inside).all())

    def before(self, below: Array, above: Array, one: BodyShape) -> NDArray[np.bool_]:
        """Which boxes along one's joint, corners of shape (N, 3), are where its body goes, as a whole."""
        low, high = self.about(one)
        return self._goes(one, below >= high - ROUNDED, above <= low + ROUNDED)

    def _goes(self, one: BodyShape, forth: NDArray[np.bool_], back: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """What holds along the axis on which one's body goes most, shape (..., 3), there or there.

        Args:
            one: Whose body it is.
            forth: What holds on the side where that axis leads.
            back: On the other.
        """
        joint = self.joint(one)
        way = self.axes(one) @ np.array(joint.axis)
        if joint.type is not JointType.PRISMATIC:
            way = np.cross(way, sum(self.about(one)) / 2)
        k = int(np.argmax(np.abs(way)))
        if way[k] < 0:
            forth, back = back, forth
        start = _start(joint.limits)
        up, down = joint.limits.upper > start, joint.limits.lower < start
        return (forth[..., k] & up) | (back[..., k] & down)

    def off(self, below: Array, above: Array, one: BodyShape) -> Array:
        """How far such boxes are from that about one's body, shape (N,) [m]."""
        low, high = self.about(one)
        off: Array = np.linalg.norm(np.maximum(np.maximum(low - above, below - high), 0.0), axis=1)
        return off

    def axes(self, one: BodyShape) -> Array:
        """Directions along which boxes about one's body are taken, rows in its joint's frame, shape (3, 3).

        They are the frame's own but where something slides along none of them: then one is its axis.
        """
        if one.joint not in self._axes:
            self._axes[one.joint] = _axes(self.joint(one))
        return self._axes[one.joint]

    def about(self, one: BodyShape) -> tuple[Array, Array]:
        """Corners of the box about one's body."""
        if one.body not in self._abouts:
            self._abouts[one.body] = self.box(self._bodies[one.body], one)
        return self._abouts[one.body]

    def box(self, shapes: Sequence[BodyShape], one: BodyShape) -> tuple[Array, Array]:
        """Corners of the box about some shapes along `axes` of one's joint, shape (3,) [m]."""
        boxes = [self._box(each, one) for each in shapes]
        return np.min([low for _, low, _ in boxes], axis=0), np.max([high for _, _, high in boxes], axis=0)

    def _box(self, each: BodyShape, one: BodyShape) -> tuple[BodyShape, Array, Array]:
        """A shape, which is kept so that its number is its own, and the corners of its box."""
        key = id(each), one.joint
        if key not in self._boxes:
            axes, seen = self.axes(one), self._frames[one.joint].actInv(self._frames[each.joint])
            middle = axes @ seen.act(each.centre)
            half = np.abs(axes @ seen.rotation @ each.rotation) @ each.half
            self._boxes[key] = each, middle - half, middle + half
        return self._boxes[key]


def _axes(joint: Joint) -> Array:
    axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
    k = int(np.argmax(np.abs(axis)))
    if joint.type is not JointType.PRISMATIC or abs(axis[k]) >= ALONG:
        return np.eye(3)
    across = np.cross(axis, np.eye(3)[k - 1])
    across /= np.linalg.norm(across)
    axes = np.empty((3, 3))
    axes[k], axes[k - 2], axes[k - 1] = axis, across, np.cross(axis, across)
    return axes


def _frames(model: Model) -> list[pin.SE3]:
    """world_T_joint of every joint, at its start position."""
    q = np.array([_start(joint.limits) for joint in model.part.joints])
    return [frame.copy() for frame in model.placements.move(model.coupling.positions(q))]


def gap_between(
    one: BodyShape, one_at: coal.Transform3s, other: BodyShape, other_at: coal.Transform3s
) -> tuple[float, Array]:
    """Distance of two shapes [m], negative where they penetrate, and from one to the other its direction."""
    return gap(one.piece.shape, one_at, other.piece.shape, other_at)


def _start(limits: Limits) -> float:
    return 0.0 if limits.lower <= 0 <= limits.upper else limits.lower


def placed(pose: pin.SE3) -> coal.Transform3s:
    """The pose as coal takes it."""
    return coal.Transform3s(pose.rotation, pose.translation)
