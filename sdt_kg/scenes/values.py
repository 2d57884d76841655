"""Names, numbers and poses as SDF writes them."""

import math
from collections.abc import Iterable
from typing import Final
from xml.etree import ElementTree as ET

import numpy as np

from sdt_kg.errors import UrdfError
from sdt_kg.numbers import number_in, so_many
from sdt_kg.scenes.build import Matrix, matrix_of, turn
from sdt_kg.urdf.degrees import WHOLE_TURN

QUATERNION: Final = "quat_xyzw"
PLACED: Final = ("model", "link", "joint", "collision", "frame")
"""Elements whose poses a verdict rests on."""


def numbers_of(element: ET.Element, count: int, where: str) -> list[float]:
    """The finite numbers that the element holds.

    Raises:
        UrdfError: Not so many, or one that is none.
    """
    text = element.text or ""
    try:
        numbers = [number_in(word) for word in text.split()]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        allowed = so_many(count, "finite number", "finite numbers")
        raise UrdfError(f"{where}: <{element.tag}> '{text.strip()}'", allowed=allowed)
    return numbers


def number_of(element: ET.Element | None, tag: str, default: float, where: str) -> float:
    """The number in a part of the element, infinite ones too; the default where there is none."""
    found = None if element is None else element.find(tag)
    if found is None:
        return default
    text = (found.text or "").strip().lower()
    if text in ("inf", "+inf", "-inf"):
        return float(text)
    return numbers_of(found, 1, where)[0]


def by_name(elements: Iterable[ET.Element], where: str) -> dict[str, ET.Element]:
    """The elements by their names, to which poses and axes are relative.

    Raises:
        UrdfError: A name twice.
    """
    named: dict[str, ET.Element] = {}
    for each in elements:
        name = each.get("name", "")
        if name in named:
            raise UrdfError(
                f"{where}: <{named[name].tag}> and <{each.tag}> are both named '{name}'",
                allowed="links, joints and frames of a model, each with a name of its own",
                remedy="rename one of them",
            )
        named[name] = each
    return named


def label(element: ET.Element) -> str:
    """What to call it: its name, or the file that it is."""
    return (
        element.get("name")
        or element.findtext("uri", "").strip()
        or element.get("filename")
        or "without name"
    )


def is_true(text: str, where: str) -> bool:
    """Whether a word is SDF's yes, in whatever case; nothing is no.

    Raises:
        UrdfError: It is neither.
    """
    word = text.strip().lower()
    if word not in ("", "true", "1", "false", "0"):
        raise UrdfError(f"{where}: '{text.strip()}' is no truth value", allowed="true, false, 1, 0")
    return word in ("true", "1")


def turned_far(root: ET.Element) -> list[str]:
    """What has a pose beyond a turn, in radians that are not said to be some; no visuals and no sensors."""
    found: list[str] = []
    for element in (each for each in root.iter() if each.tag in PLACED):
        pose = element.find("pose")
        if pose is not None and "degrees" not in pose.attrib and pose.get("rotation_format") != QUATERNION:
            angles = (pose.text or "").split()[3:]
            if any(map(_beyond_a_turn, angles)):
                found.append(f"{element.tag} '{label(element)}' ({' '.join(angles)})")
    return found


def _beyond_a_turn(text: str) -> bool:
    try:
        return abs(number_in(text)) > WHOLE_TURN
    except ValueError:  # of a pose that nothing needs
        return False


def own_pose(element: ET.Element, where: str) -> Matrix:
    """Transform of the element's <pose>, whatever it is relative to; shape (4, 4)."""
    pose = element.find("pose")
    if pose is None or not (pose.text or "").strip():
        return np.eye(4)
    spelled = pose.get("rotation_format", "euler_rpy")
    if spelled not in ("euler_rpy", QUATERNION):
        raise UrdfError(f"{where}: pose with rotation_format='{spelled}'", allowed="euler_rpy, quat_xyzw")
    if spelled == QUATERNION:
        numbers = numbers_of(pose, 7, where)
        if not any(numbers[3:]):
            raise UrdfError(f"{where}: quaternion 0 0 0 0", allowed="any other")
        return matrix_of(numbers[:3], numbers[3:])
    x, y, z, roll, pitch, yaw = numbers_of(pose, 6, where)
    scale = math.pi / 180 if is_true(pose.get("degrees", ""), where) else 1.0
    turns = turn((0, 0, 1), yaw * scale) @ turn((0, 1, 0), pitch * scale) @ turn((1, 0, 0), roll * scale)
    return matrix_of((x, y, z)) @ turns
