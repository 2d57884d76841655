"""What is drawn is what is judged: postures, shapes, films and marks against the judge's own."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Answer, Case, Diagnosis, Evidence, Kind, Quantity
from predicates.margins import NearestPair
from sdt_kg.errors import UrdfError
from sdt_kg.iri import Iri, body_iri, joint_iri, local_name
from sdt_kg.mechanism import Body, Geometry, Mechanism, Pose, ShapeType
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Twin
from sdt_kg.urdf.meshes import mesh_hash
from services.app import load
from services.physics.model import Scene
from services.viewer.picture.film import Film
from services.viewer.picture.looks import Looks, handle_path, kitchen_colours, limit_line
from services.viewer.picture.marks import Mark, What, marks_of, nearest_of
from services.viewer.picture.shapes import collision_surfaces, visual_surfaces
from services.viewer.picture.skeleton import Skeleton, base_pose
from services.viewer.picture.standing import kitchen_positions, parked
from services.viewer.picture.timeline import KITCHEN_ALONE, WHOLE, Timeline
from tests.small import small_twin

BASE = (0.4, -0.3, 0.7)


@pytest.fixture(scope="module")
def twin() -> Twin:
    """Five containers; `folding_door` mimics a panel."""
    return small_twin("a", ("pr2",))


@pytest.fixture(scope="module")
def looks(twin: Twin) -> Looks:
    mechanism = twin.mechanism(twin.environment)
    surfaces = collision_surfaces(mechanism, hulls=False)
    return Looks(Skeleton.of(mechanism), surfaces, {}, kitchen_colours(twin))


def joint(twin: Twin, name: str) -> Iri:
    return joint_iri(twin.name(twin.environment), name)


@pytest.mark.oracle
def test_every_body_is_drawn_where_the_judge_has_it() -> None:
    closed = load("a", ["pr2"]).twin
    twin = closed.at({each.active_joint: 0.1 for each in closed.containers()})
    (robot,) = twin.robots
    scene, annotation = Scene(twin, robot), twin.robot(robot)
    kitchen, machine = (Skeleton.of(twin.mechanism(each)) for each in (twin.environment, robot))
    joints = {"torso_lift_joint": 0.2, "l_elbow_flex_joint": -1.1, "r_gripper_l_finger_joint": 0.3}
    q = scene.q(BASE, joints)
    sides = (
        (kitchen, kitchen_positions(kitchen, dict(twin.state)), np.eye(4)),
        (machine, parked(annotation, joints), base_pose(machine, annotation, BASE)),
    )
    for skeleton, positions, world_T_root in sides:
        placed = skeleton.placed(positions, world_T_root)
        for body, (frame, frame_T_body) in skeleton.carried.items():
            judged = scene.placement(q, body_iri(skeleton.mechanism.name, body)).homogeneous
            np.testing.assert_allclose(placed[frame] @ frame_T_body, judged, atol=1e-9, err_msg=body)


def test_a_door_that_follows_is_drawn_with_the_panel_that_it_follows(twin: Twin, looks: Looks) -> None:
    opened = twin.at({joint(twin, "folding_door_joint"): 0.5})
    whole = looks.skeleton.complete({"folding_door_joint": 0.5})
    assert whole == pytest.approx(kitchen_positions(looks.skeleton, dict(opened.state)))


@pytest.mark.parametrize(
    ("shape", "size", "half"),
    [
        (ShapeType.BOX, (0.2, 0.4, 0.6), (0.1, 0.2, 0.3)),
        (ShapeType.SPHERE, (0.5,), (0.5, 0.5, 0.5)),
        (ShapeType.CYLINDER, (0.1, 0.8), (0.1, 0.1, 0.4)),
        (ShapeType.CAPSULE, (0.1, 0.8), (0.1, 0.1, 0.5)),
    ],
)
def test_shapes_have_their_size_and_place(
    shape: ShapeType, size: tuple[float, ...], half: tuple[float, ...]
) -> None:
    at = Pose((1.0, 2.0, 3.0))
    mechanism = Mechanism("m", "body", (Body("body", None, (Geometry(shape, at, size),) * 2),), ())
    surface = collision_surfaces(mechanism, hulls=False)["body"]
    assert surface.centre == pytest.approx((1, 2, 3))
    assert np.abs(surface.vertices - surface.centre).max(axis=0) == pytest.approx(half)
    assert surface.faces.max() < len(surface.vertices)
    assert len(np.unique(surface.faces)) == len(surface.vertices)  # both shapes are there


@pytest.mark.parametrize("hulls", [True, False])
def test_a_mesh_is_drawn_as_it_is_judged(tmp_path: Path, hulls: bool) -> None:
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    faces = "".join(f"f {a} {b} {c}\n" for a, b, c in ((1, 3, 2), (1, 2, 4), (2, 3, 4), (1, 4, 3)))
    file = tmp_path / "corner.obj"
    file.write_text("".join("v {} {} {}\n".format(*corner) for corner in corners) + faces)
    geometry = Geometry(ShapeType.MESH, Pose(), (2.0, 1.0, 1.0), str(file), mesh_hash(file))
    mechanism = Mechanism("m", "body", (Body("body", None, (geometry,)),), ())
    surface = collision_surfaces(mechanism, hulls=hulls)["body"]
    assert surface.vertices.max(axis=0) == pytest.approx((2, 1, 1), abs=1e-3)
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    volume = float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6
    assert volume == pytest.approx(1 / 3, rel=0.01)  # closed, and seen from outside


def test_visuals_come_from_the_urdf_and_stay_in_its_folder(tmp_path: Path) -> None:
    urdf = tmp_path / "seen.urdf"
    link = (
        "<robot name='r'><link name='it'><visual><origin xyz='0 0 1'/>"
        "<geometry>{}</geometry></visual></link></robot>"
    )
    urdf.write_text(link.format("<box size='1 1 1'/>"))
    assert visual_surfaces(urdf)["it"].centre == pytest.approx((0, 0, 1))
    urdf.write_text(link.format("<mesh filename='../elsewhere.stl'/>"))
    with pytest.raises(UrdfError, match="lies outside"):
        visual_surfaces(urdf)


def body_motion(twin: Twin, phases: tuple[tuple[str, int], ...] = ()) -> BodyMotion:
    """Three samples from 5 s on; the base drives 1 m, then the drawer opens by 0.2 m."""
    base = np.array([(0.0, 0, 0), (1, 0, 0), (1, 0, 0)])
    drawer = np.array([(0.0,), (0,), (0.2,)])
    lift, still = np.array([(0.0,), (0.4,), (0.4,)]), np.zeros((3, 1))
    return BodyMotion(
        twin.robots[0], "", ("lift_joint",), np.array([5.0, 7.0, 8.0]), base, lift, still, np.zeros((3, 3)),
        (joint(twin, "low_drawer_joint"),), drawer, still, phases,
    )  # fmt: skip


def test_a_film_has_the_phases_of_its_motion_without_gaps(twin: Twin) -> None:
    motion = body_motion(twin, (("drive", 0), ("follow", 1)))
    timeline = Timeline(motion, twin.state, twin.entities.coupling)
    assert timeline.duration == 3.0
    assert [(each.name, each.start, each.end) for each in timeline.phases] == [
        ("drive", 0.0, 2.0),
        ("follow", 2.0, 3.0),
    ]
    assert [timeline.phase(at).name for at in (0.0, 1.9, 2.0, 9.0)] == ["drive", "drive", "follow", "follow"]
    assert timeline.since_start(7.0) == 2.0
    assert Timeline(body_motion(twin), twin.state, twin.entities.coupling).phases[0].name == WHOLE


def test_a_film_is_the_spline_that_is_judged_and_the_kitchen_moves_along(twin: Twin) -> None:
    timeline = Timeline(body_motion(twin), twin.state, twin.entities.coupling)
    begin, between, end = (timeline.at(at) for at in (0.0, 1.0, 99.0))
    assert begin.base == (0.0, 0.0, 0.0)
    assert between.base == pytest.approx((0.5, 0.0, 0.0))  # Hermite, at rest at both ends
    assert timeline.at(0.5).base == pytest.approx((0.15625, 0.0, 0.0))
    assert between.robot == pytest.approx({"lift_joint": 0.2})
    assert end.kitchen[joint(twin, "low_drawer_joint")] == pytest.approx(0.2)


def test_a_container_without_a_robot_is_a_film_too_and_followers_follow(twin: Twin) -> None:
    door = twin.container("folding_door")
    motion = Motion(door.joint, np.array([0.0, 2.0]), np.array([[0.0], [0.4]]))
    timeline = Timeline(motion, twin.state, twin.entities.coupling)
    assert timeline.phases[0].name == KITCHEN_ALONE
    posture = timeline.at(2.0)
    assert posture.base is None
    assert posture.kitchen == pytest.approx(dict(twin.at({door.joint: 0.4}).state))


def test_a_motion_beyond_limits_is_shown_beyond_limits(twin: Twin) -> None:
    drawer = twin.container("low_drawer")
    motion = Motion(drawer.joint, np.array([0.0, 1.0]), np.array([[0.0], [drawer.upper + 1.0]]))
    timeline = Timeline(motion, twin.state, twin.entities.coupling)
    assert timeline.at(1.0).kitchen[drawer.joint] == pytest.approx(drawer.upper + 1.0)


def test_a_handles_path_is_as_long_as_its_drawer_moves(twin: Twin, looks: Looks) -> None:
    drawer = twin.container("low_drawer")
    joints = kitchen_positions(looks.skeleton, dict(twin.state))
    values = np.array([0.0, drawer.open_from])
    path = handle_path(looks, joints, local_name(drawer.handle), local_name(drawer.joint), values)
    assert np.linalg.norm(np.diff(path, axis=0), axis=1).sum() == pytest.approx(drawer.open_from)
    door = twin.container("folding_door")  # its path is that of the coupled door, not of the panel at rest
    path = handle_path(looks, joints, local_name(door.handle), local_name(door.joint), np.array([0.0, 0.5]))
    after = kitchen_positions(looks.skeleton, dict(twin.at({door.joint: 0.5}).state))
    middle = np.append(looks.collision[local_name(door.handle)].centre, 1.0)
    there = looks.skeleton.body(local_name(door.handle), after, np.eye(4)) @ middle
    assert path[-1] == pytest.approx(there[:3])


def test_a_passed_limit_is_drawn_from_where_the_joint_is_to_the_limit(twin: Twin, looks: Looks) -> None:
    line = limit_line(
        looks.skeleton, {"low_drawer_joint": 0.5}, np.eye(4), joint(twin, "low_drawer_joint"), 0.3
    )
    assert np.linalg.norm(line[-1] - line[0]) == pytest.approx(0.2)
    arc = limit_line(looks.skeleton, {"side_door_joint": 1.0}, np.eye(4), joint(twin, "side_door_joint"), 0.0)
    assert np.linalg.norm(np.diff(arc, axis=0), axis=1).sum() == pytest.approx(0.18, rel=1e-3)
    assert not len(limit_line(looks.skeleton, {}, np.eye(4), joint(twin, "wall_joint"), 0.0))


def refusal(evidence: Evidence | None, *, proof: bool = False) -> Diagnosis:
    return Diagnosis(Kind.EMBODIMENT, "because", evidence, proof)


def test_marks_name_who_is_red_and_when() -> None:
    links = (body_iri("r", "arm"), body_iri("k", "door"))
    near = Evidence(Quantity.DISTANCE, -0.01, 0.0, "m", links=links, time=2.0, scope="environment")
    often = Evidence(Quantity.COUNT, 7.0, 0.0, "1", links=links)
    elbow = joint_iri("r", "elbow")
    beyond = Evidence(Quantity.POSITION, 2.0, 1.5, "rad", entity=elbow, time=3.0)
    spent = Evidence(Quantity.TIME, 20.0, 20.0, "s", entity=body_iri("k", "handle"))
    contact, search, limit = marks_of(tuple(map(refusal, (near, often, None, beyond, spent))))
    assert (contact.what, contact.reason, contact.bodies, contact.time) == (What.CONTACT, 0, links, 2.0)
    assert (search.reason, search.time) == (1, None)
    assert "in the way 7 times" in search.text
    assert (limit.what, limit.reason, limit.joint, limit.bound) == (What.LIMIT, 3, elbow, 1.5)
    assert marks_of((refusal(beyond, proof=True),)) == ()  # a proof is shown by its region
    fast = Evidence(Quantity.VELOCITY, 2.0, 1.5, "rad/s", entity=elbow, time=3.0)
    assert math.isnan(marks_of((refusal(fast),))[0].bound)


def test_a_certificates_closest_pair_is_marked_at_its_time_only(twin: Twin) -> None:
    links = body_iri("k", "drawer_handle"), body_iri("r", "finger")
    figures = {"smallest distance, self": (0.02, "m"), "smallest distance, handle": (0.0002, "m")}
    pairs = {"smallest distance, handle": NearestPair(links, 7.5)}
    (mark,) = nearest_of(Answer(Case(twin), True, figures=figures, nearest_pairs=pairs))
    assert (mark.what, mark.bodies, mark.time) == (What.NEAREST, links, 7.5)
    assert mark.text == "nearest, handle: drawer_handle and finger, 0.2 mm"
    region = Mark(What.REGION, "proved")
    film = Film(Timeline(body_motion(twin), twin.state, twin.entities.coupling), (mark, region))
    assert film.seen(None) == [region]
    film.time = 2.4
    assert film.seen(None) == [region, mark]
    film.time = 0.0
    assert film.seen(mark) == [mark, region]


def test_names_of_phases_are_read_neither_as_markdown_nor_as_html(twin: Twin) -> None:
    names = "<img src=http://x/y>", "**b** [a](b)\n# c_é"
    motion = replace(body_motion(twin), phases=((names[0], 0), (names[1], 1)))
    said = Film(Timeline(motion, twin.state, twin.entities.coupling)).says()
    assert said.startswith(r"**\<img src\=http\:\/\/x\/y\>** → \*\*b\*\* \[a\]\(b\) \# c\_é")


def test_a_film_stops_at_its_end_and_begins_again(twin: Twin) -> None:
    film = Film(Timeline(body_motion(twin), twin.state, twin.entities.coupling))
    film.play()
    film.advance(2.0)
    assert (film.time, film.playing) == (2.0, True)
    assert "**whole motion**" in film.says()
    film.advance(2.0)
    assert (film.time, film.playing) == (3.0, False)
    film.play()
    assert (film.time, film.playing) == (0.0, True)
    nothing = Film(None)
    nothing.play()
    assert (nothing.playing, nothing.says()) == (False, "")
