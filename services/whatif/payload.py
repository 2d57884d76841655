"""A box in a robot's gripper: it moves along, and may touch nothing but that gripper."""

from typing import Final

import pyoxigraph as ox

from sdt_kg.annotation import Gripper
from sdt_kg.entities import Replacement
from sdt_kg.errors import InputError
from sdt_kg.history import Rewritten
from sdt_kg.iri import SDT, Iri, body_iri, joint_iri
from sdt_kg.mechanism import Body, Geometry, Inertia, Joint, JointType, Mechanism, Pose, ShapeType
from sdt_kg.store import Triple
from sdt_kg.triples import mechanism_triples
from sdt_kg.twin import Twin
from services.edits import numbers_of

FIRST_INDEX: Final = 1_000_000
"""What is carried comes after all bodies of the robot."""
FORM: Final = "payload:GRIPPER=SX,SY,SZ[,KG]"


def carrying(twin: Twin, robot: Iri, gripper: Gripper, text: str) -> Rewritten:
    """The robot with a box whose middle is between the gripper's pads, its sides along the tool frame.

    Its mass counts where forces do (D_artic_dyn): D_artic is kinematics, in which a mass changes nothing.

    Args:
        twin: With the robot.
        robot: IRI of the robot.
        gripper: Of that robot.
        text: Three sides [m], then its mass [kg] if there is one.

    Raises:
        InputError: No such numbers, or the gripper carries something already.
    """
    numbers = numbers_of(text, (3, 4), f"payload:{gripper.name}={text}")
    sides, mass = numbers[:3], numbers[3:]
    if min(numbers) <= 0:
        raise InputError(f"'{text}' has a side or mass that is not above 0", allowed=FORM)
    mechanism = twin.mechanism(robot)
    name = f"{gripper.name}_payload"
    if name in {each.name for each in mechanism.bodies}:
        raise InputError(f"gripper {gripper.name} carries something already", allowed="one payload a gripper")
    inertia = _inertia(mass[0], sides, gripper.tool) if mass else None
    box = Body(name, inertia, (Geometry(ShapeType.BOX, gripper.tool, tuple(sides)),))
    mount = Joint(f"{name}_mount", JointType.FIXED, gripper.tool_body, name)
    added = [*_triples(mechanism, box, mount), *_touching(mechanism, box, gripper)]
    return Rewritten(
        Replacement(robot, frozenset(), frozenset(added), f"gripper {gripper.name} carries a box")
    )


def _inertia(mass: float, sides: list[float], middle: Pose) -> Inertia:
    """Of a homogeneous box whose middle is there."""
    x, y, z = (side * side for side in sides)
    return Inertia(
        mass, middle, (mass * (y + z) / 12, 0.0, 0.0, mass * (x + z) / 12, 0.0, mass * (x + y) / 12)
    )


def _triples(mechanism: Mechanism, body: Body, mount: Joint) -> list[Triple]:
    alone = Mechanism(mechanism.name, mechanism.root, (body,), (mount,))
    own = body_iri(mechanism.name, body.name), joint_iri(mechanism.name, mount.name)
    index = ox.Literal(FIRST_INDEX)
    return [
        (subject, predicate, index if predicate == SDT + "index" and subject in own else value)
        for subject, predicate, value in mechanism_triples(alone, "Robot")
        if subject.startswith(own)
    ]


def _touching(mechanism: Mechanism, body: Body, gripper: Gripper) -> list[Triple]:
    """It may touch what the gripper consists of."""
    own = ox.NamedNode(body_iri(mechanism.name, body.name))
    hand = sorted(_hand(mechanism, gripper.tool_body) | set(gripper.fingers))
    return [(body_iri(mechanism.name, each), SDT + "mayTouch", own) for each in hand]


def _hand(mechanism: Mechanism, tool_body: str) -> set[str]:
    """Bodies rigid with the tool's body, and those that they carry."""
    above = {each.child: each for each in mechanism.joints}
    top = tool_body
    while top in above and above[top].type is JointType.FIXED:
        top = above[top].parent
    hand = {top}
    for joint in mechanism.joints:  # parents before children
        if joint.parent in hand:
            hand.add(joint.child)
    return hand
