"""Models built from mechanisms have the kinematics of models built from URDF files."""

from collections.abc import Callable
from pathlib import Path

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file
import pytest
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from sdt_kg.annotating.panels import corners
from sdt_kg.errors import UnknownEntityError, UrdfError
from sdt_kg.iri import body_iri, joint_iri, local_name
from sdt_kg.load import load_twin
from sdt_kg.mechanism import (
    Body,
    Geometry,
    Inertia,
    Joint,
    JointType,
    Limits,
    Mechanism,
    Mimic,
    Pose,
    ShapeType,
)
from sdt_kg.twin import Twin
from sdt_kg.urdf import read_mechanism
from sdt_kg.urdf.meshes import mesh_hash
from services.physics.geometry.hulls import COARSE, FINE, Fineness, convex_pieces
from services.physics.geometry.pieces import pieces
from services.physics.geometry.shapes import solids, surface
from services.physics.model import Scene
from services.physics.tree import Model, build, exempt_pairs

pytestmark = pytest.mark.oracle
Array = NDArray[np.float64]
DIRECT = 1e-9  # [m, and of the entries of a rotation]


def of_urdf(urdf: pin.Model, model: Model, q: Array, raw: Mechanism) -> Array:
    """Our coordinates in the order and form of Pinocchio's own import, axes as in the file."""
    theirs = pin.neutral(urdf)
    axes = {joint.name: np.array(joint.axis) for joint in raw.joints}
    for joint, turned in zip(model.part.joints, q, strict=True):
        value = turned * np.sign(axes[joint.name] @ np.array(joint.axis))
        index = urdf.getJointId(joint.name)
        first = urdf.idx_qs[index]
        if urdf.nqs[index] == 2:
            theirs[first : first + 2] = np.cos(value), np.sin(value)
        else:
            theirs[first] = value
    return theirs


def assert_same_kinematics(model: Model, urdf: pin.Model, raw: Mechanism, rng: np.random.Generator) -> None:
    data, own, name = urdf.createData(), pin.Data(model.model), model.part.mechanism.name
    for _ in range(20):
        q = model.coupling.positions(rng.uniform(-1.5, 1.5, model.model.nq))
        pin.framesForwardKinematics(urdf, data, of_urdf(urdf, model, q, raw))
        pin.framesForwardKinematics(model.model, own, q)
        for body in model.part.mechanism.bodies:
            theirs = data.oMf[urdf.getFrameId(body.name, pin.BODY)]
            ours = own.oMf[model.model.getFrameId(body_iri(name, body.name))]
            np.testing.assert_allclose(ours.homogeneous, theirs.homogeneous, atol=DIRECT)


@pytest.mark.reference
@pytest.mark.parametrize(
    "path",
    [
        "kitchen_a_apartment/apartment_local.urdf",
        "kitchen_b_iai_kitchen/kitchen.urdf",
        "robot_pr2/pr2_with_ft2_cableguide.urdf",
        "robot_tiago_dual/tiago_dual.urdf",
        "robot_stretch/stretch_description_local.urdf",
    ],
)
def test_urdf_to_twin_to_model_moves_as_urdf_to_model(reference: Path, path: str) -> None:
    robot = path.startswith("robot")
    twin = load_twin("b", [reference / path]) if robot else load_twin(reference / path)
    model = build(twin.mechanism(twin.robots[0] if robot else twin.environment))
    urdf = pin.buildModelFromUrdf(str(reference / path))
    assert_same_kinematics(model, urdf, read_mechanism(reference / path), np.random.default_rng(0))


def random_mechanism(seed: int) -> Mechanism:
    rng = np.random.default_rng(seed)
    kinds = (JointType.REVOLUTE, JointType.PRISMATIC, JointType.CONTINUOUS, JointType.FIXED)
    joints = []
    for i in range(8):
        axis = rng.normal(size=3)
        pose = Pose(tuple(rng.normal(size=3)), tuple(Rotation.random(random_state=rng).as_quat()))
        kind, parent = kinds[rng.integers(4)], f"b{rng.integers(i + 1)}"
        joints.append(Joint(f"j{i}", kind, parent, f"b{i + 1}", pose, tuple(axis / np.linalg.norm(axis))))
    return Mechanism("random", "b0", tuple(Body(f"b{i}") for i in range(9)), tuple(joints))


@pytest.mark.parametrize("seed", range(10))
def test_random_mechanisms_move_as_their_joints_say(seed: int) -> None:
    mechanism, rng = random_mechanism(seed), np.random.default_rng(seed)
    model = build(mechanism)
    assert model.model.nq == model.model.nv == len(model.part.joints)
    q = rng.uniform(-4, 4, model.model.nq)
    value = dict(zip((joint.name for joint in model.part.joints), q, strict=True))
    world = {"b0": np.eye(4)}
    for joint in mechanism.joints:
        moved, x = np.eye(4), value.get(joint.name, 0.0)
        if joint.type is JointType.PRISMATIC:
            moved[:3, 3] = x * np.array(joint.axis)
        else:
            moved[:3, :3] = Rotation.from_rotvec(x * np.array(joint.axis)).as_matrix()
        world[joint.child] = world[joint.parent] @ joint.origin.matrix() @ moved
    own = pin.Data(model.model)
    pin.framesForwardKinematics(model.model, own, q)
    for body, expected in world.items():
        ours = own.oMf[model.model.getFrameId(body_iri("random", body))]
        np.testing.assert_allclose(ours.homogeneous, expected, atol=DIRECT)


def chain(*joints: Joint) -> Mechanism:
    bodies = [joints[0].parent, *(joint.child for joint in joints)]
    return Mechanism("chain", joints[0].parent, tuple(Body(name) for name in bodies), joints)


def test_a_chain_of_mimic_joints_follows_its_first_source() -> None:
    model = build(
        chain(
            Joint("c", JointType.REVOLUTE, "0", "1", mimic=Mimic("b", 2.0, 0.5)),
            Joint("b", JointType.REVOLUTE, "1", "2", mimic=Mimic("a", -3.0, 0.25)),
            Joint("a", JointType.PRISMATIC, "2", "3"),
        )
    )
    q = model.coupling.positions(np.array([9.0, 9.0, 0.1]))
    np.testing.assert_allclose(q, [2 * (-3 * 0.1 + 0.25) + 0.5, -3 * 0.1 + 0.25, 0.1])
    np.testing.assert_allclose(model.coupling.rates(np.array([9.0, 9.0, 0.1])), [-0.6, -0.3, 0.1])
    assert model.coupling.independent.tolist() == [2]


def test_a_joint_that_mimics_a_fixed_one_stays_at_its_offset() -> None:
    fixed = Joint("f", JointType.FIXED, "0", "1")
    model = build(chain(fixed, Joint("m", JointType.REVOLUTE, "1", "2", mimic=Mimic("f", 2.0, 0.3))))
    assert model.coupling.positions(np.array([1.0])).tolist() == [0.3]
    assert len(model.coupling.independent) == 0


def test_joints_that_mimic_each_other_are_refused() -> None:
    one = Joint("a", JointType.REVOLUTE, "0", "1", mimic=Mimic("b"))
    with pytest.raises(UrdfError, match="mimics itself"):
        build(chain(one, Joint("b", JointType.REVOLUTE, "1", "2", mimic=Mimic("a"))))


@pytest.fixture(scope="module")
def twin() -> Twin:
    return load_twin("b", ["pr2"])


@pytest.fixture(scope="module")
def scene(twin: Twin) -> Scene:
    return Scene(twin, twin.robots[0])


def test_the_base_carries_the_robot(scene: Scene) -> None:
    base = body_iri("pr2", scene.annotation.base_body)
    placement = scene.placement(scene.q((1.0, -2.0, np.pi / 2), {}), base)
    height = scene.annotation.base_height
    np.testing.assert_allclose(placement.translation, [1.0, -2.0, height], atol=DIRECT)
    np.testing.assert_allclose(placement.rotation, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=DIRECT)


def test_coordinates_follow_the_twins_state_and_the_parked_posture(scene: Scene, twin: Twin) -> None:
    q = scene.q((0, 0, 0), {})
    for iri, value in twin.state.items():
        assert q[scene.coordinate[iri]] == pytest.approx(value)
    for name, value in scene.annotation.parked.items():
        k = scene.coordinate[joint_iri("pr2", name)]
        if scene.coupling.source[k] == k:
            assert q[k] == value
    assert q[scene.coordinate[joint_iri("pr2", "torso_lift_joint")]] != 0.2
    lifted = scene.q((0, 0, 0), {"torso_lift_joint": 0.2})
    assert lifted[scene.coordinate[joint_iri("pr2", "torso_lift_joint")]] == 0.2
    with pytest.raises(UnknownEntityError, match="torso_lift_joint"):
        scene.q((0, 0, 0), {"torso_joint": 0.2})


def test_limits_are_those_of_model_and_annotation(scene: Scene) -> None:
    base, limits = scene.bounds, scene.annotation.base_limits
    assert base.velocity[scene.base].tolist() == [
        limits.linear_velocity,
        limits.linear_velocity,
        limits.angular_velocity,
    ]
    torso = scene.coordinate[joint_iri("pr2", "torso_lift_joint")]
    joint = scene.robot.mechanism.joint("torso_lift_joint")
    assert (base.lower[torso], base.upper[torso]) == (joint.limits.lower, joint.limits.upper)
    assert base.velocity[torso] == joint.limits.velocity
    assert np.isfinite(base.acceleration[torso])
    forearm = scene.coordinate[joint_iri("pr2", "r_forearm_roll_joint")]
    assert (base.lower[forearm], base.upper[forearm]) == (-np.inf, np.inf)


def test_pairs_are_all_but_neighbours_and_annotated_ones(scene: Scene) -> None:
    exempt = exempt_pairs(scene.robot.mechanism, scene.annotation)
    robot = [i for i, one in enumerate(scene.solids) if one.joint > scene.base[-1]]
    kitchen = [i for i in range(len(scene.solids)) if i not in robot]
    standing = [i for i in robot if scene.solids[i].body in scene.standing]
    assert len(scene.environment_pairs) == len(robot) * len(kitchen) - len(standing)
    own = {frozenset(pair) for pair in scene.self_pairs.tolist()}
    for i in robot:
        for j in robot:
            if i < j:
                bodies = frozenset((scene.solids[i].body, scene.solids[j].body))
                assert (frozenset((i, j)) in own) == (bodies not in exempt)
    upper_arm, forearm = (body_iri("pr2", f"r_{name}_link") for name in ("upper_arm", "shoulder_pan"))
    assert frozenset((upper_arm, body_iri("pr2", "l_upper_arm_link"))) not in exempt
    assert frozenset((forearm, body_iri("pr2", "torso_lift_link"))) in exempt


TETRAHEDRON = """solid t
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 1 0 vertex 1 0 0 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 0 1 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 1 vertex 0 1 0 endloop endfacet
{more}endsolid t
"""
SLOPE = "facet normal 0 0 0 outer loop vertex 1 0 0 vertex 0 1 0 vertex 0 0 1 endloop endfacet\n"
SQUARE = """solid s
facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 endloop endfacet
facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 1 0 vertex 0 1 0 endloop endfacet
endsolid s
"""


def mesh(path: Path, text: str, size: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Geometry:
    path.write_text(text)
    return Geometry(ShapeType.MESH, Pose(), size, str(path), mesh_hash(path))


def one(shapes: tuple[coal.CollisionGeometry, ...]) -> coal.CollisionGeometry:
    (shape,) = shapes
    return shape


def distance_to_ball(
    shape: coal.CollisionGeometry, centre: tuple[float, float, float], radius: float
) -> float:
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    ball = coal.Sphere(radius)
    return coal.distance(
        shape, coal.Transform3s(), ball, coal.Transform3s(np.eye(3), np.array(centre)), request, result
    )


def test_a_robots_mesh_is_filled_and_a_kitchens_is_its_surface(tmp_path: Path) -> None:
    # A tetrahedron without its slanted face: hollow for a kitchen, filled for a robot.
    hollow = mesh(tmp_path / "hollow.stl", TETRAHEDRON.format(more=""))
    inside, radius = (0.2, 0.2, 0.2), 0.01
    assert distance_to_ball(surface(hollow)[0], inside, radius) == pytest.approx(0.19, abs=1e-6)
    assert distance_to_ball(one(solids(hollow)), inside, radius) < 0
    closed = mesh(tmp_path / "closed.stl", TETRAHEDRON.format(more=SLOPE), (2.0, 2.0, 2.0))
    assert distance_to_ball(one(solids(closed)), (1.0, 1.0, 1.0), 0.1) == pytest.approx(
        1 / np.sqrt(3) - 0.1, abs=1e-6
    )


@pytest.mark.parametrize("number", ["nan", "inf"])
@pytest.mark.parametrize("shapes", [solids, surface], ids=["robot", "kitchen"])
def test_a_mesh_with_a_vertex_that_is_no_point_is_refused(
    shapes: Callable[[Geometry], object], number: str, tmp_path: Path
) -> None:
    # Its triangles would touch nothing, and a robot could pass through them.
    broken = SLOPE.replace("vertex 1 0 0", f"vertex {number} 0 0")
    with pytest.raises(UrdfError, match=r"broken\.stl has a vertex that is no point; allowed: finite"):
        shapes(mesh(tmp_path / "broken.stl", TETRAHEDRON.format(more=broken)))


@pytest.mark.parametrize(
    ("scale", "said"), [(1000.0, "millimetres needs scale"), (5e-4, "take the scale away")]
)
@pytest.mark.parametrize("shapes", [solids, surface], ids=["robot", "kitchen"])
def test_a_mesh_in_another_unit_is_refused(
    shapes: Callable[[Geometry], object], scale: float, said: str, tmp_path: Path
) -> None:
    # Walls a thousand times too large or too small are where no robot comes, and it passed through them.
    with pytest.raises(UrdfError, match=rf"unit\.stl is {scale:g} m long, as scaled; .* {said}"):
        shapes(mesh(tmp_path / "unit.stl", TETRAHEDRON.format(more=SLOPE), (scale, scale, scale)))


COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>{unit}</asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="12">
0 0 0 1 0 0 0 2 0 0 0 3</float_array><technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p>
</triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">
<node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


@pytest.mark.parametrize(
    ("unit", "metres"), [("", 1.0), ('<unit meter="1"/>', 1.0), ('<unit name="cm" meter="0.01"/>', 0.01)]
)
def test_a_mesh_is_as_large_as_the_unit_of_its_file_says(unit: str, metres: float, tmp_path: Path) -> None:
    file = mesh(tmp_path / "unit.dae", COLLADA.format(unit=unit), (1.0, 1.0, 2.0))
    size = np.array([1.0, 2.0, 6.0]) * metres
    np.testing.assert_allclose(one(surface(file)).aabb_local.max_, size)
    np.testing.assert_allclose(one(solids(file)).aabb_local.max_, size)
    np.testing.assert_allclose(corners([file]).max(axis=0), size)


def test_a_mesh_whose_unit_is_no_length_is_refused(tmp_path: Path) -> None:
    for meter in ("0", "-1", "inf", "cm"):
        file = mesh(tmp_path / f"unit{meter}.dae", COLLADA.format(unit=f'<unit meter="{meter}"/>'))
        with pytest.raises(UrdfError, match="has a unit that is no length"):
            surface(file)


def test_a_flat_mesh_is_a_thin_solid(tmp_path: Path) -> None:
    flat = one(solids(mesh(tmp_path / "flat.stl", SQUARE)))
    assert distance_to_ball(flat, (0.5, 0.5, 0.5), 0.1) == pytest.approx(0.4, abs=2e-4)


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (TETRAHEDRON.format(more=SLOPE), coal.ConvexBase),
        (SQUARE, coal.ConvexBase),
        (TETRAHEDRON.format(more=""), coal.BVHModelBase),
    ],
    ids=["convex", "flat", "hollow"],
)
def test_the_box_of_a_kitchens_piece_is_that_of_the_shape_that_is_made_later(
    content: str, kind: type[coal.CollisionGeometry], tmp_path: Path
) -> None:
    piece = one(pieces(mesh(tmp_path / "mesh.stl", content, (0.5, 1.0, 2.0))))
    assert isinstance(piece.shape, kind)
    assert piece.low.tolist() == piece.shape.aabb_local.min_.tolist()
    assert piece.high.tolist() == piece.shape.aabb_local.max_.tolist()


def test_a_mesh_that_cannot_be_read_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(UrdfError, match="cannot be read"):
        solids(mesh(tmp_path / "broken.stl", "no mesh"))


def box_triangles(size: tuple[float, float, float], centre: tuple[float, float, float]) -> Array:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * np.array(size) / 2
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    halves = [(a, b, c) for a, b, c, _ in faces] + [(a, c, d) for a, _, c, d in faces]
    return corners[np.array(halves)] + np.array(centre)


@pytest.mark.parametrize("fineness", [COARSE, FINE])
def test_convex_pieces_contain_every_triangle_and_leave_the_notch_free(fineness: Fineness) -> None:
    # An L of two bars 0.2 m thick: its one hull would fill the notch at (0.8, 0, 0.8).
    bars = [box_triangles((0.2, 0.2, 1), (0.1, 0, 0.5)), box_triangles((1, 0.2, 0.2), (0.5, 0, 0.1))]
    triangles = np.concatenate(bars)
    pieces = [ConvexHull(points) for points in convex_pieces(triangles, fineness)]
    weights = np.random.default_rng(0).dirichlet(np.ones(3), (len(triangles), 50))
    points = np.einsum("mkc,mcx->mkx", weights, triangles).reshape(-1, 3)
    outside = [points @ piece.equations[:, :3].T + piece.equations[:, 3] for piece in pieces]
    assert (np.min([depth.max(axis=1) for depth in outside], axis=0) <= DIRECT).all()
    notch = np.array((0.45, 0.0, 0.45))
    assert all((piece.equations[:, :3] @ notch + piece.equations[:, 3]).max() > 0 for piece in pieces)


def test_one_convex_body_is_one_piece() -> None:
    assert len(convex_pieces(box_triangles((1, 2, 3), (0, 0, 0)), FINE)) == 1


def test_wheels_stand_on_the_floor_and_hands_may_not(scene: Scene) -> None:
    pairs = {tuple(pair) for pair in scene.environment_pairs.tolist()}
    on_floor = {local_name(scene.solids[i].body) for i, j in pairs if j == scene.floor}
    assert "fl_caster_l_wheel_link" not in on_floor
    assert {"l_gripper_palm_link", "r_gripper_l_finger_tip_link", "torso_lift_link"} <= on_floor
    floor = scene.solids[scene.floor]
    assert floor.joint_T_shape.translation[2] + floor.half[2] == 0.0


def test_moments_below_0_by_rounding_are_moments_of_0() -> None:
    heavy = Inertia(2.0, Pose(), (-5e-20, 0.0, 0.0, 0.0, 0.0, 2e-20))
    hinge = Joint("hinge", JointType.REVOLUTE, "world", "link", limits=Limits(0.0, 1.0))
    model = build(Mechanism("m", "world", (Body("world"), Body("link", heavy)), (hinge,)))
    assert model.model.inertias[1].mass == 2.0
