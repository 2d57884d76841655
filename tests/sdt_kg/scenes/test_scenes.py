"""MJCF and SDF scenes become the same mechanism as a URDF, and say what they could not carry over."""

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh

import kitchens
from sdt_kg.errors import UrdfError
from sdt_kg.load import load_twin
from sdt_kg.mechanism import JointType, Mechanism, Mimic
from sdt_kg.scenes import read_scene
from sdt_kg.urdf import read_mechanism
from tests.sdt_kg.scenes.writers import forward, mjcf, sdf, shapes_in_world
from tests.small import FOLDER

WRITERS = {".xml": mjcf, ".sdf": sdf}
KITCHENS = [kitchens.path("a") / "a.urdf", kitchens.path("b") / "b.urdf", FOLDER / "a.urdf"]


def written(folder: Path, urdf: Path, suffix: str) -> tuple[Mechanism, Path]:
    mechanism = read_mechanism(urdf, turn_axes=True)
    path = folder / f"{mechanism.name}{suffix}"
    path.write_text(WRITERS[suffix](mechanism), encoding="utf-8")
    return mechanism, path


@pytest.mark.parametrize("suffix", list(WRITERS))
@pytest.mark.parametrize("urdf", KITCHENS, ids=lambda urdf: f"{urdf.parent.name}-{urdf.stem}")
def test_a_kitchen_has_the_same_kinematics_shapes_and_limits(tmp_path: Path, urdf: Path, suffix: str) -> None:
    expected, path = written(tmp_path, urdf, suffix)
    found = read_scene(path)
    movable = {joint.name: joint for joint in expected.joints if joint.type is not JointType.FIXED}
    read = {joint.name: joint for joint in found.joints if joint.type is not JointType.FIXED}
    assert set(read) == set(movable)
    for name, joint in movable.items():
        assert (read[name].type, read[name].mimic) == (joint.type, joint.mimic), name
        assert (read[name].limits.lower, read[name].limits.upper) == (
            joint.limits.lower,
            joint.limits.upper,
        ), name
        assert read[name].limits.effort == joint.limits.effort
    draw = np.random.default_rng(0)
    for _ in range(3):
        positions = {name: float(draw.uniform(-1, 1)) for name in movable}
        for one, other in zip(
            shapes_in_world(expected, positions), shapes_in_world(found, positions), strict=True
        ):
            assert one[0] == other[0]
            assert np.abs(one[1] - other[1]).max() < 1e-9, one[0]
            assert one[2] == pytest.approx(other[2], abs=1e-12)
    masses = {body.name: body.inertia.mass for body in expected.bodies if body.inertia is not None}
    assert {
        body.name: body.inertia.mass for body in found.bodies if body.name in masses and body.inertia
    } == masses


@pytest.mark.parametrize("suffix", list(WRITERS))
def test_a_scene_has_the_containers_of_the_urdf(sdt_kg_kitchen_b: Path, tmp_path: Path, suffix: str) -> None:
    _, path = written(tmp_path, sdt_kg_kitchen_b, suffix)
    twin, expected = load_twin(path), load_twin(sdt_kg_kitchen_b)
    assert [(c.name, c.kind, c.lower, c.upper, c.open_from) for c in twin.containers()] == [
        (c.name, c.kind, c.lower, c.upper, c.open_from) for c in expected.containers()
    ]
    assert len(twin.containers()) == 17


@pytest.fixture
def sdt_kg_kitchen_b() -> Path:
    return kitchens.path("b") / "b.urdf"


NASTY = """<mujoco><compiler angle="degree" meshdir="meshes"/>
<default><default class="door"><joint type="hinge" axis="0 0 1" pos="0.1 -0.2 0.3"/></default></default>
<asset><mesh name="m" file="m.stl" scale="2 1 1"/></asset>
<worldbody><geom name="floor" type="plane" size="1 1 1"/>
<body name="one" pos="1 2 3" euler="10 20 30">
  <joint name="turn" class="door" ref="15" range="-10 90"/>
  <joint name="slide" type="slide" axis="1 1 0" ref="0.2" range="-1 1"/>
  <geom name="mesh" type="mesh" mesh="m" pos="0.1 0 0.2" euler="0 40 0"/>
  <body name="two" pos="0.5 0 0" quat="0.7 0.1 0.6 0.2">
    <joint name="free turn" type="hinge" axis="0 1 0" pos="0 0.3 0"/>
    <geom name="capsule" type="capsule" fromto="0 0 0 0.1 0.2 0.3" size="0.05"/>
    <geom name="egg" type="ellipsoid" size=".1 .2 .3" contype="0" conaffinity="0"/><site name="s"/>
    <geom name="picture" type="box" size="1 1 1" contype="0" conaffinity="0"/>
  </body>
</body>
<body name="ball" pos="0 0 1"><freejoint name="loose"/><geom name="sphere" type="sphere" size=".1"/></body>
</worldbody>
<equality><joint joint1="slide" joint2="turn" polycoef="0.05 0.5 0 0 0"/>
<joint name="bent" active="false" joint1="free turn" joint2="turn" polycoef="0 0.5 1 0 0"/></equality>
<actuator><motor joint="turn"/></actuator></mujoco>"""


@pytest.fixture
def nasty(tmp_path: Path) -> Path:
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    box.apply_translation((0.5, 0.0, 0.1))
    (tmp_path / "meshes").mkdir()
    box.export(tmp_path / "meshes" / "m.stl")
    (tmp_path / "scene.xml").write_text(NASTY, encoding="utf-8")
    return tmp_path / "scene.xml"


def test_it_agrees_with_mujoco_where_joints_have_anchors_and_references(nasty: Path) -> None:
    mechanism = read_scene(nasty)
    model = mujoco.MjModel.from_xml_path(str(nasty))
    data = mujoco.MjData(model)
    draw = np.random.default_rng(0)
    for _ in range(5):
        turn, loose = (float(draw.uniform(-1, 1)) for _ in range(2))
        slide = 0.5 * (turn - np.radians(15)) + 0.2 + 0.05
        data.qpos[:3] = turn, slide, loose
        mujoco.mj_kinematics(model, data)
        found = {
            name.split()[0]: at
            for name, at, _ in shapes_in_world(mechanism, {"turn": turn, "free turn": loose})
        }
        frames = forward(mechanism, {"turn": turn, "free turn": loose})
        for shape, body in (("capsule", "two"), ("sphere", "ball")):
            geom = model.geom(shape).id
            assert np.abs(found[body][:3, 3] - data.geom_xpos[geom]).max() < 1e-9
            assert np.abs(found[body][:3, :3] - data.geom_xmat[geom].reshape(3, 3)).max() < 1e-9
        vertices = model.mesh_vert[: model.mesh_vertnum[0]]
        geom = model.geom("mesh").id
        expected = vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        (shape,) = next(each for each in mechanism.bodies if each.name == "one").collision
        mesh = trimesh.load(shape.mesh_file, force="mesh").vertices * np.array(shape.size)
        world_T_mesh = frames["one"] @ shape.pose.matrix()
        placed = mesh @ world_T_mesh[:3, :3].T + world_T_mesh[:3, 3]
        apart = np.linalg.norm(placed[:, None] - expected[None], axis=2).min(axis=1)
        assert apart.max() < 1e-6  # single precision of MuJoCo's vertices


@pytest.mark.parametrize("frame", ['refpos="0.1 0 0.2"', 'refquat="1 0 0 1"'])
def test_a_mesh_that_mujoco_moves_in_its_own_frame_is_refused(nasty: Path, frame: str) -> None:
    # The compiled model does not say how, and the mesh would stand elsewhere.
    nasty.write_text(NASTY.replace('scale="2 1 1"', f'scale="2 1 1" {frame}'), encoding="utf-8")
    with pytest.raises(UrdfError, match=r"mesh 'm' has a frame of its own; allowed: meshes without refpos"):
        read_scene(nasty)


def test_what_mjcf_cannot_carry_over_is_listed(nasty: Path) -> None:
    mechanism = read_scene(nasty)
    slide = mechanism.joint("slide")
    assert slide.mimic == Mimic("turn", 0.5, pytest.approx(0.25 - 0.5 * np.radians(15)))
    notes = "\n".join(mechanism.notes)
    for said in (
        "no velocity limits",
        "fixed where it stands: joint 'loose' (free) of body 'ball'",
        "geoms that collide with nothing: egg, picture",
        "equality constraints: bent",
        "1 actuators",
        "1 sites",
    ):
        assert said in notes


WORLD = """<sdf version="1.9"><world name="w"><light name="sun" type="point"/><include><uri>model://sun</uri></include>
<model name="one"><pose degrees="true">1 2 3 0 0 90</pose>
 <frame name="edge" attached_to="base"><pose>0.5 0 0 0 0 0</pose></frame>
 <link name="base"><sensor name="eye" type="camera"/></link>
 <link name="arm"><pose relative_to="hinge">0 0 0.1 0 0 0</pose>
  <collision name="c"><pose>0 0 0.2 0 0 0</pose>
   <geometry><sphere><radius>0.1</radius></sphere></geometry></collision>
  <collision name="none"><geometry><empty/></geometry></collision></link>
 <joint name="hinge" type="revolute"><pose relative_to="edge">0 0 1 0 0 0</pose>
  <parent>edge</parent><child>arm</child><axis><xyz expressed_in="__model__">0 1 0</xyz>
  <limit><lower>-1.0</lower><upper>0</upper></limit></axis></joint>
 <link name="tip"/><joint name="ball" type="ball"><parent>arm</parent><child>tip</child></joint>
</model>
<model name="two"><static>true</static><link name="base"><visual name="v"/></link></model>
</world></sdf>"""


CHEST = """<mujoco><worldbody><body name="chest" pos="2 1 0">
<body name="top_drawer" pos="0 0 0.7"><joint name="drawer_joint" type="slide" axis="-1 0 0" range="0 .35"/>
<geom type="box" size="0.01 0.28 0.1"/><body name="top_handle"><geom size="0.01"/></body></body>
</body></worldbody></mujoco>"""


def test_the_annotation_of_the_guide_says_what_mjcf_cannot(tmp_path: Path) -> None:
    guide = (Path(kitchens.__file__).parent / "README.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"^```turtle\n(.+?)^```$", guide, re.DOTALL | re.MULTILINE)
    scene = tmp_path / "my.xml"
    scene.write_text(CHEST, encoding="utf-8")
    bare = load_twin(scene)
    with_velocities = example.replace("# <https", "<https")
    assert with_velocities != example
    scene.with_suffix(".ttl").write_text(with_velocities, encoding="utf-8")
    said = load_twin(scene)
    limits = [twin.mechanism(twin.environment).joint("drawer_joint").limits for twin in (bare, said)]
    assert [each.velocity for each in limits] == [np.inf, 0.5]
    assert limits[1].acceleration == 1.0
    assert [twin.kitchen().start for twin in (bare, said)] == [(0.0, 0.0, 0.0), (0.5, 0.0, 0.0)]


def test_sdf_frames_axes_and_worlds(tmp_path: Path) -> None:
    (tmp_path / "s.world").write_text(WORLD, encoding="utf-8")
    mechanism = read_scene(tmp_path / "s.world")
    assert mechanism.root == "world"
    hinge = mechanism.joint("one::hinge")
    assert (hinge.limits.lower, hinge.limits.upper) == (0.0, 1.0)
    assert "axis turned" in hinge.notes[0]
    assert hinge.axis == pytest.approx((0, -1, 0))
    frames = forward(mechanism, {"one::hinge": 1.0})
    # In the model: 0.3 m above the hinge at (0.5, 0, 1), turned by -1 about y; the model by 90° about z.
    (_, sphere, size), *_ = shapes_in_world(mechanism, {"one::hinge": 1.0})
    x, z = 0.5 - 0.3 * np.sin(1.0), 1 + 0.3 * np.cos(1.0)
    assert sphere[:3, 3] == pytest.approx((1.0, 2 + x, 3 + z), abs=1e-12)
    assert size == (0.1,)
    assert set(frames) == {"world", "one::base", "one::arm", "one::tip", "two::base"}
    notes = "\n".join([*mechanism.notes, *mechanism.joint("one::ball").notes])
    for said in (
        "fixed where it stands: model one",
        "<light> of the world: sun",
        "<include> of the world: model://sun",
        "<sensor> of base: eye",
        "empty, which nothing can collide with: collision 'none' of 'one::arm'",
        "visuals of links without collision geometry: two::base",
        "ball joint, which D_artic does not know: imported as fixed",
    ):
        assert said in notes
    assert "model two" not in notes


FIXED = '<joint name="{}" type="fixed"><parent>{}</parent><child>{}</child></joint>'


def in_model(inside: str, how: str = "") -> str:
    return f'<sdf version="1.9"><model name="m" {how}><link name="a"/><link name="b"/>{inside}</model></sdf>'


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("s.xml", "<mujoco><foo/></mujoco>", "MuJoCo says: XML Error: Schema violation"),
        ("s.xml", "<robot/>", "root element is <robot>.*suffix .urdf"),
        ("s.xml", "not xml", "is not XML"),
        ("s.xml", '<!DOCTYPE x [<!ENTITY a "b">]><mujoco/>', "has a DTD"),
        ("s.xml", '<mujoco><include file="../other.xml"/></mujoco>', "lies outside of"),
        ("s.xml", '<mujoco><include file="inner.xml"/></mujoco>', "meshdir='/etc' lies outside of"),
        ("s.sdf", '<sdf version="1.4"><model name="m"/></sdf>', "SDF version '1.4'; allowed: 1.5 or later"),
        ("s.sdf", '<sdf version="1.9"/>', "has no model"),
        ("s.sdf", in_model("<pose relative_to='n'>1 0 0 0 0 0</pose>"), "placed by a frame: relative_to='n'"),
        ("s.sdf", in_model("", "placement_frame='b'"), "placed by a frame: .*placement_frame='b'"),
        ("s.sdf", in_model("<link name='c'><pose frame='b'>1 0 0 0 0 0</pose></link>"), "frame='b'; allowed"),
        ("s.sdf", in_model(FIXED.format("j", "a", "c")), "has child 'c'"),
        ("s.sdf", in_model("<link name='world'/>"), "several bodies are named 'world'"),
        ("s.sdf", in_model("<link name='c'><pose relative_to='d'/></link>"), "frame 'd' does not exist"),
        ("s.sdf", in_model("<link name='c'><pose>1 2 east 0 0 0</pose></link>"), "allowed: 6 finite"),
        ("s.sdf", in_model(FIXED.format("j", "a", "b") + FIXED.format("k", "b", "a")), "form no tree"),
    ],
)  # fmt: skip
def test_a_scene_that_is_none_is_refused(tmp_path: Path, name: str, content: str, message: str) -> None:
    (tmp_path / "inner.xml").write_text('<mujoco><compiler meshdir="/etc"/></mujoco>', encoding="utf-8")
    (tmp_path / name).write_text(content, encoding="utf-8")
    with pytest.raises(UrdfError, match=message):
        read_scene(tmp_path / name)


DOOR = """<mujoco><worldbody><body name="frame" pos="1 0 1"><body name="door" pos="0 0.3 0">
<joint name="hinge" axis="0 0 1" range="0 1.5" limited="true" pos="0 -0.3 0"/>
<geom name="panel" type="box" size="0.01 0.25 0.3"/>
<geom name="Handle bar" type="box" size="0.01 0.01 0.1" pos="-0.05 0.2 0"/>
<geom name="handle_picture" type="box" size="0.1 0.1 0.1" contype="0" conaffinity="0"/>
</body></body></worldbody></mujoco>"""
SDF_DOOR = """<sdf version="1.7"><model name="m"><static>true</static><link name="frame"/><link name="door">
<pose>1 0 1 0 0 0</pose>
<collision name="panel"><geometry><box><size>0.02 0.5 0.6</size></box></geometry></collision>
<collision name="door_handle_1"><pose>-0.05 0.2 0 0 0 0</pose>
<geometry><box><size>0.02 0.02 0.2</size></box></geometry></collision></link>
<joint name="hinge" type="revolute"><parent>frame</parent><child>door</child>
<axis><xyz>0 0 1</xyz><limit><lower>0</lower><upper>1.5</upper><velocity>1</velocity></limit></axis></joint>
</model></sdf>"""


@pytest.mark.parametrize(("suffix", "text"), [(".xml", DOOR), (".sdf", SDF_DOOR)])
def test_shapes_that_are_called_a_handle_are_one(tmp_path: Path, suffix: str, text: str) -> None:
    path = tmp_path / f"k{suffix}"
    path.write_text(text, encoding="utf-8")
    twin = load_twin(path)
    (door,) = twin.containers()
    assert (door.name, door.joint.rpartition("/")[2]) == ("door", "hinge")
    assert door.handle.endswith("/door_handle")
    mechanism = read_scene(path)
    shapes = {body.name: [one.size for one in body.collision] for body in mechanism.bodies}
    assert shapes["door"] == [(0.02, 0.5, 0.6)]
    assert shapes["door_handle"] == [(0.02, 0.02, 0.2)]
    assert (
        "the shapes of door that are called a handle are a link of their own, door_handle" in mechanism.notes
    )


def test_shapes_called_a_handle_stay_where_the_body_or_another_is_called_so(tmp_path: Path) -> None:
    own = DOOR.replace('name="door"', 'name="door handle"')
    other = DOOR.replace("</body></body>", '</body><body name="door_handle"/></body>')
    for text, count in ((own, 3), (other, 4)):
        (tmp_path / "k.xml").write_text(text, encoding="utf-8")
        bodies = read_scene(tmp_path / "k.xml").bodies
        assert next(len(each.collision) for each in bodies if each.name.startswith("door")) == 2
        assert len(bodies) == count
