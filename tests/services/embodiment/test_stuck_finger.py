"""A gripper whose finger joint planning may not move: it is not searched with, and the refusal says so."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from predicates.case import Outcome
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from services.app import Policy, Service
from services.edits import parse_edit
from tests.services.embodiment.gantry import FOLDER

pytestmark = pytest.mark.oracle

FINGER = "j:up_joint sdt:openPosition"


def gantry(folder: Path, said: str) -> Service:
    """The gantry and its cell, with this said of its finger joint."""
    for name in ("cell.urdf", "gantry.urdf"):
        shutil.copy(FOLDER / name, folder)
    text = (FOLDER / "gantry.ttl").read_text(encoding="utf-8")
    assert FINGER in text
    (folder / "gantry.ttl").write_text(text.replace(FINGER, f"j:up_joint {said}sdt:openPosition"))
    twin = load_twin(folder / "cell.urdf", [folder / "gantry.urdf"])
    return Service(twin, Policy(Drive.OMNI, None, 5.0))


def test_a_finger_joint_that_is_held_is_not_moved(tmp_path: Path) -> None:
    (verdict,) = gantry(tmp_path, "sdt:held true ; ").achieve("open:drawer_main")
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert (
        "no gripper can close: up_joint may not move, held or without a speed" in verdict.diagnoses[0].reason
    )


@pytest.mark.parametrize(
    "edit", ["up_joint.velocityLimit", "up_joint.accelerationLimit", "down_joint.velocityLimit"]
)
def test_a_finger_joint_without_a_speed_is_told(tmp_path: Path, edit: str) -> None:
    service = gantry(tmp_path, "")
    slow = replace(service, twin=parse_edit(service.twin, f"set:gantry/{edit}=0").applied(service.twin))
    (verdict,) = slow.achieve("open:drawer_main")
    assert "no gripper can close: up_joint may not move" in verdict.diagnoses[0].reason
    (verdict,) = service.achieve("open:drawer_main")
    assert verdict.outcome is Outcome.CERTIFIED
