"""Which bundled robots joints seem to be of, by their names."""

from collections.abc import Collection
from functools import cache
from typing import Final
from xml.etree import ElementTree as ET

from sdt_kg.load import bundled, bundled_names

MOST: Final = 0.5
"""[1] Of joints, more than this share have to be a robot's to be taken for its own."""


def likely(joints: Collection[str]) -> tuple[tuple[str, ...], int]:
    """The bundled robots that have most of these joints, and how many; none, and 0, where none has most."""
    counts = {name: len(own & set(joints)) for name, own in _joints().items()}
    most = max(counts.values(), default=0)
    if most <= MOST * len(set(joints)):
        return (), 0
    return tuple(name for name, count in counts.items() if count == most), most


def told_likely(joints: Collection[str], but: Collection[str] = ()) -> str:
    """Which bundled robots have most of a motion's joints; empty where none has, or one of `but` has."""
    robots, count = likely(joints)
    if not robots or not {*but}.isdisjoint(robots):
        return ""
    total, verb = len(set(joints)), "has" if len(robots) == 1 else "have"
    share = "all" if count == total else f"{count}"
    told = "the motion's joint" if total == 1 else f"{share} of the motion's {total} joints"
    return f"{' and '.join(robots)} {verb} {told}"


@cache
def _joints() -> dict[str, frozenset[str]]:
    """Bundled robot → names of its joints."""
    return {name: _names(name) for name in bundled_names("robot")}


def _names(robot: str) -> frozenset[str]:
    root = ET.parse(bundled("robot", robot)).getroot()  # noqa: S314 - a file of ours
    return frozenset(each.get("name", "") for each in root.findall("joint"))
