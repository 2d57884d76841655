"""Times that no gripper can keep: refuted by speed limits, verified, and no more than that."""

import json
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from predicates.case import Quantity
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.motion import BASE_JOINTS, Motion
from sdt_kg.twin import Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.arm import ROUNDING
from services.embodiment.proof_check.haste import arms_of, fastest, joint_velocity, travelled
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove.prover import Proved, Prover
from tests.services.embodiment.gantry import FOLDER
from tests.small import beside

DRAWER = "sink_area_left_middle_drawer_main"
ROBOTS = ("pr2", "tiago_dual", "stretch")
HERE = (0.0, 0.0, 0.0)
POSTURES = 2000


@pytest.fixture(scope="module")
def twin() -> Twin:
    return load_twin("b", list(ROBOTS))


def motion(twin: Twin, seconds: float) -> Motion:
    """The drawer opens evenly in so many seconds."""
    drawer = twin.container(DRAWER)
    values = np.linspace(0.0, 0.95 * drawer.upper, 41)[:, None]
    return Motion(drawer.joint, np.linspace(1.0, 1.0 + seconds, 41), values)


def found(twin: Twin, robot: str, drive: Drive, seconds: float) -> Proved | None:
    (iri,) = (one for one in twin.robots if twin.name(one) == robot)
    tau = motion(twin, seconds)
    return Prover(twin, iri, twin.container(DRAWER), drive, HERE, tau.values[:, 0]).hurried(tau)


@pytest.mark.parametrize("drive", [Drive.FIXED, Drive.OMNI])
@pytest.mark.parametrize("robot", ROBOTS)
def test_no_hand_opens_a_drawer_in_two_milliseconds(twin: Twin, robot: str, drive: Drive) -> None:
    proved = found(twin, robot, drive, 0.002)
    assert proved is not None
    evidence = proved.diagnosis.evidence
    assert evidence is not None
    assert evidence.quantity is Quantity.VELOCITY
    assert evidence.value > evidence.bound > 0
    (iri,) = (one for one in twin.robots if twin.name(one) == robot)
    checked = check(twin, iri, twin.container(DRAWER), proved.artefact.content)
    assert checked.holds, checked.reasons
    assert "in the given times" in checked.statement


def test_times_between_which_the_drawer_rests_are_no_proof(twin: Twin) -> None:
    """While it rests it may be let go: of what is held elsewhere then, the way of one point says nothing."""
    tau = motion(twin, 0.002)
    values, times = np.insert(tau.values, 21, tau.values[20], axis=0), np.insert(tau.times, 21, 1.00101)
    rests = Motion(tau.of, np.r_[times[:21], times[21:] + 1e-4], values)
    (pr2,) = (one for one in twin.robots if twin.name(one) == "pr2")
    drawer = twin.container(DRAWER)
    prover = Prover(twin, pr2, drawer, Drive.OMNI, HERE, rests.values[:, 0])
    proved = prover.hurried(rests)
    assert proved is not None, "of one half of the way it still is"
    whole = json.loads(zlib.decompress(proved.artefact.content))
    first, last = whole["window"]
    assert (last <= 20) or (first >= 21)
    whole["window"] = [0, len(values) - 1]
    checked = check(twin, pr2, drawer, zlib.compress(json.dumps(whole).encode()))
    assert any("may rest" in reason for reason in checked.reasons)


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_drawer_may_take_ten_seconds(twin: Twin, robot: str) -> None:
    assert found(twin, robot, Drive.OMNI, 10.0) is None


def test_what_need_not_keep_its_times_is_not_refuted_by_them(twin: Twin) -> None:
    tau = motion(twin, 0.01)
    free = Motion(tau.of, tau.times, tau.values, timed=False)
    (pr2,) = (one for one in twin.robots if twin.name(one) == "pr2")
    assert Prover(twin, pr2, twin.container(DRAWER), Drive.OMNI, HERE, tau.values[:, 0]).hurried(free) is None


@pytest.mark.parametrize("robot", ROBOTS)
def test_no_motion_within_the_limits_moves_a_point_of_the_grasp_box_faster(twin: Twin, robot: str) -> None:
    # Each joint turns the way that moves the point on, and the posture is the fastest of many.
    (iri,) = (one for one in twin.robots if twin.name(one) == robot)
    rng = np.random.default_rng(4)
    about = Statement(twin, iri, twin.container(DRAWER), Drive.FIXED, HERE, Tolerances())
    for gripper in about.grippers:
        arm = about.arm(gripper)
        assert arm is not None
        links = arm.chain.links
        low, high = (np.array([getattr(one, end) for one in links]) for end in ("lower", "upper"))
        most = np.array(
            [0.0 if one.name in BASE_JOINTS else joint_velocity(about, one.name) for one in links]
        )
        q = rng.uniform(low, high, (POSTURES, len(links)))
        origins, axes, tool = arm.chain.frames(q)
        corner = arm.middle + (arm.half - ROUNDING) * rng.choice([-1.0, 1.0], (len(q), 3))
        point = (tool.rotation.lo @ corner[:, :, None])[:, :, 0] + tool.translation.lo
        moved = np.cross(axes.lo, point[:, None] - origins.lo)
        moved = np.where(np.array([one.turns for one in links])[:, None], moved, axes.lo) * most[:, None]
        way = rng.normal(size=(len(q), 3))
        for _ in range(20):
            way = (np.sign((moved * way[:, None]).sum(axis=2))[:, :, None] * moved).sum(axis=1)
        speed = np.linalg.norm(way, axis=1).max()
        bound = fastest(about, Drive.FIXED, gripper)
        assert bound / 3 < speed < bound < fastest(about, Drive.OMNI, gripper)


@pytest.mark.parametrize("drive", [Drive.FIXED, Drive.OMNI])
@pytest.mark.parametrize("name", BASE_JOINTS)
def test_a_joint_of_the_robot_that_has_a_name_of_the_bases_moves_its_hand_as_before(
    tmp_path: Path, drive: Drive, name: str
) -> None:
    speeds: list[float] = []
    for folder, joint in ((tmp_path / "usual", "arm_joint"), (tmp_path / "renamed", name)):
        folder.mkdir()
        for file in ("gantry.urdf", "gantry.ttl", "cell.urdf"):
            (folder / file).write_text((FOLDER / file).read_text().replace("arm_joint", joint))
        twin = load_twin(folder / "cell.urdf", [folder / "gantry.urdf"])
        about = Statement(twin, twin.robots[0], twin.container("drawer_main"), drive, HERE, Tolerances())
        (hand,) = (gripper for gripper in about.grippers if gripper.name == "hand")
        speeds.append(fastest(about, drive, hand))
    assert speeds[0] == speeds[1]


@pytest.mark.parametrize("robot", ROBOTS)
def test_no_point_of_the_grasp_box_is_farther_from_an_axis_than_its_arm(twin: Twin, robot: str) -> None:
    (iri,) = (one for one in twin.robots if twin.name(one) == robot)
    rng = np.random.default_rng(6)
    about = Statement(twin, iri, twin.container(DRAWER), Drive.FIXED, HERE, Tolerances())
    arm = about.arm(about.grippers[0])
    assert arm is not None
    links = arm.chain.links
    low, high = (np.array([getattr(one, end) for one in links]) for end in ("lower", "upper"))
    q = np.where(
        rng.random((POSTURES, len(links))) < 0.3, low, rng.uniform(low, high, (POSTURES, len(links)))
    )
    origins, axes, tool = arm.chain.frames(q)
    corner = arm.middle + (arm.half - ROUNDING) * rng.choice([-1.0, 1.0], (len(q), 3))
    point = (tool.rotation.lo @ corner[:, :, None])[:, :, 0] + tool.translation.lo
    away = np.linalg.norm(np.cross(axes.lo, point[:, None] - origins.lo), axis=2).max(axis=0)
    turns = np.array([one.turns for one in links])
    assert (away < arms_of(arm))[turns].all()


def test_every_point_of_a_handle_goes_as_far_as_is_said(twin: Twin) -> None:
    door = twin.container("iai_fridge_door")
    (pr2,) = (one for one in twin.robots if twin.name(one) == "pr2")
    about = Statement(twin, pr2, door, Drive.FIXED, HERE, Tolerances())
    rng = np.random.default_rng(7)
    for one, other in rng.uniform(0.0, door.upper, (20, 2)):
        way, _ = travelled(about, float(one), float(other))
        ends = [about.target(float(value)) for value in (one, other)]
        for before, after, half in zip(ends[0].boxes, ends[1].boxes, ends[0].half, strict=True):
            local = rng.uniform(-half, half, (200, 3))
            places = [local @ box.rotation.lo.T + box.translation.lo for box in (before, after)]
            assert way <= np.linalg.norm(places[1] - places[0], axis=1).min()


def slower(whole: dict[str, Any]) -> None:
    whole["claim"]["timing"]["times"] = [1000 * one for one in whole["claim"]["timing"]["times"]]


def backwards(whole: dict[str, Any]) -> None:
    whole["claim"]["timing"]["times"].reverse()


def beyond(whole: dict[str, Any]) -> None:
    whole["window"] = [0, 41]


def windowless(whole: dict[str, Any]) -> None:
    whole["window"] = None


def timeless(whole: dict[str, Any]) -> None:
    whole["claim"]["timing"] = None


def outside(whole: dict[str, Any]) -> None:
    whole["claim"]["timing"]["values"][-1] = 99.0


@pytest.mark.parametrize("change", [slower, backwards, beyond, windowless, timeless, outside])
def test_a_changed_proof_does_not_hold(twin: Twin, change: Callable[[dict[str, Any]], None]) -> None:
    proved = found(twin, "pr2", Drive.OMNI, 0.002)
    assert proved is not None
    whole = json.loads(zlib.decompress(proved.artefact.content))
    change(whole)
    (pr2,) = (one for one in twin.robots if twin.name(one) == "pr2")
    content = zlib.compress(json.dumps(whole).encode())
    assert not check(twin, pr2, twin.container(DRAWER), content).holds


def test_a_container_may_be_off_its_times_at_both_ends_of_a_window(twin: Twin) -> None:
    # It is certified up to `coupling` behind at the first sample, and before at the last.
    (pr2,) = (one for one in twin.robots if twin.name(one) == "pr2")
    about = Statement(twin, pr2, twin.container(DRAWER), Drive.FIXED, HERE, Tolerances())
    way, _ = travelled(about, 0.1, 0.2)
    assert 0.1 - 5 * Tolerances().coupling < way <= 0.1 - 2 * Tolerances().coupling


def top_drawer_travelled(folder: Path, urdf: str, one: float, other: float) -> float:
    """How far the handle of a kitchen's drawer goes at least between two of its values [m]."""
    file = folder / "kitchen.urdf"
    file.write_text(urdf)
    twin = beside(file, "pr2")
    drawer = twin.container("top_drawer")
    return travelled(Statement(twin, twin.robots[0], drawer, Drive.FIXED, HERE, Tolerances()), one, other)[0]


HANDLE = """<link name="top_handle"><collision><geometry><box size="0.012 0.16 0.012"/></geometry></collision>
</link><joint name="top_handle_joint" type="fixed"><parent link="top_drawer"/>
<child link="top_handle"/></joint>"""
PULLED = 30.0  # [m] that a rail goes for each metre of the drawer on it
ON_A_RAIL = f"""<robot name="pulled"><link name="wall"/><link name="rail"/>
<joint name="rail_joint" type="prismatic"><parent link="wall"/><child link="rail"/>
<origin xyz="0.8 0 0.8"/><axis xyz="-1 0 0"/><limit lower="0" upper="0.6" velocity="9" effort="1"/>
<mimic joint="top_drawer_joint" multiplier="{PULLED}"/></joint>
<link name="top_drawer"/><joint name="top_drawer_joint" type="prismatic"><parent link="rail"/>
<child link="top_drawer"/><axis xyz="-1 0 0"/><limit lower="0" upper="0.02" velocity="1" effort="1"/></joint>
{HANDLE}</robot>"""


def test_what_carries_a_container_along_may_be_off_by_as_much_more(tmp_path: Path) -> None:
    # The drawer is certified up to `coupling` off its times, and its handle is 31 times as far off then.
    way, kept = top_drawer_travelled(tmp_path, ON_A_RAIL, 0.005, 0.015), Tolerances()
    assert way <= (1 + PULLED) * (0.01 - 2 * kept.coupling)
    assert way > (1 + PULLED) * (0.01 - 5 * kept.coupling)


LED = 20.0  # [m] that a drawer goes for each metre of what leads it
BY_A_CRANK = f"""<robot name="led"><link name="wall"/><link name="crank"/>
<joint name="crank_joint" type="prismatic"><parent link="wall"/><child link="crank"/>
<axis xyz="-1 0 0"/><limit lower="0" upper="0.02" velocity="1" effort="1"/></joint>
<link name="top_drawer"/><joint name="top_drawer_joint" type="prismatic"><parent link="wall"/>
<child link="top_drawer"/><origin xyz="0.8 0 0.8"/><axis xyz="-1 0 0"/>
<limit lower="0" upper="0.4" velocity="9" effort="1"/><mimic joint="crank_joint" multiplier="{LED}"/></joint>
{HANDLE}</robot>"""


def test_what_goes_farther_than_the_joint_whose_times_are_asked_may_be_off_them_by_as_much_more(
    tmp_path: Path,
) -> None:
    # Times of the crank are asked, and it is certified up to `coupling` off them.
    way, kept = top_drawer_travelled(tmp_path, BY_A_CRANK, 0.1, 0.3), Tolerances()
    assert way <= 0.2 - 2 * LED * kept.coupling
    assert way > 0.2 - 3 * LED * kept.coupling
