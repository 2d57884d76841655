"""What is asked of a whole body, and under which policy."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from predicates.case import Case
from sdt_kg.annotation import Drive
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import UNKNOWN
from sdt_kg.twin import Container
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.kit import Kits
from services.embodiment.ways.roads import Known


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """What is asked, and under which policy.

    Attributes:
        proves: Whether a proof is looked for where a search finds nothing.
    """

    world: World
    container: Container
    motion: Motion
    drive: Drive
    start: tuple[float, float, float]
    robot: Iri
    kits: Kits
    roads: Known
    tolerances: Tolerances
    proves: bool = True


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
