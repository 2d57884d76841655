"""Edits as typed: what is moved is where it is said, different things commute, undoing restores."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from predicates.case import Case, Kind
from predicates.causes import causes
from predicates.record.inputs import inputs_of, verdict_iri
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.history import History
from sdt_kg.iri import body_iri, joint_iri, local_name
from sdt_kg.load import load_twin
from sdt_kg.mechanism import JointType, Mechanism
from sdt_kg.motion import Motion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.app import Policy, Service, load
from services.edits import parse_edit
from services.physics.oracle import Kinematics
from services.whatif import World, changed, parse_change
from tests.small import FOLDER, small_twin

TWIN = small_twin("a", ("pr2",))
WORLD = World(Service(TWIN, Policy()), "pr2")
NUMBERS = st.floats(-2, 2).map(lambda each: round(each, 3))
SIZES = st.floats(0.01, 1).map(lambda each: round(each, 3))


def place_of(kitchen: Mechanism, body: str) -> np.ndarray:
    """root_T_body with every joint at 0."""
    above = {each.child: each for each in kitchen.joints}
    root_T_body = np.eye(4)
    while body in above:
        root_T_body = above[body].origin.matrix() @ root_T_body
        body = above[body].parent
    return root_T_body


def fixed_bodies(twin: Twin) -> list[str]:
    """Bodies that hang on the root by fixed joints alone."""
    kitchen = twin.mechanism(twin.environment)
    still = {kitchen.root}
    for joint in kitchen.joints:
        if joint.type is JointType.FIXED and joint.parent in still:
            still.add(joint.child)
    return sorted(still - {kitchen.root})


def hash_of(twin: Twin) -> tuple[str, str]:
    return twin.content_hash(twin.environment), repr(twin.state.positions)


def test_furniture_is_moved_and_turned_where_it_stands_with_all_on_it() -> None:
    body = fixed_bodies(TWIN)[0]
    kitchen = TWIN.mechanism(TWIN.environment)
    after = parse_edit(TWIN, f"furniture:{body}=0.3,-0.2,0.1,{math.pi / 2}").applied(TWIN)
    moved = after.mechanism(after.environment)
    before_T, after_T = place_of(kitchen, body), place_of(moved, body)
    np.testing.assert_allclose(after_T[:3, 3] - before_T[:3, 3], (0.3, -0.2, 0.1), atol=1e-12)
    turn = after_T[:3, :3] @ before_T[:3, :3].T
    np.testing.assert_allclose(turn, ((0, -1, 0), (1, 0, 0), (0, 0, 1)), atol=1e-12)
    child = next((each.child for each in kitchen.joints if each.parent == body), None)
    if child is not None:
        relative = np.linalg.inv(before_T) @ place_of(kitchen, child)
        np.testing.assert_allclose(np.linalg.inv(after_T) @ place_of(moved, child), relative, atol=1e-12)


def test_a_limit_of_the_robot_may_be_otherwise_by_a_share_too() -> None:
    change = parse_change("set:pr2/lift_joint.upperLimit=0.1")
    (pr2,) = TWIN.robots
    uppers = [
        changed(WORLD, (change,), share).service.twin.mechanism(pr2).joint("lift_joint").limits.upper
        for share in (0.0, 0.5, 1.0)
    ]
    assert uppers == pytest.approx([1.5, 0.8, 0.1])
    with pytest.raises(UnknownEntityError, match="no joint named 'lift_jnt'; did you mean 'lift_joint'"):
        changed(WORLD, (parse_change("set:pr2/lift_jnt.upperLimit=0.1"),))


@pytest.mark.parametrize(
    "text",
    [
        "handle:low_drawer=1e300,0,0",
        "furniture:low_drawer=-1e200,0",
        "box:crate=1,1,1@1e9,0,0",
        "pose:low_drawer_joint=1e7,0,0",
    ],
)
def test_a_place_out_of_this_world_is_refused_as_in_a_file(text: str) -> None:
    with pytest.raises(InputError, match=r"is too large; allowed: up to 1e\+06"):
        changed(WORLD, (parse_change(text),))


@pytest.mark.parametrize("limit", ["velocityLimit", "accelerationLimit"])
def test_about_a_container_that_moves_with_a_stuck_joint_the_law_abstains(limit: str) -> None:
    """Its own limits are inside of D_artic; those over the coupling are not."""
    twin = changed(WORLD, (parse_change(f"set:upper_panel_joint.{limit}=0"),)).service.twin
    door = twin.container("folding_door")
    task = Task(Verb.OPEN, door.iri)
    moved = Motion(door.joint, np.linspace(0, 9, 50), np.linspace(0, 1.9, 50)[:, None], timed=False)
    for case in (Case(twin, task=task), Case(twin, task=task, motion=moved)):
        (answer,) = causes(case, Kinematics())
        (said,) = answer.diagnoses
        assert (answer.holds, said.kind, said.proof) == (False, Kind.OUT_OF_SCOPE, False)
        assert said.reason.endswith("above 0, else a joint that it moves with is stuck")
        assert said.evidence is not None
        assert (said.evidence.entity, said.evidence.value, said.evidence.bound) == (door.joint, 0.0, 0.0)


def test_a_robot_that_was_changed_is_the_same_one_in_another_kitchen() -> None:
    higher, elsewhere = map(parse_change, ("set:pr2/lift_joint.upperLimit=0.9", "kitchen:b"))
    before, after = (changed(WORLD, each).service.twin for each in ((higher,), (higher, elsewhere)))
    (robot,) = after.robots
    assert after.name(after.environment) == "b"
    assert after.content_hash(robot) == before.content_hash(robot) != TWIN.content_hash(robot)


def test_a_whole_change_is_to_the_last_bit_what_was_asked() -> None:
    twin = changed(WORLD, (parse_change("set:low_drawer_joint.velocityLimit=0.1"),)).service.twin
    joint = twin.mechanism(twin.environment).joint("low_drawer_joint")
    assert joint.limits.velocity == 0.1


@pytest.mark.parametrize("limit", ["velocityLimit", "accelerationLimit"])
def test_what_would_take_longer_than_any_motion_is_not_caused_and_no_error(limit: str) -> None:
    twin = changed(WORLD, (parse_change(f"set:low_drawer_joint.{limit}=1e-300"),)).service.twin
    (answer,) = causes(Case(twin, task=Task(Verb.OPEN, twin.container("low_drawer").iri)), Kinematics())
    (said,) = answer.diagnoses
    assert said.reason == "the physics found no motion into the goal"
    assert not said.proof


def test_what_hangs_on_a_door_is_no_furniture() -> None:
    handle = local_name(TWIN.containers()[0].handle)
    with pytest.raises(InputError, match="which moves"):
        parse_edit(TWIN, f"furniture:{handle}=1,0")


def test_a_mesh_is_an_obstacle_with_its_content_in_the_hash(tmp_path) -> None:
    worlds = []
    for height in (1, 2):
        file = tmp_path / f"{height}.stl"
        corners = f"vertex 0 0 0\nvertex 1 0 0\nvertex 0 0 {height}\n"
        file.write_text(f"solid a\nfacet normal 0 1 0\nouter loop\n{corners}endloop\nendfacet\nendsolid a\n")
        worlds.append(changed(WORLD, (parse_change(f"mesh:sail={file}*0.5@1,2,0"),)))
    twins = [each.service.twin for each in worlds]
    assert len({hash_of(TWIN), *map(hash_of, twins)}) == 3
    shapes = {each.name: each.collision for each in twins[0].mechanism(TWIN.environment).bodies}
    assert shapes["sail"][0].size == (0.5, 0.5, 0.5)


def test_a_payload_takes_the_gripper_and_may_touch_that_hand_alone() -> None:
    robot = TWIN.robots[0]
    names = [each.name for each in TWIN.robot(robot).grippers]
    if len(names) < 2:
        with pytest.raises(InputError, match="only gripper"):
            changed(WORLD, (parse_change(f"payload:{names[0]}=0.1,0.1,0.1"),))
        return
    after = changed(WORLD, (parse_change(f"payload:{names[0]}=0.1,0.1,0.2,1.5"),)).service.twin
    assert [each.name for each in after.robot(robot).grippers] == names[1:]
    (body,) = (each for each in after.mechanism(robot).bodies if each.name == f"{names[0]}_payload")
    assert body.inertia is not None
    assert body.inertia.mass == 1.5
    touching = {
        other
        for pair in after.robot(robot).allowed_contacts - TWIN.robot(robot).allowed_contacts
        for other in pair
    }
    assert touching >= set(TWIN.robot(robot).grippers[0].fingers) | {body.name}
    assert body_iri(after.name(robot), body.name)


def test_the_mass_of_a_payload_is_where_its_box_is() -> None:
    world = World(load("b", ["tiago_dual"]), "tiago_dual")
    robot = world.service.robot(None)
    after = changed(world, (parse_change("payload:left=0.1,0.2,0.3,2"),)).service.twin
    (gripper,) = (each for each in world.service.twin.robot(robot).grippers if each.name == "left")
    (body,) = (each for each in after.mechanism(robot).bodies if each.name == "left_payload")
    assert body.inertia is not None
    assert body.inertia.pose == body.collision[0].pose == gripper.tool
    assert gripper.tool.position == (0.05, 0.0, 0.0)
    assert body.inertia.moments == pytest.approx((2 * 0.13 / 12, 0, 0, 2 * 0.10 / 12, 0, 2 * 0.05 / 12))


BODIES, JOINTS = fixed_bodies(TWIN), [local_name(each.joint) for each in TWIN.containers()]
EDITS = st.one_of(
    st.builds(
        lambda name, x, y, z, side: (name, f"box:{name}={side},{side},{side}@{x},{y},{z}"),
        st.sampled_from(["crate", "chair", "bin"]),
        *[NUMBERS] * 3,
        SIZES,
    ),
    st.builds(
        lambda name, x, y: (name, f"furniture:{name}={x},{y}"), st.sampled_from(BODIES), *[NUMBERS] * 2
    ),
    st.builds(lambda name, v: (name, f"set:{name}.velocityLimit={v}"), st.sampled_from(JOINTS), SIZES),
    st.builds(
        lambda each, share: (
            each.name + " state",
            f"move:{each.name}={round(share * each.upper / each.multiplier, 4)}",
        ),
        st.sampled_from(TWIN.containers()),
        st.floats(0.05, 1),
    ),
)


def test_a_joint_that_follows_another_is_moved_where_it_is_said() -> None:
    folding = TWIN.container("folding_door")
    text = f"move:{local_name(folding.joint)}=0.4"
    assert parse_edit(TWIN, text).applied(TWIN).state[folding.joint] == pytest.approx(0.4)
    change = parse_change(text)
    assert change.at(WORLD, 1.0).service.twin.state[folding.joint] == pytest.approx(0.4)
    half = change.at(WORLD, 0.5).service.twin
    assert half.state[folding.joint] == pytest.approx(0.2)
    assert half.state[folding.active_joint] == pytest.approx(0.2 / folding.multiplier)
    with pytest.raises(InputError, match="several"):
        parse_change("move:all=open").at(WORLD, 1.0)


@settings(max_examples=20, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(EDITS, min_size=2, max_size=3, unique_by=lambda each: each[0]), st.randoms())
def test_edits_of_different_entities_commute(edits: list[tuple[str, str]], random) -> None:
    texts = [each[1] for each in edits]
    other = random.sample(texts, len(texts))
    made = [changed(WORLD, tuple(map(parse_change, each))).service.twin for each in (texts, other)]
    assert hash_of(made[0]) == hash_of(made[1])


@settings(max_examples=20, suppress_health_check=[HealthCheck.too_slow])
@given(EDITS)
def test_an_undone_edit_restores_the_content(edit: tuple[str, str]) -> None:
    history = History.of(TWIN)
    history, made = history.derived(history.first, parse_edit(TWIN, edit[1]))
    _, back = history.undone(made)
    assert back.content_hash == history.first.content_hash
    assert hash_of(back.twin) == hash_of(TWIN)


@pytest.mark.parametrize(
    "texts",
    [
        ("box:crate=1,1,1@3,3,0.5", "without:crate"),
        (f"move:{TWIN.containers()[0].name}=open", f"move:{TWIN.containers()[0].name}=closed"),
        ("drive:fixed", "drive:omni"),
    ],
)
def test_an_undone_edit_restores_the_verdict_s_iri(texts: tuple[str, str]) -> None:
    world = changed(WORLD, (parse_change("drive:omni"),))
    there, back = (changed(world, tuple(map(parse_change, texts[:n]))) for n in (1, 2))
    assert _iri(back) == _iri(world) != _iri(there)


def _iri(world: World) -> str:
    service = world.service
    case = service.case(f"open:{TWIN.containers()[0].name}", world.robot_iri)
    return verdict_iri(inputs_of(case, service.physics, service.embodiment))


def slashed(tmp_path: Path, *names: str) -> Twin:
    """Drawers whose joints have these names, and the small robot."""
    parts = (
        f"""<link name="drawer_{k}"/><joint name="{name}" type="prismatic">
          <parent link="room"/><child link="drawer_{k}"/><axis xyz="1 0 0"/>
          <limit lower="0" upper="0.4" velocity="1" effort="1"/></joint>"""
        for k, name in enumerate(names)
    )
    path = tmp_path / "room.urdf"
    path.write_text(f'<robot name="room"><link name="room"/>{"".join(parts)}</robot>')
    return load_twin(path, [FOLDER / "pr2.urdf"])


def upper(twin: Twin, model: str, joint: str) -> float:
    return twin.mechanism(model).joint(joint).limits.upper


def test_a_joint_with_a_slash_in_its_name_is_edited(tmp_path: Path) -> None:
    twin = slashed(tmp_path, "left/rail", "rail")
    (robot,) = twin.robots
    own = next(each for each in twin.mechanism(robot).joints if each.type is JointType.PRISMATIC).name
    for text, model, joint in (
        ("set:left/rail.upperLimit=0.3", twin.environment, "left/rail"),
        ("set:room/left/rail.upperLimit=0.3", twin.environment, "left/rail"),
        ("set:room/rail.upperLimit=0.3", twin.environment, "rail"),
        (f"set:pr2/{own}.upperLimit=0.3", robot, own),
    ):
        assert upper(parse_edit(twin, text).applied(twin), model, joint) == 0.3, text
        world = World(Service(twin, Policy()), "pr2")
        after = changed(world, (parse_change(text),)).service.twin
        assert upper(after, model, joint) == pytest.approx(0.3), text
    moved = parse_edit(twin, "move:left/rail=0.2").applied(twin)
    assert moved.state[joint_iri("room", "left/rail")] == 0.2


def test_a_name_with_a_slash_that_is_none_or_two_is_told(tmp_path: Path) -> None:
    twin = slashed(tmp_path, "left/rail", "pr2/lift_joint", "base")
    own = twin.mechanism(twin.robots[0]).joints[0].name
    for text, said in (
        ("set:left/rial.upperLimit=0.3", "no joint named 'left/rial'"),
        ("set:pr2/nothing.upperLimit=0.3", "no joint named 'nothing'"),
    ):
        with pytest.raises(UnknownEntityError, match=said):
            parse_edit(twin, text)
    with pytest.raises(UnknownEntityError, match="no kitchen or robot named 'pr3'"):
        parse_edit(TWIN, f"set:pr3/{own}.upperLimit=0.3")
    both = slashed(tmp_path, f"pr2/{own}")
    with pytest.raises(InputError, match=f"'room/pr2/{own}' is the kitchen's"):
        parse_edit(both, f"set:pr2/{own}.upperLimit=0.3")
    edited = parse_edit(both, f"set:room/pr2/{own}.upperLimit=0.3").applied(both)
    assert upper(edited, both.environment, f"pr2/{own}") == 0.3


@pytest.mark.parametrize("edit", ["kitchen:b", "robot:stretch"])
def test_the_force_that_is_allowed_at_handles_goes_along_to_another_kitchen(edit: str) -> None:
    world = World(load("a", robots=["pr2"]).with_forces(handle_force=7.0), "pr2")
    there = changed(world, [parse_change(edit)]).service.twin
    facts = there.entities.facts
    models = {model for each in there.containers() for model in facts.iris(each.joint, "hasForceModel")}
    assert models
    assert {facts.number(model, "allowedHandleForce") for model in models} == {7.0}
