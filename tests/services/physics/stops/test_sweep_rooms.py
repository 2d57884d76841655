"""Φ stops a container at the floor, and at what belongs to the body that it hangs on but does not bear it."""

from pathlib import Path

import pytest

from predicates.case import Answer, Case
from predicates.causes import causes
from sdt_kg.load import load_twin
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.edits import parse_edit
from services.physics.oracle import Kinematics

PHYSICS = Kinematics()

FLAP = """<robot name="post"><link name="world"/><link name="door">{panel}</link>
<link name="door_handle"><collision><origin xyz="0.04 0 0.5"/><geometry><box size="0.01 0.2 0.01"/></geometry>
</collision></link><joint name="door_joint" type="revolute"><parent link="world"/><child link="door"/>
<origin xyz="0 0 {high}"/><axis xyz="0 1 0"/><limit lower="0" upper="2.6" velocity="1" effort="1"/></joint>
<joint name="handle_joint" type="fixed"><parent link="door"/><child link="door_handle"/></joint></robot>"""


def asked(twin: Twin, name: str) -> Answer:
    (answer,) = causes(Case(twin, task=Task(Verb.OPEN, twin.container(name).iri)), PHYSICS)
    return answer


@pytest.mark.parametrize(("high", "free"), [(0.3, False), (0.6, True), (-0.5, True)])
def test_a_flap_does_not_turn_through_the_floor(tmp_path: Path, high: float, free: bool) -> None:
    # At 2.35 rad its edge is 0.39 m below its hinge; a kitchen whose floor is elsewhere is as it was drawn.
    panel = '<collision><origin xyz="0 0 0.28"/><geometry><box size="0.02 0.6 0.55"/></geometry></collision>'
    (tmp_path / "post.urdf").write_text(FLAP.format(panel=panel, high=high))
    answer = asked(load_twin(tmp_path / "post.urdf"), "door")
    assert answer.holds is free
    assert free or any("runs into floor" in each.reason for each in answer.diagnoses)


ROOM = """<robot name="post"><link name="room">{panels}{obstacle}</link>
<link name="drawer"><collision><geometry><box size="0.4 0.58 0.2"/></geometry></collision></link>
<link name="drawer_handle"><collision><geometry><box size="0.01 0.2 0.01"/></geometry></collision></link>
<joint name="drawer_joint" type="prismatic"><parent link="room"/><child link="drawer"/><axis xyz="1 0 0"/>
<limit lower="0" upper="0.4" velocity="1" effort="1"/></joint>
<joint name="handle_joint" type="fixed"><parent link="drawer"/><child link="drawer_handle"/>
<origin xyz="0.25 0 {high}"/></joint></robot>"""


def shape(size: str, at: str) -> str:
    return f'<collision><origin xyz="{at}"/><geometry><box size="{size}"/></geometry></collision>'


PANELS = (
    shape("0.5 0.02 0.3", "0 0.31 0")
    + shape("0.02 0.64 0.3", "-0.25 0 0")
    + shape("0.4 0.04 0.02", "0 0.28 0")
)


@pytest.mark.parametrize(
    ("obstacle", "free"),
    [
        ("", True),
        (shape("0.1 2 0.1", "0.6 0 0"), False),  # a wall beyond
        (shape("0.1 2 0.1", "0.25 0 0"), False),  # a board that touches the front
        (shape("0.1 2 0.1", "0.75 0 0"), True),
        (shape("0.4 0.02 0.02", "0.05 -0.28 0"), True),  # a rail inside
    ],
    ids=["nothing", "wall", "board", "far", "rail"],
)
def test_a_drawer_of_a_room_that_is_one_body_does_not_pass_its_walls(
    tmp_path: Path, obstacle: str, free: bool
) -> None:
    (tmp_path / "post.urdf").write_text(ROOM.format(panels=PANELS, obstacle=obstacle, high=0.13))
    assert asked(load_twin(tmp_path / "post.urdf"), "drawer").holds is free


@pytest.mark.parametrize("deep", [-0.002, 0.002])
def test_a_crate_that_leans_on_a_front_stops_it_though_both_hang_on_the_same_body(
    tmp_path: Path, deep: float
) -> None:
    urdf = ROOM.format(panels="", obstacle="", high=0.13)
    crate = f'<link name="crate">{shape("0.4 0.3 0.3", f"{0.4 - deep} 0 0")}</link>'
    crate += '<joint name="crate_joint" type="fixed"><parent link="room"/><child link="crate"/></joint>'
    (tmp_path / "post.urdf").write_text(urdf.replace("</robot>", f"{crate}</robot>"))
    assert not asked(load_twin(tmp_path / "post.urdf"), "drawer").holds


def test_a_wall_beside_a_door_stops_it_though_a_room_that_bears_its_cabinet_has_both_inside(
    tmp_path: Path,
) -> None:
    walls = shape("0.1 0.1 1.0", "0.05 -0.305 0") + shape("0.1 4 4", "-2 0 0") + shape("0.1 4 4", "2 0 0")
    door = FLAP.format(panel=shape("0.02 0.5 0.5", "0 0.25 0"), high=0.0)
    door = door.replace('xyz="0 0 0.0"', 'xyz="0 -0.25 0"').replace('xyz="0 1 0"', 'xyz="0 0 -1"')
    door = door.replace('<parent link="world"/>', '<parent link="cabinet"/>').replace(
        "0.04 0 0.5", "0.04 0.4 0"
    )
    room = f'<link name="world">{walls}</link><link name="cabinet"/><joint name="on" type="fixed">'
    room += '<parent link="world"/><child link="cabinet"/></joint>'
    (tmp_path / "post.urdf").write_text(door.replace('<link name="world"/>', room))
    assert not asked(load_twin(tmp_path / "post.urdf"), "door").holds


CAPS = ((0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4))


def angle(file: Path, ends: tuple[float, float, float], heights: tuple[float, float, float]) -> str:
    """A mesh of a floor along x and a wall at its end, 1 m wide, as one surface; its collision element."""
    (x0, x1, x2), (z0, z1, z2) = ends, heights
    profile = (x0, z0), (x2, z0), (x2, z2), (x1, z2), (x1, z1), (x0, z1)
    points = [(x, y, z) for y in (-0.5, 0.5) for x, z in profile]
    faces = [(a, b, c) for a, b, c in CAPS] + [(c + 6, b + 6, a + 6) for a, b, c in CAPS]
    for k in range(6):
        n = (k + 1) % 6
        faces += [(n, k, k + 6), (n, k + 6, n + 6)]
    lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    file.write_text("\n".join(lines) + "\n")
    return f'<collision><geometry><mesh filename="{file.name}"/></geometry></collision>'


@pytest.mark.parametrize(("wall", "free"), [(0.6, False), (0.7, True)])
def test_a_drawer_of_a_room_that_is_one_mesh_does_not_pass_its_walls(
    tmp_path: Path, wall: float, free: bool
) -> None:
    # A box about the mesh has the drawer inside: all of it counted as the drawer's own cabinet.
    room = angle(tmp_path / "room.obj", (-0.5, wall, 0.8), (-0.4, -0.11, 0.5))
    (tmp_path / "post.urdf").write_text(ROOM.format(panels=room, obstacle="", high=0.0))
    assert asked(load_twin(tmp_path / "post.urdf"), "drawer").holds is free


def bent_drawer(tmp_path: Path, other: str, joints: tuple[tuple[str, str], ...], high: float = 0.0) -> str:
    """A drawer that is one bent mesh, 0.4 m long, and another one of link `shelf`."""
    drawer = angle(tmp_path / "drawer.obj", (-0.2, 0.18, 0.2), (-0.1101, -0.1, 0.1))
    urdf = ROOM.format(panels="", obstacle="", high=0.0).replace("0.25 0 0.0", f"0.1 0 {high}")
    urdf = urdf.replace('<collision><geometry><box size="0.4 0.58 0.2"/></geometry></collision>', drawer)
    links = f'<link name="between"/><link name="shelf">{other}</link>'
    for parent, child in joints:
        links += (
            f'<joint name="at_{child}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'
        )
    return urdf.replace("</robot>", f"{links}</robot>")


APART = ("room", "between"), ("between", "shelf")
MOUNTED = ("room", "between"), ("room", "shelf")


@pytest.mark.parametrize(("wall", "free"), [(0.5, False), (0.7, True)])
def test_a_bent_drawer_that_lies_on_a_bent_shelf_stops_at_the_wall_behind_it(
    tmp_path: Path, wall: float, free: bool
) -> None:
    # Where triangles touch at rest they do not tell how deep they are; of what is elsewhere they do.
    shelf = angle(tmp_path / "shelf.obj", (-0.5, wall, 0.8), (-0.4, -0.11, 0.5))
    (tmp_path / "post.urdf").write_text(bent_drawer(tmp_path, shelf, APART))
    assert asked(load_twin(tmp_path / "post.urdf"), "drawer").holds is free


@pytest.mark.parametrize("joints", [APART, MOUNTED])
@pytest.mark.parametrize("gap", [-0.0005, 0.0005])
def test_a_bent_drawer_stops_at_a_bent_panel_before_it_whether_or_not_both_touch(
    tmp_path: Path, gap: float, joints: tuple[tuple[str, str], ...]
) -> None:
    panel = angle(tmp_path / "panel.obj", (0.2 + gap, 0.23, 0.245), (-0.1, -0.09, 0.1))
    (tmp_path / "post.urdf").write_text(bent_drawer(tmp_path, panel, joints, high=0.3))
    assert not asked(load_twin(tmp_path / "post.urdf"), "drawer").holds


@pytest.mark.parametrize(("wall", "free"), [(shape("0.3 0.05 1", "0.15 -0.28 0"), False), ("", True)])
def test_a_wall_at_the_hinge_of_the_body_that_a_door_hangs_on_stops_it(
    tmp_path: Path, wall: str, free: bool
) -> None:
    # 5 mm beside the door, it is its cabinet's panel as far as its edge goes; at 90° its face
    # meets it, nearer than the bar.
    door = FLAP.format(panel=shape("0.02 0.5 0.5", "0 0.25 0"), high=0.0)
    door = door.replace('xyz="0 0 0.0"', 'xyz="0 -0.25 0"').replace('xyz="0 1 0"', 'xyz="0 0 -1"')
    door = door.replace("0.04 0 0.5", "0 0.45 0.26").replace(
        '<link name="world"/>', f'<link name="world">{wall}</link>'
    )
    (tmp_path / "post.urdf").write_text(door)
    assert asked(load_twin(tmp_path / "post.urdf"), "door").holds is free


@pytest.mark.parametrize("into", [0.0, 0.009, 0.019])
@pytest.mark.parametrize("put", [True, False])
def test_a_board_that_was_put_before_a_drawer_stops_it_however_deep_it_was_put_in_its_front(
    tmp_path: Path, into: float, put: bool
) -> None:
    # Drawn with the kitchen, twice the depth is meant, but nothing goes right through what is ahead of it.
    front = FRONT.replace("{more}", "" if put else BOARD.format(at=0.02 - into))
    (tmp_path / "front.urdf").write_text(front)
    twin = load_twin(tmp_path / "front.urdf")
    twin = parse_edit(twin, f"box:board=0.02,0.2,0.1@{0.02 - into},0,0.5").applied(twin) if put else twin
    assert not asked(twin, "drawer").holds


@pytest.mark.parametrize("into", [0.0, 0.009, 0.019])
@pytest.mark.parametrize(("edit", "root"), [("furniture:board={},0", -2), ("pose:board_joint={},0,0.5", 0)])
def test_a_board_that_an_edit_moves_before_a_drawer_stops_it_and_moved_back_it_is_as_it_was_drawn(
    tmp_path: Path, into: float, edit: str, root: int
) -> None:
    # Furniture is moved from where it is, 2 m behind; poses are in the root's frame.
    (tmp_path / "front.urdf").write_text(FRONT.replace("{more}", BOARD.format(at=-2)))
    twin = load_twin(tmp_path / "front.urdf")
    assert asked(twin, "drawer").holds
    put = parse_edit(twin, edit.format(0.02 - into - root))
    origin = twin.mechanism(twin.environment).joint("board_joint").origin
    assert put.applied(twin).drawn_at == {"board_joint": origin}
    assert not asked(put.applied(twin), "drawer").holds
    undone = put.inverse(twin).applied(put.applied(twin))
    assert undone.drawn_at == twin.drawn_at == {}


@pytest.mark.parametrize("by", ["0,0,0.000001", "-0.002,0"])
@pytest.mark.parametrize("door", ["iai_fridge_door", "oven_area_oven_door", "fridge_area_lower_drawer_main"])
def test_what_was_drawn_into_its_neighbour_opens_when_it_is_moved_a_little(by: str, door: str) -> None:
    # Doors of kitchen b are drawn up to 11 mm into the furniture beside theirs: that much they are allowed.
    twin = load_twin("b")
    assert asked(parse_edit(twin, f"furniture:{door}={by}").applied(twin), door).holds


@pytest.mark.parametrize("edit", ["furniture:cabinet=0.1,0", "pose:cabinet_joint=0.1,0,0"])
def test_a_cabinet_that_is_moved_takes_what_was_fitted_into_it_along(tmp_path: Path, edit: str) -> None:
    # The front is drawn 8 mm into the cabinet's rail, which reaches 40 mm over its lower edge, moved or not.
    bar = f'<link name="cabinet">{shape("0.4 0.2 0.1", "0.202 0 0.39")}</link>'
    joint = '<joint name="cabinet_joint" type="fixed"><parent link="world"/><child link="cabinet"/></joint>'
    urdf = FRONT.replace("{more}", bar + joint).replace('world"/><child link="d', 'cabinet"/><child link="d')
    (tmp_path / "front.urdf").write_text(urdf)
    twin = load_twin(tmp_path / "front.urdf")
    assert asked(twin, "drawer").holds
    assert asked(parse_edit(twin, edit).applied(twin), "drawer").holds


FRONT = """<robot name="front"><link name="world"/>
<link name="drawer"><collision><geometry><box size="0.02 0.5 0.2"/></geometry></collision></link>
<link name="drawer_handle"><collision><geometry><box size="0.01 0.02 0.01"/></geometry></collision></link>
<joint name="drawer_joint" type="prismatic"><parent link="world"/><child link="drawer"/><axis xyz="1 0 0"/>
<origin xyz="0 0 0.5"/><limit lower="0" upper="0.4" velocity="1" effort="1"/></joint>
<joint name="handle_joint" type="fixed"><parent link="drawer"/><child link="drawer_handle"/>
<origin xyz="0.05 0.2 0"/></joint>{more}</robot>"""
BOARD = """<link name="board"><collision><geometry><box size="0.02 0.2 0.1"/></geometry></collision></link>
<joint name="board_joint" type="fixed"><parent link="world"/><child link="board"/>
<origin xyz="{at} 0 0.5"/></joint>"""
