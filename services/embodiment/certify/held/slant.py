"""How far the faces with which fingers hold a handle look away from the way in which they close."""

from sdt_kg.twin import Twin
from services.embodiment.certify.certificate import Certificate
from services.embodiment.certify.held.hold import TURN
from services.embodiment.certify.held.holds import one_after_the_other
from services.embodiment.certify.held.stints import begin
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.sweep.subject import subject
from services.physics.model import Scene


def slant(scene: Scene, twin: Twin, certificate: Certificate) -> float:
    """Of all holds of a certified motion, the most [rad]; pi / 2 where nothing is shown.

    Args:
        scene: Kitchen and robot of the certificate.
        twin: Both, in the state in which the motion begins.
        certificate: Which fingers hold what, and how far the tool turns on it.
    """
    container, motion = certificate.held_in(twin), certificate.motion
    pieces, _ = whole_motion(scene, motion, certificate.tolerances)
    first = begin(pieces, scene.coordinate[container.joint])
    if first is None:
        return 0.0
    (gripper,) = (one for one in scene.annotation.grippers if one.name == motion.gripper)
    checked = subject(scene, pieces, certificate.tolerances)
    holds = one_after_the_other(checked, container, gripper, first)
    return max(hold.slant() for hold in holds) + certificate.figures[TURN][0]
