"""Angles that may be in degrees: URDF and SDF have radians, and read so they are of another model."""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Final
from xml.etree import ElementTree as ET

from sdt_kg.mechanism import Joint, JointType
from sdt_kg.naming import few

WHOLE_TURN: Final = 6.3
"""[rad] rpy beyond it, which is 2π as it is rounded, is no way to write a rotation in radians."""

TURNS: Final = 4 * math.pi
"""[rad] A joint with limits turns about once either way; one that ends beyond this, in degrees perhaps."""

FAST: Final = 60.0
"""[rad/s] Ten turns a second: arms are slower, and their speeds in degrees are faster; ours."""

ENDLESS: Final = 3 * 360.0
"""[1] Limits and speeds beyond it, as 1e16, stand for none in either unit."""

SHOWN: Final = 3
"""[names] Of each kind."""


def maybe_degrees(root: ET.Element, joints: Iterable[Joint]) -> tuple[str, ...]:
    """That angles are read in radians, where some would be plausible in degrees alone; one note, or none."""
    hinges = [joint for joint in joints if joint.type is JointType.REVOLUTE]
    found = (
        ("rpy of", list(dict.fromkeys(_turned(root)))),
        ("limits of", [_limits(joint) for joint in hinges if TURNS < _farthest(joint) <= ENDLESS]),
        ("velocity of", [_speed(joint) for joint in hinges if FAST < joint.limits.velocity <= ENDLESS]),
    )
    return in_words(found)


def in_words(found: Iterable[tuple[str, Sequence[str]]]) -> tuple[str, ...]:
    """The note about these: what of them is meant, and their names; none where there are no names."""
    told = [f"{what} {few(names, SHOWN)}" for what, names in found if names]
    if not told:
        return ()
    return (f"angles are read in radians, and these may be in degrees: {'; '.join(told)}",)


def _turned(root: ET.Element) -> Iterator[str]:
    """Joints and collision shapes that are placed by angles beyond a turn."""
    placed = [(each, each.find("origin")) for each in root.findall("joint")]
    placed += [(link, origin) for link in root.findall("link") for origin in link.findall("collision/origin")]
    for element, origin in placed:
        rpy = "" if origin is None else origin.get("rpy", "")
        if any(abs(float(part)) > WHOLE_TURN for part in rpy.split()):
            yield f"{element.tag} '{element.get('name')}' ({' '.join(rpy.split())})"


def _farthest(joint: Joint) -> float:
    return max(abs(joint.limits.lower), abs(joint.limits.upper))


def _limits(joint: Joint) -> str:
    return f"joint '{joint.name}' ({joint.limits.lower:g} to {joint.limits.upper:g})"


def _speed(joint: Joint) -> str:
    return f"joint '{joint.name}' ({joint.limits.velocity:g} a second)"
