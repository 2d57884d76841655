"""The first annotation of a robot, whole."""

from dataclasses import dataclass, replace
from pathlib import Path

from sdt_kg.annotation import RobotAnnotation
from sdt_kg.describe import guessed, turtle
from sdt_kg.urdf import read_mechanism
from services.describing.parking import parked
from services.describing.touching import touching


@dataclass(frozen=True, slots=True)
class Described:
    """A first annotation, as a value and as Turtle.

    Attributes:
        notes: What import noticed about the model, and what was guessed and from what.
    """

    robot: RobotAnnotation
    text: str
    notes: tuple[str, ...]


def describe(urdf: Path) -> Described:
    """A first annotation of a URDF or xacro file; it loads as it is, unless no gripper was found.

    Raises:
        UrdfError: Not a valid URDF.
    """
    mechanism = read_mechanism(urdf)
    robot = guessed(mechanism)
    why = touching(mechanism, robot)
    robot = parked(urdf, replace(robot, allowed_contacts=robot.allowed_contacts | why.keys()))
    return Described(robot, turtle(robot, urdf.name, why), (*mechanism.notes, *robot.notes))
