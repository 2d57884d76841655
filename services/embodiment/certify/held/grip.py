"""Whether a handle is between a gripper's fingers, not merely near them."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri
from services.embodiment.certify.sweep.kinematics import Placed
from services.embodiment.certify.sweep.shapes import STILL, Shapes
from services.embodiment.certify.tolerances import Tolerances

Array = NDArray[np.float64]

STEP = 1e-3  # [m] what is thinner than this, finger and handle together, may be passed over, hence refused
EXACT = 1e-7  # [m] of the way until finger and handle touch
APART = 1e-5  # [m] from touching, so that nearest points are well defined
ROOM_STEPS = 6  # halvings of the tolerance of contact
NOTHING = 0.0  # [m] reaches over the handle


@dataclass(frozen=True, slots=True)
class Press:
    """One finger on one side of the handle.

    Attributes:
        finger: Its body.
        gap: Its way to the handle along the closing direction [m]; negative is its depth.
        at: Where it then touches the handle, along y of the tool [m].
        over: How far it reaches over the handle [m], at most what is demanded.
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
    """

    def __init__(  # noqa: PLR0913, PLR0917  # a place, two bodies and what is demanded of them
        self,
        shapes: Shapes,
        placed: Placed,
        axes: Array,
        fingers: dict[Iri, list[int]],
        handle: list[int],
        tolerances: Tolerances,
    ) -> None:
        self._shapes, self._placed, self._tolerances = shapes, placed, tolerances
        self._x, self._y, self._z = axes.T
        self._slope = float(np.tan(tolerances.facing))
        #: Distance of each finger's body to the handle [m].
        self.gaps: dict[Iri, float] = {}
        self._pairs: dict[Iri, list[tuple[int, int]]] = {}
        self._finger = _fingers(shapes, fingers)
        far = np.hypot(tolerances.engaged, tolerances.contact + tolerances.engaged * self._slope)
        for body, own in fingers.items():
            near = {pair: shapes.nearest_points(placed, pair)[0] for pair in product(own, handle)}
            self.gaps[body] = min(near.values(), default=np.inf)
            self._pairs[body] = [pair for pair, distance in near.items() if distance <= far + STEP]

        #: Fingers that press on the handle from above, and from below.
        self.sides = [
            [press for body in self._pairs if (press := self._press(body, inward))]
            for inward in (-self._y, self._y)
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

        The faces that meet are those that meet at the grasp. At least so much is shown, for one convex
        piece of each finger and one of the handle.
        """
        error, step = 0.0, self._tolerances.contact
        for _ in range(ROOM_STEPS):
            step /= 2
            if self._keeps(pinch, error + step):
                error += step
        return error

    def _keeps(self, pinch: Pinch, error: float) -> bool:
        most = self._tolerances.contact - error
        reach = self._tolerances.engaged + float(np.sqrt(2)) * error
        corners = [reach * way for way in (self._x, -self._x, self._z, -self._z)]
        ways = np.append(np.arange(-self._tolerances.contact, most, STEP), most)
        return all(
            any(self._stays(pair, inward, corners, ways) for pair in self._pairs[body])
            for body, inward in zip(pinch.fingers, (-self._y, self._y), strict=True)
        )

    def _stays(self, pair: tuple[int, int], inward: Array, corners: list[Array], ways: Array) -> bool:
        """Whether a piece of a finger touches a piece of the handle from every corner."""
        return all(
            any(self._shapes.touch(self._placed, pair, corner + way * inward) for way in ways[::-1])
            for corner in corners
        )

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
        gap = self._gap(body, inward)
        if gap is None or (gap < 0 and not self._meets(body, STILL)):
            return None
        back = (gap - APART) * inward
        nearest = (self._shapes.nearest_points(self._placed, pair, back) for pair in self._pairs[body])
        _, _, on_handle = min(nearest, key=lambda each: each[0])
        over = min(self._over(body, inward, gap, way) for way in (self._x, -self._x, self._z, -self._z))
        return Press(body, gap, float(on_handle @ self._y), over)

    def _gap(self, body: Iri, inward: Array) -> float | None:
        """The way inward on which the finger first touches the handle [m]; None if it is not near it."""
        most = self._tolerances.contact
        ways = [*np.arange(-2 * most - STEP, most - EXACT, STEP).tolist(), most]
        if self._meets(body, ways[0] * inward):
            return None
        for clear, touching in pairwise(ways):
            if self._meets(body, touching * inward):
                return _border(lambda way: self._meets(body, way * inward), clear, touching)
        return None

    def _over(self, body: Iri, inward: Array, gap: float, way: Array) -> float:
        """How far the finger can be moved that way and still presses on the handle [m]."""

        def presses(moved: float) -> bool:
            more = moved * self._slope
            ways = np.linspace(gap, gap + more, 1 + int(np.ceil(more / STEP)))
            return any(self._meets(body, moved * way + each * inward) for each in ways[::-1])

        demanded = self._tolerances.engaged
        return demanded if presses(demanded) else _border(presses, demanded, NOTHING)

    def _meets(self, body: Iri, shift: Array) -> bool:
        """Whether the finger, moved by this in the world, touches the handle."""
        return any(self._shapes.touch(self._placed, pair, shift) for pair in self._pairs[body])


def _fingers(shapes: Shapes, fingers: dict[Iri, list[int]]) -> dict[Iri, int]:
    """The joint with which each body's finger begins, where all have parted; 0 for one that is the palm's."""
    paths = {body: shapes.path(own[0]) for body, own in fingers.items() if own}
    least = min(map(len, paths.values()), default=0)
    shared = next((k for k in range(least) if len({path[k] for path in paths.values()}) > 1), least)
    return {body: path[shared] if len(path) > shared else 0 for body, path in paths.items()}


def _border(holds: Callable[[float], bool], without: float, within: float) -> float:
    """The last value on the way from `within`, where something holds, to `without`, where it does not."""
    while abs(within - without) > EXACT:
        middle = (without + within) / 2
        without, within = (without, middle) if holds(middle) else (middle, within)
    return within
