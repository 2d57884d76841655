"""Points for the picture: where two bodies are nearest, and where a proof says that nothing holds."""

from collections.abc import Iterable
from dataclasses import replace

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from predicates.case import Artefact, ArtefactKind
from predicates.meant import unit_of
from sdt_kg.iri import Iri
from sdt_kg.twin import Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.proof.content import at_one_value
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.physics.model import Scene
from services.viewer.picture.marks import Box, Mark, Point, What
from services.viewer.picture.timeline import Posture

Array = NDArray[np.float64]


def with_ends(scene: Scene, posture: Posture, mark: Mark) -> Mark:
    """The mark with the two points at which its bodies are nearest in that posture."""
    assert posture.base is not None, "a pair of the robot's was measured"
    q = scene.q(posture.base, posture.robot, posture.kitchen)
    ends = nearest(scene, q, mark.bodies)
    return mark if ends is None else replace(mark, ends=ends)


def nearest(scene: Scene, q: Array, bodies: tuple[Iri, ...]) -> tuple[Point, Point] | None:
    """The points of two bodies that are nearest to each other; None where one has no shape."""
    if len(bodies) != 2:
        return None
    scene.placements.move(q)
    best = None
    for one in _solids(scene, bodies[0]):
        for other in _solids(scene, bodies[1]):
            request, result = coal.DistanceRequest(), coal.DistanceResult()
            distance = coal.distance(one[0], one[1], other[0], other[1], request, result)
            if best is None or distance < best[0]:
                best = distance, _point(result.getNearestPoint1()), _point(result.getNearestPoint2())
    return None if best is None else (best[1], best[2])


def _solids(scene: Scene, body: Iri) -> list[tuple[coal.CollisionGeometry, coal.Transform3s]]:
    at = scene.placements.world_T_joint
    placed = ((one, at[one.joint] * one.joint_T_shape) for one in scene.solids if one.body == body)
    return [(one.shape, coal.Transform3s(where.rotation, where.translation)) for one, where in placed]


def _point(vector: Iterable[float]) -> Point:
    x, y, z = (float(each) for each in vector)
    return x, y, z


def region(twin: Twin, artefact: Artefact | None) -> Mark | None:
    """Where a proof says that a gripper had to hold and cannot: the handle, inflated by what is tolerated."""
    if artefact is None or artefact.kind is not ArtefactKind.PROOF:
        return None
    proof = read_proof(artefact.content)
    claim = proof.claim
    if not proof.refutations:
        return None
    lasting = [one for one in proof.refutations if one.places is not None]
    value = [*lasting, *proof.refutations][0].value
    container = twin.container(claim.container)
    about = twin, claim.models[1][0], container, claim.drive, claim.start, Tolerances()
    statement = Statement(*about, within=claim.within, declared=claim.declared)
    target = statement.target(value)
    boxes = []
    for place, half in zip(target.boxes, target.half, strict=True):
        rotation = place.rotation.middle
        middle = place.translation.middle
        a, b, c, w = (float(each) for each in Rotation.from_matrix(rotation).as_quat())
        boxes.append(Box(_point(middle), (a, b, c, w), _point(2 * half)))
    what = "holds the handle" if claim.within is None else "has the middle between its fingers"
    proved = "proved of its collision shapes" if claim.declared else "proved"
    at = f"{container.name} at {value:.3g} {unit_of(twin, container)}"
    text = f"{proved}: no gripper {what} here with {at}"
    if lasting or not at_one_value(proof.refutations):
        text = f"{proved}: no gripper keeps one hold all along; here with {at}"
    elif any(one.steps is not None for one in proof.refutations):
        text = f"{proved}: no gripper {what} at all values; here with {at}"
    return Mark(What.REGION, text, reason=0, bodies=(container.handle,), boxes=tuple(boxes))
