"""What is asked of a whole body, and under which policy."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from predicates.case import Case
from sdt_kg.annotation import Drive
from sdt_kg.errors import MotionError, OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import UNKNOWN
from sdt_kg.twin import Container
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.kit import Kits
from services.embodiment.ways.roads import Known
from services.physics.model import Scene


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """What is asked, and under which policy."""

    world: World
    container: Container
    motion: Motion
    drive: Drive
    start: tuple[float, float, float]
    robot: Iri
    kits: Kits
    roads: Known
    tolerances: Tolerances


def of_own_joint(scene: Scene, container: Container, motion: Motion) -> Motion:
    """The motion as values of the container's own joint, if it is given as those of one that moves with it.

    Raises:
        MotionError: It is of a joint that does not.
    """
    own, given = scene.coordinate[container.joint], scene.coordinate.get(motion.of)
    if given == own:
        return motion
    source, multiplier, offset = scene.coupling.source, scene.coupling.multiplier, scene.coupling.offset
    if given is None or source[given] != source[own] or multiplier[given] == 0:
        raise MotionError(
            f"the motion is of {local_name(motion.of)}, which does not move {container.name}",
            allowed=f"one of {local_name(container.joint)}",
        )
    scale = multiplier[own] / multiplier[given]
    values = offset[own] + scale * (motion.values - offset[given])
    velocities = None if motion.velocities is None else np.asarray(scale * motion.velocities)
    return replace(motion, of=container.joint, values=values, velocities=velocities)


def container_of(case: Case) -> Container:
    """The container which the case is about: the task's, else the one that its motion moves.

    Raises:
        OracleRejectedError: Neither names one.
    """
    if case.task is not UNKNOWN and case.task.container is not UNKNOWN:
        return case.twin.container(case.task.container)
    return next(_moved(case))


def _moved(case: Case) -> Iterator[Container]:
    named: set[Iri] = set()
    if isinstance(case.motion, Motion):
        named.add(case.motion.of)
    if isinstance(case.body_motion, BodyMotion):
        span = np.ptp(case.body_motion.kitchen_q, axis=0) if len(case.body_motion.kitchen_joints) else ()
        named.update(j for j, moved in zip(case.body_motion.kitchen_joints, span, strict=True) if moved > 0)
    for one in case.twin.containers():
        if named & {one.joint, one.active_joint, one.handle, *one.more_handles, one.iri}:
            yield one
    raise OracleRejectedError(f"none of {sorted(named) or 'nothing'} is a container or its joint")
