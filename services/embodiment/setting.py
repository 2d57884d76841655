"""What is asked of a whole body, and under which policy."""

from dataclasses import dataclass, replace

import numpy as np

from sdt_kg.annotation import Drive
from sdt_kg.errors import MotionError
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import Motion
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
