"""Motions that another planner accepted, judged on our kitchen and robots."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Quantity
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from services.embodiment.certify import Refused, Tolerances, certify
from services.motions import read_motion
from services.physics.model import Scene

pytestmark = [pytest.mark.oracle, pytest.mark.reference]


@pytest.mark.parametrize(
    ("robot", "files"), [("pr2", "pr2_B_*"), ("tiago_dual", "tiago_B_*"), ("stretch", "stretch_B_*")]
)
def test_in_every_peer_motion_the_container_moves_before_it_is_held(
    reference: Path, robot: str, files: str
) -> None:
    paths = sorted((reference / "peer_motions").glob(f"{files}.npz"))[:3]
    assert len(paths) == 3
    twin = load_twin("b", [robot])
    scene = Scene(twin, twin.robots[0])
    for path in paths:
        motion = read_motion(path, twin, twin.robots[0])
        assert isinstance(motion, BodyMotion)
        with np.load(path) as arrays:
            container = twin.container(str(arrays["container"]))
        verdict = certify(
            twin, twin.robots[0], motion, container, Tolerances(), drive=Drive.OMNI, scene=scene
        )
        assert isinstance(verdict, Refused)
        held = [one for one in verdict.diagnoses if "moves before it is held" in one.reason]
        assert len(held) == 1
        assert held[0].evidence is not None
        assert held[0].evidence.quantity is Quantity.DISTANCE
        assert held[0].evidence.value > 0.5  # the gripper is still on its way
        differential = certify(
            twin, twin.robots[0], motion, container, Tolerances(), drive=Drive.DIFFERENTIAL, scene=scene
        )
        assert isinstance(differential, Refused)
        assert any("sideways" in one.reason for one in differential.diagnoses)
