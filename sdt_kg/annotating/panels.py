"""Measures of hinged bodies and of what is fixed to them, for the structural rule.

SPARQL has no square root, so these are taken here, from the collision geometry.
"""

from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import product
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import SDT, Iri
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.store import Store, Triple, double, rows_of
from sdt_kg.triples import Facts
from sdt_kg.triples.to_mechanism import geometry_of
from sdt_kg.urdf.meshes import triangles_of

Points = NDArray[np.float64]

CANDIDATES: Final = """
PREFIX sdt: <https://example.org/sdt#>
SELECT DISTINCT ?joint ?body ?part ?mount
WHERE {
  VALUES ?type { sdt:RevoluteJoint sdt:ContinuousJoint }
  ?joint a ?type ;
    sdt:child ?body ;
    sdt:partOf/a sdt:Environment .
  ?mount a sdt:FixedJoint ;
    sdt:parent ?body ;
    sdt:child ?part .
  FILTER NOT EXISTS { ?body a sdt:Container }
}
"""


def panel_triples(store: Store, graphs: Sequence[Iri]) -> Iterator[Triple]:
    """Reach and sides of hinged bodies that are no containers yet, and of what is fixed to them."""
    _, rows = rows_of(store.query(CANDIDATES, graphs))
    if not rows:
        return
    facts = Facts(triple for graph in graphs for triple in store.triples(graph))
    measured: set[Iri] = set()
    for row in rows:
        joint, body, part, mount = (str(row[name]) for name in ("joint", "body", "part", "mount"))
        panel, piece = corners(_shapes(facts, body)), corners(_shapes(facts, part))
        if not len(panel) or not len(piece):
            continue
        axis = np.array([facts.number(joint, f"axis{name}") for name in "XYZ"])
        if body not in measured:
            measured.add(body)
            yield body, SDT + "hingeReach", double(float(distances(panel, axis).max()))
            yield from _sides(body, panel)
        piece_in_panel = moved(piece, facts.pose(str(facts.one(mount, "hasOrigin"))))
        centre = (piece_in_panel.min(axis=0) + piece_in_panel.max(axis=0)) / 2
        yield part, SDT + "hingeDistance", double(float(distances(centre[None], axis)[0]))
        yield from _sides(part, piece)


def _sides(body: Iri, points: Points) -> Iterator[Triple]:
    shortest, middle, longest = sorted(float(side) for side in np.ptp(points, axis=0))
    yield body, SDT + "shortestSide", double(shortest)
    yield body, SDT + "middleSide", double(middle)
    yield body, SDT + "longestSide", double(longest)


def _shapes(facts: Facts, body: Iri) -> list[Geometry]:
    return [geometry_of(facts, shape) for shape in facts.iris(body, "hasCollisionGeometry")]


def corners(shapes: Iterable[Geometry]) -> Points:
    """Corners of boxes around the shapes, vertices of meshes, in the body's frame, shape (n, 3) [m]."""
    parts = [moved(_own_corners(shape), shape.pose) for shape in shapes]
    return np.concatenate(parts) if parts else np.zeros((0, 3))


def _own_corners(shape: Geometry) -> Points:
    if shape.shape is ShapeType.MESH:
        return _vertices(shape.mesh_file, shape.mesh_hash) * np.array(shape.size)
    if shape.shape is ShapeType.BOX:
        half = np.array(shape.size) / 2
    elif shape.shape is ShapeType.SPHERE:
        half = np.full(3, shape.size[0])
    else:
        radius, length = shape.size
        caps = radius if shape.shape is ShapeType.CAPSULE else 0.0
        half = np.array((radius, radius, length / 2 + caps))
    return np.array(list(product((-1.0, 1.0), repeat=3))) * half


@cache
def _vertices(file: str, _hash: str) -> Points:
    """Vertices of a mesh file, shape (n, 3) [m]; one that changed is another."""
    return triangles_of(Path(file))[0]


def moved(points: Points, pose: Pose) -> Points:
    """The points in the parent frame of the pose."""
    parent_T_child = pose.matrix()
    return points @ parent_T_child[:3, :3].T + parent_T_child[:3, 3]


def distances(points: Points, axis: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of each point from the axis through the origin, shape (n,) [m]."""
    along = np.outer(points @ axis, axis)
    return np.linalg.norm(points - along, axis=1)
