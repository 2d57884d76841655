"""Times that no gripper can keep: refuted by speed limits, verified, and no more than that."""

import json
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from predicates.case import Quantity
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.motion import Motion
from sdt_kg.twin import Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.haste import fastest
from services.embodiment.proof_check.statement import BASE, Statement
from services.embodiment.prove.prover import Proved, Prover

DRAWER = "sink_area_left_middle_drawer_main"
ROBOTS = ("pr2", "tiago_dual", "stretch")
HERE = (0.0, 0.0, 0.0)


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


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_drawer_may_take_ten_seconds(twin: Twin, robot: str) -> None:
    assert found(twin, robot, Drive.OMNI, 10.0) is None


def test_what_need_not_keep_its_times_is_not_refuted_by_them(twin: Twin) -> None:
    tau = motion(twin, 0.01)
    free = Motion(tau.of, tau.times, tau.values, timed=False)
    (pr2,) = (one for one in twin.robots if twin.name(one) == "pr2")
    assert Prover(twin, pr2, twin.container(DRAWER), Drive.OMNI, HERE, tau.values[:, 0]).hurried(free) is None


@pytest.mark.parametrize("robot", ROBOTS)
def test_no_random_motion_within_the_limits_moves_a_tool_faster(twin: Twin, robot: str) -> None:
    (iri,) = (one for one in twin.robots if twin.name(one) == robot)
    rng = np.random.default_rng(4)
    about = Statement(twin, iri, twin.container(DRAWER), Drive.FIXED, HERE, Tolerances())
    for gripper in about.grippers:
        arm = about.arm(gripper)
        assert arm is not None
        links = arm.chain.links
        low, high = (np.array([getattr(one, end) for one in links]) for end in ("lower", "upper"))
        most = np.array([0.0 if one.name in BASE else about.joint_velocity(one.name) for one in links])
        q, step = rng.uniform(low, high, (1000, len(links))), 1e-4
        moved = q + step * most * rng.choice([-1.0, 1.0], q.shape)
        tools = [arm.chain.frames(each)[2].translation.lo for each in (q, moved)]
        speed = np.linalg.norm(tools[1] - tools[0], axis=1).max() / step
        assert 0 < speed < fastest(about, Drive.FIXED, gripper)
        assert fastest(about, Drive.FIXED, gripper) < fastest(about, Drive.OMNI, gripper)


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
