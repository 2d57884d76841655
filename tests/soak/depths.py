"""How deep one surface is in another, by numpy alone: the deepest point of either inside the other.

Inside is what a surface goes around, seen from there more than half of the way (Jacobson et al., 2013: of
surfaces with holes, too). A point's depth is its distance from that surface, and changes no faster than the
point moves: triangles are halved where they may still have a deeper point.
"""

import numpy as np
import trimesh
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

PRECISE = 1e-3  # [m]
MOST = 200_000  # pairs of points and triangles that are looked at together, for memory
AROUND = 0.5  # [1] of the full solid angle


def parts(mesh: trimesh.Trimesh) -> list[Array]:
    """Triangles of each connected part, shape (F, 3, 3) [m]."""
    whole = mesh.copy()
    whole.merge_vertices(merge_tex=True, merge_norm=True)
    groups = trimesh.graph.connected_components(whole.face_adjacency, nodes=np.arange(len(whole.faces)))
    return [np.asarray(whole.triangles[group]) for group in groups]


def depth(one: list[Array], other: list[Array]) -> float:
    """Of the parts of one surface in those of another, in one frame [m]; 0 if none is in any."""
    found = 0.0
    for part in one:
        for against in other:
            for surface, body in ((part, against), (against, part)):
                found = max(found, _deepest(surface, body, found))
    return found


def _deepest(triangles: Array, body: Array, least: float) -> float:
    """Depth of the deepest point of these triangles in a body [m], if it is `PRECISE` more than `least`."""
    low, high = body.min(axis=(0, 1)), body.max(axis=(0, 1))
    while len(triangles):
        ends = triangles.min(axis=1), triangles.max(axis=1)
        triangles = triangles[((ends[0] <= high) & (ends[1] >= low)).all(axis=1)]
        middle = triangles.mean(axis=1)
        radius = np.linalg.norm(triangles - middle[:, None], axis=2).max(axis=1)
        most = float(np.minimum(high - middle, middle - low).min(axis=1).max(initial=0.0))
        deep = _depths(middle, body, most)
        least = max(least, float(deep.max(initial=0.0)))
        triangles = _halved(triangles[deep + radius > least + PRECISE])
    return least


def _halved(triangles: Array) -> Array:
    """Each cut across its longest edge."""
    edges = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)
    first = (np.argmax(edges, axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(triangles, first[:, :, None], axis=1), 1, 0)
    middle = (a + b) / 2
    return np.concatenate((np.stack((a, middle, c), axis=1), np.stack((middle, b, c), axis=1)))


def _depths(points: Array, body: Array, most: float) -> Array:
    """Distance of each point from a surface [m], at most `most`; negative outside. Shape (P,)."""
    size, far = max(1, MOST // len(body)), [np.zeros(0)]
    for block in (points[first : first + size] for first in range(0, len(points), size)):
        low, high = block.min(axis=0) - most, block.max(axis=0) + most
        near = ((body.min(axis=1) <= high) & (body.max(axis=1) >= low)).all(axis=1)
        distance = np.minimum(_distances(block, body[near]), most)
        far.append(np.where(_within(block, body), distance, -distance))
    return np.concatenate(far)


def _within(points: Array, body: Array) -> Mask:
    """Whether the surface goes around each point (Van Oosterom and Strackee, 1983)."""
    a, b, c = np.moveaxis(body[None] - points[:, None, None], 2, 0)
    la, lb, lc = (np.linalg.norm(x, axis=2) for x in (a, b, c))
    top = (a * np.cross(b, c)).sum(axis=2)
    below = la * lb * lc + (a * b).sum(axis=2) * lc + (b * c).sum(axis=2) * la + (c * a).sum(axis=2) * lb
    return np.abs(2 * np.arctan2(top, below).sum(axis=1)) > AROUND * 4 * np.pi


def _distances(points: Array, body: Array) -> Array:
    """Of each point from the nearest of these triangles, shape (P,) [m]."""
    corners = np.moveaxis(body, 1, 0)
    edges = np.roll(corners, -1, axis=0) - corners
    normal = np.cross(edges[0], -edges[2])
    size = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(size > 0, size, 1.0)[:, None]
    off = points[:, None] - corners[0]
    above, least = np.abs((off * unit).sum(axis=2)), np.full((len(points), len(body)), np.inf)
    over = np.broadcast_to(size > 0, least.shape).copy()
    for corner, edge in zip(corners, edges, strict=True):
        off = points[:, None] - corner
        length = (edge * edge).sum(axis=1)
        share = np.clip((off * edge).sum(axis=2) / np.where(length > 0, length, 1.0), 0.0, 1.0)
        least = np.minimum(least, np.linalg.norm(off - share[:, :, None] * edge, axis=2))
        over &= (off * np.cross(unit, edge)).sum(axis=2) >= 0
    return np.where(over, above, least).min(axis=1, initial=np.inf)
