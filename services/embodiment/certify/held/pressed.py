"""How deep the holding fingers are in a handle that is a mesh.

The sweep knows how deep a finger is in each single triangle. Many small ones let a finger through,
since a little way aside parts it from each, so here the depth is that of the mesh's points in the
finger: its vertices, and the middles of its triangles. Between samples it is bounded by how far the
finger moves against the handle; the sweep still sees what passes through large triangles.
"""

from functools import lru_cache
from itertools import product

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from predicates.case import Evidence, Quantity
from sdt_kg.iri import local_name
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.held.hold import Hold
from services.embodiment.certify.held.slip import DEEPEST
from services.embodiment.certify.sweep import compiled
from services.embodiment.certify.sweep.depth import faces
from services.embodiment.certify.sweep.kinematics import Of, Placed
from services.embodiment.certify.sweep.pieces import Spans
from services.embodiment.certify.sweep.subject import Subject

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
NOTE = "the handle is a mesh: how deep fingers are in it is that of its vertices and its triangles' middles"

FINE = 5e-4
"""[m] Precision of the largest depth that is told."""


def pressed(checked: Subject, hold: Hold) -> Findings:
    """No point of a handle's mesh is deeper in a finger than the tolerance allows, while it is held."""
    findings, solids = Findings(), checked.scene.solids
    meshes = [int(k) for k in hold.bar if isinstance(solids[k].shape, coal.BVHModelBase)]
    if meshes:
        findings.nearest.append(NOTE)
        first = int(np.searchsorted(checked.timeline.pieces.start, hold.arrived))
        pieces = np.arange(first, hold.left)
        looks = _looks(checked, 0, pieces)
        for mesh, finger in product(meshes, map(int, hold.fingers)):
            findings.add(_in(checked, (finger, mesh), pieces, looks))
    return findings


def _looks(checked: Subject, halving: int, intervals: Indices) -> tuple[Spans, Placed]:
    """What moves on some intervals, so often halved, of the motion's pieces, and where it is in their middles."""
    spans = checked.timeline.spans(checked.timeline.depth + halving, intervals)
    return spans, checked.kinematics.place(spans.q, spans.v)


def _in(
    checked: Subject, pair: tuple[int, int], intervals: Indices, looks: tuple[Spans, Placed]
) -> Findings:
    """Where a finger is too deep in a mesh, first and worst; what is not shown to be less is refused.

    Args:
        checked: The motion.
        pair: Finger and mesh.
        intervals: The pieces on which that is asked.
        looks: What moves on these.
    """
    findings, most, worst = Findings(), checked.tolerances.depth, 0.0
    points, found = _points(checked.scene.solids[pair[1]].shape), list[tuple[float, float]]()
    for halving in range(DEEPEST + 1):
        if not len(intervals):
            break
        spans, placed = looks if halving == 0 else _looks(checked, halving, intervals)
        depth = depths(checked, placed, pair[0], checked.shapes.along(placed, pair[1]), points)
        upper = depth + _moves(checked, spans, placed, pair)
        if halving == DEEPEST:
            depth = upper
        worst = max(worst, float(depth.max()))
        found += zip(spans.middle[depth > most].tolist(), depth[depth > most].tolist(), strict=True)
        intervals = intervals[(upper > most) & ((depth <= most) | (upper > worst + FINE))]
        intervals = np.concatenate((2 * intervals, 2 * intervals + 1))
    if found:
        for time, depth in {min(found), max(found, key=lambda each: each[1])}:
            findings.violations.append(_violation(checked, pair, depth, time))
    return findings


def _moves(checked: Subject, spans: Spans, placed: Placed, pair: tuple[int, int]) -> Array:
    """How far any point of a finger moves against a mesh, from the middles of intervals on, at most [m]."""
    shapes, (finger, mesh) = checked.shapes, pair
    every = np.arange(len(placed.origin))
    centre = shapes.centres(placed, every, np.full_like(every, finger))
    carriers = int(shapes.carrier[finger]), int(shapes.carrier[mesh])
    ball = Of(*carriers, centre, float(shapes.radius[finger]))
    return checked.kinematics.bounds(spans, placed, ball)[0]


@lru_cache(maxsize=64)
def _points(mesh: coal.BVHModelBase) -> Array:
    """Vertices and middles of triangles in the mesh's frame, shape (K, 3) [m]; kept, so not to be changed."""
    vertices = np.array(mesh.vertices())
    corners = np.array([[face[k] for k in range(3)] for face in map(mesh.tri_indices, range(mesh.num_tris))])
    return np.vstack((np.unique(vertices, axis=0), vertices[corners].mean(axis=1)))


def depths(checked: Subject, placed: Placed, finger: int, mesh: tuple[Array, Array], points: Array) -> Array:
    """Depth of the deepest of the points in the finger at each time, shape (T,) [m]; 0 if none is in it.

    `mesh` has the frames in which the points are.
    """
    shape, found = checked.scene.solids[finger].shape, np.empty(len(placed.origin))
    body, box = faces(shape), shape.aabb_local
    assert body is not None, "shapes of the robot are convex"
    own, corners = checked.shapes.along(placed, finger), (np.array(box.min_), np.array(box.max_))
    room = np.empty((3, 3)), np.empty(3), np.empty(3)
    compiled.deepest_points(points, mesh, own, corners, body.normals, body.offsets, room, found)
    return found


def _violation(checked: Subject, pair: tuple[int, int], depth: float, time: float) -> Violation:
    one, other = (checked.scene.solids[k].body for k in pair)
    reason = f"{local_name(one)} and {local_name(other)} are {depth * 1000:.1f} mm in each other"
    least = -checked.tolerances.depth
    evidence = Evidence(
        Quantity.DISTANCE, -depth, least, "m", links=(one, other), time=time, scope="environment"
    )
    return Violation("finger in the handle", reason, evidence, depth + least)
