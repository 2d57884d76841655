"""URDF text → XML tree that is safe and whole, or a UrdfError that says what is wrong."""

import math
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Final, NoReturn
from xml.etree import ElementTree as ET
from xml.parsers import expat

from sdt_kg.errors import UrdfError, meant
from sdt_kg.numbers import number_in, so_many
from sdt_kg.urdf.spelling import NUMBERS, SHAPES, check_expanded, check_once, check_spelling, solid_parts

MAX_BYTES: Final = 50_000_000
"""[byte] Larger files are refused; the largest robot that we know of is below 1 MB."""

MAX_DEPTH: Final = 100
"""[1] Elements inside each other; a URDF needs six, what other tools add to one a few more."""

MOVABLE_TYPES: Final = ("prismatic", "revolute", "continuous")
JOINT_TYPES: Final = ("fixed", *MOVABLE_TYPES)
LARGEST: Final = 1e6
"""[m or rad] Of a pose, a size, an axis or a mimic: no model has a larger one, and no product overflows."""

BOUNDED: Final = ("origin", "box", "cylinder", "sphere", "axis", "mesh", "mimic")
POSITIVE: Final = {("box", "size"), ("cylinder", "radius"), ("cylinder", "length"), ("sphere", "radius")}


def parse_xml(text: bytes, source: Path) -> ET.Element:
    """Root element `robot` of a document without DTD, whose links and joints form one tree.

    Raises:
        UrdfError: Anything else.
    """
    if len(text) > MAX_BYTES:
        raise UrdfError(f"{source}: {len(text)} bytes", allowed=f"up to {MAX_BYTES} bytes")
    refuse_unsafe(text, source)
    root = ET.fromstring(text)  # noqa: S314 - no DTD, hence no entity, is left in the text
    if root.tag != "robot":
        raise UrdfError(f"{source}: the root element is <{root.tag}>", allowed="<robot>")
    check_expanded(root, source)
    check_spelling(root, source)
    check_once(root, source)
    _check_names(root, source)
    for joint in root.findall("joint"):
        _check_joint(joint, source)
    _check_tree(root, source)
    for owner in (*root.findall("link"), *root.findall("joint")):
        _check_numbers(owner, source)
    return root


def refuse_unsafe(text: bytes, source: Path) -> None:
    """The text is XML without DTD and without endless nesting, or an UrdfError."""
    depth = 0

    def refuse(*_: object) -> NoReturn:
        raise UrdfError(
            f"{source}: has a DTD or defines entities",
            allowed="XML without <!DOCTYPE>",
            remedy="remove the <!DOCTYPE …> part",
        )

    def deeper(*_: object) -> None:
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            raise UrdfError(f"{source}: is nested too deep", allowed=f"{MAX_DEPTH} elements in each other")

    def back(*_: object) -> None:
        nonlocal depth
        depth -= 1

    parser = expat.ParserCreate(namespace_separator=" ")  # so that a prefix without xmlns is told
    parser.StartDoctypeDeclHandler = refuse
    parser.EntityDeclHandler = refuse
    parser.StartElementHandler, parser.EndElementHandler = deeper, back
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise UrdfError(f"{source}: is not XML: {error}", allowed="a URDF or xacro file") from None


def _check_names(root: ET.Element, source: Path) -> None:
    for tag in ("link", "joint"):
        names = [element.get("name", "") for element in root.findall(tag)]
        if "" in names:
            raise UrdfError(f"{source}: a {tag} has no name", remedy=f"give each {tag} a name of its own")
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise UrdfError(
                f"{source}: {tag} named twice: {_list(twice)}", remedy=f"give each {tag} a name of its own"
            )
    if root.find("link") is None:
        raise UrdfError(f"{source}: has no link", allowed="at least one link")


def _check_joint(joint: ET.Element, source: Path) -> None:
    name = f"{source}: joint '{joint.get('name')}'"
    kind = joint.get("type")
    if kind not in JOINT_TYPES:
        raise UrdfError(
            f"{name} has type '{kind}'",
            allowed=", ".join(JOINT_TYPES),
            remedy="replace it by joints of these types, or make it fixed",
        )
    for tag in ("parent", "child"):
        end = joint.find(tag)
        if end is None or not end.get("link"):
            raise UrdfError(f"{name} has no {tag} link", remedy=f'add <{tag} link="…"/>')
    if kind in ("prismatic", "revolute") and joint.find("limit") is None:
        raise UrdfError(
            f"{name} ({kind}) has no limits",
            allowed='<limit lower="…" upper="…" velocity="…" effort="…"/>',
            remedy="add them, or make a hinge without end 'continuous'",
        )


def _check_tree(root: ET.Element, source: Path) -> None:
    links = {link.get("name", "") for link in root.findall("link")}
    ends = [(_link(joint, "parent"), _link(joint, "child")) for joint in root.findall("joint")]
    unknown = sorted({end for pair in ends for end in pair} - links)
    if unknown:
        near = meant(unknown[0], sorted(links))
        raise UrdfError(
            f"{source}: joints name links which do not exist: {_list(unknown)}",
            allowed=f"did you mean '{near}'?" if near else _list(links),
            remedy='add <link name="…"/>, or repair the name',
        )
    twice = [child for child, count in Counter(child for _, child in ends).items() if count > 1]
    if twice:
        raise UrdfError(
            f"{source}: links with more than one parent (a loop): {_list(twice)}", allowed="a tree of links"
        )
    roots = sorted(links - {child for _, child in ends})
    if len(roots) > 1:
        raise UrdfError(f"{source}: {len(roots)} links without parent: {_list(roots)}", allowed="one root")
    if not roots:
        raise UrdfError(f"{source}: every link has a parent (a loop)", allowed="a tree of links")
    cut_off = sorted(links - reachable(roots[0], ends))
    if cut_off:
        raise UrdfError(
            f"{source}: a loop that is not joined to the root: {_list(cut_off)}", allowed="a tree of links"
        )


def reachable(root: str, ends: Iterable[tuple[str, str]]) -> set[str]:
    """Links which can be reached from the root along (parent, child) pairs."""
    children: dict[str, list[str]] = {}
    for parent, child in ends:
        children.setdefault(parent, []).append(child)
    seen, waiting = {root}, [root]
    while waiting:
        fresh = [child for child in children.get(waiting.pop(), []) if child not in seen]
        seen.update(fresh)
        waiting += fresh
    return seen


def _link(joint: ET.Element, tag: str) -> str:
    end = joint.find(tag)
    return "" if end is None else end.get("link", "")


def _check_numbers(owner: ET.Element, source: Path) -> None:
    where = f"{source}: {owner.tag} '{owner.get('name')}'"
    for element in solid_parts(owner):
        if element.tag == "origin" and element.get("quat_xyzw") is not None:
            raise UrdfError(
                f"{where}: origin has quat_xyzw",
                allowed='rpy="…"',
                remedy="write the same orientation as roll, pitch, yaw [rad]",
            )
        for attribute, count in NUMBERS.get(element.tag, {}).items():
            text = element.get(attribute)
            if text is not None:
                _check_number(
                    f"{where}: {element.tag} {attribute}='{text}'", element.tag, attribute, text, count
                )
    _check_geometry(owner, where)


def _check_number(where: str, tag: str, attribute: str, text: str, count: int) -> None:
    try:
        values = [number_in(word) for word in text.split()]
    except ValueError:
        raise UrdfError(
            f"{where} is not {so_many(count, 'number', 'numbers')}",
            allowed=f"{count}, parted by spaces, with a point before decimals",
        ) from None
    if len(values) != count:
        raise UrdfError(f"{where} holds {so_many(len(values), 'number', 'numbers')}", allowed=f"{count}")
    if not all(map(math.isfinite, values)):
        raise UrdfError(
            f"{where} is not finite", allowed="finite numbers", remedy="write the value, or leave it out"
        )
    if tag in BOUNDED and max(map(abs, values)) > LARGEST:
        raise UrdfError(where, allowed=f"up to {LARGEST:g}")
    if (tag, attribute) in POSITIVE and min(values) <= 0:
        raise UrdfError(where, allowed="above 0 m")
    if (tag, attribute) == ("mesh", "scale") and 0 in values:
        raise UrdfError(where, allowed="other than 0, which makes it flat")


def _check_geometry(link: ET.Element, where: str) -> None:
    for collision in link.findall("collision"):
        geometry = collision.find("geometry")
        shapes = [] if geometry is None else list(geometry)
        if len(shapes) != 1 or shapes[0].tag not in SHAPES:
            found = ", ".join(f"<{shape.tag}>" for shape in shapes) or "none"
            raise UrdfError(f"{where}: collision geometry is {found}", allowed="one of " + ", ".join(SHAPES))
        needed = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}
        for attribute in needed.get(shapes[0].tag, ("filename",)):
            if not shapes[0].get(attribute):
                raise UrdfError(f"{where}: collision {shapes[0].tag} has no {attribute}")


def _list(names: Iterable[str]) -> str:
    ordered = sorted(names)
    return ", ".join(f"'{name}'" for name in ordered[:8]) + (" …" if len(ordered) > 8 else "")
