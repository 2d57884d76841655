"""Errors that a certificate tolerates leave the motion certified; depths are those of deepest points."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import coal
import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from sdt_kg.annotation import Drive
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from services.embodiment.certify import Certified, Tolerances, certify
from services.embodiment.certify.sweep.depth import deepest
from services.physics.geometry.depth import faces, placed
from services.physics.geometry.shapes import hull
from tests.services.embodiment.gantry import FOLDER, RESTS, gantry_twin, opening
from tests.services.embodiment.judging import judge

pytestmark = pytest.mark.oracle

NEARLY = 0.98
DIAGONAL = np.array((1.0, 1.0, 1.0)) / np.sqrt(3)


@pytest.fixture(scope="module")
def figures(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[float, str]]:
    verdict = judge(gantry_twin(tmp_path_factory.mktemp("gantry")), opening())
    assert isinstance(verdict, Certified)
    return verdict.figures


@pytest.mark.parametrize("way", [(0, 0, 1.0), (0, 0, -1.0), (1.0, 0, 0), (0, -1.0, 0), DIAGONAL, -DIAGONAL])
def test_a_handle_elsewhere_by_what_is_tolerated_is_held(
    tmp_path: Path, figures: dict[str, tuple[float, str]], way: tuple[float, float, float]
) -> None:
    error, unit = figures["handle error tolerated"]
    assert unit == "m"
    assert error > 0.0005
    x, y, z = (np.array((-0.295, 0.0, 0.0)) + NEARLY * error * np.array(way)).tolist()
    cell = (FOLDER / "cell.urdf").read_text().replace('xyz="-0.295 0 0"', f'xyz="{x!r} {y!r} {z!r}"')
    (tmp_path / "cell.urdf").write_text(cell)
    verdict = judge(load_twin(tmp_path / "cell.urdf", [FOLDER / "gantry.urdf"]), opening())
    assert isinstance(verdict, Certified), verdict.diagnoses


@pytest.mark.parametrize(
    ("x", "y", "yaw"), [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0.6, -0.8, 0), (0, 0, 1), (0, 0, -1)]
)
def test_a_base_elsewhere_by_what_is_tolerated_still_opens(
    tmp_path: Path, figures: dict[str, tuple[float, str]], x: float, y: float, yaw: float
) -> None:
    shift, turn = figures["base error tolerated"][0], figures["base turn tolerated"][0]
    assert shift > 0.0005
    assert turn > 0.0001
    motion = opening()
    error = NEARLY * np.array((x * shift, y * shift, yaw * turn))
    verdict = judge(gantry_twin(tmp_path), replace(motion, base=motion.base + error), start=None)
    assert isinstance(verdict, Certified), verdict.diagnoses


@pytest.mark.parametrize("up", [1.0, -1.0])
def test_a_handle_of_many_small_triangles_is_no_deeper_in_a_finger_where_it_is_elsewhere(
    tmp_path: Path, up: float
) -> None:
    radius, deep = 0.012, 0.0005
    trimesh.creation.icosphere(subdivisions=4, radius=radius).export(tmp_path / "knob.stl")
    text = (FOLDER / "cell.urdf").read_text()
    bar = text[text.index('<link name="drawer_handle">') : text.index('<joint name="drawer_handle_joint"')]
    knob = '<collision><geometry><mesh filename="knob.stl"/></geometry></collision></link>'
    text = text.replace(bar, f'<link name="drawer_handle">{knob}')
    rests = RESTS.copy()
    rests[3:, 7] = radius - deep
    error = 0.0
    for _ in range(2):
        at = f'xyz="-0.295 0 {up * NEARLY * error!r}"'
        (tmp_path / "cell.urdf").write_text(text.replace('xyz="-0.295 0 0"', at))
        verdict = judge(load_twin(tmp_path / "cell.urdf", [FOLDER / "gantry.urdf"]), opening(rests=rests))
        assert isinstance(verdict, Certified), verdict.diagnoses
        error = error or verdict.figures["handle error tolerated"][0]
    assert 0.0004 < error < 0.002 - deep


def test_a_base_on_wheels_that_is_turned_by_what_is_tolerated_still_rolls_ahead(tmp_path: Path) -> None:
    twin, motion, aslant = gantry_twin(tmp_path), opening(), np.array((0.0, 0.0, 0.012))
    motion = replace(motion, base=motion.base + aslant)
    verdict = judge(twin, motion, Drive.DIFFERENTIAL, start=None)
    assert isinstance(verdict, Certified), verdict.diagnoses
    turn = NEARLY * verdict.figures["base turn tolerated"][0]
    assert turn > 0
    for error in (turn, -turn):
        turned = replace(motion, base=motion.base + np.array((0.0, 0.0, error)))
        verdict = judge(twin, turned, Drive.DIFFERENTIAL, start=None)
        assert isinstance(verdict, Certified), verdict.diagnoses


HINGE = np.array((1.255, 0.35))
DOOR = """<link name="door"><collision><origin xyz="0 -0.35 0"/>
<geometry><box size="0.02 0.4 0.2"/></geometry></collision></link>
<joint name="door_joint" type="revolute"><parent link="world"/><child link="door"/>
<origin xyz="1.255 0.35 0.5"/><axis xyz="0 0 -1"/>
<limit lower="0" upper="1.5" velocity="1" effort="9"/></joint>
<link name="door_handle"><collision><geometry><box size="0.01 0.2 0.01"/></geometry></collision></link>
<joint name="door_handle_joint" type="fixed"><parent link="door"/><child link="door_handle"/>
<origin xyz="-0.05 -0.35 0"/></joint></robot>"""
ANGLE, SWING = 1.4, 20.0  # [rad] of the door, in so many seconds


def swinging(drift: float) -> BodyMotion:
    """The base drives about the door's hinge, which is in hand; then the hand leaves, at first by so much."""
    before = opening(rests=RESTS[:4])
    part = np.linspace(0.0, 1.0, 400)[1:]
    angle, rate = ANGLE * (3 * part**2 - 2 * part**3), ANGLE * (6 * part - 6 * part**2) / SWING
    arm = before.base[-1, :2] - HINGE
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = arm[0] * cos + arm[1] * sin, arm[1] * cos - arm[0] * sin
    base = np.column_stack((HINGE[0] + x, HINGE[1] + y, -angle))
    base_v = rate[:, None] * np.column_stack((y, -x, -np.ones_like(x)))
    back = -np.array((cos[-1], -sin[-1], 0.0))
    base = np.vstack((before.base, base, base[-1] + drift * back, base[-1] + (drift + 0.1) * back))
    base_v = np.vstack((before.base_v, base_v, np.zeros((2, 3))))
    q = np.tile(before.q[-1], (len(base), 1))
    q[: len(before.q)], q[-2:, 3], v = before.q, 0.03, np.zeros_like(q)
    v[: len(before.q)] = before.v
    kitchen_q, kitchen_v = np.zeros((2, len(base), 1))
    kitchen_q[len(before.q) :, 0] = np.append(angle, [ANGLE, ANGLE])
    kitchen_v[len(before.q) : -2, 0] = rate
    end = before.times[-1]
    times = np.concatenate((before.times, end + SWING * part, end + SWING + np.array((4.0, 8.0))))
    joints = before.joints, times, base, q, v, base_v
    return BodyMotion(before.robot, "hand", *joints, (joint_iri("cell", "door_joint"),), kitchen_q, kitchen_v)


@pytest.mark.parametrize("drift", [0.0, 0.0015])
def test_a_hand_that_leaves_a_door_has_let_it_go_where_the_base_is_elsewhere_too(
    tmp_path: Path, drift: float
) -> None:
    text = (FOLDER / "cell.urdf").read_text()
    cell = text[: text.index('<link name="cabinet">')] + DOOR
    (tmp_path / "cell.urdf").write_text(cell)
    twin, motion = load_twin(tmp_path / "cell.urdf", [FOLDER / "gantry.urdf"]), swinging(drift)
    about = twin.container("door"), Tolerances()
    verdict = certify(twin, twin.robots[0], motion, *about, drive=Drive.OMNI)
    assert isinstance(verdict, Certified), verdict.diagnoses
    error = NEARLY * verdict.figures["base error tolerated"][0]
    assert error > 1e-4
    for way in np.linspace(0, 2 * np.pi, 8, endpoint=False):
        shift = error * np.array((np.cos(way), np.sin(way), 0.0))
        shifted = replace(motion, base=motion.base + shift)
        verdict = certify(twin, twin.robots[0], shifted, *about, drive=Drive.OMNI)
        assert isinstance(verdict, Certified), verdict.diagnoses


def depth(one: coal.CollisionGeometry, other: coal.CollisionGeometry, offset: Sequence[float]) -> float:
    polyhedra = [faces(one), faces(other)]
    assert polyhedra[0] is not None
    assert polyhedra[1] is not None
    at = placed(polyhedra[1], np.eye(3), np.array(offset))
    return deepest(polyhedra[0], at)


def test_depth_is_that_of_the_deepest_point() -> None:
    cube, rod, plate = coal.Box(0.2, 0.2, 0.2), coal.Box(0.01, 0.01, 1.0), coal.Box(1.0, 1.0, 0.03)
    assert depth(cube, cube, (0.193, 0, 0)) == pytest.approx(0.007, abs=1e-9)  # face into face
    assert depth(cube, cube, (0.201, 0, 0)) == 0.0
    assert depth(plate, rod, (0.1, 0, 0)) == pytest.approx(
        0.015, abs=1e-9
    )  # a rod through a plate: half of it
    assert depth(cube, rod, (0, 0, 0.58)) == pytest.approx(0.02, abs=1e-9)  # its end, 20 mm in
    assert depth(cube, coal.Sphere(0.05), (0.14, 0, 0)) == pytest.approx(0.01, abs=5e-4)
    assert depth(cube, coal.Cylinder(0.05, 0.4), (0.14, 0, 0)) == pytest.approx(0.01, abs=1e-4)


def test_depth_of_what_is_round_is_right_to_a_fifth_of_a_millimetre_whatever_its_size() -> None:
    # A ball's deepest point in another ball is its point nearest to that one's centre.
    ball, aslant = coal.Sphere(0.3), (0.23, -0.31, 0.11)
    assert depth(ball, ball, aslant) == pytest.approx(0.6 - np.linalg.norm(aslant), abs=2e-4)
    # A capsule leans by 45° over the middle of a block whose upper face is at z = 0.
    block, capsule = faces(coal.Box(4.0, 4.0, 4.0)), faces(coal.Capsule(0.3, 0.3))
    leaning = Rotation.from_euler("x", 45, degrees=True).as_matrix()
    found = deepest(
        placed(capsule, leaning, np.array((0, 0, 0.2))), placed(block, np.eye(3), np.array((0, 0, -2.0)))
    )
    assert found == pytest.approx(0.3 + 0.15 * np.sqrt(0.5) - 0.2, abs=2e-4)


def test_the_faces_of_a_hull_hold_all_its_points_and_meet_three_each() -> None:
    points = np.random.default_rng(0).normal(size=(60, 3))
    found = faces(hull(points))
    beyond = points @ found.normals.T - found.offsets
    assert beyond.max() <= 1e-12
    assert (np.count_nonzero(beyond > -1e-12, axis=0) >= 3).all()
    expected = ConvexHull(points).equations
    ours = np.column_stack((found.normals, -found.offsets))
    assert np.abs(ours[:, None] - expected).max(axis=2).min(axis=0).max() < 1e-9
