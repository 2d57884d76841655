"""Joints that stand where the robot is parked, in every motion that certification accepts.

Certification refuses a motion in which a joint of the robot moves, however little, for which nothing says
how fast it may become (`certify.limits`), and one that does not start parked, each joint to within
`start_angle` or `start_position` (`certify.motion.start`). So a joint without a limit of acceleration is
as far from its parked position all along: a head that planning holds, mostly. Finger joints may start
anywhere, and a joint that mimics another moves with that; neither is meant.
"""

import math
from dataclasses import replace

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.mechanism import Joint, Mechanism
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.geometry.mechanics import Chain, Link

ROUNDING = 1e-9  # [rad or m] more than a difference of positions is off by


def with_parked(
    chain: Chain, mechanism: Mechanism, annotation: RobotAnnotation, tolerances: Tolerances
) -> Chain:
    """The same chain, its joints that certification never lets move where they are parked."""
    return replace(
        chain,
        links=tuple(
            _stood(link, mechanism.joint(link.name), annotation, tolerances)
            if stands(mechanism.joint(link.name), annotation)
            else link
            for link in chain.links
        ),
    )


def stands(joint: Joint, annotation: RobotAnnotation) -> bool:
    """Whether no certified motion moves a joint of the robot, and it starts parked."""
    known = annotation.acceleration.get(joint.name, math.inf)
    return (
        joint.mimic is None
        and joint.name not in annotation.finger_joints
        and not math.isfinite(min(joint.limits.acceleration, known))
    )


def _stood(link: Link, joint: Joint, annotation: RobotAnnotation, tolerances: Tolerances) -> Link:
    """A joint about its parked position: as annotated, else at or nearest to 0."""
    rest = min(max(0.0, joint.limits.lower), joint.limits.upper)
    at = annotation.parked.get(joint.name, rest)
    far = (tolerances.start_angle if link.turns else tolerances.start_position) + ROUNDING
    return replace(link, lower=at - far, upper=at + far)
