"""Φ stops a container at the floor, and at what belongs to the body that it hangs on but does not bear it."""

from pathlib import Path

import pytest

from predicates.case import Answer, Case
from predicates.causes import causes
from sdt_kg.load import load_twin
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
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
