"""A differential base turns about a point amid its wheels, wherever its annotation has the base."""

import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case, Kind, Quantity
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.state import Interval, Region
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Refused
from services.embodiment.certify.sweep import pieces
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import FOLDER, RESTS, gantry_twin, opening
from tests.services.embodiment.judging import judge, refusal

pytestmark = pytest.mark.oracle

WHEEL = """<link name="wheel_{y}"><collision><origin rpy="1.5708 0 0"/>
<geometry><cylinder radius="0.05" length="0.02"/></geometry></collision></link>
<joint name="wheel_{y}_joint" type="continuous"><parent link="base"/><child link="wheel_{y}"/>
<origin xyz="{x} {y} 0.05" rpy="0 0 {yaw}"/><axis xyz="0 1 0"/><limit velocity="9" effort="9"/></joint>"""
HELD = "<https://example.org/id/gantry/joint/wheel_{y}_joint> <https://example.org/sdt#held> true .\n"
ASIDE = ("0.22", "-0.22")


def on_wheels(folder: Path, x: float, yaw: float = 0.0) -> Twin:
    """The gantry with two wheels so far before its base's origin, both turned by a yaw."""
    gantry_twin(folder)
    wheels = "".join(WHEEL.format(x=x, y=y, yaw=yaw) for y in ASIDE)
    urdf = (FOLDER / "gantry.urdf").read_text().replace("</robot>", f"{wheels}</robot>")
    (folder / "gantry.urdf").write_text(urdf)
    held = "".join(HELD.format(y=y) for y in ASIDE)
    (folder / "gantry.ttl").write_text((FOLDER / "gantry.ttl").read_text() + held)
    return load_twin(folder / "cell.urdf", [folder / "gantry.urdf"])


def turning_first() -> np.ndarray:
    """The base turns on the spot and back, then opens the drawer."""
    turns = np.repeat(RESTS[:1], 2, axis=0)
    turns[1, [0, 3]] = 2.0, 0.1
    later = RESTS.copy()
    later[:, 0] += 4.0
    return np.vstack((turns, later))


def test_turning_about_a_point_amid_the_wheels_is_no_sideways_motion(tmp_path: Path) -> None:
    verdict = judge(on_wheels(tmp_path, 0.0), opening(rests=turning_first()), Drive.DIFFERENTIAL)
    assert isinstance(verdict, Certified), verdict.diagnoses


@pytest.mark.parametrize("x", [0.1, -0.1])
def test_turning_about_a_point_before_or_behind_the_wheels_is_sideways_motion(
    tmp_path: Path, x: float
) -> None:
    twin, motion = on_wheels(tmp_path, x), opening(rests=turning_first())
    found = refusal(twin, motion, Quantity.SIDEWAYS_VELOCITY, Drive.DIFFERENTIAL)
    side = "before" if x > 0 else "behind"
    assert f"0.100 m {side} sdt:baseBody" in found[0].reason
    fastest = 1.5 * 0.1 / 2.0 * 0.1  # [m/s] of the wheels' line
    assert fastest <= max(one.evidence.value for one in found if one.evidence) <= fastest * 1.05


@pytest.mark.parametrize("yaw", [np.pi / 2, -np.pi / 2, 0.2])
def test_a_base_whose_wheels_roll_aside_does_not_go_ahead(tmp_path: Path, yaw: float) -> None:
    twin, motion = on_wheels(tmp_path, 0.0, yaw), opening()
    found = refusal(twin, motion, Quantity.SIDEWAYS_VELOCITY, Drive.DIFFERENTIAL)
    assert f"roll at {np.degrees(abs(yaw)):.3g}° to x of sdt:baseBody" in found[0].reason
    fastest = np.abs(motion.base_v[:, 0]).max() * np.sin(abs(yaw))
    assert max(one.evidence.value for one in found if one.evidence) == pytest.approx(fastest, rel=0.05)


def test_nothing_is_searched_for_a_base_whose_wheels_roll_aside(tmp_path: Path) -> None:
    twin = on_wheels(tmp_path, 0.0, np.pi / 2)
    (drawer,), (robot,) = twin.containers(), twin.robots
    goal = Region(((drawer.joint, Interval(drawer.open_from, drawer.upper)),))
    motion = next(Kinematics().generate(twin, goal))
    case = Case(twin, robot, Task(Verb.OPEN, drawer.iri), motion)
    answer = WholeBody(Drive.DIFFERENTIAL).perform(case)
    (said,) = answer.diagnoses
    assert (answer.holds, said.kind, said.proof) == (False, Kind.EMBODIMENT, False)
    assert "roll at 90° to x of sdt:baseBody" in said.reason
    assert "none was searched for" in answer.notes


@pytest.mark.parametrize(
    ("x", "drive", "told"), [(-0.3, "DIFFERENTIAL", 1), (1e-4, "DIFFERENTIAL", 0), (-0.3, "OMNI", 0)]
)
def test_a_search_that_finds_nothing_says_that_the_base_turns_elsewhere(
    tmp_path: Path, x: float, drive: str, told: int
) -> None:
    twin = on_wheels(tmp_path, x)
    (drawer,), (robot,) = twin.containers(), twin.robots
    goal = Region(((drawer.joint, Interval(drawer.open_from, drawer.upper)),))
    case = Case(twin, robot, Task(Verb.OPEN, drawer.iri), next(Kinematics().generate(twin, goal)))
    answer = WholeBody(Drive[drive], budget=1e-9).perform(case)
    said = [each for each in answer.diagnoses if "a line 0.300 m behind it" in each.reason]
    assert (answer.holds, len(said)) == (False, told)
    assert all(one.search is not None and not one.proof for one in said)


@pytest.mark.parametrize("looks", [pieces.LOOKS, 7])
def test_bounds_of_the_sideways_velocity_hold_however_few_looks_there_is_room_for(
    monkeypatch: pytest.MonkeyPatch, looks: int
) -> None:
    monkeypatch.setattr(pieces, "LOOKS", looks)
    rng = np.random.default_rng(0)
    times, q = np.cumsum(rng.uniform(0.05, 1.0, 30)), np.cumsum(rng.normal(0, 0.1, (30, 3)), axis=0)
    base, ahead = pieces.hermite(times, q, rng.normal(0, 0.1, (30, 3))), 0.15
    most, _, path = pieces.sideways(base, ahead, 1e-4)
    dense, total = np.zeros(29), 0.0
    for n in range(29):
        s = np.linspace(0, base.duration[n], 2001)
        at, rate, _ = base.at(np.full(len(s), n), s)
        across = -np.sin(at[:, 2]) * rate[:, 0] + np.cos(at[:, 2]) * rate[:, 1] + ahead * rate[:, 2]
        dense[n], total = np.abs(across).max(), total + np.trapezoid(np.abs(across), s)
    assert (most >= dense).all()
    assert path >= total - 1e-9
    if looks > 7:
        assert (most - dense).max() < 3e-4


def test_a_recorded_base_that_shakes_is_refused_in_little_memory(tmp_path: Path) -> None:
    motion, rng = opening(0.0005), np.random.default_rng(0)  # some 100 million looks would be demanded
    shaken = motion.base_v + rng.normal(0, 0.05, motion.base_v.shape)
    tracemalloc.start()
    verdict = judge(gantry_twin(tmp_path), replace(motion, base_v=shaken), Drive.DIFFERENTIAL)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert isinstance(verdict, Refused)
    assert peak < 1e9
