"""Mesh references of a URDF → files inside the model's own folder."""

import hashlib
import math
import re
from functools import lru_cache
from pathlib import Path
from typing import Final

from sdt_kg.errors import UrdfError

PACKAGE: Final = "package://"
FILE: Final = "file://"
COLLADA: Final = ".dae"
UNIT: Final = re.compile(rb"""<unit\b[^>]*?\bmeter\s*=\s*["']([^"']*)["']""")
"""A COLLADA file's unit, which its first `asset` gives; without one it is the metre."""


def mesh_path(reference: str, urdf: Path, where: str) -> Path:
    """File of a mesh reference.

    `package://NAME/…` is the folder NAME beside the URDF (which may be a link), or the folder
    NAME that the URDF lies in; a relative path starts at the URDF's folder. The file may not lie
    outside that folder, whether by `..` or by a link.

    Raises:
        UrdfError: Outside its root, or not there.
    """
    root, relative = _split(reference, urdf)
    path = (root / relative).resolve()
    if not path.is_relative_to(root.resolve()):
        raise UrdfError(
            f"{where}: mesh '{reference}' lies outside of '{root}'",
            allowed="files below that folder",
            remedy="put the mesh there and name it package://NAME/… or by a relative path",
        )
    if not path.is_file():
        raise UrdfError(
            f"{where}: no mesh file '{path}' (written '{reference}')",
            remedy="put the file there, or replace the mesh by a box, cylinder or sphere",
        )
    return path


def _split(reference: str, urdf: Path) -> tuple[Path, str]:
    folder = urdf.parent
    if reference.startswith(PACKAGE):
        name, _, relative = reference.removeprefix(PACKAGE).partition("/")
        if not (folder / name).is_dir():
            inside = next((parent for parent in urdf.resolve().parents if parent.name == name), None)
            if inside is not None:
                return inside, relative
        return folder / name, relative
    return folder, reference.removeprefix(FILE)


def mesh_hash(path: Path) -> str:
    """SHA-256 of the file's bytes; read once for each version of the file."""
    stat = path.stat()
    return _hash(path, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=1024)
def _hash(path: Path, _modified: int, _size: int) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def metres(path: Path) -> float:
    """How long a mesh file's unit is [m]: COLLADA files say so, others are in metres.

    Raises:
        UrdfError: It is no length.
    """
    if path.suffix.lower() != COLLADA:
        return 1.0
    said = UNIT.search(path.read_bytes())
    try:
        unit = 1.0 if said is None else float(said[1])
    except ValueError:
        unit = math.nan
    if not 0 < unit < math.inf:
        raise UrdfError(f"mesh {path} has a unit that is no length", allowed='<unit meter="1"/>')
    return unit
