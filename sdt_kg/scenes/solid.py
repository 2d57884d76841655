"""What is solid in an SDF scene and cannot be read: without it a motion through it would be certified."""

import re
from collections.abc import Collection
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

from sdt_kg.errors import UrdfError

HARMLESS: Final = ("sun", "ground_plane")
"""Models that scenes include for their light, and for the floor that every twin has."""

TAKEN_OUT: Final = "take it out if nothing is to meet it"


def check_solid(holder: ET.Element, shapes: Collection[str], path: Path) -> None:
    """Nothing is left out of a world, or a file without one, that something may collide with.

    Args:
        holder: World or file.
        shapes: Those that are read, and what is none.
        path: For errors.

    Raises:
        UrdfError: A shape of another kind, a model in a model, or one that is in another file.
    """
    models = holder.findall("model")
    for each in (holder, *models):
        for include in each.findall("include"):
            _check_included((include.findtext("uri") or "").strip(), path)
    for outer in (*models, *holder.findall("population")):
        for inner in outer.findall("model"):
            _check_nested(inner, f"<{outer.tag}> '{outer.get('name')}'", path)
    for model in models:
        for link in model.findall("link"):
            for collision in link.findall("collision"):
                where = f"collision '{collision.get('name')}' of link '{link.get('name')}'"
                _check_shape(collision, shapes, f"{path}: model '{model.get('name')}': {where}")


def _check_included(uri: str, path: Path) -> None:
    named = [part for part in uri.split("/") if not part.isdigit()]  # at the end may be a version
    if re.sub(r"\W", "_", named[-1].lower() if named else "") not in HARMLESS:
        raise UrdfError(
            f"{path}: <include> of '{uri}', which is in another file",
            allowed=", ".join(HARMLESS),
            remedy=f"gz sdf -p FILE writes it into the file; or {TAKEN_OUT}",
        )


def _check_nested(model: ET.Element, where: str, path: Path) -> None:
    if model.find(".//collision") is not None or model.find(".//include") is not None:
        raise UrdfError(
            f"{path}: model '{model.get('name')}' in {where}",
            allowed="models of the world",
            remedy=f"make it one, placed by its pose; or {TAKEN_OUT}",
        )


def _check_shape(collision: ET.Element, shapes: Collection[str], where: str) -> None:
    for shape in collision.findall("geometry/*"):
        if shape.tag not in shapes:
            raise UrdfError(
                f"{where} has <{shape.tag}>",
                allowed=", ".join(shapes),
                remedy=f"write it as one of these, a mesh say; or {TAKEN_OUT}",
            )
