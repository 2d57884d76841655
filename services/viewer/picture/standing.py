"""Where a robot begins, and where its links then are."""

import math

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.twin import Container, Twin
from services.viewer.picture.skeleton import Skeleton

Array = NDArray[np.float64]
Pose2 = tuple[float, float, float]


def kitchen_positions(skeleton: Skeleton, positions: dict[Iri, float]) -> dict[str, float]:
    """Positions by joint name of positions by joint IRI [rad or m]."""
    own = joint_iri(skeleton.mechanism.name, "")
    return {local_name(joint): at for joint, at in positions.items() if joint.startswith(own)}


def start_pose(twin: Twin, kitchen: Skeleton, container: Container, base: Pose2 | None) -> Pose2:
    """Base pose x, y [m], yaw [rad] as CanPerform takes it: as told, else turned to the handle."""
    if base is not None:
        return base
    x, y, _ = twin.kitchen().start
    positions = kitchen_positions(kitchen, dict(twin.state))
    handle = kitchen.body(local_name(container.handle), positions, np.eye(4))[:3, 3]
    return x, y, math.atan2(handle[1] - y, handle[0] - x)


def parked(annotation: RobotAnnotation, positions: dict[str, float]) -> dict[str, float]:
    """Robot joint name → position [rad or m]: as given, else parked; what is not listed rests."""
    return annotation.parked | positions
