"""How deep the holding fingers are in a handle that is a mesh.

The sweep knows how deep a finger is in each single triangle. Many small ones let a finger through,
since a little way aside parts it from each, so here the depth is that of the mesh's points in the
finger: its vertices, and the middles of its triangles. Between samples it is bounded by how far the
finger moves against the handle; the sweep still sees what passes through large triangles.
"""

from functools import lru_cache

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
NOTE = "the handle is a mesh: how deep fingers are in it is that of its vertices and its triangles' middles"

FINE = 5e-4
"""[m] Precision of the largest depth that is told."""


def pressed(checked: Subject, hold: Hold) -> Findings:
    """No point of a handle's mesh is deeper in a finger than the tolerance allows, while it is held."""
    findings, solids = Findings(), checked.scene.solids
    meshes = [int(k) for k in hold.bar if isinstance(solids[k].shape, coal.BVHModelBase)]
    if meshes:
        findings.nearest.append(NOTE)
    for mesh in meshes:
        for finger in map(int, hold.fingers):
            findings.add(_in(checked, hold, finger, mesh))
    return findings


def _in(checked: Subject, hold: Hold, finger: int, mesh: int) -> Findings:
    """Where a finger is too deep in a mesh, first and worst; what is not shown to be less is refused."""
    findings, most, worst = Findings(), checked.tolerances.depth, 0.0
    timeline, points = checked.timeline, _points(checked.scene.solids[mesh].shape)
    first = int(np.searchsorted(timeline.pieces.start, hold.arrived))
    intervals, found = np.arange(first, hold.left), list[tuple[float, float]]()
    for halving in range(DEEPEST + 1):
        if not len(intervals):
            break
        spans = timeline.spans(timeline.depth + halving, intervals)
        placed = checked.kinematics.place(spans.q, spans.v)
        depth = depths(checked, placed, finger, checked.shapes.along(placed, mesh), points)
        upper = depth + _moves(checked, spans, placed, finger, mesh)
        if halving == DEEPEST:
            depth = upper
        worst = max(worst, float(depth.max()))
        found += zip(spans.middle[depth > most].tolist(), depth[depth > most].tolist(), strict=True)
        intervals = intervals[(upper > most) & ((depth <= most) | (upper > worst + FINE))]
        intervals = np.concatenate((2 * intervals, 2 * intervals + 1))
    if found:
        for time, depth in {min(found), max(found, key=lambda each: each[1])}:
            findings.violations.append(_violation(checked, (finger, mesh), depth, time))
    return findings


def _moves(checked: Subject, spans: Spans, placed: Placed, finger: int, mesh: int) -> Array:
    """How far any point of a finger moves against a mesh, from the middles of intervals on, at most [m]."""
    shapes, every = checked.shapes, np.arange(len(placed.origin))
    centre, radius = shapes.centres(placed, every, np.full_like(every, finger)), shapes.radius[finger]
    ball = Of(int(shapes.carrier[finger]), int(shapes.carrier[mesh]), centre, np.full(len(every), radius))
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
