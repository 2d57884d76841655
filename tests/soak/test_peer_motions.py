"""Every motion that the authors' planner made, judged, and each rejection confirmed on the reference meshes.

`make soak`. Confirmed by other code: placements from the reference's URDFs, surfaces as triangles.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from sdt_kg.annotation import Drive
from sdt_kg.iri import local_name
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from services.embodiment.certify import Certified, Refused, Tolerances, certify
from services.embodiment.certify.collisions.survey import hand
from services.motions import read_motion
from services.physics.model import Scene
from tests.soak.reference_meshes import Array, Placed, boxes_apart, overlap
from tests.soak.repair import repaired

pytestmark = [pytest.mark.oracle, pytest.mark.reference, pytest.mark.slow]

KITCHEN = "kitchen_b_iai_kitchen/kitchen.urdf"
ROBOTS = {
    "pr2": ("pr2", "robot_pr2/pr2_with_ft2_cableguide.urdf"),
    "tiago": ("tiago_dual", "robot_tiago_dual/tiago_dual.urdf"),
    "stretch": ("stretch", "robot_stretch/stretch_description_local.urdf"),
}
FILES = {"pr2": 17, "tiago": 17, "stretch": 17}
CERTAIN = 0.020  # [m] our shapes contain the robots; what is deeper is no artefact of ours
FAR = 0.02  # [m] a gripper this far from a handle does not hold it
DRIFT = 0.001  # [m or rad]


class Recorded:
    """What a file holds, at any time: the C² spline from rest to rest, as README of motions says."""

    def __init__(self, path: Path) -> None:
        with np.load(path) as arrays:
            self.container = str(arrays["container"])
            self.times = arrays["times"]
            names = [arrays["robot_joint_names"].tolist(), arrays["kitchen_joint_names"].tolist()]
            values = np.hstack((arrays["base"], arrays["robot_positions"], arrays["kitchen_positions"]))
        self.names = (["x", "y", "yaw"], *names)
        self.values = values
        self._way = CubicSpline(self.times, values, bc_type="clamped")

    def at(self, time: float) -> tuple[Array, dict[str, float], dict[str, float]]:
        """world_T_root of the robot on the floor, robot joints, kitchen joints."""
        row = self._way(np.clip(time, self.times[0], self.times[-1]))
        x, y, yaw = row[:3]
        root = np.eye(4)
        root[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
        root[:2, 3] = x, y
        split = 3 + len(self.names[1])
        return (
            root,
            dict(zip(self.names[1], row[3:split].tolist(), strict=True)),
            dict(zip(self.names[2], row[split:].tolist(), strict=True)),
        )


@pytest.mark.parametrize("robot", list(ROBOTS))
def test_each_rejection_is_confirmed_on_the_reference_meshes(reference: Path, robot: str) -> None:
    name, urdf = ROBOTS[robot]
    paths = sorted((reference / "peer_motions").glob(f"{robot}_B_*.npz"))
    assert len(paths) == FILES[robot]
    twin = load_twin("b", [name])
    scene = Scene(twin, twin.robots[0])
    machine, kitchen = Placed(reference / urdf), Placed(reference / KITCHEN)
    for path in paths:
        recorded, motion = Recorded(path), read_motion(path, twin, twin.robots[0])
        assert isinstance(motion, BodyMotion)
        container = twin.container(recorded.container)
        verdict = certify(
            twin, twin.robots[0], motion, container, Tolerances(), drive=Drive.OMNI, scene=scene, in_full=True
        )
        assert isinstance(verdict, Refused), path.name
        assert any("moves before it is held" in one.reason for one in verdict.diagnoses), path.name
        grippers = [hand(twin.mechanism(twin.robots[0]), gripper) for gripper in scene.annotation.grippers]
        links = [local_name(body) for bodies in grippers for body in bodies]
        assert drifts_alone(machine, kitchen, recorded, links, local_name(container.handle)), path.name
        for one in verdict.diagnoses:
            evidence = one.evidence
            if (
                evidence is None
                or evidence.links is None
                or evidence.value > -CERTAIN
                or evidence.time is None
            ):
                continue
            own, other = map(local_name, evidence.links)
            machine.root, q, kitchen_q = recorded.at(evidence.time)
            against = (machine, other, q) if evidence.scope == "self" else (kitchen, other, kitchen_q)
            if other != "floor":
                assert overlap(machine, own, q, *against), f"{path.name}: {one.reason}"


def drifts_alone(machine: Placed, kitchen: Placed, recorded: Recorded, links: list[str], handle: str) -> bool:
    """Whether the container moves while every gripper is far from its handle, by boxes that contain them."""
    column = len(recorded.values[0]) - len(recorded.names[2])
    joint = recorded.names[2].index(moving_joint(recorded))
    moved = np.abs(recorded.values[:, column + joint] - recorded.values[0, column + joint])
    for k in np.flatnonzero(moved > DRIFT):
        machine.root, q, kitchen_q = recorded.at(float(recorded.times[k]))
        known = [link for link in links if link in machine.links.links]
        return boxes_apart(machine, known, q, kitchen, handle, kitchen_q) > FAR
    return False


def moving_joint(recorded: Recorded) -> str:
    """The kitchen joint that moves most."""
    column = len(recorded.values[0]) - len(recorded.names[2])
    return recorded.names[2][int(np.ptp(recorded.values[:, column:], axis=0).argmax())]


@pytest.mark.parametrize("robot", list(ROBOTS))
def test_no_differential_base_can_drive_them(reference: Path, robot: str) -> None:
    for path in sorted((reference / "peer_motions").glob(f"{robot}_B_*.npz")):
        with np.load(path) as arrays:
            base = arrays["base"]
        step, yaw = np.diff(base[:, :2], axis=0), (base[1:, 2] + base[:-1, 2]) / 2
        sideways = np.abs(-np.sin(yaw) * step[:, 0] + np.cos(yaw) * step[:, 1]).sum()
        assert sideways > Tolerances().drift, path.name


@pytest.mark.parametrize(
    ("file", "closed"), [("oven_area_area_middle_upper", 0.1), ("kitchen_island_left_upper", 0.11)]
)
def test_repaired_by_hand_they_are_certified(reference: Path, file: str, closed: float) -> None:
    twin = load_twin("b", ["pr2"])
    scene = Scene(twin, twin.robots[0])
    motion = read_motion(reference / "peer_motions" / f"pr2_B_{file}_drawer_main.npz", twin, twin.robots[0])
    assert isinstance(motion, BodyMotion)
    container = twin.container(f"{file}_drawer_main")
    mended = repaired(scene, motion, container, slower=6.0, closed=closed)
    verdict = certify(
        twin, twin.robots[0], mended, container, Tolerances(), drive=Drive.OMNI, scene=scene, in_full=True
    )
    assert isinstance(verdict, Certified), [one.reason for one in verdict.diagnoses]
    assert verdict.figures["container at the end"][0] >= container.open_from
