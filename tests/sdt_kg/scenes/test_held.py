"""What a scene says besides its joints and poses: read, of no account, or refused; never passed over."""

from pathlib import Path

import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import JointType
from sdt_kg.scenes import read_scene

MJCF = """<mujoco><worldbody>
<geom name="wall" type="box" size=".1 1 1" pos="2 0 0"/><site name="hook"/>
<body name="drawer" pos="1 0 1"><joint name="pull" type="slide" axis="-1 0 0" range="0 .4"/>
 <geom name="front" type="box" size=".02 .2 .1"/><site name="knob"/></body>
<body name="flap" pos="1 1 1"><joint name="turn" type="hinge" range="0 1"/>
 <geom type="box" size=".2 .02 .1"/></body>
<body name="crate" pos=".5 0 1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
<body name="jar" pos=".5 1 1"><freejoint/><geom type="sphere" size=".1"/><site name="lid"/></body>
{body}</worldbody>{more}</mujoco>"""

SDF = """<sdf version="1.9"><world name="w">{more}
<model name="kit"><static>true</static><link name="base"><collision name="c"><geometry><box>
<size>1 1 1</size></box></geometry></collision></link></model>
<model name="crate"><pose>3 3 0.5 0 0 0</pose><link name="box"><collision name="c"><geometry><box>
<size>1 1 1</size></box></geometry></collision></link></model></world></sdf>"""

FLEX = """<flexcomp name="soft" type="grid" dim="3" count="3 3 3" spacing=".1 .1 .1"
 pos=".5 0 1" rigid="true">
<contact contype="{0}" conaffinity="{0}"/></flexcomp>"""
TENDON = '<tendon><fixed name="cord" {0}><joint joint="pull" coef="1"/></fixed></tendon>'
ROPE = """<tendon><spatial name="rope" limited="true" range="0 9">
<site site="{}"/><site site="hook"/></spatial></tendon>
<equality><tendon name="e" tendon1="rope"/></equality>"""


def mjcf(folder: Path, more: str = "", body: str = "") -> str:
    """Notes of the scene with more in it."""
    (folder / "scene.xml").write_text(MJCF.format(more=more, body=body), encoding="utf-8")
    return "\n".join(read_scene(folder / "scene.xml").notes)


def sdf(folder: Path, more: str) -> str:
    """The same of a world."""
    (folder / "scene.sdf").write_text(SDF.format(more=more), encoding="utf-8")
    return "\n".join(read_scene(folder / "scene.sdf").notes)


@pytest.mark.parametrize(
    "more",
    [
        '<equality><joint joint1="pull" polycoef=".5 1 0 0 0"/></equality>',  # beyond its range
        '<equality><joint joint1="pull"/><joint joint1="pull" joint2="turn"/></equality>',
        '<equality><joint joint1="pull" joint2="turn" polycoef="0 1 1 0 0"/></equality>',
        '<equality><weld body1="drawer"/></equality>',
        '<equality><weld body1="crate" body2="drawer"/></equality>',
        '<equality><connect body1="crate" body2="flap" anchor="0 0 0"/></equality>',
        TENDON.format('limited="true" range="-.01 .01"'),
        f"{TENDON.format('')}<equality><tendon tendon1='cord'/></equality>",
        ROPE.format("knob"),
    ],
)
def test_what_holds_a_drawer_otherwise_than_by_its_joint_is_refused(tmp_path: Path, more: str) -> None:
    with pytest.raises(UrdfError, match="holds or couples"):
        mjcf(tmp_path, more)


@pytest.mark.parametrize(
    "more",
    [
        '<equality><weld name="e" body1="crate" body2="jar"/></equality>',
        '<equality><weld name="e" body1="crate"/></equality>',
        '<equality><weld name="e" body1="crate" body2="drawer" active="false"/></equality>',
        ROPE.format("lid"),
    ],
)
def test_what_holds_only_what_is_fixed_here_is_told(tmp_path: Path, more: str) -> None:
    assert "equality constraints: e" in mjcf(tmp_path, more)


@pytest.mark.parametrize(
    ("ref", "more"),
    [
        (0.0, '<joint name="lock" joint1="pull" polycoef=".3 1 0 0 0"/>'),
        (0.1, '<joint name="lock" joint1="pull" polycoef=".2 1 0 0 0"/>'),
        (0.1, '<joint name="lock" joint1="pull" polycoef=".2 1 9 0 0" solref=".1 1"/>'),  # only a counts
    ],
)
def test_a_joint_that_is_held_alone_is_fixed_where_it_is_held(tmp_path: Path, ref: float, more: str) -> None:
    path = tmp_path / "scene.xml"
    text = MJCF.format(more=f"<equality>{more}</equality>", body="")
    path.write_text(text.replace('name="pull"', f'name="pull" ref="{ref}"'), encoding="utf-8")
    joint = read_scene(path).joint("pull")
    assert joint.type is JointType.FIXED
    assert joint.origin.position == pytest.approx((1 + ref - 0.3, 0, 1))  # 0.3 m along -x from where it is 0
    assert "held by equality constraint 'lock'" in joint.notes


def test_what_follows_a_joint_that_is_held_is_fixed_too(tmp_path: Path) -> None:
    more = '<joint joint1="pull" polycoef=".2 1 0 0 0"/><joint joint1="turn" joint2="pull"/>'
    (tmp_path / "scene.xml").write_text(MJCF.format(more=f"<equality>{more}</equality>", body=""))
    joints = {joint.name: joint.type for joint in read_scene(tmp_path / "scene.xml").joints}
    assert joints["pull"] is joints["turn"] is JointType.FIXED


def test_a_tendon_without_limits_holds_nothing(tmp_path: Path) -> None:
    assert "1 tendons" in mjcf(tmp_path, TENDON.format(""))


def test_a_flexible_body_that_something_may_meet_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UrdfError, match="'soft' is flexible"):
        mjcf(tmp_path, body=FLEX.format(1))
    assert "1 flexible bodies" in mjcf(tmp_path, body=FLEX.format(0))


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ('<state world_name="w"><model name="crate"><pose>.8 0 .8 0 0 0</pose></model></state>', "<state>"),
        ('<state world_name="w"><insertions><model name="m"/></insertions></state>', "<insertions>"),
        ('<state world_name="w"><deletions><name>crate</name></deletions></state>', "<deletions>"),
        (
            '<joint name="j" type="fixed"><parent>kit::base</parent><child>crate::box</child></joint>',
            "joint 'j'",
        ),
        (
            "<include><uri>model://ground_plane</uri><pose>0 0 0.5 0 0 0</pose></include>",
            "raised or turned",
        ),
        (
            '<include><uri>model://ground_plane</uri><pose degrees="true">1 0 0 0 90 0</pose></include>',
            "raised or turned",
        ),
        (
            '<include><uri>model://ground_plane</uri><pose relative_to="kit">0 0 0 0 0 0</pose></include>',
            "raised or turned",
        ),
        ('<population name="p"><include><uri>model://chair</uri></include></population>', "model://chair"),
        (
            '<actor name="a"><link name="l"><collision name="c"><geometry><sphere><radius>1</radius></sphere>'
            "</geometry></collision></link></actor>",
            "model 'a'",
        ),
        ('<x:crate xmlns:x="http://www.ros.org/wiki/xacro"/>', "xacro"),
        ("<xacro:crate/>", "unbound prefix"),
        ('<model xmlns="urn:x" name="m"><link name="l"/></model>', "<model> of the namespace 'urn:x'"),
        ('<x:crates xmlns:x="urn:x"><x:model name="m"/></x:crates>', "<crates> of the namespace 'urn:x'"),
        (
            "<include><uri>model://ground_plane</uri><Pose>0 0 0.5 0 0 0</Pose></include>",
            "write <pose>",
        ),
        (
            '<model name="m"><pose>0 0 0.5 0 0 0</pose><include><uri>model://ground_plane</uri></include></model>',
            "or by that of <model>",
        ),
        (
            "<include><uri>model://table</uri><pose>0 0 0.5 0 0 0</pose></include>",
            "in another file",
        ),
        ('<state world_name="w"><Model name="crate"/></state>', "<Model>"),
        (
            '<state world_name="w"><insertions name="sun"><model name="m"/></insertions></state>',
            "<insertions>",
        ),
        (
            '<state world_name="w"><model name="ground_plane"><pose>0 0 0.5 0 0 0</pose></model></state>',
            "ground_plane",
        ),
        (
            '<state world_name="w"><model name="sun"/></state>'
            '<model name="sun"><pose>3 3 0 0 0 0</pose></model>',
            "<state>",
        ),
    ],
)
def test_what_would_stand_elsewhere_or_not_be_read_is_refused(tmp_path: Path, more: str, said: str) -> None:
    with pytest.raises(UrdfError, match=said):
        sdf(tmp_path, more)


@pytest.mark.parametrize(
    "more",
    [
        "<include><uri>model://ground_plane</uri><pose>1 2 0 0 0 0.3</pose></include>",
        "<include><uri>model://sun</uri></include>",
        "<include><uri>model://sun</uri><pose>0 0 10 0 0 0</pose></include>",
        '<d:proximity_properties xmlns:d="drake.mit.edu"/>',
        '<state world_name="w"><sim_time>1 0</sim_time><model name="ground_plane"/></state>',
        '<actor name="a"><skin><filename>walk.dae</filename></skin></actor>',
    ],
)
def test_what_changes_nothing_is_passed_over(tmp_path: Path, more: str) -> None:
    assert "crate" in sdf(tmp_path, more)
