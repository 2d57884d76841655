"""Robots as they were read: their graphs, kept on disk, as reading and checking a URDF takes 0.1 s."""

import hashlib
import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pyoxigraph as ox

import ontology
import robots
import sdt_kg
from sdt_kg import load
from sdt_kg.entities import Entities
from sdt_kg.errors import UrdfError
from sdt_kg.urdf.meshes import mesh_hash, mesh_path
from services.keeping.files import place, read, write
from services.keeping.text import recalled, told
from services.versions import version_of

ROBOTS = "robots"
"""Kind of what is kept."""

KEPT_OF = ".urdf"
"""Files of robots of which something is kept; a xacro reads others."""

END = b"\n"
"""Between the meshes and what is told of the robot."""

Mesh = tuple[str, str, str]
"""How a URDF names it, where it lies, and the hash of its content."""


def read_robot(robot: str | Path) -> Entities:
    """What `load.read_robot` gives: as it was kept of the same files, or read and kept for the next time.

    Raises:
        UnknownEntityError, UrdfError, AnnotationError: As there.
    """
    urdf = load.model_path("robot", robot)
    if urdf.suffix != KEPT_OF:
        return load.read_robot(robot)
    key = _follows_from(urdf)
    path = place(ROBOTS, key)
    found = _recalled(read(path), urdf)
    if found is None:
        found = load.read_robot(robot)
        if not found.containers and _follows_from(urdf) == key:  # nobody wrote the files meanwhile
            write(path, json.dumps(_meshes(urdf)).encode() + END + told(found))
    return found


def _follows_from(urdf: Path) -> tuple[object, ...]:
    """All that decides what is read of a robot, but for its meshes."""
    beside = urdf.with_suffix(".ttl")
    files = (_hash(each.read_bytes()) if each.is_file() else "" for each in (urdf, beside))
    return (_code(), str(urdf.absolute()), *files)


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


@cache
def _code() -> str:
    """Hash of the code that reads robots, of what it reads besides, and versions of what parses."""
    sources = sorted(Path(str(sdt_kg.__file__)).parent.rglob("*.py"))
    read_too = (ontology.path("sdt.ttl"), ontology.path("tee.ttl"), *ontology.path("rules").glob("*.rq"))
    own = (*sources, Path(__file__), *sorted(read_too), *sorted(robots.path("").glob("*/*.ttl")))
    versions = ox.__version__, np.__version__, version_of("yourdfpy")
    return _hash(b"".join(each.read_bytes() for each in own)) + repr(versions)


def _meshes(urdf: Path) -> list[Mesh]:
    """Meshes of collision shapes, each once."""
    shapes = ET.fromstring(urdf.read_bytes()).iterfind("link/collision/geometry/mesh")  # noqa: S314 - read before
    names = sorted({each.get("filename", "") for each in shapes})
    return [(name, str(path), mesh_hash(path)) for name in names for path in [mesh_path(name, urdf, "")]]


def _recalled(content: bytes | None, urdf: Path) -> Entities | None:
    """The robot that was kept, if its meshes are the same files still."""
    if content is None:
        return None
    meshes, _, said = content.partition(END)
    return recalled(said) if _are_there(json.loads(meshes), urdf) else None


def _are_there(meshes: Iterable[Mesh], urdf: Path) -> bool:
    """Whether the URDF's names lead to the same files with the same content."""
    try:
        return all(
            str(path := mesh_path(name, urdf, "")) == where and mesh_hash(path) == hashed
            for name, where, hashed in meshes
        )
    except (UrdfError, OSError):
        return False
