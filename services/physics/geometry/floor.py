"""The floor: the plane z = 0 of the kitchen's root frame, on which robots stand.

Kitchens rarely model it, and a certificate without it would let an arm reach below the ground.
"""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.iri import Iri, body_iri
from sdt_kg.mechanism import JointType, Mechanism, Pose

SIDE = 100.0  # [m] of the box that stands for the plane, about the kitchen's origin
DEPTH = 1.0  # [m] below z = 0

LEVEL = 0.002  # [m] above z = 0 what of a kitchen ends is its floor: a tool may slip as much on a handle

SIZE = SIDE, SIDE, DEPTH
"""[m] Of that box."""

BELOW = Pose((0.0, 0.0, -DEPTH / 2))
"""Where the centre of that box is."""


def floor_iri(environment: Iri) -> Iri:
    """Individual of a kitchen's floor."""
    return f"{environment}/floor"


def floor_box() -> coal.Box:
    """The box whose upper face is the floor."""
    box = coal.Box(*SIZE)
    box.computeLocalAABB()
    return box


def standing(mechanism: Mechanism, annotation: RobotAnnotation) -> frozenset[Iri]:
    """Bodies (IRIs) that keep their height wherever the robot goes, and so may stand on the floor.

    They are those which only fixed joints, and joints that planning holds (wheels, casters, suspensions),
    part from the root. A held joint that follows another, or has a limit of acceleration, may move in a
    motion that is given: it counts only where it turns without end, as wheels do.
    """
    bodies = {mechanism.root}
    for joint in mechanism.joints:
        stays = joint.mimic is None and joint.name not in annotation.acceleration
        held = joint.name in annotation.held and (stays or joint.type is JointType.CONTINUOUS)
        if joint.parent in bodies and (held or joint.type is JointType.FIXED):
            bodies.add(joint.child)
    return frozenset(body_iri(mechanism.name, body) for body in bodies)
