"""How deep the holding fingers are in a handle that is a mesh.

The sweep knows how deep a finger is in each single triangle. Many small ones let a finger through,
since a little way aside parts it from each, so here the depth is that of the mesh's points in the
finger: its vertices, and the middles of its triangles. It is looked at at many times, not between
them, and the verdict says so; the sweep still sees what passes through large triangles.
"""

from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from predicates.case import Evidence, Quantity
from sdt_kg.iri import local_name
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.held.hold import Hold
from services.embodiment.certify.sweep import compiled
from services.embodiment.certify.sweep.depth import faces
from services.embodiment.certify.sweep.kinematics import Placed
from services.embodiment.certify.sweep.subject import Subject

Array = NDArray[np.float64]
NOTE = "the handle is a mesh: how deep fingers are in it was looked at at each sample and halfway to the next"


def pressed(checked: Subject, hold: Hold) -> Findings:
    """No point of a handle's mesh is deeper in a finger than the tolerance allows, while it is held."""
    findings, solids = Findings(), checked.scene.solids
    meshes = [int(k) for k in hold.bar if isinstance(solids[k].shape, coal.BVHModelBase)]
    if not meshes:
        return findings
    findings.nearest.append(NOTE)
    pieces = checked.timeline.pieces
    times = np.sort(
        np.concatenate((pieces.start, pieces.start + pieces.duration / 2, [checked.timeline.end]))
    )
    times = times[(times >= hold.arrived) & (times <= hold.clear_from())]
    piece = np.clip(np.searchsorted(pieces.start, times, side="right") - 1, 0, len(pieces.start) - 1)
    q, v, _ = pieces.at(piece, times - pieces.start[piece])
    placed = checked.kinematics.place(q, v)
    for mesh in meshes:
        points, at = _points(solids[mesh].shape), checked.shapes.along(placed, mesh)
        for finger in map(int, hold.fingers):
            found = depths(checked, placed, finger, at, points)
            for n in {int(np.argmax(found > checked.tolerances.depth)), int(np.argmax(found))}:
                if found[n] > checked.tolerances.depth:
                    pair, depth, time = (finger, mesh), float(found[n]), float(times[n])
                    findings.violations.append(_violation(checked, pair, depth, time))
    return findings


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
