"""Whether a point lies inside a mesh: triangles alone have no inside, closed surfaces of them do.

Vertices that files repeat for each face are one, and so are faces that are listed twice, as for
looking at them from both sides. A mesh then falls into parts whose faces share edges. A part is
closed if an even number of faces meets at each of its edges; an open part has no inside.
"""

from dataclasses import dataclass
from enum import Enum
from functools import lru_cache
from itertools import combinations, starmap

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from services.physics.geometry.pieces import joined, same_points
from services.physics.geometry.shapes import Triangles

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

DIRECTIONS = ((0.29, 0.53, 0.797), (-0.71, 0.37, 0.6), (0.61, -0.43, 0.665), (-0.17, -0.88, 0.443))
"""Of rays, one after the other until one meets no edge: askew, since furniture is not."""

HALF = 0.5  # [1] of all directions in which a surface is seen from inside
GRAZES = 1e-9  # [1] relative: a ray that passes an edge more closely says nothing


class Where(Enum):
    """Where a point lies that is on no triangle."""

    OUTSIDE = "outside"
    INSIDE = "inside"
    CAVITY = "cavity"
    """Inside a closed part, and in another one inside that, whose faces look the other way."""
    UNSEEN = "unseen"
    """In the box of an open part, and inside no closed one: an open part has no inside."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Faces that share edges.

    Attributes:
        triangles: Corners, shape (M, 3, 3) [m].
        box: Least and largest of these, shape (2, 3) [m].
        closed: Whether an even number of faces meets at each edge.
        alike: Whether they are closed and all look outwards, or all inwards.
    """

    triangles: Array
    box: Array
    closed: bool
    alike: bool

    def has_in_box(self, point: Array) -> bool:
        """Whether a point lies in the box about the part."""
        return bool(((point >= self.box[0]) & (point <= self.box[1])).all())


def where(mesh: coal.BVHModelBase, point: Array) -> Where:
    """Where a point (3,) [m] of the mesh's frame lies.

    Args:
        mesh: It must not be changed afterwards: its parts are kept.
        point: On no triangle.
    """
    near = [part for part in _parts(mesh) if part.has_in_box(point)]
    turns = [(part, round(_winding(part.triangles - point))) for part in near if part.alike]
    about = [part for part, turn in turns if turn != 0]
    odd = any(_odd(part.triangles - point) for part in near if part.closed and not part.alike)
    if odd or sum(turn for _, turn in turns) != 0:
        return Where.INSIDE
    if about:
        # Of two surfaces about a point that do not meet one is inside the other.
        return Where.INSIDE if any(starmap(_meet, combinations(about, 2))) else Where.CAVITY
    return Where.OUTSIDE if all(part.closed for part in near) else Where.UNSEEN


def within(mesh: coal.BVHModelBase, point: Array) -> bool:
    """Whether a point (3,) [m] of the mesh's frame lies inside it, or an open part goes around it by half.

    What has a gap is open, and all the same solid for a finger (Jacobson et al., 2013).
    """
    found = where(mesh, point)
    if found is not Where.UNSEEN:
        return found is Where.INSIDE
    return any(abs(_winding(part.triangles - point)) > HALF for part in _parts(mesh) if not part.closed)


def is_closed(mesh: coal.BVHModelBase) -> bool:
    """Whether all of its parts are: what meets no triangle of it is inside or outside as a whole."""
    return all(part.closed for part in _parts(mesh))


@lru_cache(maxsize=1024)
def _parts(mesh: coal.BVHModelBase) -> tuple[Part, ...]:
    faces = np.array([[face[k] for k in range(3)] for face in map(mesh.tri_indices, range(mesh.num_tris))])
    vertices, index = same_points(np.array(mesh.vertices()))
    faces = index[faces]
    ordered = np.sort(faces, axis=1)
    _, first = np.unique(ordered, axis=0, return_index=True)
    kept = first[(np.diff(ordered[first], axis=1) > 0).all(axis=1)]  # a face with one corner twice is none
    faces, ordered = faces[kept], ordered[kept]
    if not len(faces):
        return ()
    directed = np.concatenate((faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]))
    _, edge = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    edge, face, count = edge.reshape(-1), np.tile(np.arange(len(faces)), 3), int(edge.max()) + 1
    forth = np.where(directed[:, 0] < directed[:, 1], 1, -1)
    meet, turn = np.bincount(edge), np.bincount(edge, weights=forth)
    label = joined(np.column_stack((face, len(faces) + edge)), len(faces) + count)
    parts: list[Part] = []
    for each in np.unique(label[: len(faces)]):
        own = np.flatnonzero(label[len(faces) :] == each)
        closed = bool((meet[own] % 2 == 0).all())
        corners = np.ascontiguousarray(vertices[faces[label[: len(faces)] == each]])
        box = np.array((corners.min(axis=(0, 1)), corners.max(axis=(0, 1))))
        parts.append(Part(corners, box, closed, closed and bool((turn[own] == 0).all())))
    return tuple(parts)


def _meet(one: Part, other: Part) -> bool:
    """Whether the surfaces of two parts touch."""
    first, second = (
        Triangles(part.triangles.reshape(-1, 3), np.arange(3 * len(part.triangles)).reshape(-1, 3))
        for part in (one, other)
    )
    here, request, result = coal.Transform3s(), coal.DistanceRequest(), coal.DistanceResult()
    return float(coal.distance(first, here, second, here, request, result)) <= 0


def _winding(corners: Array) -> float:
    """How often closed triangles, seen from the origin, go around it: their solid angle by 4 π.

    Van Oosterom and Strackee (1983).
    """
    la, lb, lc = np.sqrt(np.einsum("mij,mij->im", corners, corners))
    ab, bc, ca = np.einsum("mij,mij->im", corners, corners[:, [1, 2, 0]])
    volume = np.linalg.det(corners)
    return float(np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb).sum() / (2 * np.pi))


def _odd(corners: Array) -> bool:
    """Whether a ray from the origin meets an odd number of triangles; true where none can be counted."""
    for direction in DIRECTIONS:
        count = _met(corners, np.array(direction))
        if count is not None:
            return count % 2 == 1
    return True


def _met(corners: Array, direction: Array) -> int | None:
    """How many triangles the ray meets; None if it grazes an edge of one."""
    a, b, c = np.moveaxis(corners, 1, 0)
    sides = np.column_stack([np.cross(x, y) @ direction for x, y in ((b, c), (c, a), (a, b))])
    close = GRAZES * (np.linalg.norm(corners, axis=2).max(axis=1) ** 2)[:, None]
    line = (sides > -close).all(axis=1) | (sides < close).all(axis=1)
    if (line & (np.abs(sides) <= close).any(axis=1)).any():
        return None
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    return int((line & (volume * sides.sum(axis=1) > 0)).sum())
