"""What readers of URDF pass over: misspelled elements and attributes, parts given twice, other files.

A `<Collision>` would be nothing that can be met, nor a second `<geometry>`, nor what `<xacro:cabinet/>`
stands for; `xzy="…"` would be no place.
"""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

from sdt_kg.errors import UrdfError, meant

SHAPES: Final = ("box", "cylinder", "sphere", "mesh")

# Tag → numeric attributes and how many numbers each holds.
NUMBERS: Final[dict[str, dict[str, int]]] = {
    "axis": {"xyz": 3},
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), 1),
    "limit": dict.fromkeys(("lower", "upper", "velocity", "effort"), 1),
    "mass": {"value": 1},
    "mesh": {"scale": 3},
    "mimic": {"multiplier": 1, "offset": 1},
    "origin": {"xyz": 3, "rpy": 3},
    "safety_controller": dict.fromkeys(
        ("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"), 1
    ),
    "sphere": {"radius": 1},
}

PARTS: Final[Mapping[str, tuple[str, ...]]] = {
    "robot": ("link", "joint", "material", "transmission", "gazebo"),
    "link": ("inertial", "visual", "collision"),
    "joint": (
        *("parent", "child", "origin", "axis", "limit", "mimic"),
        *("dynamics", "calibration", "safety_controller"),
    ),
    "inertial": ("origin", "mass", "inertia"),
    "collision": ("origin", "geometry"),
    "geometry": SHAPES,
}
"""Element → elements in it, http://wiki.ros.org/urdf/XML."""

TEXTS: Final[Mapping[str, tuple[str, ...]]] = {
    "child": ("link",),
    "mesh": ("filename",),
    "mimic": ("joint",),
    "parent": ("link",),
}
UNREAD: Final = ("dynamics", "calibration", "limit")
"""Parts of a joint that no verdict looks at, or that are told (`limits_given_twice`)."""

ATTRIBUTES: Final = {tag: (*TEXTS.get(tag, ()), *NUMBERS.get(tag, ())) for tag in (*TEXTS, *NUMBERS)}


def check_spelling(root: ET.Element, source: Path) -> None:
    """No element or attribute of a link or joint is misspelled; visuals are not looked at.

    Raises:
        UrdfError: One is; it says what may be meant.
    """
    check_slips(_looked_at(root), PARTS, ATTRIBUTES, source)


def check_slips(
    elements: Iterable[ET.Element],
    parts: Mapping[str, tuple[str, ...]],
    attributes: Mapping[str, tuple[str, ...]],
    source: Path,
) -> None:
    """No element has a part, or an attribute, that is a slip of one which it may have.

    Args:
        elements: That are looked at, each by itself.
        parts: Element → elements that it may have.
        attributes: Element → attributes that it may have.
        source: Where they are written.

    Raises:
        UrdfError: One has; it says what may be meant.
    """
    for element in elements:
        known = parts.get(element.tag, ())
        for part in element:
            if slip := _slip_of(part.tag, known):
                what = f"{place_of(element, source)} has <{part.tag}>"
                raise UrdfError(what, allowed=", ".join(known), remedy=f"write <{slip}>")
        known = attributes.get(element.tag, ())
        for name, value in element.attrib.items():
            if slip := _slip_of(name, known):
                what = f'{place_of(element, source)} has {name}="{value}"'
                raise UrdfError(what, allowed=", ".join(known), remedy=f"write {slip}")


def place_of(element: ET.Element, source: Path) -> str:
    """Where it is written, and which it is."""
    return f"{source}: {element.tag}" + (f" '{element.get('name')}'" if element.get("name") else "")


def check_expanded(root: ET.Element, source: Path) -> None:
    """Nothing stands for what is written elsewhere: no xacro, no other file.

    Raises:
        UrdfError: Something does.
    """
    check_no_xacro(root, source)
    for element in root.iter():
        space, _, tag = element.tag.rpartition("}")
        if tag == "include" and (space or element in root):
            raise UrdfError(
                f"{source}: has <include>, which URDF does not read",
                allowed="one file with all links and joints, or <xacro:include> in a file .xacro",
                remedy="put in what it includes",
            )


def check_no_xacro(root: ET.Element, source: Path) -> None:
    """Nothing is left to be expanded.

    Raises:
        UrdfError: Something is.
    """
    for element in root.iter():
        space, _, tag = element.tag.rpartition("}")
        if space.endswith("xacro"):
            suffix = source.suffix or ".urdf"
            raise UrdfError(
                f"{source}: has <xacro:{tag}>, which only xacro reads",
                allowed="a file without xacro, or URDF with it in a file .xacro",
                remedy=f"name the file .xacro, or expand it: xacro FILE.xacro > FILE{suffix}",
            )


def check_once(root: ET.Element, source: Path) -> None:
    """No part of a link or joint is given twice where one is read.

    Raises:
        UrdfError: One is.
    """
    for element in _looked_at(root):
        once = ("inertial",) if element.tag == "link" else PARTS.get(element.tag, ())
        for tag in once if element.tag in ("link", "joint", "inertial", "collision") else ():
            if tag not in UNREAD and len(element.findall(tag)) > 1:
                raise UrdfError(
                    f"{place_of(element, source)} has <{tag}> more than once",
                    allowed="one",
                    remedy="leave all but one out; a link may have several <collision>",
                )


def limits_given_twice(root: ET.Element) -> list[str]:
    """A note on each joint with several `<limit>`: the first holds, as everywhere in ROS."""
    return [
        f"joint '{joint.get('name')}' has <limit> more than once: the first is taken"
        for joint in root.findall("joint")
        if len(joint.findall("limit")) > 1
    ]


def _looked_at(root: ET.Element) -> Iterator[ET.Element]:
    yield root
    for owner in (*root.findall("link"), *root.findall("joint")):
        yield owner
        yield from solid_parts(owner)


def solid_parts(owner: ET.Element) -> Iterator[ET.Element]:
    """All elements in a link or joint but what is only seen."""
    return (element for part in owner if part.tag != "visual" for element in part.iter())


def _slip_of(name: str, known: tuple[str, ...]) -> str | None:
    """The known name that an unknown one is a slip of, if it is like one."""
    if name in known:
        return None
    swapped = (each for each in known if sorted(each) == sorted(name.lower()))
    return next(swapped, None) or meant(name.lower(), known)
