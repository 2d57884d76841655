"""A plane of MJCF or SDF is solid, and where it is the floor, robots stand on it."""

from pathlib import Path

import numpy as np
import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import JointType, ShapeType
from sdt_kg.scenes import read_scene
from tests.sdt_kg.scenes.writers import shapes_in_world

MJCF = """<mujoco><worldbody>{}<body name="cupboard" pos="1 0 0.5"><geom type="box" size="0.2 0.2 0.2"/>
</body></worldbody></mujoco>"""
SDF = """<sdf version="1.9"><world name="w"><model name="ground"><static>true</static><link name="link">{}
</link></model></world></sdf>"""


def mjcf(folder: Path, *planes: str) -> Path:
    """A scene with planes, of each its place."""
    (folder / "s.xml").write_text(
        MJCF.format("".join(f'<geom type="plane" size="1 1 1" {at}/>' for at in planes))
    )
    return folder / "s.xml"


def sdf(folder: Path, pose: str, normal: str) -> Path:
    written = f"<normal>{normal}</normal>" if normal else ""
    plane = f"<pose>{pose}</pose><geometry><plane>{written}<size>1 1</size></plane></geometry>"
    (folder / "s.sdf").write_text(SDF.format(f'<collision name="c">{plane}</collision>'))
    return folder / "s.sdf"


def behind(path: Path, point: tuple[float, float, float]) -> bool:
    """Whether a point is in the box of the scene that stands for a plane."""
    ((_, at, size),) = [one for one in shapes_in_world(read_scene(path), {}) if one[2] == (100.0, 100.0, 1.0)]
    seen = np.linalg.inv(at) @ (*point, 1.0)
    return bool((np.abs(seen[:3]) <= np.array(size) / 2).all())


LOOKS = [
    ('pos="0 0 0"', ((9, 9, -0.01), True), ((9, 9, 0.01), False)),
    ('pos="0 2 0" euler="90 0 0"', ((5, 2.01, 3), True), ((5, 1.99, 3), False)),
    ('pos="0 -2 0" euler="-90 0 0"', ((5, -2.01, 3), True), ((5, -1.99, 3), False)),
    ('pos="0 0 2.5" euler="180 0 0"', ((9, 9, 2.51), True), ((9, 9, 2.49), False)),
]


@pytest.mark.parametrize(("at", "one", "other"), LOOKS)
def test_what_is_behind_a_plane_is_solid(
    tmp_path: Path,
    at: str,
    one: tuple[tuple[float, float, float], bool],
    other: tuple[tuple[float, float, float], bool],
) -> None:
    path = mjcf(tmp_path, at)
    for point, solid in (one, other):
        assert behind(path, point) == solid


@pytest.mark.parametrize(
    ("pose", "normal", "inside", "outside"),
    [
        ("0 0 0 0 0 0", "", (9, 9, -0.01), (9, 9, 0.01)),
        ("0 2 0 0 0 0", "0 -3 0", (5, 2.01, 3), (5, 1.99, 3)),
        ("0 0 2.5 0 0 0", "0 0 -1", (9, 9, 2.51), (9, 9, 2.49)),
        ("1 0 0 0 0 1.5707963267948966", "0 1 0", (1.01, 5, 3), (0.99, 5, 3)),
    ],
)
def test_a_plane_of_sdf_has_a_normal_of_its_own(
    tmp_path: Path, pose: str, normal: str, inside: tuple[float, ...], outside: tuple[float, ...]
) -> None:
    path = sdf(tmp_path, pose, normal)
    (plane,) = (one for body in read_scene(path).bodies for one in body.collision)
    assert plane.shape is ShapeType.BOX
    for point, solid in ((inside, True), (outside, False)):
        assert behind(path, (point[0], point[1], point[2])) == solid


def test_a_plane_without_a_normal_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UrdfError, match="a plane with normal 0 0 0"):
        read_scene(sdf(tmp_path, "0 0 0 0 0 0", "0 0 0"))


@pytest.mark.parametrize(
    ("planes", "height"),
    [
        (('pos="0 0 -0.001"',), 0.0),
        (('pos="0 0 -0.8"',), 0.8),  # the scene's own root is at a worktop
        (('pos="0 0 -0.8"', 'pos="0 0 0"'), 0.0),  # a pit
        (('pos="0 0 0.3"',), 0.0),  # robots touch it, and are told so
        (('pos="0 2 -0.8" euler="90 0 0"',), 0.0),  # a wall
    ],
)
def test_robots_stand_where_the_floor_is(tmp_path: Path, planes: tuple[str, ...], height: float) -> None:
    scene = read_scene(mjcf(tmp_path, *planes))
    said = "the floor, a plane of 'world', is 0.8 m below the scene's z = 0: heights are from the floor"
    assert (said in scene.notes) == (height > 0)
    if height == 0:
        assert scene.root == "world"
        return
    (up,) = (each for each in scene.joints if each.child == "world")
    assert (up.parent, up.type) == (scene.root, JointType.FIXED)
    assert up.origin.position == pytest.approx((0.0, 0.0, height))
