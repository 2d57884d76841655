"""Φ stops a container where it meets another body, and lets everything else move."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from predicates.case import Answer, Case, Kind, Outcome, Quantity
from predicates.causes import causes
from predicates.law import law
from sdt_kg.iri import SDT
from sdt_kg.load import load_twin
from sdt_kg.motion import Motion
from sdt_kg.state import State
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.physics.oracle import Kinematics

PHYSICS = Kinematics()
A, B = load_twin("a"), load_twin("b")

DRAWER = """<robot name="post"><link name="world"/>
<link name="drawer"><collision><geometry><box size="0.018 0.5 0.2"/></geometry></collision></link>
<link name="drawer_handle"><collision><origin xyz="0.05 0 0"/>
<geometry><box size="0.01 0.2 0.01"/></geometry></collision></link>
<link name="post"><collision><geometry><box size="{thickness} {thickness} 1"/></geometry></collision></link>
<joint name="post_joint" type="fixed"><origin xyz="{at} 0.2 0"/>
<parent link="world"/><child link="post"/></joint>
<joint name="drawer_joint" type="prismatic"><parent link="world"/><child link="drawer"/><axis xyz="1 0 0"/>
<limit lower="0" upper="0.5" velocity="0.5" effort="10"/></joint>
<joint name="handle_joint" type="fixed"><parent link="drawer"/>
<child link="drawer_handle"/></joint></robot>"""


def asked(twin: Twin, name: str, verb: Verb = Verb.OPEN) -> Answer:
    (answer,) = causes(Case(twin, task=Task(verb, twin.container(name).iri)), PHYSICS)
    return answer


def all_open(twin: Twin) -> Twin:
    return twin.at({each.joint: each.upper for each in twin.containers()})


def stopped(twin: Twin, verb: Verb) -> set[str]:
    return {each.name for each in twin.containers() if not asked(twin, each.name, verb).holds}


def stopped_in(folder: Path, urdf: str) -> tuple[Answer, float]:
    """What is said of a kitchen's drawer that does not come open, and where it is stopped [m]."""
    (folder / "post.urdf").write_text(urdf)
    twin = load_twin(folder / "post.urdf")
    answer = asked(twin, "drawer")
    assert not answer.holds
    assert isinstance(answer.case.final, State)
    return answer, answer.case.final[twin.container("drawer").joint]


def with_post(folder: Path, at: float, thickness: float) -> Twin:
    (folder / "post.urdf").write_text(DRAWER.format(at=at, thickness=thickness))
    return load_twin(folder / "post.urdf")


def test_a_drawer_behind_a_closed_door_is_stopped_by_it() -> None:
    answer = asked(A, "dishwasher_drawer_middle")
    assert not answer.holds
    evidence = answer.diagnoses[0].evidence
    assert evidence is not None
    assert evidence.links is not None
    assert answer.diagnoses[0].kind is Kind.CAUSAL
    assert not answer.diagnoses[0].proof
    assert evidence.quantity is Quantity.DISTANCE
    assert evidence.value < evidence.bound < 0
    assert [each.rsplit("/", 1)[-1] for each in evidence.links] == [
        "dishwasher_drawer_middle",
        "cabinet7_door_bottom_left",
    ]
    assert isinstance(answer.case.final, State)
    joint = A.container("dishwasher_drawer_middle").joint
    assert answer.case.final[joint] == pytest.approx(0.1104, abs=1e-4)


def test_with_the_door_open_the_drawer_is_free() -> None:
    door = A.container("cabinet7_door_bottom_left")
    assert asked(A.at({door.joint: door.upper}), "dishwasher_drawer_middle").holds


def test_a_door_does_not_close_through_a_drawer_that_stands_out() -> None:
    small = {f"{A.environment}/joint/cabinet2_drawer_big_joint": 0.42}
    door = A.container("cabinet2_door_left")
    assert not asked(A.at({door.joint: 1.4, **small}), door.name, Verb.CLOSE).holds
    assert asked(A.at({door.joint: 1.4}), door.name, Verb.CLOSE).holds


@pytest.mark.parametrize(
    ("twin", "verb", "expected"),
    [
        (A, Verb.OPEN, {"dishwasher_drawer_middle"}),
        (B, Verb.OPEN, set[str]()),
        (all_open(A), Verb.CLOSE, {"cabinet7_door_bottom_left"}),
        (all_open(B), Verb.CLOSE, set[str]()),
    ],
)
def test_of_the_bundled_containers_only_the_blocked_ones_are_stopped(
    twin: Twin, verb: Verb, expected: set[str]
) -> None:
    assert stopped(twin, verb) == expected


@pytest.mark.parametrize("thickness", [0.005, 0.02, 0.1])
def test_a_post_before_a_drawer_stops_it_however_thin(tmp_path: Path, thickness: float) -> None:
    assert not asked(with_post(tmp_path, 0.3, thickness), "drawer").holds
    assert asked(with_post(tmp_path, 0.8, thickness), "drawer").holds


@pytest.mark.parametrize(("thickness", "allowed"), [(0.02, 0.0095), (0.1, 0.01)])
def test_a_drawer_stops_where_it_is_as_deep_as_is_allowed(
    tmp_path: Path, thickness: float, allowed: float
) -> None:
    twin = with_post(tmp_path, 0.3, thickness)
    block = PHYSICS._sweep_of(PHYSICS._of(twin), twin).first_block(
        twin.state, twin.container("drawer").joint, 0.45
    )
    assert block is not None
    assert block.position == pytest.approx(0.3 - thickness / 2 - 0.009 + allowed, abs=3e-6)
    assert block.depth > block.allowed == pytest.approx(allowed)


@pytest.mark.parametrize("thickness", [1e-4, 3e-4])
def test_a_sheet_does_not_go_through_another_however_far_that_is(tmp_path: Path, thickness: float) -> None:
    sheet = DRAWER.replace("0.018 0.5 0.2", f"{thickness} 0.5 0.2").replace(" {thickness} 1", " 0.2 1")
    for at in np.linspace(0.1, 0.4, 20):
        (tmp_path / "post.urdf").write_text(sheet.format(at=at, thickness=thickness))
        twin = load_twin(tmp_path / "post.urdf")
        block = PHYSICS._sweep_of(PHYSICS._of(twin), twin).first_block(
            twin.state, twin.container("drawer").joint, 0.45
        )
        assert block is not None, at
        assert block.moved.endswith("/drawer")


def test_a_drawer_does_not_pass_a_post_by_small_steps_either(tmp_path: Path) -> None:
    twin = with_post(tmp_path, 0.3, 0.1)
    joint, step = twin.container("drawer").joint, 0.008
    passed = [0.0]
    while passed[-1] < 0.45:
        begins, ends = twin.at({joint: passed[-1]}), passed[-1] + step
        motion = Motion(joint, np.array([0.0, 1.0]), np.array([[passed[-1]], [ends]]))
        if not next(causes(Case(begins, motion=motion), PHYSICS)).holds:
            break
        passed.append(ends)
    assert 0.2 < passed[-1] < 0.26


@pytest.mark.parametrize("verb", list(Verb))
def test_nothing_begins_where_it_is_deep_in_another_body(tmp_path: Path, verb: Verb) -> None:
    twin = with_post(tmp_path, 0.3, 0.1)
    diagnosis, *_ = asked(twin.at({twin.container("drawer").joint: 0.3}), "drawer", verb).diagnoses
    assert diagnosis.evidence is not None
    assert diagnosis.evidence.time == 0
    assert not diagnosis.proof


def test_an_obstacle_of_an_edited_twin_is_seen(tmp_path: Path) -> None:
    twin = with_post(tmp_path, 0.8, 0.1)
    (row,) = twin.query(
        f"SELECT ?shape {{ <{twin.environment}/body/post> <{SDT}hasCollisionGeometry> ?shape }}"
    )[1]
    assert asked(twin, "drawer").holds
    assert not asked(twin.with_edit(str(row["shape"]), sizeX=0.9), "drawer").holds


def test_a_stop_found_with_outer_shapes_proves_nothing() -> None:
    twin = load_twin("a")
    task = Task(Verb.OPEN, twin.container("dishwasher_drawer_middle").iri)
    (verdict,) = law(Case(twin, task=task), Kinematics())
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    kinds = {(each.kind, each.proof) for each in verdict.diagnoses}
    assert {(Kind.SEMANTIC, False), (Kind.CAUSAL, False)} <= kinds
    assert True not in {proof for _, proof in kinds}


def angle(file: Path, thick: float, wide: float, rim: float, high: float) -> str:
    """A board of that thickness along x, centred, with a rim at one end of its width: one bent mesh."""
    x, y = thick / 2, wide / 2
    ground = [(-x, -y), (x, -y), (x, y), (x + rim, y), (x + rim, y + thick), (-x, y + thick)]
    corners = [(*point, z) for z in (-high / 2, high / 2) for point in ground]
    flat = [(0, 1, 2), (0, 2, 5), (2, 3, 4), (2, 4, 5)]
    sides = [(k, (k + 1) % 6, (k + 1) % 6 + 6) for k in range(6)]
    sides += [(k, (k + 1) % 6 + 6, k + 6) for k in range(6)]
    faces = [face[::-1] for face in flat] + [(a + 6, b + 6, c + 6) for a, b, c in flat] + sides
    trimesh.Trimesh(corners, faces, process=False).export(file)
    return f'<mesh filename="{file.name}"/>'


@pytest.mark.parametrize("bent", [False, True], ids=["boxes", "meshes"])
def test_a_drawer_does_not_pass_a_wall_that_is_a_bent_mesh(tmp_path: Path, bent: bool) -> None:
    # Triangles have no thickness: a thin board is never deep in one of them, and two meshes never are.
    wall = angle(tmp_path / "wall.stl", 0.1, 2.0, 0.3, 2.0)
    urdf = DRAWER.replace('<box size="{thickness} {thickness} 1"/>', wall).format(at=0.25)
    if bent:
        front = angle(tmp_path / "front.stl", 0.018, 0.5, 0.02, 0.2)
        bar = angle(tmp_path / "bar.stl", 0.01, 0.2, 0.01, 0.01)
        urdf = urdf.replace('<box size="0.018 0.5 0.2"/>', front).replace('<box size="0.01 0.2 0.01"/>', bar)
    (tmp_path / "post.urdf").write_text(urdf)
    twin = load_twin(tmp_path / "post.urdf")
    answer, drawer = asked(twin, "drawer"), twin.container("drawer")
    assert not answer.holds
    assert isinstance(answer.case.final, State)
    met = 0.2 - 0.055 - (0.01 if bent else 0.0)  # the bar comes to the wall's face, the mesh's rim first
    at = answer.case.final[drawer.joint]
    assert (met - 3e-5 <= at < met) if bent else (met - 1e-6 <= at <= met + 0.006)
    stands = twin.at({drawer.joint: at})
    assert asked(stands, "drawer", Verb.CLOSE).holds is bent  # nothing begins where it is deep
    for further in (0.001, 0.01):
        motion = Motion(drawer.joint, np.array([0.0, 2.0]), np.array([[at], [at + further]]))
        assert PHYSICS.replay(stands, motion).violations


def test_a_front_that_runs_in_a_slot_of_a_wall_stops_where_the_slot_ends(tmp_path: Path) -> None:
    # The slot is 1.8 % of the wall: in a solid one the front was drawn 80 mm deep, and so might go through.
    face, ground = 0.17 - 0.2, 0.26 - 0.2
    line = [
        (-2, face),
        (-0.06, face),
        (-0.06, ground),
        (0.1, ground),
        (0.1, face),
        (2, face),
        (2, 0.17),
        (-2, 0.17),
    ]
    flat = [(0, 1, 2), (0, 2, 7), (2, 3, 6), (2, 6, 7), (3, 4, 5), (3, 5, 6)]
    sides = [(k, (k + 1) % 8, (k + 1) % 8 + 8) for k in range(8)]
    sides += [(k, (k + 1) % 8 + 8, k + 8) for k in range(8)]
    faces = [each[::-1] for each in flat] + [(a + 8, b + 8, c + 8) for a, b, c in flat] + sides
    corners = [(x, y, z) for z in (-1.0, 1.0) for x, y in line]
    trimesh.Trimesh(corners, faces, process=False).export(tmp_path / "wall.stl")
    wall = DRAWER.replace('<box size="{thickness} {thickness} 1"/>', '<mesh filename="wall.stl"/>')
    _, at = stopped_in(tmp_path, wall.format(at=0.0))
    assert 0.091 <= at <= 0.0965


@pytest.mark.parametrize("sections", [16, 128])
def test_a_drawer_comes_no_deeper_into_a_ring_of_small_triangles_than_into_one_of_large_ones(
    tmp_path: Path, sections: int
) -> None:
    ring = trimesh.creation.torus(0.08, 0.04, major_sections=sections, minor_sections=sections)
    ring.export(tmp_path / "ring.stl")
    bent = DRAWER.replace('<box size="{thickness} {thickness} 1"/>', '<mesh filename="ring.stl"/>')
    _, at = stopped_in(tmp_path, bent.format(at=0.3))
    met = 0.3 - 0.12 - 0.009  # the front, whose thickness allows a quarter of it
    assert at == pytest.approx(met + 0.018 / 4, abs=1e-4)


def sheet(file: Path) -> str:
    """A bent sheet without thickness, aslant to x."""
    ground = ((0.0, -0.1), (0.2, 0.0), (0.408, 0.1))
    corners = [(x, y, z) for z in (-0.05, 0.05) for x, y in ground]
    faces = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)]
    trimesh.Trimesh(corners, faces, process=False).export(file)
    return f'<mesh filename="{file.name}"/>'


@pytest.mark.parametrize("at", [2e-4, 0.23, 0.2317, 0.301])
def test_a_sheet_does_not_pass_through_one_like_it_between_two_steps(tmp_path: Path, at: float) -> None:
    thin = DRAWER.replace('<box size="{thickness} {thickness} 1"/>', sheet(tmp_path / "wall.stl"))
    thin = thin.replace('<box size="0.018 0.5 0.2"/>', sheet(tmp_path / "front.stl"))
    thin = thin.replace('<origin xyz="0.05 0 0"/>', '<origin xyz="0.05 0 0.5"/>')
    answer, where = stopped_in(tmp_path, thin.replace("{at} 0.2 0", f"{at} 0 0"))
    assert at - 1e-4 <= where < at
    assert "not convex" in answer.diagnoses[0].reason
    twin = load_twin(tmp_path / "post.urdf")
    drawer = twin.container("drawer")
    assert not asked(twin.at({drawer.joint: where}), "drawer").holds  # nor from there on


@pytest.mark.parametrize("thickness", [1e-6, 1e-5])
@pytest.mark.parametrize("meshes", [False, True])
def test_nothing_is_so_thin_that_it_passes(tmp_path: Path, thickness: float, meshes: bool) -> None:
    plate, wall = f'<box size="{thickness} 0.5 0.2"/>', f'<box size="{thickness} 0.3 0.2"/>'
    if meshes:
        trimesh.creation.box((thickness, 0.5, 0.2)).export(tmp_path / "plate.stl")
        plate, wall = '<mesh filename="plate.stl"/>', sheet(tmp_path / "wall.stl")
    urdf = DRAWER.replace('<box size="{thickness} {thickness} 1"/>', wall)
    urdf = urdf.replace('<box size="0.018 0.5 0.2"/>', plate).replace('"0.05 0 0"', '"0.05 0 0.5"')
    _, where = stopped_in(tmp_path, urdf.format(at=0.3))
    assert 0.2999 <= where <= 0.3003


@pytest.mark.parametrize("at", [2e-4, 0.1])
def test_a_bent_sheet_does_not_turn_through_one_like_it(tmp_path: Path, at: float) -> None:
    turned = f"""<robot name="leaf"><link name="world"/>
    <link name="door"><collision><origin xyz="0.3 0 0"/><geometry>{sheet(tmp_path / "front.stl")}</geometry>
    </collision></link><link name="door_handle"><collision><origin xyz="0.7 0 0.5"/><geometry>
    <box size="0.01 0.01 0.1"/></geometry></collision></link>
    <link name="wall"><collision><origin xyz="0.3 0 0"/><geometry>{sheet(tmp_path / "wall.stl")}</geometry>
    </collision></link><joint name="wall_joint" type="fixed"><origin rpy="0 0 {at}"/><parent link="world"/>
    <child link="wall"/></joint>
    <joint name="door_joint" type="revolute"><parent link="world"/><child link="door"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1.5" velocity="0.5" effort="10"/></joint>
    <joint name="handle_joint" type="fixed"><parent link="door"/><child link="door_handle"/></joint>
    </robot>"""
    (tmp_path / "leaf.urdf").write_text(turned)
    twin = load_twin(tmp_path / "leaf.urdf")
    answer, door = asked(twin, "door"), twin.container("door")
    assert isinstance(answer.case.final, State)
    assert at - 4e-4 <= answer.case.final[door.joint] < at


def test_bent_meshes_that_were_fitted_together_slide_on_each_other(tmp_path: Path) -> None:
    board = angle(tmp_path / "front.stl", 0.018, 0.5, 0.02, 0.2)
    urdf = DRAWER.replace('<box size="0.018 0.5 0.2"/>', board).format(at=0.0, thickness=0.1)
    urdf = urdf.replace('<box size="0.1 0.1 1"/>', angle(tmp_path / "rail.stl", 0.6, 0.02, 0.02, 0.02))
    (tmp_path / "post.urdf").write_text(urdf)
    assert asked(load_twin(tmp_path / "post.urdf"), "drawer").holds


@pytest.mark.parametrize(("way", "meet"), [(-1.0, True), (1.0, False)])
def test_two_leaves_of_which_one_follows_the_other_do_not_go_through_each_other(
    tmp_path: Path, way: float, meet: bool
) -> None:
    leaf = '<link name="leaf"><collision><geometry><box size="0.02 0.5 0.2"/></geometry></collision></link>'
    follows = f"""<joint name="leaf_joint" type="prismatic"><origin xyz="0.4 0 0"/><parent link="world"/>
    <child link="leaf"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/>
    <mimic joint="drawer_joint" multiplier="{way}"/></joint>"""
    urdf = DRAWER.format(at=2.0, thickness=0.1).replace("</robot>", f"{leaf}{follows}</robot>")
    (tmp_path / "post.urdf").write_text(urdf)
    answer = asked(load_twin(tmp_path / "post.urdf"), "drawer")
    assert answer.holds is not meet
    if meet:
        assert answer.diagnoses[0].evidence is not None
        assert answer.diagnoses[0].evidence.links is not None
        assert "leaf" in "".join(answer.diagnoses[0].evidence.links)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_a_thin_drawer_does_not_pass_a_pane_however_both_lie_in_their_files(
    tmp_path: Path, turn: float
) -> None:
    turned = trimesh.transformations.euler_matrix(turn / 2, turn, turn, "sxyz")
    urdf, thin = DRAWER.format(at=0.0, thickness=1), 0.004
    pane = '<box size="1 1 1"/>', (thin, 1.0, 1.0), (0.3, 0.7, 0.0)  # beside the bar
    front = '<box size="0.018 0.5 0.2"/>', (thin, 0.5, 0.2), (0.0, 0.0, 0.0)
    bar = '<box size="0.01 0.2 0.01"/>', (0.01, 0.2, 0.01), (0.0, 0.0, 0.0)
    for k, (box, size, at) in enumerate((pane, front, bar)):
        mesh = trimesh.creation.box(size)
        mesh.apply_translation(at)
        mesh.apply_transform(turned)
        mesh.export(tmp_path / f"{k}.stl")
        urdf = urdf.replace(box, f'<mesh filename="{k}.stl"/>')
    x, y, z = turned[:3, 0]
    urdf = urdf.replace("0.0 0.2 0", "0 0 0").replace('axis xyz="1 0 0"', f'axis xyz="{x} {y} {z}"')
    (tmp_path / "post.urdf").write_text(urdf)
    assert not asked(load_twin(tmp_path / "post.urdf"), "drawer").holds


def with_rail(folder: Path, deep: float) -> Twin:
    """A rail along the drawer's way, drawn so deep [m] into the lower edge of its front."""
    rail = DRAWER.replace("{thickness} {thickness} 1", "0.8 0.1 0.1").replace("{at} 0.2 0", "0.3 0.2 {z}")
    (folder / "rail.urdf").write_text(rail.format(z=deep - 0.15))
    return load_twin(folder / "rail.urdf")


@pytest.mark.parametrize(("deep", "told"), [(-0.01, False), (0.003, False), (0.02, True)])
def test_that_a_drawer_goes_through_what_it_is_drawn_into_is_told(
    tmp_path: Path, deep: float, told: bool
) -> None:
    answer = asked(with_rail(tmp_path, deep), "drawer")
    assert answer.holds
    mm, allowed = 1e3 * deep, 1e3 * (2 * deep + min(0.01, 0.25 * 0.118))
    why = f"the model has them {mm:.1f} mm in each other, so {allowed:.1f} mm are allowed"
    assert (f"drawer goes {mm:.1f} mm deep in post: {why}" in answer.notes) is told
    assert len([note for note in answer.notes if " deep in " in note]) == told


def test_that_more_was_allowed_of_what_is_drawn_into_another_is_told(tmp_path: Path) -> None:
    wall = DRAWER.replace("{thickness} {thickness} 1", "0.1 0.6 1").replace("{at} 0.2 0", "0.054 0 0")
    (tmp_path / "wall.urdf").write_text(wall)
    answer = asked(load_twin(tmp_path / "wall.urdf"), "drawer")
    assert not answer.holds
    assert "51.500 mm allowed, as the model has them 51.0 mm in each other" in answer.diagnoses[0].reason
