"""Which reader a scene file needs."""

import re
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Mechanism
from sdt_kg.scenes.mjcf import read_mjcf
from sdt_kg.scenes.sdf import read_sdf
from sdt_kg.urdf.document import MAX_BYTES, refuse_unsafe

SCENE_SUFFIXES: Final = (".xml", ".mjcf", ".sdf", ".world")
_READERS: Final = {"mujoco": read_mjcf, "sdf": read_sdf}
_OTHERS: Final = {
    "robot": "give a URDF the suffix .urdf",
    "mujocoinclude": "it is a part of a scene: give the file that includes it",
}
"""Root element → what to do with such a file."""


def scene_stem(path: Path) -> str:
    """Name of a model after its file."""
    return re.sub(r"\.(xml|mjcf|sdf|world)$", "", path.name)


def read_scene(path: Path) -> Mechanism:
    """The scene of an MJCF (`<mujoco>`) or SDF (`<sdf>`) file, its root the world.

    Axes with limits like [-π/2, 0] are turned, as in a kitchen's URDF.

    Raises:
        UrdfError: Neither, or not a tree that D_artic knows.
    """
    if not path.is_file():
        raise UrdfError(f"no file at {path}", allowed="a scene file")
    text = path.read_bytes()
    if len(text) > MAX_BYTES:
        raise UrdfError(f"{path}: {len(text)} bytes", allowed=f"up to {MAX_BYTES} bytes")
    refuse_unsafe(text, path)
    root = ET.fromstring(text)  # noqa: S314 - no DTD, hence no entity, is left in the text
    if root.tag not in _READERS:
        raise UrdfError(
            f"{path}: the root element is <{root.tag}>",
            allowed="<mujoco>, <sdf>",
            remedy=_OTHERS.get(root.tag, ""),
        )
    return _READERS[root.tag](root, path, scene_stem(path))
