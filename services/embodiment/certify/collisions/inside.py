"""No body of the robot begins wholly inside a closed mesh of the kitchen.

A shape that lies wholly inside touches no triangle, so the sweep over the motion sees nothing of it.
The start is enough: seen from the mesh's body, each convex shape of the robot moves continuously,
and what is inside a closed surface can only be reached through it, where the shape touches a
triangle and the sweep refuses. A kitchen's body inside the robot needs no look: the robot's shapes are
solid. A room around the robot is a closed mesh too: its walls need an outer surface as well.
"""

from collections.abc import Iterator
from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from predicates.case import Evidence, Quantity
from sdt_kg.iri import local_name
from sdt_kg.naming import few
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.sweep.kinematics import Placed
from services.embodiment.certify.sweep.subject import Subject
from services.physics.geometry.inside import Where, where
from services.physics.model import Scene

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

TOLD = 3  # bodies that a note names; of more it says how many


def inside(checked: Subject) -> Findings:
    """Where the robot begins inside a mesh, and of which meshes that cannot be told."""
    findings, solids = Findings(), checked.scene.solids
    robot, own, meshes = _asked(checked.scene)
    if not len(meshes):
        return findings
    first = checked.timeline.pieces.c[:2, 0]
    placed = checked.kinematics.place(first[:1], first[1:])
    unseen: dict[Where, set[str]] = {Where.CAVITY: set(), Where.UNSEEN: set()}
    for shape, mesh, point in _in_boxes(checked, placed, robot, own, meshes):
        found = where(solids[mesh].shape, point)
        if found in unseen:
            unseen[found].add(local_name(solids[mesh].body))
        elif found is Where.INSIDE:
            findings.violations.extend(_enclosed(checked, placed, shape, mesh))
    for found, bodies in unseen.items():
        if bodies:
            findings.nearest.append(_SAID[found].format(few(sorted(bodies), TOLD)))
    return findings


_SAID = {
    Where.UNSEEN: "not seen: the robot begins in the box about a mesh that is not closed, so that it "
    "cannot be told to be inside: {}",
    Where.CAVITY: "the robot begins in a cavity of a mesh, inside one surface and another that looks "
    "inwards: {}",
}


@lru_cache(maxsize=8)
def _asked(scene: Scene) -> tuple[Indices, Array, Indices]:
    """The robot's shapes, a point of each in its frame, shape (M, 3) [m], and the kitchen's meshes.

    Kept, so not to be changed.
    """
    robot, others = (np.unique(scene.environment_pairs[:, k]) for k in (0, 1))
    meshes = [k for k in others if isinstance(scene.solids[k].shape, coal.BVHModelBase)]
    own = np.array([_point(scene.solids[k].shape) for k in robot])
    return robot, own, np.array(meshes, dtype=np.intp)


def _in_boxes(
    checked: Subject, placed: Placed, robot: Indices, own: Array, meshes: Indices
) -> Iterator[tuple[int, int, Array]]:
    """Robot shape, mesh, and a point of the shape in the mesh's frame, for those in the mesh's box."""
    rotation, origin = checked.shapes.frames(placed, np.zeros_like(robot), robot)
    points = origin + (rotation @ own[:, :, None])[:, :, 0]
    low, high = points.min(axis=0), points.max(axis=0)
    centre, radius = (
        checked.shapes.centres(placed, np.zeros_like(meshes), meshes),
        checked.shapes.radius[meshes],
    )
    meshes = meshes[(np.abs(centre - (low + high) / 2) <= (high - low) / 2 + radius[:, None]).all(axis=1)]
    outlines, frames = checked.scene.outlines, checked.shapes.frames(placed, np.zeros_like(meshes), meshes)
    seen = (points - frames[1][:, None]) @ frames[0]
    off = np.abs(seen - outlines.middle[meshes, None])
    for m, n in zip(*np.nonzero((off <= outlines.half[meshes, None]).all(axis=2)), strict=True):
        yield int(robot[n]), int(meshes[m]), seen[m, n]


def _point(shape: coal.CollisionGeometry) -> Array:
    """A point of a convex shape, in its frame, shape (3,) [m]."""
    if isinstance(shape, coal.ConvexBase):
        return np.array(shape.points()).mean(axis=0)
    return np.zeros(3)


def _enclosed(checked: Subject, placed: Placed, shape: int, mesh: int) -> Iterator[Violation]:
    """The violation, unless the shape touches a triangle: the sweep judges that."""
    pairs = np.array([(shape, mesh)], dtype=np.intp)
    distance = float(checked.shapes.distances(placed, np.zeros(1, dtype=np.intp), pairs)[0])
    if distance <= 0:
        return
    links = checked.scene.solids[shape].body, checked.scene.solids[mesh].body
    names = f"{local_name(links[0])} begins wholly inside {local_name(links[1])}"
    reason = f"{names}, a closed mesh, {distance * 1000:.1f} mm from its surface"
    evidence = Evidence(
        Quantity.DISTANCE,
        -distance,
        0.0,
        "m",
        links=links,
        time=float(checked.pieces.start[0]),
        scope="environment",
    )
    yield Violation("inside at the start", reason, evidence, distance)
