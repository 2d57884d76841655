"""τ of a container under a body motion."""

import numpy as np

from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Container, Twin
from services.physics.tree import Model


def carried(model: Model, twin: Twin, body_motion: BodyMotion, container: Container) -> Motion:
    """Motion of the container's own joint, as the body motion says; still where it says nothing."""
    del model
    columns = {joint: i for i, joint in enumerate(body_motion.kitchen_joints)}
    m, o = container.multiplier, container.offset
    if container.active_joint in columns:
        i = columns[container.active_joint]
        values, velocities = m * body_motion.kitchen_q[:, [i]] + o, m * body_motion.kitchen_v[:, [i]]
    elif container.joint in columns:
        i = columns[container.joint]
        values, velocities = body_motion.kitchen_q[:, [i]], body_motion.kitchen_v[:, [i]]
    else:
        still = m * twin.state[container.active_joint] + o
        values, velocities = (
            np.full((len(body_motion.times), 1), still),
            np.zeros((len(body_motion.times), 1)),
        )
    return Motion(container.joint, body_motion.times, values, velocities=velocities)
