"""What a reader of SDF passes over: misspelled elements and attributes, parts given twice.

A `<Collision>` would be nothing that can be met, nor a second shape in a `<geometry>`.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

from sdt_kg.errors import UrdfError
from sdt_kg.urdf.spelling import check_no_xacro, check_slips, place_of

SHAPES: Final = (
    *("empty", "box", "capsule", "cone", "cylinder", "ellipsoid", "heightmap", "image", "mesh", "plane"),
    *("polyline", "sphere"),
)
PARTS: Final[Mapping[str, tuple[str, ...]]] = {
    "sdf": ("world", "model", "actor", "light"),
    "world": (
        *("audio", "wind", "include", "gravity", "magnetic_field", "atmosphere", "gui", "physics", "scene"),
        *("light", "frame", "model", "actor", "plugin", "joint", "road", "population", "state"),
        "spherical_coordinates",
    ),
    "include": ("uri", "pose", "name", "static", "placement_frame", "plugin"),
    "model": (
        *("static", "self_collide", "allow_auto_disable", "include", "model", "enable_wind", "frame", "pose"),
        *("link", "joint", "plugin", "gripper"),
    ),
    "link": (
        *("gravity", "enable_wind", "self_collide", "kinematic", "must_be_base_link", "velocity_decay"),
        *("frame", "pose", "inertial", "collision", "visual", "sensor", "projector", "audio_sink"),
        *("audio_source", "battery", "light", "particle_emitter", "plugin"),
    ),
    "joint": (
        *("parent", "child", "gearbox_ratio", "gearbox_reference_body", "thread_pitch", "screw_thread_pitch"),
        *("axis", "axis2", "physics", "frame", "pose", "sensor"),
    ),
    "frame": ("pose",),
    "axis": ("initial_position", "xyz", "use_parent_model_frame", "dynamics", "limit", "mimic"),
    "limit": ("lower", "upper", "effort", "velocity", "stiffness", "dissipation"),
    "mimic": ("multiplier", "offset", "reference"),
    "inertial": ("mass", "density", "auto_inertia_params", "frame", "pose", "inertia", "fluid_added_mass"),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "collision": (
        *("laser_retro", "max_contacts", "density", "auto_inertia_params", "frame", "pose", "geometry"),
        "surface",
    ),
    "geometry": SHAPES,
    "box": ("size",),
    "capsule": ("radius", "length"),
    "cylinder": ("radius", "length"),
    "mesh": ("uri", "submesh", "scale", "convex_decomposition"),
    "plane": ("normal", "size"),
    "sphere": ("radius",),
}
"""Element → elements in it, http://sdformat.org/spec (1.12)."""

ATTRIBUTES: Final[Mapping[str, tuple[str, ...]]] = {
    "frame": ("name", "attached_to"),
    "mimic": ("joint", "axis"),
    "model": ("name", "canonical_link", "placement_frame"),
    "pose": ("relative_to", "frame", "degrees", "rotation_format"),
    "xyz": ("expressed_in",),
}
SEVERAL: Final = ("sdf", "world", "model", "link", "frame")
"""Elements of which some parts may be there several times; of the others, each once."""

ONCE: Final = ("static", "pose", "inertial")
"""Parts that are there once even so."""

OFTEN: Final = ("frame", "sensor", "plugin")
"""Parts that may be there several times in the others, too."""

SOLID: Final = {"include", "model", "link", "collision"}
"""What is, or may hold, something that can be met."""


def check_spelling(root: ET.Element, source: Path) -> None:
    """No element or attribute is misspelled, and nothing is given twice where one is read.

    Raises:
        UrdfError: Something is; it says what may be meant.
    """
    check_no_xacro(root, source)
    _check_namespaces(root, source)
    check_slips(_looked_at(root), PARTS, ATTRIBUTES, source)
    for element in _looked_at(root):
        _check_once(element, source)


def _check_namespaces(root: ET.Element, source: Path) -> None:
    """No element of another namespace is called, or has in it, what would be read: Gazebo heeds no xmlns."""
    for element in _looked_at(root):
        for part in element:
            space, _, tag = part.tag.rpartition("}")
            inner = {each.tag.rpartition("}")[2] for each in part.iter()}
            if space and (tag in PARTS.get(element.tag, ()) or inner & SOLID):
                raise UrdfError(
                    f"{place_of(element, source)} has <{tag}> of the namespace '{space[1:]}'",
                    allowed="elements of SDF, which have none",
                    remedy="take out its xmlns, or its prefix; or all of it if nothing is to meet it",
                )


def _check_once(element: ET.Element, source: Path) -> None:
    for tag in ONCE if element.tag in SEVERAL else PARTS.get(element.tag, ()):
        if tag not in OFTEN and len(element.findall(tag)) > 1:
            raise UrdfError(f"{place_of(element, source)} has <{tag}> more than once", allowed="one")
    shapes = [part.tag for part in element if part.tag in SHAPES] if element.tag == "geometry" else []
    if len(shapes) > 1:
        raise UrdfError(
            f"{place_of(element, source)} has {len(shapes)} shapes: {', '.join(shapes)}",
            allowed="one",
            remedy="give each a <collision> of its own; a link may have several",
        )


def _looked_at(element: ET.Element) -> Iterator[ET.Element]:
    """The element and those in it that are read; visuals, sensors and plugins are not."""
    yield element
    for part in element:
        if part.tag in PARTS or part.tag in ATTRIBUTES:
            yield from _looked_at(part)
