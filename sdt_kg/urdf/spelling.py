"""Elements and attributes that URDF does not have, and that look like ones that it has.

Readers of URDF pass over what they do not know: a `<Collision>` would be nothing that can be met, and
`xzy="…"` no place.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

from sdt_kg.errors import UrdfError, meant

PARTS: Final[Mapping[str, tuple[str, ...]]] = {
    "robot": ("link", "joint", "material", "transmission", "gazebo"),
    "link": ("inertial", "visual", "collision"),
    "joint": (
        *("parent", "child", "origin", "axis", "limit", "mimic"),
        *("dynamics", "calibration", "safety_controller"),
    ),
    "inertial": ("origin", "mass", "inertia"),
    "collision": ("origin", "geometry"),
    "geometry": ("box", "cylinder", "sphere", "mesh"),
}
"""Element → elements in it, http://wiki.ros.org/urdf/XML."""

ATTRIBUTES: Final[Mapping[str, tuple[str, ...]]] = {
    "axis": ("xyz",),
    "box": ("size",),
    "child": ("link",),
    "cylinder": ("radius", "length"),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "limit": ("lower", "upper", "velocity", "effort"),
    "mass": ("value",),
    "mesh": ("filename", "scale"),
    "mimic": ("joint", "multiplier", "offset"),
    "origin": ("xyz", "rpy"),
    "parent": ("link",),
    "safety_controller": ("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"),
    "sphere": ("radius",),
}


def check_spelling(root: ET.Element, source: Path) -> None:
    """No element or attribute of a link or joint is misspelled; visuals are not looked at.

    Raises:
        UrdfError: One is; it says what may be meant.
    """
    for element in _looked_at(root):
        where = f"{source}: {element.tag}" + (f" '{element.get('name')}'" if element.get("name") else "")
        known = PARTS.get(element.tag, ())
        for part in element:
            if slip := _slip_of(part.tag, known):
                what = f"{where} has <{part.tag}>"
                raise UrdfError(what, allowed=", ".join(known), remedy=f"write <{slip}>")
        known = ATTRIBUTES.get(element.tag, ())
        for name, value in element.attrib.items():
            if slip := _slip_of(name, known):
                what = f'{where} has {name}="{value}"'
                raise UrdfError(what, allowed=", ".join(known), remedy=f"write {slip}")


def _looked_at(root: ET.Element) -> Iterator[ET.Element]:
    yield root
    for owner in (*root.findall("link"), *root.findall("joint")):
        yield owner
        for part in owner:
            if part.tag != "visual":
                yield from part.iter()


def _slip_of(name: str, known: tuple[str, ...]) -> str | None:
    """The known name that an unknown one is a slip of, if it is like one."""
    if name in known:
        return None
    swapped = (each for each in known if sorted(each) == sorted(name.lower()))
    return next(swapped, None) or meant(name.lower(), known)
