"""URDF → Mechanism: what is kept, what is changed and noted, and what is refused."""

import math
import os
from pathlib import Path

import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Geometry, JointType, Limits, Mimic, Pose, ShapeType
from sdt_kg.urdf import read_mechanism
from tests.sdt_kg.conftest import Write, joint, limit, link

TWO = (link("world"), link("door"))


def hinge(inside: str, kind: str = "revolute") -> tuple[str, ...]:
    return (*TWO, joint("hinge", kind, "world", "door", inside))


def test_a_drawer_is_read_as_it_is_written(drawer: Path) -> None:
    model = read_mechanism(drawer)
    assert (model.name, model.root) == ("k", "world")
    assert [body.name for body in model.bodies] == ["world", "cupboard_drawer", "cupboard_handle"]
    assert model.bodies[1].collision == (Geometry(ShapeType.BOX, Pose(), (0.4, 0.5, 0.2)),)
    slide = model.joint("slide")
    assert slide.type is JointType.PRISMATIC
    assert slide.axis == (1.0, 0.0, 0.0)
    assert slide.limits == Limits(lower=0.0, upper=0.5, velocity=1.0, effort=10.0)
    assert slide.limits.acceleration == math.inf
    assert slide.notes == ()
    assert model.joint("mount").origin == Pose((0.22, 0.0, 0.0))


@pytest.mark.parametrize(
    ("rpy", "quaternion"),
    [
        ("0 0 0", (0, 0, 0, 1)),
        ("3.141592653589793 0 0", (1, 0, 0, 0)),
        ("0 3.141592653589793 0", (0, 1, 0, 0)),
        ("0 0 3.141592653589793", (0, 0, 1, 0)),
        ("0 0 1.5707963267948966", (0, 0, math.sqrt(0.5), math.sqrt(0.5))),
        ("1.5707963267948966 0 1.5707963267948966", (0.5, 0.5, 0.5, 0.5)),
        # about x first: what turns about z first, or about turned axes, is another one
        ("1.5707963267948966 1.5707963267948966 0", (0.5, 0.5, -0.5, 0.5)),
        ("0.3 -0.5 0.7", (0.2198957663291046, -0.1801458579968856, 0.3632373697282358, 0.8872721876797529)),
    ],
)
def test_roll_pitch_yaw_becomes_a_quaternion(write: Write, rpy: str, quaternion: tuple[float, ...]) -> None:
    model = read_mechanism(write(*hinge(f'<origin rpy="{rpy}"/>{limit(0, 1)}')))
    assert model.joint("hinge").origin.orientation == pytest.approx(quaternion, abs=1e-15)


def test_joints_come_parents_before_children(write: Write) -> None:
    late = joint("b", "fixed", "door", "knob")
    model = read_mechanism(write(link("knob"), *TWO, late, joint("a", "fixed", "world", "door")))
    assert [each.name for each in model.joints] == ["a", "b"]


def test_equal_limits_are_a_fixed_joint_and_a_note(write: Write) -> None:
    model = read_mechanism(write(*hinge(limit(0, 0))))
    assert model.joint("hinge").type is JointType.FIXED
    assert model.joint("hinge").notes == ("revolute joint with equal limits 0..0: imported as fixed",)


@pytest.mark.parametrize(
    ("written", "lacks"),
    [("", "no lower and no upper"), (' lower="0"', "no upper"), (' upper="0"', "no lower")],
)
def test_ends_that_are_not_written_are_named_where_the_joint_cannot_move_for_that(
    write: Write, written: str, lacks: str
) -> None:
    model = read_mechanism(write(*hinge(f'<limit{written} velocity="1" effort="1"/>', "prismatic")))
    assert model.joint("hinge").notes == (
        f"its <limit> has {lacks}, which URDF takes for 0",
        "prismatic joint with equal limits 0..0: imported as fixed",
    )
    moves = read_mechanism(write(*hinge('<limit upper="0.4" velocity="1" effort="1"/>', "prismatic")))
    assert moves.joint("hinge").notes == ()


def test_equal_limits_elsewhere_than_0_move_the_child_there(write: Write) -> None:
    model = read_mechanism(write(*hinge(f'<axis xyz="0 1 0"/>{limit(0.3, 0.3)}', "prismatic")))
    assert model.joint("hinge").origin.position == (0.0, 0.3, 0.0)
    assert model.joint("hinge").fixed_at == 0.3
    turned = read_mechanism(write(*hinge(f'<axis xyz="0 0 1"/>{limit(math.pi / 2, math.pi / 2)}')))
    assert turned.joint("hinge").fixed_at == pytest.approx(math.pi / 2, rel=5e-6)
    assert turned.joint("hinge").origin.orientation == pytest.approx((0, 0, math.sqrt(0.5), math.sqrt(0.5)))


INERTIAL = '<inertial><mass value="2"/><inertia ixx="{}" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


@pytest.mark.parametrize(("ixx", "kept"), [("0", True), ("-1e-7", True), ("-1e-3", False)])
def test_moments_that_no_body_has_are_left_out_and_a_note(write: Write, ixx: str, kept: bool) -> None:
    heavy = f'<link name="door">{INERTIAL.format(ixx)}</link>'
    model = read_mechanism(write(link("world"), heavy, joint("hinge", "fixed", "world", "door")))
    assert (model.bodies[1].inertia is not None) is kept
    left_out = "the inertia of door is left out, with its mass of 2 kg: no body has these moments"
    assert [left_out in note for note in model.notes] == ([] if kept else [True])


def test_moments_of_nothing_but_rounding_are_kept(write: Write) -> None:
    figures = 'ixx="-5e-20" ixy="0" ixz="0" iyy="0" iyz="0" izz="2e-20"'
    heavy = f'<link name="world"><inertial><mass value="2"/><inertia {figures}/></inertial></link>'
    assert read_mechanism(write(heavy)).bodies[0].inertia is not None


def test_limits_that_are_not_written_are_0_as_urdf_says(write: Write) -> None:
    model = read_mechanism(write(*hinge('<limit velocity="1" effort="1"/>')))
    assert model.joint("hinge").type is JointType.FIXED


def test_an_axis_is_normalised_and_noted(write: Write) -> None:
    slide = read_mechanism(write(*hinge(f'<axis xyz="0 3 4"/>{limit(0, 1)}', "prismatic"))).joint("hinge")
    assert slide.axis == (0.0, 0.6, 0.8)
    assert slide.notes == ("axis (0, 3, 4) had length 5 and was normalised",)


def test_kitchens_have_backward_limits_turned_and_mimics_with_them(write: Write) -> None:
    flap = joint("flap", "revolute", "door", "knob", f'<mimic joint="hinge" multiplier="2"/>{limit(-2, 2)}')
    path = write(*hinge(f'<axis xyz="0 0 1"/>{limit(-math.pi / 2, 0)}'), link("knob"), flap)
    model = read_mechanism(path, turn_axes=True)
    turned = model.joint("hinge")
    assert turned.axis == (0.0, 0.0, -1.0)
    assert (turned.limits.lower, turned.limits.upper) == (0.0, math.pi / 2)
    assert "axis turned" in turned.notes[0]
    assert model.joint("flap").mimic == Mimic("hinge", -2.0)
    robot = read_mechanism(path).joint("hinge")
    assert (robot.limits.lower, robot.axis, robot.notes) == (-math.pi / 2, (0.0, 0.0, 1.0), ())


def test_limits_on_both_sides_of_0_are_left_as_they_are(write: Write) -> None:
    model = read_mechanism(write(*hinge(limit(-1, 1))), turn_axes=True)
    assert model.joint("hinge").limits.lower == -1.0


@pytest.mark.parametrize(
    ("soft", "lower", "upper"),
    [
        ('soft_lower_limit="-0.9" soft_upper_limit="0.5"', -0.9, 0.5),
        ('soft_lower_limit="-3" soft_upper_limit="0.5"', -1, 0.5),
        ('soft_upper_limit="0.5"', 0, 0.5),
        ('soft_lower_limit="0" soft_upper_limit="0"', -1, 1),
        ("", -1, 1),
    ],
)
def test_a_robots_joint_ends_at_the_soft_limits_of_its_safety_controller(
    write: Write, soft: str, lower: float, upper: float
) -> None:
    parts = hinge(f'{limit(-1, 1)}<safety_controller k_position="20" k_velocity="1" {soft}/>')
    found = read_mechanism(write(*parts)).joint("hinge")
    assert (found.limits.lower, found.limits.upper) == (lower, upper)
    assert any("safety controller, short of -1 to 1" in each for each in found.notes) is (
        (lower, upper) != (-1, 1)
    )
    stops = read_mechanism(write(*parts), turn_axes=True).joint("hinge").limits  # of a kitchen
    assert (stops.lower, stops.upper) == (-1, 1)


@pytest.mark.parametrize(
    ("gain", "soft", "kept"),
    [
        ('k_position="20"', (-0.9, 0.5), 20),
        ('k_position="20"', (-1, 1), 20),
        ('k_position="20"', (-3, 3), math.inf),
        ('k_position="0"', (-0.9, 0.5), math.inf),
        ("", (-0.9, 0.5), math.inf),
    ],
)
def test_a_safety_controller_slows_a_joint_before_its_limits(
    write: Write, gain: str, soft: tuple[float, float], kept: float
) -> None:
    ends = f'soft_lower_limit="{soft[0]}" soft_upper_limit="{soft[1]}"'
    parts = hinge(f'{limit(-1, 1)}<safety_controller {gain} k_velocity="1" {ends}/>')
    assert read_mechanism(write(*parts)).joint("hinge").limits.gain == kept


def test_a_chain_of_mimics_becomes_one_step(write: Write) -> None:
    second = joint(
        "b", "revolute", "door", "l2", f'<mimic joint="hinge" multiplier="2" offset="1"/>{limit(0, 9)}'
    )
    third = joint("c", "revolute", "l2", "l3", f'<mimic joint="b" multiplier="3" offset="5"/>{limit(0, 99)}')
    model = read_mechanism(write(*hinge(limit(0, 1)), link("l2"), link("l3"), second, third))
    assert model.joint("c").mimic == Mimic("hinge", 6.0, 8.0)
    assert model.joint("c").notes == ("mimics 'b', which mimics 'hinge': joined",)


def test_a_chain_of_mimics_ends_at_a_joint_that_stands_though_it_mimics(write: Write) -> None:
    stands = joint("b", "prismatic", "door", "l2", f'<mimic joint="hinge"/>{limit(0.5, 0.5)}')
    follower = joint("c", "prismatic", "l2", "l3", f'<mimic joint="b" multiplier="2"/>{limit(0, 9)}')
    model = read_mechanism(write(*hinge(limit(0, 1)), link("l2"), link("l3"), stands, follower))
    assert [model.joint(name).type for name in ("b", "c")] == [JointType.FIXED] * 2
    assert [model.joint(name).origin.position[0] for name in ("b", "c")] == [0.5, 1.0]


@pytest.mark.parametrize(
    "mimic", ['<mimic joint="hinge" offset="0.25"/>', '<mimic joint="x" multiplier="0"/>']
)
def test_what_mimics_a_joint_that_cannot_move_is_fixed(write: Write, mimic: str) -> None:
    moving = joint("x", "prismatic", "door", "l2", limit(0, 1))
    path = write(
        *hinge(limit(0, 0)), link("l2"), link("l3"), moving,
        joint("b", "prismatic", "l2", "l3", f"{mimic}{limit(0, 1)}"),
    )  # fmt: skip
    follower = read_mechanism(path).joint("b")
    assert follower.type is JointType.FIXED
    assert follower.mimic is None
    assert follower.origin.position == ((0.25, 0.0, 0.0) if "offset" in mimic else (0.0, 0.0, 0.0))


def test_visual_geometry_is_not_read_but_noted(write: Write) -> None:
    wheel = '<link name="wheel"><visual><geometry><mesh filename="nowhere.dae"/></geometry></visual></link>'
    model = read_mechanism(write(link("world"), wheel, joint("j", "fixed", "world", "wheel")))
    assert model.bodies[1].collision == ()
    assert model.notes == (
        "links with a visual but no collision geometry, which nothing can collide with: wheel",
    )


def test_meshes_are_found_beside_the_urdf_and_hashed_by_content(write: Write, tmp_path: Path) -> None:
    folder = tmp_path / "pkg" / "meshes"
    folder.mkdir(parents=True)
    (folder / "a.stl").write_bytes(b"solid")
    (folder / "b.stl").write_bytes(b"solid")
    meshes = [
        '<mesh filename="package://pkg/meshes/a.stl" scale="1 2 3"/>',
        '<mesh filename="pkg/meshes/b.stl"/>',
    ]
    one, other = read_mechanism(write(link("world", *meshes))).bodies[0].collision
    assert one.size == (1.0, 2.0, 3.0)
    assert other.size == (1.0, 1.0, 1.0)
    assert one.mesh_file == str(folder / "a.stl")
    assert one.mesh_hash == other.mesh_hash
    assert len(one.mesh_hash) == 64


def test_a_urdf_inside_its_package_finds_the_package(tmp_path: Path) -> None:
    (tmp_path / "pkg" / "urdf").mkdir(parents=True)
    (tmp_path / "pkg" / "a.stl").write_bytes(b"solid")
    path = tmp_path / "pkg" / "urdf" / "k.urdf"
    path.write_text(
        f'<robot name="k">{link("w", MESH.format("package://pkg/a.stl"))}</robot>', encoding="utf-8"
    )
    assert read_mechanism(path).bodies[0].collision[0].mesh_file == str(tmp_path / "pkg" / "a.stl")


MESH = '<mesh filename="{}"/>'


def test_endless_nesting_is_refused(write: Write) -> None:
    deep = "<a>" * 50_000 + "</a>" * 50_000
    with pytest.raises(UrdfError, match="nested too deep"):
        read_mechanism(write(f'<link name="w">{deep}</link>'))


BOMB = '<!DOCTYPE lolz [<!ENTITY lol "lol"><!ENTITY lol2 "&lol;&lol;&lol;&lol;">]>'

BAD: dict[str, tuple[tuple[str, ...], str]] = {
    "joint of an unknown type": (hinge("", "planar"), "allowed: fixed, prismatic, revolute, continuous"),
    "floating joint": (hinge("", "floating"), "has type 'floating'"),
    "hinge without limits": (hinge(""), "has no limits"),
    "inverted limits": (hinge(limit(1, 0)), "lower limit 1 above upper limit 0"),
    "zero axis": (hinge(f'<axis xyz="0 0 0"/>{limit(0, 1)}'), "axis 0 0 0"),
    "not a number": (hinge(f'<origin xyz="nan 0 0"/>{limit(0, 1)}'), "is not finite"),
    "infinite limit": (hinge('<limit lower="0" upper="inf" velocity="1" effort="1"/>'), "is not finite"),
    "quaternion": (
        hinge(f'<origin xyz="0 0 1" quat_xyzw="0 0 0.6 0.8"/>{limit(0, 1)}'),
        "joint 'hinge': origin has quat_xyzw; allowed: rpy=\"…\"",
    ),
    "no number": (hinge(f'<origin xyz="a b c"/>{limit(0, 1)}'), "is not 3 number"),
    "two numbers for three": (hinge(f'<origin xyz="0 0"/>{limit(0, 1)}'), "holds 2 number"),
    "negative speed": (hinge(limit(0, 1, -1)), "negative velocity"),
    "duplicate link": (
        (*TWO, link("door"), joint("j", "fixed", "world", "door")),
        "link named twice: 'door'",
    ),
    "duplicate joint": (
        (*hinge(limit(0, 1)), link("x"), joint("hinge", "fixed", "door", "x")),
        "joint named twice",
    ),
    "two parents": (
        (*hinge(limit(0, 1)), link("x"), joint("a", "fixed", "world", "x"), joint("b", "fixed", "door", "x")),
        "more than one parent (a loop): 'x'",
    ),
    "loop without root": (
        (link("a"), link("b"), joint("j", "fixed", "a", "b"), joint("k", "fixed", "b", "a")),
        "every link has a parent (a loop)",
    ),
    "loop beside the tree": (
        (link("w"), link("a"), link("b"), joint("j", "fixed", "a", "b"), joint("k", "fixed", "b", "a")),
        "a loop that is not joined to the root: 'a', 'b'",
    ),
    "two roots": (TWO, "2 links without parent"),
    "unknown link": (
        (link("world"), joint("j", "fixed", "world", "door")),
        "do not exist: 'door'; allowed: 'world'; add",
    ),
    "misspelled link name": (
        (*TWO, joint("j", "fixed", "world", "dor")),
        "do not exist: 'dor'; did you mean 'door'? add <link",
    ),
    "decimal comma": (hinge(f'<origin xyz="1,9 0 0"/>{limit(0, 1)}'), "with a point before decimals"),
    "flat mesh": ((link("world", '<mesh filename="a.stl" scale="1 1 0"/>'),), "allowed: other than 0"),
    "no child": (
        (link("world"), '<joint name="j" type="fixed"><parent link="world"/></joint>'),
        "no child link",
    ),
    "mimic of nothing": (hinge(f'<mimic joint="nix"/>{limit(0, 1)}'), "mimics 'nix', which does not exist"),
    "mimic of itself": (hinge(f'<mimic joint="hinge"/>{limit(0, 1)}'), "which mimics it in turn"),
    "flat box": ((link("world", '<box size="1 0 1"/>'),), "above 0 m"),
    "cone": ((link("world", '<cone radius="1"/>'),), "collision geometry is <cone>; allowed: one of box"),
    "missing mesh": ((link("world", MESH.format("a.stl")),), "no mesh file"),
    "mesh outside": ((link("world", MESH.format("../../a.stl")),), "lies outside of"),
    "mesh outside of its package": (
        (link("world", MESH.format("package://p/../../../a.stl")),),
        "outside of",
    ),
    "absolute mesh": ((link("world", MESH.format("file:///etc/passwd")),), "outside of"),
    "soft limits elsewhere": (
        hinge(f'{limit(0, 1)}<safety_controller soft_lower_limit="2" soft_upper_limit="3" k_velocity="1"/>'),
        "joint 'hinge' has the soft limits 2 to 3; allowed: a part of 0 to 1",
    ),
    "slowed backwards": (
        hinge(f'{limit(0, 1)}<safety_controller k_position="-2" soft_upper_limit="1" k_velocity="1"/>'),
        "joint 'hinge' has k_position -2; allowed: 0",
    ),
    "capital element": (
        ('<link name="a"><Collision/></link>',),
        "link 'a' has <Collision>; allowed: inertial",
    ),
    "misspelled element": (hinge(f'<orgin xyz="0 0 1"/>{limit(0, 1)}'), "has <orgin>"),
    "misspelled shape": ((link("a", '<Box size="1 1 1"/>'),), "geometry has <Box>"),
    "swapped letters": (hinge(f'<origin xzy="0 0 1"/>{limit(0, 1)}'), 'origin has xzy="0 0 1"'),
    "misspelled number": (hinge('<limit lower="0" uper="1"/>'), 'has uper="1"; allowed: lower, upper'),
    "misspelled link": (("<Link/>", link("a")), "has <Link>"),
    "empty": ((), "has no link"),
    "nameless link": (("<link/>",), "a link has no name"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_urdf_is_refused_with_its_reason(write: Write, case: str) -> None:
    parts, reason = BAD[case]
    with pytest.raises(UrdfError) as caught:
        read_mechanism(write(*parts))
    assert reason in str(caught.value)
    assert "k.urdf" in str(caught.value)


def test_what_other_tools_add_is_passed_over(write: Write) -> None:
    more = '<limit lower="0" upper="1" acceleration="2"/><visual><Geometry/></visual><hardware/>'
    assert read_mechanism(write(*hinge(more), "<ros2_control/>")).joint("hinge").limits.upper == 1


@pytest.mark.parametrize("name", ["k.urdf", "k.urdf.xacro"])
def test_a_dtd_is_refused_before_it_is_expanded(write: Write, name: str) -> None:
    with pytest.raises(UrdfError, match="has a DTD"):
        read_mechanism(write(link("&lol2;"), head=BOMB, name=name))


@pytest.mark.parametrize("text", ["", "<robot", "not xml", "<sdf/>"])
def test_what_is_no_urdf_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "k.urdf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UrdfError):
        read_mechanism(path)


def test_a_link_out_of_the_folder_is_refused(write: Write, tmp_path: Path) -> None:
    secret = tmp_path.parent / "secret.stl"
    secret.write_bytes(b"solid")
    (tmp_path / "mesh.stl").symlink_to(secret)
    with pytest.raises(UrdfError, match="lies outside of"):
        read_mechanism(write(link("world", MESH.format("mesh.stl"))))


def test_a_file_name_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / os.fsdecode(b"k\xff.urdf")
    path.write_text('<robot name="r"><link name="l"/></robot>')
    with pytest.raises(UrdfError, match="is no text; allowed: UTF-8; rename the file"):
        read_mechanism(path)


def test_nothing_is_printed(drawer: Path, capfd: pytest.CaptureFixture[str]) -> None:
    read_mechanism(drawer)
    assert capfd.readouterr() == ("", "")
