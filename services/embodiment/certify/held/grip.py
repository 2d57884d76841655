"""Whether a handle is between a gripper's fingers, not merely near them."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain, product

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri
from services.embodiment.certify.held import moved
from services.embodiment.certify.held.moved import STEP
from services.embodiment.certify.held.surface import Surface
from services.embodiment.certify.sweep.kinematics import Placed
from services.embodiment.certify.sweep.shapes import Shapes
from services.embodiment.certify.tolerances import Tolerances
from services.physics.geometry.convex import ROOM

Array = NDArray[np.float64]
Pairs = NDArray[np.intp]

APART = 1e-5  # [m] from touching, so that nearest points are well defined
NOTHING = 0.0  # [m] reaches over the handle
LATER = 1e-4  # [m] what touches later than the first by more bears nothing


@dataclass(frozen=True, slots=True)
class Press:
    """One finger on one side of the handle.

    Attributes:
        finger: Its body.
        gap: Its way to the handle along the closing direction [m]; negative is its depth. Of a finger with
            meshes, that of its triangles.
        at: Where it then touches the handle, along y of the tool [m].
        over: How far it reaches over the handle [m], at most what is demanded. Of a finger with meshes, the
            less of what its pieces and its triangles do.
    """

    finger: Iri
    gap: float
    at: float
    over: float


@dataclass(frozen=True, slots=True)
class Pinch:
    """Two fingers with the handle between them.

    Attributes:
        gap: The larger of both gaps [m].
        over: The smaller of both reaches [m].
        finger: The finger that reaches less.
        fingers: The finger above the handle, and the one below.
    """

    gap: float
    over: float
    finger: Iri
    fingers: tuple[Iri, Iri]


class Grip:
    r"""A gripper's fingers at a handle, at one configuration.

    A finger presses on the handle from the side :math:`+y` if it is clear of it and touches it when
    moved along :math:`-y` of the tool by at most the tolerance of contact; and the other way round.
    One that touches it only farther back, having passed it, does not.
    It reaches over the handle by e if it still does when it is first moved by e along each of
    :math:`\pm x` and :math:`\pm z`, and its way to the handle then grows by no more than
    :math:`e \tan(facing)`: the faces that meet look nearly along y. The handle is between two
    fingers if they press on it from both sides, the upper one not below the lower one, and they
    are two: bodies of one finger, which follow the same joint of the hand, count as one. This asks
    nothing of the handle's form: bars, knobs and boxes are treated alike.

    Args:
        shapes, placed: The scene at the configuration, which is the first of `placed`.
        axes: World directions of the tool's axes, as columns, shape (3, 3).
        fingers: Body of each finger → its shapes.
        handle: The handle's shapes.
        surfaces: Body of each finger that has meshes → it and the handle as they are.
    """

    def __init__(  # noqa: PLR0913, PLR0917  # a place, two bodies and what is demanded of them
        self,
        shapes: Shapes,
        placed: Placed,
        axes: Array,
        fingers: dict[Iri, list[int]],
        handle: list[int],
        surfaces: Mapping[Iri, Surface],
        tolerances: Tolerances,
    ) -> None:
        self._shapes, self._placed, self._tolerances = shapes, placed, tolerances
        self._surfaces, self._hollow = surfaces, set[Iri]()
        x, y, z = np.ascontiguousarray(axes.T)
        self._inward, self._sides = (-y, y), np.stack((x, -x, z, -z))
        self._room = np.empty(3), np.zeros(ROOM)
        self._slope = float(np.tan(tolerances.facing))
        #: Distance of each finger's body to the handle [m].
        self.gaps: dict[Iri, float] = {}
        self._pairs: dict[Iri, Pairs] = {}
        self._finger = _fingers(shapes, fingers)
        self._every = np.array([*chain.from_iterable(fingers.values()), *handle], dtype=np.intp)
        self._posed = self._every, *shapes.middles(placed, self._every)
        row = {shape: k for k, shape in enumerate(self._every.tolist())}
        far = np.hypot(tolerances.engaged, tolerances.contact + tolerances.engaged * self._slope)
        for body, own in fingers.items():
            near = {pair: shapes.nearest_points(placed, pair)[0] for pair in product(own, handle)}
            self.gaps[body] = min(near.values(), default=np.inf)
            close = [(row[i], row[j]) for (i, j), distance in near.items() if distance <= far + STEP]
            self._pairs[body] = np.array(close, dtype=np.intp).reshape(-1, 2)

        #: Fingers that press on the handle from above, and from below.
        self.sides = [
            [press for body in self._pairs if (press := self._press(body, inward))] for inward in self._inward
        ]

    def pinch(self) -> Pinch | None:
        """The best two fingers that have the handle between them; None if there are no two."""
        found = [
            Pinch(
                max(one.gap, other.gap),
                *min((one.over, one.finger), (other.over, other.finger)),
                (one.finger, other.finger),
            )
            for one, other in product(*self.sides)
            if self._finger[one.finger] != self._finger[other.finger] and one.at >= other.at - APART
        ]
        return max(found, key=lambda each: (each.over, -each.gap), default=None)

    def room(self, pinch: Pinch) -> float:
        """By how much the handle may be elsewhere and is still between these fingers [m].

        At least so much is shown, for one convex piece of each finger and one of the handle; nothing, where
        a piece fills a hollow of its finger, or reaches farther than its triangles.
        """
        if not self._hollow.isdisjoint(pinch.fingers):
            return 0.0
        both = tuple(self._pairs[body] for body in pinch.fingers)
        contact, engaged = self._tolerances.contact, self._tolerances.engaged
        convex, posed, asked = self._shapes.convex, self._posed, (contact, engaged, self._slope)
        error = moved.tolerated(convex, both, posed, self._inward, self._sides, *asked, self._room)
        far = engaged + float(np.sqrt(2.0)) * error
        for body, pairs, inward in zip(pinch.fingers, both, self._inward, strict=True):
            if body in self._surfaces:
                most = moved.farthest(convex, pairs, posed, inward, *asked, error, self._room)
                if not self._surfaces[body].touches(inward, -contact, most, self._sides, far):
                    return 0.0
        return error

    def slant(self, pinch: Pinch) -> float:
        """How far faces with which they touch the handle look away from the way in which they close [rad].

        No less than that, of every piece that touches first or hardly later; pi / 2 where nothing is shown.
        """
        return max(
            self._slant(body, inward) for body, inward in zip(pinch.fingers, self._inward, strict=True)
        )

    def _slant(self, body: Iri, inward: Array) -> float:
        """The same of one finger."""
        if body in self._hollow:
            return np.pi / 2
        pairs = np.split(self._pairs[body], len(self._pairs[body]))
        gaps = [self._gap(pair, inward) for pair in pairs]
        first = [(pair, gap) for pair, gap in zip(pairs, gaps, strict=True) if gap <= min(gaps) + LATER]
        convex, posed, sides = self._shapes.convex, self._posed, self._sides
        slopes = [
            moved.slope(convex, pair, posed, inward, sides, gap, self._slope, self._room)
            for pair, gap in first
        ]
        return float(np.arctan(max(slopes)))

    def _gap(self, pair: Pairs, inward: Array) -> float:
        """The way of one shape to one of the handle, inward; infinite if it does not press on that."""
        tolerances = self._tolerances
        asked = tolerances.contact, tolerances.engaged, self._slope, self._room
        gap, _ = moved.press(self._shapes.convex, pair, self._posed, inward, self._sides, *asked)
        return np.inf if np.isnan(gap) else float(gap)

    def lacking(self) -> Iri:
        """The finger to blame if no two have the handle between them: one that is missing on its side."""
        nearest = min(self.gaps, key=lambda body: self.gaps[body])
        pressing = [{press.finger for press in side} for side in self.sides]
        if all(pressing) or not any(pressing):
            return nearest
        others = self.gaps.keys() - pressing[0] - pressing[1]
        return min(sorted(others), key=lambda body: self.gaps[body], default=nearest)

    def _press(self, body: Iri, inward: Array) -> Press | None:
        """How a finger presses on the handle when it is moved inward; None if it does not."""
        pairs, tolerances = self._pairs[body], self._tolerances
        if not len(pairs):
            return None
        asked = tolerances.contact, tolerances.engaged, self._slope, self._room
        gap, over = moved.press(self._shapes.convex, pairs, self._posed, inward, self._sides, *asked)
        if np.isnan(gap):
            return None
        back = (gap - APART) * inward
        shapes = (tuple(pair) for pair in self._every[pairs].tolist())
        nearest = (self._shapes.nearest_points(self._placed, pair, back) for pair in shapes)
        _, _, on_handle = min(nearest, key=lambda each: each[0])
        way = self._way(body, inward, gap)
        if not np.isfinite(way):
            return None
        if body in self._surfaces:
            real = self._surfaces[body]
            over = min(over, real.over(inward, way, self._sides, tolerances.engaged, self._slope))
        return Press(body, way, float(on_handle @ self._inward[1]), over)

    def _way(self, body: Iri, inward: Array, gap: float) -> float:
        """The way of the finger as it is, whose pieces have that gap [m]; infinite if it does not touch."""
        if body not in self._surfaces:
            return gap
        real = self._surfaces[body]
        way = real.way(inward, gap, self._tolerances.contact)
        if way > gap:
            self._hollow.add(body)
            self.gaps[body] = max(self.gaps[body], real.distance(np.zeros(3)))
        return way


def _fingers(shapes: Shapes, fingers: dict[Iri, list[int]]) -> dict[Iri, int]:
    """The joint with which each body's finger begins, where all have parted; 0 for one that is the palm's."""
    paths = {body: shapes.path(own[0]) for body, own in fingers.items() if own}
    least = min(map(len, paths.values()), default=0)
    shared = next((k for k in range(least) if len({path[k] for path in paths.values()}) > 1), least)
    return {body: path[shared] if len(path) > shared else 0 for body, path in paths.items()}
