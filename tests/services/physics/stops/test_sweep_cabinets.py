"""Φ stops a drawer or door at what is beside it in its own cabinet, but for its rails and its hinge."""

import math
import re
from pathlib import Path

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pytest

from services.physics.geometry.pieces import Piece, beyond
from services.physics.geometry.shapes import Triangles, corners
from tests.services.physics.stops.test_sweep_rooms import asked, load_twin, shape


def link(name: str, *shapes: str) -> str:
    return f'<link name="{name}">{"".join(shapes)}</link>'


def fixed(parent: str, child: str, at: str = "0 0 0", turned: str = "0 0 0") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{at}" rpy="{turned}"/>'
    return f'<joint name="{child}_joint" type="fixed">{ends}</joint>'


def moved(  # noqa: PLR0917
    parent: str, child: str, kind: str, axis: str, upper: float, more: str = ""
) -> str:
    """A joint at the parent's frame, or where `more` has its origin."""
    ends = f'<parent link="{parent}"/><child link="{child}"/><axis xyz="{axis}"/>'
    limit = f'<limit lower="0" upper="{upper}" velocity="1" effort="9"/>'
    return f'<joint name="{child}_joint" type="{kind}">{ends}{limit}{more}</joint>'


def turned(box: str, yaw: float) -> str:
    """A shape as one sees it in a frame that is turned by -yaw about the vertical."""
    if not yaw:
        return box
    origin = box.split('"', maxsplit=2)[1]
    x, y, z = map(float, origin.split())
    c, s = math.cos(yaw), math.sin(yaw)
    return box.replace(f'xyz="{origin}"', f'xyz="{c * x - s * y} {s * x + c * y} {z}" rpy="0 0 {yaw}"', 1)


SIDES = shape("0.5 0.02 0.3", "-0.25 0.263 0"), shape("0.5 0.02 0.3", "-0.25 -0.263 0")
DRAWER = (
    shape("0.02 0.5 0.25", "-0.01 0 0"),  # front
    shape("0.45 0.48 0.015", "-0.225 0 -0.1175"),
    shape("0.015 0.48 0.16", "-0.435 0 -0.03"),  # back
    *(shape("0.45 0.015 0.16", f"-0.225 {y} -0.03") for y in (0.23, -0.23)),
)
HANDLE = link("bar_handle", shape("0.01 0.2 0.01", "0.04 0 0"))
PIPE = shape("0.05 0.05 0.2", "-0.15 0 0.06")  # it stands in the open drawer


def drawer(inner: tuple[str, ...] = (), room: tuple[str, ...] = (), yaw: float = 0.0) -> str:
    """A hollow drawer that slides 0.35 m along +x, turned by yaw, in a cabinet of two sides."""
    cabinet, own = ((turned(each, yaw) for each in all_) for all_ in ((*SIDES, *inner), DRAWER))
    parts = (
        link("room", *room) + link("cabinet", *cabinet) + link("drawer", *own) + HANDLE,
        fixed("room", "cabinet") + fixed("drawer", "bar_handle", turned=f"0 0 {yaw}"),
        moved("cabinet", "drawer", "prismatic", f"{math.cos(yaw)} {math.sin(yaw)} 0", 0.35),
    )
    return "".join(parts)


def opens(tmp_path: Path, parts: str, name: str) -> bool:
    (tmp_path / "post.urdf").write_text(f'<robot name="post">{parts}</robot>')
    answer = asked(load_twin(tmp_path / "post.urdf"), name)
    reasons = [each.reason for each in answer.diagnoses]
    assert answer.holds or any("runs into" in each for each in reasons), reasons
    for depth, allowed in re.findall(r": ([\d.]+) mm deep at .*, ([\d.]+) mm allowed", " ".join(reasons)):
        assert float(depth) > float(allowed), reasons
    return answer.holds


SLANTED = shape("0.7 0.02 0.03", "0.25 0.12 -0.105").replace("/>", ' rpy="0 0 -0.52"/>', 1)


@pytest.mark.parametrize(
    ("inner", "free"),
    [
        ((), True),
        ((PIPE,), False),
        ((shape("0.4 0.02 0.02", "-0.25 0.243 0"),), True),  # a rail
        ((SLANTED,), False),  # from beside the drawer to before it
        ((shape("0.05 0.05 0.3", "-0.15 0 0.039"),), False),  # a pipe, 1 mm in the drawer's floor
        ((shape("0.05 0.05 0.3", "-0.15 0 0.0375"),), False),
        ((shape("0.05 0.05 0.2", "-0.4065 0 0.06"),), False),  # 4 mm in its back
        ((shape("0.2 0.05 0.2", "-0.1165 0 0.06"),), False),  # 3.5 mm in its front, which leaves it
        ((shape("0.05 0.05 0.3", "-0.15 0 0.03"),), False),  # 10 mm in its floor, in which it slides
        ((shape("0.02 0.455 0.02", "-0.15 0 0"),), False),  # a bar, 5 mm in both its sides
        ((shape("0.02 0.5 0.3", "-0.15 0 0"),), True),  # a board, through which its sides and floor go
        ((shape("0.4 0.02 0.3", "-0.2 0.2 -0.26"),), True),  # the drawer's floor slides in it
    ],
    ids=[
        *("nothing", "pipe", "rail", "slanted", "pipe 1 mm in", "pipe 2.5 mm in"),
        *("pipe in its back", "pipe in its front", "pipe in its floor", "bar", "board", "guide"),
    ],
)
def test_a_drawer_is_stopped_by_its_own_cabinet_beyond_its_rails(
    tmp_path: Path, inner: tuple[str, ...], free: bool
) -> None:
    assert opens(tmp_path, drawer(inner), "drawer") is free


@pytest.mark.parametrize(
    "back",
    [
        'xyz="-0.42 0 0" rpy="1.5708 0 0"/><geometry><cylinder radius="0.02" length="0.46"/></geometry>',
        'xyz="-0.4 0 0.01"/><geometry><sphere radius="0.12"/></geometry>',
    ],
    ids=["rod", "ball"],
)
def test_a_pipe_stops_what_is_round_too(tmp_path: Path, back: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{__name__}.DRAWER", (*DRAWER[:2], f"<collision><origin {back}</collision>"))
    assert opens(tmp_path, drawer(), "drawer")
    assert not opens(tmp_path, drawer((PIPE,)), "drawer")


@pytest.mark.parametrize("deep", [-0.01, 0.003], ids=["clear of its back", "3 mm in its back"])
def test_a_pipe_of_a_room_stops_a_drawer_whether_or_not_the_rooms_wall_is_drawn_into_it(
    tmp_path: Path, deep: float
) -> None:
    wall = shape("0.1 4 2", f"{-0.4425 + deep - 0.05} 0 0")
    assert not opens(tmp_path, drawer(room=(PIPE, wall)), "drawer")
    assert opens(tmp_path, drawer(room=(wall,)), "drawer")
    around = shape("0.1 2 2", "-1 0 0"), shape("2 2 0.1", "0 0 -1"), wall  # about the drawer
    in_its_back = shape("0.05 0.05 0.2", "-0.4065 0 0.06")
    assert not opens(tmp_path, drawer(room=(in_its_back, *around)), "drawer")


ACROSS = shape("1.1 0.02 0.1", "-0.1 0.155 0")
"""A board of the cabinet beside a sliding door, or aslant from beside it to across its way."""


@pytest.mark.parametrize(("slant", "free"), [(0.0, True), (0.33, False)])
def test_a_thin_door_does_not_slide_through_what_is_aslant_beside_it(
    tmp_path: Path, slant: float, free: bool
) -> None:
    parts = (
        link("cabinet", ACROSS.replace("/>", f' rpy="0 0 {slant}"/>', 1))
        + link("door", shape("0.5 0.02 0.6", "-0.25 0.13 0"))
        + HANDLE,
        moved("cabinet", "door", "prismatic", "1 0 0", 0.4) + fixed("door", "bar_handle", "-0.3 0.08 0"),
    )
    assert opens(tmp_path, "".join(parts), "door") is free


@pytest.mark.parametrize(("inner", "free"), [((), True), ((shape("0.05 0.05 0.3", "-0.4065 0 0"),), False)])
def test_a_low_drawer_does_not_slide_through_a_pipe_that_is_drawn_into_it(
    tmp_path: Path, inner: tuple[str, ...], free: bool
) -> None:
    low = shape("0.02 0.5 0.09", "-0.01 0 0"), shape("0.015 0.48 0.06", "-0.435 0 0")
    parts = (
        link("cabinet", *SIDES, *inner) + link("drawer", *low) + HANDLE,
        moved("cabinet", "drawer", "prismatic", "1 0 0", 0.35) + fixed("drawer", "bar_handle"),
    )
    assert opens(tmp_path, "".join(parts), "drawer") is free


@pytest.mark.parametrize("yaw", [0.0, 0.7])
@pytest.mark.parametrize(("inner", "free"), [((), True), ((shape("0.02 0.5 0.03", "0.15 0 -0.1"),), False)])
def test_a_board_before_a_drawer_stops_it_however_its_frame_is_turned(
    tmp_path: Path, yaw: float, inner: tuple[str, ...], free: bool
) -> None:
    assert opens(tmp_path, drawer(inner, yaw=yaw), "drawer") is free


@pytest.mark.parametrize("short", [0.2, 0.45])
@pytest.mark.parametrize(("shelf", "free"), [((), True), ((-0.213,), False)], ids=["free", "shelf"])
def test_the_short_side_of_a_pivot_door_does_not_turn_through_a_shelf(
    tmp_path: Path, short: float, shelf: tuple[float, ...], free: bool
) -> None:
    """The door lies in x = 0, its hinge `short` from one end and 0.45 m from the other."""
    door = shape(f"0.02 {short + 0.45} 0.5", f"0 {(short - 0.45) / 2} 0")
    shelves = (shape("0.4 0.15 0.1", f"{x} {short - 0.08} 0.1") for x in shelf)
    parts = (
        link("cabinet", shape("0.02 1.2 0.5", "-0.6 0 0"), *shelves) + link("door", door) + HANDLE,
        moved("cabinet", "door", "revolute", "0 0 1", 1.5) + fixed("door", "bar_handle", "0 -0.4 0"),
    )
    assert opens(tmp_path, "".join(parts), "door") is free


@pytest.mark.parametrize(("multiplier", "free"), [(1.5, True), (2.5, False)])
def test_a_folding_leaf_does_not_turn_through_the_leaf_that_carries_it(
    tmp_path: Path, multiplier: float, free: bool
) -> None:
    follows = f'<origin xyz="-0.02 -0.3 0"/><mimic joint="door_joint" multiplier="{multiplier}"/>'
    parts = (
        link("cabinet", shape("0.02 1 0.5", "-0.7 0 0")),
        link("door", shape("0.02 0.294 0.5", "-0.01 -0.15 0")),
        link("leaf", shape("0.02 0.294 0.5", "0.01 -0.15 0")) + HANDLE,
        moved("cabinet", "door", "revolute", "0 0 1", 1.5),
        moved("door", "leaf", "revolute", "0 0 -1", 5.0, follows),
        fixed("door", "bar_handle", "0 -0.25 0"),
    )
    assert opens(tmp_path, "".join(parts), "door") is free


@pytest.mark.parametrize("sunk", ["0", "-0.5"])
def test_a_bin_below_the_floor_lets_nothing_else_through_it(tmp_path: Path, sunk: str) -> None:
    lift = shape("0.3 0.3 0.5", "0 0 0.26")
    parts = (
        link("room")
        + link("lift_drawer", lift)
        + link("bin_drawer", shape("0.2 0.2 0.2", f"3 0 {float(sunk) + 0.1}")),
        HANDLE
        + moved("room", "lift_drawer", "prismatic", "0 0 -1", 0.3)
        + fixed("lift_drawer", "bar_handle", "0.15 0 0.3"),
        moved("room", "bin_drawer", "prismatic", "1 0 0", 0.3),
        link("bin_handle", shape("0.01 0.1 0.01", "3.14 0 0.1")) + fixed("bin_drawer", "bin_handle"),
    )
    assert not opens(tmp_path, "".join(parts), "lift_drawer")
    assert opens(tmp_path, "".join(parts), "bin_drawer")


def test_of_triangles_what_is_beyond_a_plane_is_cut_off_at_it() -> None:
    # Two triangles of a square of 2 m, cut at x = 0.5: 1.5 m by 2 m are left.
    square = [[(0, 0, 0), (2, 0, 0), (2, 2, 0)], [(0, 0, 0), (2, 2, 0), (0, 2, 0)]]
    points = np.array(square, float)
    mesh = Triangles(points.reshape(-1, 3), np.arange(6).reshape(2, 3))
    part = beyond(Piece(points.min((0, 1)), points.max((0, 1)), lambda: mesh), np.array([1.0, 0, 0]), 0.5)
    assert part is not None
    left = corners(part.shape)
    assert np.linalg.norm(np.cross(left[:, 1] - left[:, 0], left[:, 2] - left[:, 0]), axis=1).sum() / 2 == 3.0
    assert left[:, :, 0].min() == 0.5


@pytest.mark.parametrize(
    ("shape_", "high"),
    [(coal.Cylinder(0.02, 0.4), 0.2), (coal.Capsule(0.02, 0.4), 0.22), (coal.Sphere(0.2), 0.2)],
)
def test_of_what_is_round_what_is_beyond_a_plane_is_cut_off_at_it(
    shape_: coal.ShapeBase, high: float
) -> None:
    box = shape_.computeLocalAABB() or shape_.aabb_local
    piece = Piece(box.min_.copy(), box.max_.copy(), lambda: shape_)
    part = beyond(piece, np.array([0.0, 0, 1]), 0.1)
    assert part is not None
    np.testing.assert_allclose((part.low[2], part.high[2]), (0.1, high), atol=1e-9)
    assert beyond(piece, np.array([0.0, 0, 1]), 0.3) is None
    assert beyond(piece, np.array([0.0, 0, 1]), -0.3) is piece
