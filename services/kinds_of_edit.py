"""How edits of a twin are written, and what is said of a text that is none."""

from collections.abc import Mapping
from typing import Final

from sdt_kg.errors import InputError, meant

EDITS: Final = {
    "move": "move:JOINT=VALUE (a joint or container at a position [rad or m], open or closed)",
    "set": "set:JOINT.PROPERTY=NUMBER (upperLimit, velocityLimit …; of a robot ROBOT/JOINT)",
    "pose": "pose:JOINT=X,Y,Z[,ROLL,PITCH,YAW] (where it sits on its parent) [m, rad]",
    "furniture": "furniture:NAME=DX,DY[,DZ[,YAW]] (a body with all on it, or what a container is part of) "
    "[m, rad]",
    "box": "box:NAME=SX,SY,SZ@X,Y,Z[,YAW] (an obstacle: its sides, and where its middle is) [m, rad]",
    "mesh": "mesh:NAME=FILE[*SCALE]@X,Y,Z[,YAW] (an obstacle of triangles: .stl, .obj, .dae) [m, rad]",
    "without": "without:NAME (of an obstacle or robot)",
    "clear": "clear:BODY (of the kitchen, with all on it: nothing can run into it any more)",
    "robot": "robot:NAME (bundled, or a path)",
    "follow": "follow:MOTION.npz (joint values, or a body motion)",
}
"""Kind → how it is written, and what it means."""

OTHER_WORDS: Final = {
    "remove": ("without", "clear"),
    "delete": ("without", "clear"),
    "add": ("box", "mesh"),
    "close": ("move",),
    "open": ("move",),
}
"""What people call a kind, → kinds."""


def no_edit(text: str, kinds: Mapping[str, str], more: str = "sdt whatif --edit help") -> InputError:
    """That a text is none of these kinds.

    Args:
        text: As it was typed.
        kinds: Kind → how it is written, and what it means.
        more: What tells all of that.

    Returns:
        With how its kind is written; of an unknown kind with the form of each, and those that may be meant.
    """
    kind = text.partition(":")[0].strip().lower()
    what = f"'{text}' is no edit"
    if kind in kinds:
        return InputError(what, allowed=kinds[kind])
    others = OTHER_WORDS.get(kind, (meant(kind, kinds) or "",))
    near = " or ".join(kinds[each] for each in others if each in kinds)
    forms = ", ".join(said.partition(" ")[0] for said in kinds.values())
    asked = f"did you mean {near}? " if near else ""
    return InputError(what, allowed=forms, remedy=f"{asked}{more} says what each does")
