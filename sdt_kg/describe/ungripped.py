"""Why no gripper was found: fingers without shape, fingers that do not close on each other, or none."""

from collections.abc import Iterator

from sdt_kg.describe.grippers import ARM, FINGER_WORDS, is_named
from sdt_kg.describe.tree import Tree, listed
from sdt_kg.mechanism import JointType


def why_none(tree: Tree) -> str:
    """What to repair first, of a robot in which no gripper was found."""
    fingers = list(_fingers(tree))
    bare = [body for body in fingers if not len(tree.points(tuple(tree.below(body)), body, {}))]
    if bare:
        why = f"{listed(bare)} would be fingers, but have no collision geometry to hold anything with. "
        remedy = "Give them one"
    elif len(fingers) > 1:
        why = f"{listed(fingers)} would be fingers, but do not close on each other as their joints move. "
        remedy = "Repair axes, limits or mimic of these"
    else:
        why = (
            f"none of two bodies that close on each other, with {listed(FINGER_WORDS)} in their names or at "
            f"the end of {ARM} joints or more; the longest row of joints ends in '{_end(tree)}'. A suction "
            "cup or a hook is none: a handle is held by two fingers. "
        )
        remedy = "Name its fingers so"
    return (
        f"check: no gripper was found: {why}{remedy} and describe the robot again, or add sdt:hasGripper "
        "as robots/README.md says"
    )


def _fingers(tree: Tree) -> Iterator[str]:
    """Bodies that a joint moves and that are named as fingers, without those that hang on one."""
    moving = (JointType.PRISMATIC, JointType.REVOLUTE)
    named = [
        joint for joint in tree.mechanism.joints if joint.type in moving and is_named(joint.name, joint.child)
    ]
    inside: set[str] = set()
    for joint in named:
        below = tree.below(joint.child)
        bears = [tree.rigid_root(other.parent) for other in named if other.parent in below]
        if joint.child not in inside and len(set(bears)) == len(bears):  # else it is their palm, or wrist
            inside.update(below)
            yield joint.child


def _end(tree: Tree) -> str:
    """The body that most joints move."""
    return max((body.name for body in tree.mechanism.bodies), key=tree.movable_above)
