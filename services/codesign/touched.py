"""Which bodies of a kitchen an edit touches: everything else is where it was, whatever moves there."""

from dataclasses import dataclass, replace

from sdt_kg.annotation import Drive, RobotAnnotation
from sdt_kg.iri import Iri, body_iri, joint_iri
from sdt_kg.mechanism import Joint, Mechanism
from sdt_kg.twin import Twin


@dataclass(frozen=True, slots=True)
class Touched:
    """What differs between two twins, as far as a motion that is certified in one rests on it.

    Attributes:
        bodies: Bodies of the other kitchen whose shapes differ, or that may be elsewhere at some time.
        robot: Whether shapes, kinematics or parked posture of the robot differ.
    """

    bodies: frozenset[Iri]
    robot: bool


def touched(before: Twin, after: Twin, robot: Iri) -> Touched:
    """What an edit touches, seen from the twins alone and not from what the edit says of itself.

    A body is untouched if its shapes are equal, and every joint between it and the root, with what
    that mimics, is equal and in the same position: it is then where it was as long as the same
    joints move in the same way.
    """
    kitchens = before.mechanism(before.environment), after.mechanism(after.environment)
    other = _robot_differs(before, after, robot)
    if kitchens[0] is kitchens[1] and before.state == after.state:
        return Touched(frozenset(), other)
    if kitchens[0].root != kitchens[1].root or kitchens[0].name != kitchens[1].name:
        bodies = (body_iri(kitchens[1].name, each.name) for each in kitchens[1].bodies)
        return Touched(frozenset(bodies), other)
    still = _still(before, after)
    shapes = {body.name: body.collision for body in kitchens[0].bodies}
    own = kitchens[1]
    found = (
        body_iri(own.name, body.name)
        for body in own.bodies
        if body.name not in still or shapes.get(body.name) != body.collision
    )
    return Touched(frozenset(found), other)


def _still(before: Twin, after: Twin) -> set[str]:
    """Names of bodies all of whose joints are equal and in the same position."""
    one, other = before.mechanism(before.environment), after.mechanism(after.environment)
    known = {each.name: each for each in one.joints}
    still = {other.root}
    for joint in other.joints:  # parents before children
        same = _same_joint(known.get(joint.name), joint) and _stands(before, after, one, joint.name)
        if same and joint.mimic is not None:
            source = joint.mimic.joint
            found = next((each for each in other.joints if each.name == source), None)
            same = found is not None and _same_joint(known.get(source), found)
            same = same and _stands(before, after, one, source)
        if same and joint.parent in still:
            still.add(joint.child)
    return still


def _same_joint(one: Joint | None, other: Joint) -> bool:
    """Whether two joints place their child alike in every position; limits move nothing."""
    return one is not None and replace(one, limits=other.limits, notes=other.notes) == other


def _stands(before: Twin, after: Twin, kitchen: Mechanism, joint: str) -> bool:
    iri = joint_iri(kitchen.name, joint)
    return before.state.get(iri) == after.state.get(iri)


def _robot_differs(before: Twin, after: Twin, robot: Iri) -> bool:
    """Whether anything of the robot differs but its drive, its grippers and what is said of it.

    Grippers decide which contacts are a hold: pairs with the handle are never taken as known.
    """
    if robot not in before.robots or before.mechanism(robot) != after.mechanism(robot):
        return True
    return _bare(before.robot(robot)) != _bare(after.robot(robot))


def _bare(one: RobotAnnotation) -> RobotAnnotation:
    return replace(one, drive=Drive.OMNI, grippers=(), notes=())
