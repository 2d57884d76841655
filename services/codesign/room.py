"""Whether one world has room for no motion that another has none for: then nothing is searched again."""

from dataclasses import replace

from predicates.case import Case
from sdt_kg.entities.container import Container
from sdt_kg.iri import Iri, body_iri
from sdt_kg.twin import Twin
from services.codesign.again import FREEDOM, whole_body
from services.codesign.entries import How
from services.codesign.touched import Touched
from services.embodiment.setting import container_of
from services.whatif import World


def reusable(before: World, after: World, case: Case, found: Touched) -> How | None:
    """Why a search in one world answers for the other, or None if it does not.

    Whatever motion is certified in the other world would be certified in the first: robot, container,
    handle, start and tolerances are the same, each body that was there is there and as it was, and the
    base and the grippers can do no more. Where no body is new either, nothing differs that a search
    rests on.

    Args:
        before: The world in which it was searched.
        after: The other one.
        case: In the other one.
        found: What differs.
    """
    one, other = before.service, after.service
    if found.robot or before.robot_iri != after.robot_iri or not _asked_alike(before, after):
        return None
    if one.twin.kitchen() != other.twin.kitchen():
        return None
    held = _same_container(one.twin, other.twin, container_of(case).name, found)
    if not held or not _new(one.twin, other.twin) >= found.bodies or _gone(one.twin, other.twin):
        return None
    robot = before.robot_iri
    drives = [FREEDOM.index(each.policy.drive_of(each.twin, robot)) for each in (one, other)]
    grippers = [set(each.twin.robot(robot).grippers) for each in (one, other)]
    if drives[1] > drives[0] or not grippers[1] <= grippers[0] or not _start_alike(before, after, case):
        return None
    alike = not found.bodies and drives[0] == drives[1] and grippers[0] == grippers[1]
    return How.NOTHING if alike else How.LESS_ROOM


def _asked_alike(before: World, after: World) -> bool:
    """Whether both policies are the same but for the drive, and the search is allowed no more time."""
    one, other = before.service.policy, after.service.policy
    return other.budget <= one.budget and replace(one, drive=None, budget=0.0) == replace(
        other, drive=None, budget=0.0
    )


def _start_alike(before: World, after: World, case: Case) -> bool:
    """Whether the robot starts at the same pose: what is new may stand where it started."""
    then = replace(case, twin=before.service.twin)
    return whole_body(before.service).start_pose(then) == whole_body(after.service).start_pose(case)


def _same_container(before: Twin, after: Twin, name: str, found: Touched) -> bool:
    """Whether figures, and limits of what moves with it, are equal; neither it nor its handle is touched."""
    one: Container = before.container(name)
    if after.container(name) != one or {one.iri, one.handle} & found.bodies:
        return False
    joints = one.joint, *before.entities.coupling.together(one.joint)
    kitchens = [twin.entities.coupling.joints for twin in (before, after)]
    return all(kitchens[0][each].limits == kitchens[1][each].limits for each in joints)


def _bodies(twin: Twin) -> set[Iri]:
    kitchen = twin.mechanism(twin.environment)
    return {body_iri(kitchen.name, each.name) for each in kitchen.bodies}


def _new(before: Twin, after: Twin) -> set[Iri]:
    return _bodies(after) - _bodies(before)


def _gone(before: Twin, after: Twin) -> set[Iri]:
    return _bodies(before) - _bodies(after)
