"""Bodies with handles whose joints an import made fixed: no containers, though meant as such, maybe."""

from collections.abc import Iterator
from typing import Final

from sdt_kg.entities.container import LeftOut
from sdt_kg.iri import body_iri, joint_iri
from sdt_kg.mechanism import JointType, Mechanism

MADE_FIXED: Final = "imported as fixed"
"""What the note on such a joint says."""


def stuck(kitchen: Mechanism) -> Iterator[LeftOut]:
    """Bodies to which a handle is fixed, by its name as in rule r04, and what is noted of their joints."""
    fixed = [joint for joint in kitchen.joints if joint.type is JointType.FIXED]
    held = {joint.parent for joint in fixed if "handle" in joint.child.lower()}
    for joint in fixed:
        if joint.child in held and any(MADE_FIXED in note for note in joint.notes):
            why = "; ".join(joint.notes)
            reason = f"its joint does not move ({why}): give it limits between which it does"
            yield LeftOut(joint_iri(kitchen.name, joint.name), body_iri(kitchen.name, joint.child), reason)
