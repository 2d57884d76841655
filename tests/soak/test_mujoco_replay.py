"""Certified motions of our models, replayed in MuJoCo: it sees no contact and no slip. `make soak`."""

from collections.abc import Iterator
from copy import copy
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from sdt_kg.annotation import Drive
from services.app import Policy
from services.table import cells, run
from tests.soak.audit import Way
from tests.soak.mujoco_replay import Scene, replayed
from tests.soak.test_audit import bundled, stage
from tests.soak.test_tables import ROBOTS

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

STEP = 0.002  # [m] of travel between looks
SLIP, TURN = 0.002, np.radians(1.0)  # [m], [rad] that a certificate allows
ASKED = [("open", ()), ("close", ("all=half-open:7",))]
SHIFT = 0.1  # [m] towards the kitchen


def files(kitchen: str, robot: str) -> tuple[Path, Path]:
    return bundled("kitchens", kitchen, ".urdf"), bundled("robots", robot, ".urdf")


@cache
def scene(kitchen: str, robot: str, base: str, height: float) -> Scene:
    return Scene(*files(kitchen, robot), base, height)


def certified_ways(
    kitchen: str, robot: str, asked: tuple[str, tuple[str, ...]], folder: Path
) -> Iterator[tuple[str, Way, dict[str, tuple[float, str]]]]:
    """Case, certified motion, and the figures of its verdict."""
    verb, states = asked
    every = cells((kitchen,), (robot,), verb, states, Policy(drive=Drive.OMNI))
    result = run(every, 2, lambda _: None, folder)
    about = {"kitchen": kitchen, "robot": robot, "verb": verb, "drive": "omni"}
    for each in result.results:
        if each.verdict["outcome"] == "certified":
            judged = stage(*files(kitchen, robot), about, each.cell.container, states)
            with np.load(folder / each.cell.file_name) as motion:
                way = Way(judged, dict(motion), STEP)
            verdict: Any = each.verdict  # JSON
            yield each.cell.container, way, verdict["figures"]


def ways(kitchen: str, robot: str, asked: tuple[str, tuple[str, ...]], folder: Path) -> dict[str, Way]:
    """Case → certified motion."""
    return {case: way for case, way, _ in certified_ways(kitchen, robot, asked, folder)}


@pytest.mark.parametrize("asked", ASKED)
@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_mujoco_sees_nothing_wrong_with_what_is_certified(
    tmp_path: Path, kitchen: str, robot: str, asked: tuple[str, tuple[str, ...]]
) -> None:
    certified = ways(kitchen, robot, asked, tmp_path)
    assert certified
    wrong = dict[str, object]()
    for container, way in certified.items():
        note = way.stage.note
        overlaps, slip, turn = replayed(scene(kitchen, robot, note.base_body, note.height), way)
        if overlaps or slip > SLIP or turn > TURN:
            wrong[container] = overlaps, slip, turn
    assert wrong == {}


@pytest.mark.parametrize("robot", ROBOTS)
def test_mujoco_sees_a_robot_that_stands_too_near(tmp_path: Path, robot: str) -> None:
    certified = ways("b", robot, ASKED[0], tmp_path)
    assert certified
    for way in list(certified.values())[::4]:
        note = way.stage.note
        world_T_handle = way.rooms[way.stage.handle][0]
        towards = world_T_handle[:2, 3] - way.q[-1, :2]
        way.q[:, :2] += SHIFT * towards / np.linalg.norm(towards)
        nearer = copy(way)
        nearer.spline = CubicHermiteSpline(way.knots, way.q, way.v)
        overlaps, _, _ = replayed(scene("b", robot, note.base_body, note.height), nearer)
        assert overlaps
