"""A gantry with a second hand beside the first, and a motion in which it takes over."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Twin
from tests.services.embodiment.gantry import FOLDER, JOINTS, opening

BOTH = (*JOINTS, "second_arm_joint", "second_up_joint")
ARM, FINGER, SECOND_ARM, SECOND_FINGER, VALUE = 5, 7, 8, 9, 10  # columns of TAKEN_OVER
LEAVES, GONE, COMES, SHUTS = 5, 6, 7, 8  # rows of it

# Seconds, and at each a rest: base x, y, yaw; the joints above; drawer.
TAKEN_OVER = np.array(
    (
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.04, 0.0, 0.04, 0.0),
        (5.0, 0.4, -0.05, 0.0, 0.2, 0.0, 0.0, 0.04, 0.0, 0.04, 0.0),
        (9.0, 0.4, -0.05, 0.0, 0.2, 0.635, 0.0, 0.04, 0.0, 0.04, 0.0),
        (11.0, 0.4, -0.05, 0.0, 0.2, 0.635, 0.0, 0.005, 0.0, 0.04, 0.0),
        (15.0, 0.2, -0.05, 0.0, 0.2, 0.605, 0.0, 0.005, 0.0, 0.04, 0.23),
        (17.0, 0.2, -0.05, 0.0, 0.2, 0.605, 0.0, 0.04, 0.0, 0.04, 0.23),
        (20.0, 0.2, -0.05, 0.0, 0.2, 0.205, 0.0, 0.04, 0.0, 0.04, 0.23),
        (24.0, 0.2, -0.05, 0.0, 0.2, 0.205, 0.0, 0.04, 0.605, 0.04, 0.23),
        (26.0, 0.2, -0.05, 0.0, 0.2, 0.205, 0.0, 0.04, 0.605, 0.005, 0.23),
        (30.0, 0.0, -0.05, 0.0, 0.2, 0.175, 0.0, 0.04, 0.575, 0.005, 0.46),
    )
)


def two_handed(folder: Path) -> Twin:
    """Twin of the cell and the gantry with a second arm, 0.1 m beside the first on the same lift."""
    urdf, note = (FOLDER / f"gantry{suffix}" for suffix in (".urdf", ".ttl"))
    body = urdf.read_text()
    first = body[body.index('<link name="arm">') : body.index("</robot>")]
    names = (
        "arm",
        "palm",
        "wrist",
        "up_finger",
        "down_finger",
        "arm_joint",
        "wrist_joint",
        "up_joint",
        "down_joint",
    )
    second = first
    for name in names:
        second = second.replace(f'"{name}"', f'"second_{name}"')
    second = second.replace(
        '<child link="second_arm"/><origin xyz="0 0 0"/>', '<child link="second_arm"/><origin xyz="0 0.1 0"/>'
    )
    assert "0 0.1 0" in second
    (folder / "gantry.urdf").write_text(body.replace("</robot>", second + "</robot>"))
    lines = [
        "<https://example.org/id/gantry> sdt:hasGripper <https://example.org/id/gantry/gripper/second> .",
        '<https://example.org/id/gantry/gripper/second> a sdt:Gripper ; rdfs:label "second" ;',
        "    sdt:toolBody b:second_palm ; sdt:toolFrame <https://example.org/id/gantry/tool> ;",
        "    sdt:hasFinger b:second_up_finger, b:second_down_finger ;",
        "    sdt:hasFingerJoint j:second_up_joint ; sdt:opening 0.08 .",
        "j:second_up_joint sdt:openPosition 0.04 ; sdt:closedPosition 0.0 ; sdt:parkedPosition 0.04 ;",
        "    sdt:accelerationLimit 1.0 .",
        "j:second_down_joint sdt:accelerationLimit 1.0 ; sdt:parkedPosition 0.04 .",
        "j:second_arm_joint sdt:accelerationLimit 1.0 .",
        "j:second_wrist_joint sdt:accelerationLimit 4.0 .",
    ]
    (folder / "gantry.ttl").write_text("\n".join((note.read_text(), *lines)) + "\n")
    (folder / "cell.urdf").write_text((FOLDER / "cell.urdf").read_text())
    return load_twin(folder / "cell.urdf", [folder / "gantry.urdf"])


def taken_over(*changes: tuple[int, int, float], gripper: str = "", step: float = 0.1) -> BodyMotion:
    """That motion with entries of its rests changed: row, column, value; a gripper may be named."""
    rests = TAKEN_OVER.copy()
    for row, column, value in changes:
        rests[row, column] = value
    return replace(opening(step, rests, BOTH), gripper=gripper)
