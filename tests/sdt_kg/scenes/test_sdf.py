"""SDF says where links are and how joints move in ways that are easily misread."""

import math
from pathlib import Path

import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import JointType, Mechanism
from sdt_kg.scenes import read_scene

LINKS = """<link name="a"/><link name="b"><pose degrees="{yes}">0 3 0 0 0 90</pose></link>"""
JOINT = """<joint name="{name}" type="{kind}"><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz>
<use_parent_model_frame>{yes}</use_parent_model_frame><limit><lower>0</lower>{upper}</limit></axis></joint>"""
UPPER = "<upper>1</upper>"


def model(
    tmp_path: Path,
    *,
    name: str = "j",
    kind: str = "prismatic",
    yes: str = "true",
    static: str = "",
    upper: str = UPPER,
) -> Mechanism:
    inside = LINKS.format(yes=yes) + JOINT.format(name=name, kind=kind, yes=yes, upper=upper)
    return read(
        tmp_path, f'<sdf version="1.6"><model name="m"><static>{static}</static>{inside}</model></sdf>'
    )


def read(folder: Path, text: str) -> Mechanism:
    path = folder / "k.sdf"
    path.write_text(text, encoding="utf-8")
    return read_scene(path)


@pytest.mark.parametrize("yes", ["true", "1", "True", " TRUE "])
def test_yes_is_yes_in_whatever_case(yes: str, tmp_path: Path) -> None:
    joint = model(tmp_path, yes=yes).joint("j")
    assert joint.origin.orientation == pytest.approx((0, 0, math.sqrt(0.5), math.sqrt(0.5)))
    assert joint.axis == pytest.approx((0, -1, 0))  # of the model's x, in a frame that is turned by 90°


def test_what_is_neither_yes_nor_no_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UrdfError, match="model 'm': 'yes' is no truth value; allowed: true, false, 1, 0"):
        model(tmp_path, yes="yes")


def test_a_joint_with_the_name_of_a_link_is_refused(tmp_path: Path) -> None:
    # Link a stood where the joint is, 3 m away.
    with pytest.raises(UrdfError, match=r"<link> and <joint> are both named 'a'; .*; rename one of them"):
        model(tmp_path, name="a")


def test_a_continuous_joint_turns_without_end_whatever_its_limits(tmp_path: Path) -> None:
    joint = model(tmp_path, kind="continuous").joint("j")
    assert joint.type is JointType.CONTINUOUS
    assert (joint.limits.lower, joint.limits.upper) == (-math.inf, math.inf)


@pytest.mark.parametrize(("kind", "said"), [("prismatic", True), ("fixed", False)])
def test_that_joints_of_a_static_model_are_taken_to_move_is_said(
    kind: str, said: bool, tmp_path: Path
) -> None:
    note = "model m is static, which is taken of its base: its joints move"
    assert (note in model(tmp_path, kind=kind, static="True").notes) is said


def test_a_hinge_with_one_end_keeps_it(tmp_path: Path) -> None:
    joint = model(tmp_path, kind="revolute", upper="").joint("j")
    assert joint.type is JointType.REVOLUTE
    assert (joint.limits.lower, joint.limits.upper) == (0.0, math.inf)


def test_a_model_beside_the_world_is_said_to_be_left_out(tmp_path: Path) -> None:
    inside = '<world name="w"><model name="m"><link name="a"/></model></world><model name="wall"/>'
    mechanism = read(tmp_path, f'<sdf version="1.9">{inside}</sdf>')
    assert "not carried over: <model> beside the world: wall" in mechanism.notes


def test_a_pose_whose_turn_is_spelled_in_another_way_is_refused(tmp_path: Path) -> None:
    pose = '<pose rotation_format="quat_wxyz">0 0 0 1 0 0 0</pose>'
    with pytest.raises(UrdfError, match="rotation_format='quat_wxyz'; allowed: euler_rpy, quat_xyzw"):
        read(tmp_path, f'<sdf version="1.9"><model name="m">{pose}<link name="a"/></model></sdf>')


BOX = "<geometry><box><size>1 1 1</size></box></geometry>"
WRONG = {
    "<Collision": ("<Collision name='c'/>", "link 'a' has <Collision>; .*; write <collision>"),
    "<colision": ("<colision name='c'/>", "write <collision>"),
    "<Pose": ("<Pose>0 0 1 0 0 0</Pose>", "write <pose>"),
    "relative-to": ("<pose relative-to='j'>0 0 1 0 0 0</pose>", "write relative_to"),
    "<Box": ("<collision name='c'><geometry><Box/></geometry></collision>", "write <box>"),
    "two geometries": (f"<collision name='c'>{BOX}{BOX}</collision>", "<geometry> more than once"),
    "two poses": ("<pose>0 0 1 0 0 0</pose><pose>0 0 2 0 0 0</pose>", "<pose> more than once"),
    "two shapes": (
        f"<collision name='c'>{BOX.replace('</geometry>', '<sphere><radius>1</radius></sphere></geometry>')}"
        "</collision>",
        "has 2 shapes: box, sphere",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_would_be_passed_over_is_refused(name: str, tmp_path: Path) -> None:
    inside, message = WRONG[name]
    with pytest.raises(UrdfError, match=message):
        read(tmp_path, f'<sdf version="1.9"><model name="m"><link name="a">{inside}</link></model></sdf>')


def test_what_is_only_seen_or_another_programs_may_be_spelled_as_it_likes(tmp_path: Path) -> None:
    inside = "<visual name='v'><Geometry/></visual><plugin name='p'><pos>1</pos><pos>2</pos></plugin>"
    read(tmp_path, f'<sdf version="1.9"><model name="m"><link name="a">{inside}</link></model></sdf>')


IN_WORLD = '<sdf version="1.9"><world name="w">{}</world></sdf>'
NESTED = f"<model name='n'><link name='b'><collision name='c'>{BOX}</collision></link></model>"
SOLID = {
    "a shape": (
        "<collision name='c'><geometry><ellipsoid/></geometry></collision></link>",
        r"model 'm': collision 'c' of link 'a' has <ellipsoid>; allowed: box, .*; write it as one of these",
    ),
    "a model in it": (f"</link>{NESTED}", "model 'n' in <model> 'm'; allowed: models of the world"),
    "another file in it": ("</link><include><uri>model://n</uri></include>", "<include> of 'model://n'"),
    "another file beside it": (
        "</link></model><include><uri>https://fuel/models/Table/2</uri></include><model name='o'>",
        "<include> of 'https://fuel/models/Table/2', which is in another file; allowed: sun, ground_plane",
    ),
    "another file of one who is called so": (
        "</link></model><include><uri>https://fuel/1.0/sun/models/Table/2</uri></include><model name='o'>",
        "<include> of 'https://fuel/1.0/sun/models/Table/2'",
    ),
    "many beside it": (
        f"</link></model><population name='p'>{NESTED}</population><model name='o'>",
        "model 'n' in <population> 'p'",
    ),
}


@pytest.mark.parametrize("name", SOLID)
def test_what_is_solid_and_cannot_be_read_is_refused(name: str, tmp_path: Path) -> None:
    # Nothing would be met there, and a motion through it certified.
    inside, message = SOLID[name]
    with pytest.raises(UrdfError, match=message):
        read(tmp_path, IN_WORLD.format(f'<model name="m"><link name="a">{inside}</model>'))


@pytest.mark.parametrize("uri", ["model://sun", "https://fuel/1.0/openrobotics/models/Ground Plane/1"])
def test_light_and_floor_may_be_included(uri: str, tmp_path: Path) -> None:
    included = f'<include><uri>{uri}</uri></include><model name="m"><link name="a"/></model>'
    notes = read(tmp_path, IN_WORLD.format(included)).notes
    assert f"not carried over: <include> of the world: {uri}" in notes


def test_light_that_a_model_includes_is_told(tmp_path: Path) -> None:
    included = '<model name="m"><link name="a"/><include><uri>model://sun</uri></include></model>'
    assert "not carried over: <include> of m: model://sun" in read(tmp_path, IN_WORLD.format(included)).notes


@pytest.mark.parametrize(
    ("how", "turn", "told"),
    [("", "0 0 90", True), (' degrees="true"', "0 0 90", False), ("", "0 0 -6.2832", False)],
)
def test_poses_that_may_be_in_degrees_are_told(tmp_path: Path, how: str, turn: str, told: bool) -> None:
    pose = f"<pose{how}>1 2 3 {turn}</pose>"
    seen = f'<visual name="v">{pose.replace(turn, "0 0 45")}<geometry/></visual>' if not how else ""
    notes = read(
        tmp_path, f'<sdf version="1.7"><model name="m"><link name="a">{pose}{seen}</link></model></sdf>'
    ).notes
    said = "angles are read in radians, and these may be in degrees: pose of link 'a' (0 0 90)"
    assert (said in notes) is told
    assert any("angles are read" in note for note in notes) is told
