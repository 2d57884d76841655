"""What was proved, in words: where the handle is out of reach, and for which base."""

import numpy as np

from predicates.case import Diagnosis, Evidence, Kind, Quantity
from sdt_kg.iri import local_name
from sdt_kg.mechanism import JointType
from sdt_kg.motion import Motion
from sdt_kg.numbers import so_many
from services.embodiment.proof_check.geometry.mechanics import Tree
from services.embodiment.proof_check.parked import stands
from services.embodiment.proof_check.proof.content import LEAF, Refutation, at_one_value
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove.windows import Window

HINGE, SLIDE = "rad", "m"


def diagnosis(statement: Statement, refutations: list[Refutation], leaves: int, *, whole: bool) -> Diagnosis:
    """In words: where the handle is out of reach, and for which base."""
    assert statement.span is not None
    value = refutations[0].value
    joint = statement.twin.mechanism(statement.twin.environment).joint(local_name(statement.container.joint))
    unit = SLIDE if joint.type is JointType.PRISMATIC else HINGE
    boxes = statement.target(value).boxes
    height = np.array([(box.translation.lo[2] + box.translation.hi[2]) / 2 for box in boxes])
    handle = local_name(statement.container.handle)
    where = (
        f"at a height of {height.mean():.3f} m, whatever base pose it takes"
        if statement.level
        else "with its base fixed at {:.2f} m, {:.2f} m, {:.2f} rad".format(*statement.start)
    )
    within = statement.within
    come = _come(statement, refutations)
    values = sorted({value for one in refutations for value in one.values})
    if any(one.places is not None for one in refutations) or not at_one_value(refutations):
        amid = "one hold" if within is None else f"the middle between its fingers within {within:g} m"
        come, value = f"keep {amid} of", values[-1]
    there = " and ".join(f"{each:.3g}" for each in values)
    reason = (
        f"no gripper of {local_name(statement.robot)} can {come} {handle} with {statement.container.name} at "
        f"{there} {unit}, {where}: all joint positions are refuted, "
        f"in {so_many(leaves, 'box', 'boxes')} of them"
    )
    if statement.bar is not None:
        reason += " for grasps whose fingers close across the bar, from the front; other holds were searched"
    if inside := _inside(statement, refutations):
        reason += f"; in some of them {inside} would be inside the furniture or the robot"
    if any(one.steps is not None for one in refutations):
        reason += "; each part of the lift at one of these values, and from one to the next where they meet"
    if held := _held(statement, refutations):
        reason += f", with {held} where the robot is parked, since no limit of acceleration is known"
    opens = statement.twin.state[statement.container.joint] <= statement.span[0]
    demanded = statement.span[1] if opens else statement.span[0]
    evidence = Evidence(Quantity.DEMANDED_POSITION, demanded, value, unit, entity=statement.container.joint)
    if statement.declared:
        reason += "; its bodies are taken as the collision shapes that certification has"
    return Diagnosis(Kind.EMBODIMENT, reason, evidence, proof=whole)


def _come(statement: Statement, refutations: list[Refutation]) -> str:
    """What no gripper can do to a handle, at one value."""
    if any(one.grasped for one in refutations):
        return "have a grasp across the bar of"
    if any(one.pinched or one.between for one in refutations):
        return "bring two fingers to"
    within = statement.within
    return "come to" if within is None else f"have the middle between its fingers within {within:g} m of"


def _held(statement: Statement, refutations: list[Refutation]) -> str:
    """Names of joints behind limbs beside the arm that no certified motion moves."""
    tree, own = Tree(statement.twin.mechanism(statement.robot)), statement.twin.robot(statement.robot)
    limbs = {body for one in refutations if one.parked for body in one.beside}
    joints = {joint for body in limbs for joint in tree.path(body) if joint.type is not JointType.FIXED}
    return ", ".join(sorted(joint.name for joint in joints if stands(joint, own)))


def too_slow(statement: Statement, found: Window, motion: Motion) -> Diagnosis:
    """In words: between which times the handle is faster than any gripper."""
    first, last = (float(motion.times[k]) for k in found.ends)
    robot, handle = local_name(statement.robot), statement.container.handle
    reason = (
        f"{local_name(handle)} has to move at {found.asked:.2f} m/s between {first:.2f} s and {last:.2f} s "
        f"of the motion; no gripper of {robot} holds it at more than {found.most:.2f} m/s, "
        "in whatever posture"
    )
    asked = Evidence(Quantity.VELOCITY, found.asked, found.most, "m/s", entity=handle, time=first)
    return Diagnosis(Kind.EMBODIMENT, reason, asked, proof=True)


def _inside(statement: Statement, refutations: list[Refutation]) -> str:
    """Names of the bodies whose cores refute something at a single value; of limbs, the ends."""
    bodies: set[str] = set()
    for one in refutations:
        if one.beside:
            bodies.update(f"{body} or what carries it" for body in one.beside)
            continue
        arm = next(
            arm for each in statement.grippers if each.name == one.gripper and (arm := statement.arm(each))
        )
        first = LEAF + len(one.joints) + 1
        codes = set(one.tree) if one.places is None and not one.grasped else set[int]()
        bodies.update(arm.cores[code - first].body for code in codes if code >= first)
    return ", ".join(sorted(bodies))
