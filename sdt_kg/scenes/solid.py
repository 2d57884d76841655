"""What is solid in an SDF scene and cannot be read: without it a motion through it would be certified."""

import re
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

import numpy as np

from sdt_kg.errors import UrdfError
from sdt_kg.scenes.values import own_pose

FLOOR: Final = "ground_plane"
HARMLESS: Final = ("sun", FLOOR)
"""Models that scenes include for their light, and for the floor that every twin has."""

TOLD_BY_STATE: Final = ("sim_time", "wall_time", "real_time", "iterations", "light")
"""What a state of the world may tell: no model is elsewhere by it."""

WORLD: Final = "world"
FLAT: Final = 1e-9
"""[m, 1] By which an included floor may be off z = 0."""

TAKEN_OUT: Final = "take it out if nothing is to meet it"


def check_solid(holder: ET.Element, shapes: Collection[str], path: Path) -> None:
    """Nothing is left out of a world, or a file without one, that something may collide with.

    Args:
        holder: World or file.
        shapes: Those that are read, and what is none.
        path: For errors.

    Raises:
        UrdfError: A shape of another kind, a model in a model, or one that is in another file, models that
            are joined, or elsewhere than where their poses say.
    """
    models, crowds = holder.findall("model"), holder.findall("population")
    for each in (holder, *models, *crowds):
        for include in each.findall("include"):
            _check_included(include, each, path)
    for outer in (*models, *crowds):
        for inner in outer.findall("model"):
            _check_nested(inner, f"<{outer.tag}> '{outer.get('name')}'", path)
    for actor in holder.findall("actor"):
        _check_nested(actor, "an <actor>", path)
    _check_joined(holder, path)
    _check_state(holder, path)
    _check_shapes(models, shapes, path)


def _check_shapes(models: Iterable[ET.Element], shapes: Collection[str], path: Path) -> None:
    for model in models:
        for link in model.findall("link"):
            for collision in link.findall("collision"):
                where = f"collision '{collision.get('name')}' of link '{link.get('name')}'"
                _check_shape(collision, shapes, f"{path}: model '{model.get('name')}': {where}")


def _check_included(include: ET.Element, holder: ET.Element, path: Path) -> None:
    uri = (include.findtext("uri") or "").strip()
    where = f"{path}: <include> of '{uri}'"
    named = [part for part in uri.split("/") if not part.isdigit()]  # at the end may be a version
    name = re.sub(r"\W", "_", named[-1].lower() if named else "")
    if name not in HARMLESS:
        raise UrdfError(
            f"{where}, which is in another file",
            allowed=", ".join(HARMLESS),
            remedy=f"gz sdf -p FILE writes it into the file; or {TAKEN_OUT}",
        )
    if name == FLOOR and not all(_is_level(each, where) for each in (include, holder)):
        raise UrdfError(
            f"{where} is raised or turned by its <pose>, or by that of <{holder.tag}>",
            allowed="z, roll and pitch 0",
            remedy=f"write a <plane> there in its place; or {TAKEN_OUT}",
        )


def _is_level(element: ET.Element, where: str) -> bool:
    """Whether z = 0 stays z = 0; a pose by another frame may be anywhere."""
    pose, at = element.find("pose"), own_pose(element, where)
    by_world = pose is None or pose.get("relative_to", WORLD) in ("", WORLD)
    return by_world and abs(at[2, 3]) < FLAT and at[2, 2] > 1 - FLAT


def _check_joined(holder: ET.Element, path: Path) -> None:
    """No joint of the world holds models together, or has one of them move."""
    for joint in holder.findall("joint"):
        raise UrdfError(
            f"{path}: joint '{joint.get('name')}' of the world",
            allowed="joints of models",
            remedy="make what it joins one model; or take it out if each stands where it is",
        )


def _check_state(holder: ET.Element, path: Path) -> None:
    """Models are where their poses say: no state of the world moves, adds or takes out any."""
    for part in (each for state in holder.findall("state") for each in state):
        if part.tag not in TOLD_BY_STATE and not _is_at_origin(part, holder, path):
            raise UrdfError(
                f"{path}: <state> of the world has <{part.tag}> {part.get('name') or ''}".rstrip(),
                allowed="models where their own poses place them",
                remedy="write these poses and models into the world, and take <state> out",
            )


def _is_at_origin(state: ET.Element, holder: ET.Element, path: Path) -> bool:
    """Whether it tells of the floor or light that it is where it would be anyway."""
    if state.tag != "model" or state.get("name") not in HARMLESS:
        return False
    written = (model for model in holder.findall("model") if model.get("name") == state.get("name"))
    placed = [element for one in (state, *written) for element in one.iter()]
    where = f"{path}: '{state.get('name')}'"
    return all((own_pose(each, where) == np.eye(4)).all() for each in placed) and state.find("scale") is None


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
