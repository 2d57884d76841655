"""What is drawn is where the physics has it."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sdt_kg.iri import local_name
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.twin import Twin
from services import load
from services.physics.model import Scene
from services.reports.scene.camera import ASPECT, beside, overview
from services.reports.scene.clip import Clip, container_clip
from services.reports.scene.gap import gap
from services.reports.scene.meshes import MOST_TRIANGLES, _thinned, mesh_of
from services.reports.scene.raster import fill, stroke
from services.reports.scene.tree import kitchen_tree, robot_tree
from services.reports.scene.view import view_of


@pytest.fixture(scope="module")
def scene() -> Scene:
    service = load("b", ["stretch"])
    return Scene(service.twin, service.robot("stretch"))


@pytest.fixture(scope="module")
def twin(scene: Scene) -> Twin:
    return scene.twin


def postures(scene: Scene) -> np.ndarray:
    """Five postures of all coordinates, mimicking ones consistent."""
    low, high = np.maximum(scene.bounds.lower, -2), np.minimum(scene.bounds.upper, 2)
    draw = np.random.default_rng(7).uniform(low, high, (5, scene.model.nq))
    return scene.coupling.positions(draw)


def test_bodies_are_drawn_where_pinocchio_has_them(scene: Scene, twin: Twin) -> None:
    trees = kitchen_tree(twin), robot_tree(scene)
    for q in postures(scene):
        for tree in trees:
            frames = tree.frames(np.array([q[scene.coordinate[joint]] for joint in tree.joints]))
            for joint, frame in zip(tree.joints, frames, strict=False):
                index = scene.model.getJointId(joint)
                scene.placement(q, tree.bodies[0].iri)  # forward kinematics of q
                assert np.allclose(frame, scene.placements.world_T_joint[index].homogeneous, atol=1e-9), joint


def test_every_body_with_a_shape_is_drawn_once(scene: Scene, twin: Twin) -> None:
    drawn = [each.iri for tree in (kitchen_tree(twin), robot_tree(scene)) for each in tree.bodies]
    assert sorted(drawn) == sorted({each.body for i, each in enumerate(scene.solids) if i != scene.floor})


@pytest.mark.parametrize(
    ("shape", "size", "low", "high"),
    [
        (ShapeType.BOX, (0.2, 0.4, 0.6), (-0.1, -0.2, -0.3), (0.1, 0.2, 0.3)),
        (ShapeType.SPHERE, (0.5,), (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)),
        (ShapeType.CYLINDER, (0.1, 0.6), (-0.1, -0.1, -0.3), (0.1, 0.1, 0.3)),
        (ShapeType.CAPSULE, (0.1, 0.6), (-0.1, -0.1, -0.4), (0.1, 0.1, 0.4)),
    ],
)
def test_a_shape_has_its_size_about_its_own_middle(shape: ShapeType, size, low, high) -> None:
    vertices = mesh_of(Geometry(shape, Pose(), size)).vertices
    assert np.allclose(vertices.min(axis=0), low, atol=3e-3)
    assert np.allclose(vertices.max(axis=0), high, atol=3e-3)


def test_a_fine_mesh_is_drawn_by_few_triangles_in_the_same_place() -> None:
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 120, endpoint=False), np.linspace(0.05, np.pi - 0.05, 60))
    points = np.stack((np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)), axis=-1).reshape(-1, 3)
    i = np.arange(len(points) - 121)
    faces = np.vstack((np.stack((i, i + 1, i + 120), axis=1), np.stack((i + 1, i + 121, i + 120), axis=1)))
    vertices, thinned = _thinned(points, faces)
    assert 100 < len(thinned) <= MOST_TRIANGLES
    assert np.abs(np.linalg.norm(vertices[np.unique(thinned)], axis=1) - 1).max() < 0.1


def test_handle_paths_begin_at_the_handle_and_leave_out_what_is_open(twin: Twin, scene: Scene) -> None:
    view = view_of(twin, [scene], "")
    assert {each.label for each in view.lines} == {each.name for each in twin.containers()}
    door = twin.container("iai_fridge_door")
    ajar = twin.at({door.active_joint: door.upper})
    assert door.name not in {each.label for each in view_of(ajar, [], "").lines}
    path = next(each for each in view.lines if each.label == door.name).points
    axis = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert np.allclose(axis, axis[0], rtol=1e-6)  # equal steps of the door are equal steps on a circle
    tree = view.trees[0]
    handle = next(each for each in tree.bodies if each.iri == door.handle)
    corners = handle.mesh.placed(tree.frames(tree.rest)[handle.joint]).vertices
    assert np.allclose(path[0], (corners.min(axis=0) + corners.max(axis=0)) / 2)


def test_a_containers_clip_ends_where_its_motion_ends(twin: Twin) -> None:
    service = load("b")
    (answer,) = service.causes("open:iai_fridge_door")
    from services.physics.tree import build  # noqa: PLC0415 - beside its one use

    clip = container_clip(
        "", build(service.twin.mechanism(service.twin.environment)), service.twin, answer.case.motion
    )
    (joint,) = clip.joints
    assert local_name(joint) == "iai_fridge_door_joint"
    assert clip.values[0, 0] == pytest.approx(0.0)
    assert clip.values[-1, 0] == pytest.approx(answer.case.motion.values[-1, 0])


def test_the_gap_is_the_distance_of_the_two_bodies(scene: Scene) -> None:
    q = scene.q((0.0, 0.0, 0.0), {})
    bodies = (scene.solids[0].body, scene.solids[-1].body)
    found = gap(scene, q, bodies)
    assert found is not None
    distance, ends = found
    assert distance == pytest.approx(np.linalg.norm(ends[0] - ends[1]))
    assert gap(scene, q, (bodies[0], "https://example.org/id/b/body/nothing")) is None


def test_a_camera_has_all_that_matters_in_the_picture() -> None:
    room = np.random.default_rng(1).uniform((-1, -4, 0), (3, 4, 2), (50, 3))
    near = beside(room[:5], np.array([0.5, 0.5]), (5.0, 0.0))
    for camera, points in ((overview(room, (5.0, 0.0)), room), (near, room[:5])):
        seen = camera.screen(points)
        assert (np.abs(seen[:, 0]) <= ASPECT).all()
        assert (np.abs(seen[:, 1]) <= 1).all()
        assert (seen[:, 2] >= camera.distance - camera.reach).all()


def test_the_nearest_triangle_is_seen_and_what_is_too_near_is_cut() -> None:
    color, depth = np.ones((40, 80, 3)), np.full((40, 80), np.inf)
    wall = np.array([[-9.0, -9, 5], [9, -9, 5], [0, 9, 5]])
    near, far = wall * (1, 1, 0.4), wall
    fill(color, depth, np.array([far, near]), np.array([[0.2, 0, 0], [0, 0.2, 0]]), 0.5, 20.0)
    assert color[20, 40].tolist() == [0, 0.2, 0]
    fill(color, depth, np.array([wall * (1, 1, 0.05)]), np.array([[0, 0, 0.2]]), 0.5, 20.0)
    assert color[20, 40].tolist() == [0, 0.2, 0]
    stroke(color, depth, np.array([[[-1.0, 0, 4], [1, 0, 4]]]), np.zeros(3), 0.5, 20.0, 0.01)
    assert color[20, 40].tolist() == [0, 0.2, 0]  # behind
    stroke(color, depth, np.array([[[-1.0, 0, 1.9], [1, 0, 1.9]]]), np.zeros(3), 0.5, 20.0, 0.01)
    assert color[20, 40].tolist() == [0, 0.1, 0]


def test_a_clip_between_its_frames_lies_between_them(scene: Scene) -> None:
    tree = robot_tree(scene)
    joint = tree.joints[5]
    clip = Clip("", tree.name, np.array([0.0, 2.0]), (joint,), np.array([[0.1], [0.3]]))
    assert clip.positions(tree, 1.0)[5] == pytest.approx(0.2)
    assert np.delete(clip.positions(tree, 1.0), 5) == pytest.approx(np.delete(tree.rest, 5))


def test_rotations_of_a_tree_are_right_handed(scene: Scene) -> None:
    tree = robot_tree(scene)
    yaw = np.zeros(len(tree.joints))
    yaw[2] = np.pi / 2
    frame = tree.frames(yaw)[2]
    assert Rotation.from_matrix(frame[:3, :3]).as_rotvec() == pytest.approx([0, 0, np.pi / 2])


def test_no_name_ends_or_comments_out_the_data_of_a_view(twin: Twin) -> None:
    shown = view_of(twin, [], "</script><!--<script>")._repr_html_()
    data = shown.partition('<script type="application/json">')[2].partition("</script>")[0]
    assert "<" not in data
    assert json.loads(data)["title"] == "</script><!--<script>"
