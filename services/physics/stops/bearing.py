"""What bears what moves: its rails and hinge, what houses it, what it was drawn into; the rest stops it."""

from collections.abc import Iterator

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np

from sdt_kg.iri import Iri
from sdt_kg.mechanism import JointType
from services.physics.geometry.bodies import BodyShape, with_piece
from services.physics.geometry.pieces import Piece, bent, beyond
from services.physics.geometry.shapes import corners
from services.physics.stops.rest import ALLOWANCE, ALONG, Rest
from services.physics.tree import Array

SIDES = 0.25
"""[1] Share of a slide's extent across its way that counts as one of its sides at most: of a thin board,
and of a low drawer, the middle is left."""

FITTED = 0.003
"""[m] Depth from which on what slides is drawn into what bears it; less is a slip of the drawing. In the
bundled kitchens and their sources what slides so is more than 4 mm deep in what bears it."""

ENCLOSED = 0.5
"""[1] Share of a body that has to lie in what bears it and is not its joint's parent: the drawer below the
fridge of kitchen `b` has 0.53."""

FRAME = 0.05
"""[m] How far from a container at rest triangles of a bent mesh may be that still belong to its cabinet: the
frame before a drawer. A whole room may be one mesh."""

HINGE = 0.1
"""[m] How far from its hinge a door may turn into what is beside it: doors are less thick."""

RAILS = 0.02
"""[m] How far from the sides of what slides it may slide in what is beside it: rails are less thick."""

RUNNERS = 0.05
"""[m] Likewise in what it was fitted into: fronts reach that far beyond the drawer between its runners. In
the kitchens' sources a drawer's back meets the wedges in place of runners up to 44 mm from the sides."""


class Bearing:
    """Which shapes of a kitchen may stop which, as they were fitted together."""

    def __init__(self, rest: Rest) -> None:
        self.rest = rest
        self._known: dict[tuple[Iri, int], BodyShape | None] = {}
        self._away: dict[tuple[Iri, int], BodyShape | None] = {}
        self._cores: dict[tuple[int, float], tuple[BodyShape, ...]] = {}
        self._in: dict[tuple[int, int], bool] = {}
        self._right_through: dict[tuple[int, int], bool] = {}
        self._housed: dict[tuple[Iri, Iri], bool] = {}
        self._largest: dict[int, Iri] = {}

    def stopping(self, one: BodyShape, other: BodyShape) -> BodyShape | None:
        """What of another shape may stop a moved one; None where it moves in or on all of it.

        It does on shapes beside its body at rest, of its joint's parent or mount. Of a parent that is much
        more than a cabinet, a whole room, the rest stops it; so do triangles of a bent mesh that are farther
        from it, for the mesh may be the whole room. What is fixed to the parent bears it only where it
        houses it: a box that stands before a drawer does not. The floor stops what was not drawn below it.
        """
        if other is self.rest.floor:
            return None if self._sunk(one) else other
        key = (one.body, id(other))
        if key not in self._known:
            self._known[key] = self._not_beside(other, one) if self._bears(other.body, one) else other
        return self._known[key]

    def cores(self, one: BodyShape, other: BodyShape) -> tuple[BodyShape, ...]:
        """What of a moved shape another one stops that is beside it: what is far from its hinge or rails.

        At its hinge a door turns into the edges of its cabinet, on rails a drawer slides in its cabinet. With
        its face a door stops at a wall beside it, and with its back a drawer at a pipe in its cabinet.
        Runners into which a drawer was fitted may be thicker. It is borne all along by what it goes right
        through, as the bars of a drawer in a dishwasher go through a board; of what houses it, by all through
        which it reaches, as the drawer below a fridge through the fridge.
        """
        if other is self.rest.floor:
            return ()
        if self.rest.joint(one).type is not JointType.PRISMATIC:
            return self._cores_of(one, HINGE)
        if not self._fitted(one, other):
            return self._cores_of(one, RAILS)
        return () if self._through(one, other) else self._cores_of(one, RUNNERS)

    def away(self, mesh: BodyShape, one: BodyShape) -> BodyShape | None:
        """What of a bent mesh is farther than `FRAME` from another shape's body; None if nothing is.

        Of a mesh on which that body does not hang, what stands before it too.
        """
        key = (one.body, id(mesh))
        if key not in self._away:
            triangles = corners(mesh.piece.shape)
            seen = self.rest.seen(mesh, one)
            turned = (triangles @ seen.rotation.T + seen.translation) @ self.rest.axes(one).T
            box = turned.min(axis=1), turned.max(axis=1)
            apart = self.rest.off(*box, one) > FRAME
            if not self._bears(mesh.body, one):
                apart |= self.rest.before(*box, one)
            part = with_piece(mesh, bent(triangles[apart])) if apart.any() else None
            self._away[key] = part and self.rest.placed_as(mesh, part)
        return self._away[key]

    def _sunk(self, one: BodyShape) -> bool:
        """Whether something that one's joint moves reaches below the floor: there the floor is elsewhere."""
        return min(map(self.rest.height, self.rest.moved_with(one))) < -ALLOWANCE

    def _fitted(self, one: BodyShape, other: BodyShape) -> bool:
        """Whether anything that one's joint moves was fitted into the other shape."""
        key = (one.joint, id(other))
        if key not in self._in:
            self._in[key] = any(self.rest.depth(e, other) > FITTED for e in self.rest.moved_with(one))
        return self._in[key]

    def _through(self, one: BodyShape, other: BodyShape) -> bool:
        """Whether anything of that goes right through the other shape."""
        key = (one.joint, id(other))
        if key not in self._right_through:
            own = other.body == one.parent
            self._right_through[key] = any(
                self.rest.is_through(e, other, within=own) and self.rest.depth(e, other) > FITTED
                for e in self.rest.moved_with(one)
            )
        return self._right_through[key]

    def _cores_of(self, one: BodyShape, margin: float) -> tuple[BodyShape, ...]:
        """The parts of the shape that are farther than that from hinge or rails."""
        key = (id(one), margin)
        if key not in self._cores:
            sliding = self.rest.joint(one).type is JointType.PRISMATIC
            parts = self._between_rails(one, margin) if sliding else self._off_hinge(one, margin)
            self._cores[key] = tuple(self.rest.placed_as(one, with_piece(one, each)) for each in parts)
        return self._cores[key]

    def _off_hinge(self, one: BodyShape, margin: float) -> Iterator[Piece]:
        """The parts of the shape that are farther than a margin from the axis, on each of its four sides."""
        axis = np.array(self.rest.joint(one).axis)
        axis /= np.linalg.norm(axis)
        out = sum(self.rest.about(one)) / 2
        out -= (out @ axis) * axis
        if not out.any():
            out = np.eye(3)[np.argmin(np.abs(axis))]
            out -= (out @ axis) * axis
        out /= np.linalg.norm(out)
        side = np.cross(axis, out)
        yield from filter(None, (_cut(one, way, margin) for way in (out, -out, side, -side)))

    def _between_rails(self, one: BodyShape, margin: float) -> Iterator[Piece]:
        """The part of the shape that is farther than a margin from the sides of what slides."""
        low, high = self._sides(one)
        axes, piece = self.rest.axes(one), one.piece
        for k in np.flatnonzero(np.abs(axes @ np.array(self.rest.joint(one).axis)) < ALONG):
            off = min(margin, SIDES * float(high[k] - low[k]))
            for way, least in ((axes[k], low[k] + off), (-axes[k], off - high[k])):
                within = _cut(with_piece(one, piece), way, least)
                if within is None:
                    return
                piece = within
        yield piece

    def _sides(self, one: BodyShape) -> tuple[Array, Array]:
        """Corners of the box about one's body and the largest that its joint moves, without their handles."""
        if one.joint not in self._largest:
            moved = {each.body: self.rest.about(each) for each in self.rest.moved_with(one)}
            self._largest[one.joint] = max(moved, key=lambda body: np.prod(moved[body][1] - moved[body][0]))
        shapes = [each for body in {one.body, self._largest[one.joint]} for each in self.rest.of(body)]
        return self.rest.box(shapes, one)

    def _not_beside(self, other: BodyShape, one: BodyShape) -> BodyShape | None:
        """The shape without what of it is beside one's body."""
        below, above = self.rest.box([other], one)
        box = below[None], above[None], one
        if self.rest.off(*box)[0] > ALLOWANCE or self.rest.before(*box)[0]:
            return other
        return self.away(other, one) if isinstance(other.piece.shape, coal.BVHModelBase) else None

    def _bears(self, body: Iri, one: BodyShape) -> bool:
        """Whether one's body hangs on the other, or is housed by what is fixed to that."""
        return one.parent == body or (body in one.mount and self._houses(body, one))

    def _houses(self, body: Iri, one: BodyShape) -> bool:
        """Whether a body overlaps one's, and a box about it has most of that about one's in it."""
        own, others, key = self.rest.of(one.body), self.rest.of(body), (one.body, body)
        if key not in self._housed:
            (low, high), (below, above) = self.rest.box(own, one), self.rest.box(others, one)
            shared = np.clip(np.minimum(high, above) - np.maximum(low, below), 0.0, None)
            most = bool(np.prod(shared) > ENCLOSED * np.prod(high - low))
            self._housed[key] = most and any(self.rest.depth(a, b) > 0 for a in own for b in others)
        return self._housed[key]


def _cut(one: BodyShape, way: Array, least: float) -> Piece | None:
    """The part of a shape that is farther along a direction of its joint's frame than that [m]."""
    rotation, origin = one.pose.rotation, one.pose.translation
    return beyond(one.piece, rotation.T @ way, least - float(origin @ way))
