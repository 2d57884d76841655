"""Mesh references of a URDF → files inside the model's own folder."""

import hashlib
import math
import re
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import UrdfError
from sdt_kg.urdf.folder import PACKAGES, WIDER, folder_of, models_folder

PACKAGE: Final = "package://"
FILE: Final = "file://"
COLLADA: Final = ".dae"
WHOLE: Final = (".dae", ".obj", ".off", ".ply", ".stl")
"""Suffixes of files that hold all of a mesh's shape. What others name besides is in no hash, and coal
leaves out how the first node of a glTF stands."""
UNIT: Final = re.compile(rb"""<unit\b[^>]*?\bmeter\s*=\s*["']([^"']*)["']""")
"""A COLLADA file's unit, which its first `asset` gives; without one it is the metre."""

COMMENT: Final = re.compile(rb"<!--.*?-->", re.DOTALL)


def mesh_path(reference: str, urdf: Path, where: str) -> Path:
    """File of a mesh reference.

    `package://NAME/…` is the folder NAME beside the URDF (which may be a link), the folder NAME that the
    URDF lies in, or the one in the folder that `SDT_MODELS` names, and the file lies in it. A relative
    path starts at the URDF's folder, and the file lies where `folder_of` says, whether by `..` or a link.

    Raises:
        UrdfError: Outside its root, or not there.
    """
    start, relative, root = _split(reference, urdf)
    path = (start / relative).resolve()
    if not path.is_relative_to(root.resolve()):
        raise UrdfError(
            f"{where}: mesh '{reference}' lies outside of '{root}'",
            allowed="files below that folder",
            remedy=f"put the mesh there and name it package://NAME/… or by a relative path, or {WIDER}",
        )
    if not path.is_file():
        raise UrdfError(
            f"{where}: no mesh file '{path}' (written '{reference}')",
            remedy="put the file there, or replace the mesh by a box, cylinder or sphere"
            + (f"; {PACKAGES}" if reference.startswith(PACKAGE) else ""),
        )
    return path


def collision_file(reference: str, urdf: Path, where: str) -> Path:
    """File of the mesh of a collision shape, which holds all of it.

    Raises:
        UrdfError: As `mesh_path`; or its format may keep the shape in other files.
    """
    path = mesh_path(reference, urdf, where)
    check_whole(path, where)
    return path


def check_whole(path: Path, where: str) -> None:
    """The file of a collision shape is of a format that holds all of it.

    Raises:
        UrdfError: It is of another.
    """
    if path.suffix.lower() not in WHOLE:
        raise UrdfError(
            f"{where}: the shape of mesh '{path.name}' may lie in other files too, which no hash tells",
            allowed=", ".join(WHOLE),
            remedy="convert it to one of these",
        )


def _split(reference: str, urdf: Path) -> tuple[Path, str, Path]:
    """Folder at which the reference starts, the way from there, and the folder below which it stays."""
    root = folder_of(urdf)
    name, _, relative = reference.removeprefix(PACKAGE).lstrip("/").partition("/")
    if not reference.startswith(PACKAGE) or name in {"", ".", ".."}:
        return urdf.parent, reference.removeprefix(PACKAGE).removeprefix(FILE), root
    package = _package(name, urdf)
    return package, relative, root if package.resolve().is_relative_to(root) else package


def _package(name: str, urdf: Path) -> Path:
    """The folder of a package, or where it would be beside the URDF."""
    beside, shared = urdf.parent / name, models_folder()
    above = (each for each in urdf.resolve().parents if each.name == name)
    candidates = (beside, *above, *([] if shared is None else [shared / name]))
    return next((each for each in candidates if each.is_dir()), beside)


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
    said = UNIT.search(COMMENT.sub(b"", path.read_bytes()))
    try:
        unit = 1.0 if said is None else float(said[1])
    except ValueError:
        unit = math.nan
    if not 0 < unit < math.inf:
        raise UrdfError(f"mesh {path} has a unit that is no length", allowed='<unit meter="1"/>')
    return unit


def triangles_of(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points of all meshes in a file, shape (V, 3) [m], and the three of each triangle, shape (M, 3)."""
    import trimesh  # noqa: PLC0415 - slow to import, and few meshes need it

    loader: Any = trimesh  # its annotations are partial
    mesh = loader.load(path, force="mesh")
    points = np.asarray(mesh.vertices, dtype=np.float64) * metres(path)
    faces = np.asarray(mesh.faces, dtype=np.int64).reshape(-1, 3)
    corners = points[faces]
    lines = (corners == np.roll(corners, 1, axis=1)).all(axis=2).any(axis=1)
    return points, faces[~lines]
