"""Loading: bundled names and paths, which annotation is taken, and what is wrong with others."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from sdt_kg.annotation import Drive
from sdt_kg.errors import AnnotationError, InputError, UnknownEntityError
from sdt_kg.iri import body_iri, model_iri
from sdt_kg.load import bundled, load_twin, model_name, read_robot, with_robot
from sdt_kg.mechanism import Pose
from tests.sdt_kg.conftest import Write, joint, limit, link

PREFIX = "@prefix sdt: <https://example.org/sdt#> .\n@prefix id: <https://example.org/id/> .\n"
START = (
    "id:START a sdt:Pose ; sdt:x 1.0 ; sdt:y 2.0 ; sdt:z 0.0 ; sdt:qx 0.0 ; sdt:qy 0.0 ; "
    "sdt:qz 1.0 ; sdt:qw 0.0 .\n"
)
KITCHEN = f"{PREFIX}id:k a sdt:Environment ; sdt:startPose id:START .\n{START}"


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_bundled_robots_have_a_complete_annotation(robot: str) -> None:
    twin = load_twin("b", [robot])
    annotation = twin.robot(twin.robots[0])
    mechanism = twin.mechanism(twin.robots[0])
    assert annotation.robot == robot == mechanism.name
    bodies, joints = {body.name for body in mechanism.bodies}, {joint.name for joint in mechanism.joints}
    assert annotation.base_body in bodies
    assert annotation.grippers
    for gripper in annotation.grippers:
        assert bodies >= {gripper.tool_body, *gripper.fingers}
        assert joints >= {finger.joint for finger in gripper.finger_joints}
        assert gripper.opening > 0.05
    assert joints >= {*annotation.parked, *annotation.held, *annotation.acceleration}
    for name, acceleration in annotation.acceleration.items():
        assert mechanism.joint(name).limits.acceleration == acceleration


def test_drives_are_those_of_the_hardware() -> None:
    drives = {name: load_twin("b", [name]) for name in ("pr2", "tiago_dual", "stretch")}
    found = {name: twin.robot(twin.robots[0]).drive for name, twin in drives.items()}
    assert found == {
        "pr2": Drive.OMNI,
        "tiago_dual": Drive.DIFFERENTIAL,
        "stretch": Drive.DIFFERENTIAL,
    }


def test_start_poses_are_those_of_the_paper() -> None:
    assert load_twin("a").kitchen().start == (1.5, 2.0, 0.0)
    assert load_twin("b").kitchen().start == (0.0, 0.0, 0.0)


def test_several_robots_may_be_loaded() -> None:
    twin = load_twin("b", ["pr2", "stretch"])
    assert [twin.name(robot) for robot in twin.robots] == ["pr2", "stretch"]


@pytest.mark.parametrize(
    ("kitchen", "robots", "near"),
    [
        ("c", [], "allowed: a, b"),
        ("b", ["pr3"], "did you mean 'pr2'"),
        ("b", ["tiago"], "no robot named 'tiago'; did you mean 'tiago_dual'? a bundled name, or the path"),
        ("b", ["b"], "pr2, stretch, tiago_dual"),
    ],
)
def test_unknown_models_are_refused_with_names(kitchen: str, robots: list[str], near: str) -> None:
    with pytest.raises(UnknownEntityError) as caught:
        load_twin(kitchen, robots)
    assert near in str(caught.value)


def test_one_name_for_two_models_is_refused() -> None:
    with pytest.raises(InputError, match="two models are named 'pr2'"):
        load_twin("b", ["pr2", "pr2"])


def test_a_kitchen_without_annotation_starts_at_the_origin_and_says_so(drawer: Path) -> None:
    twin = load_twin(drawer)
    assert twin.kitchen().start == (0.0, 0.0, 0.0)
    assert twin.container("cupboard_drawer").acceleration == 1.0
    assert any("assumed to start at x = 0" in note for note in twin.kitchen().notes)


@pytest.mark.parametrize(("out", "said"), [("0.22", False), ("220", True)])
def test_a_kitchen_that_may_be_in_millimetres_is_said_to_be_read_in_metres(
    drawer: Path, out: str, said: bool
) -> None:
    drawer.write_text(drawer.read_text(encoding="utf-8").replace("0.22", out), encoding="utf-8")
    note = "joint 'mount' lies 220 m from 'cupboard_drawer': lengths are read in metres"
    twin = load_twin(drawer)
    assert any(note in each for each in twin.notes) is said
    kitchen = twin.mechanism(twin.environment)
    assert any(each.startswith(note) for each in kitchen.oversized) is said
    assert replace(kitchen, notes=()).oversized == kitchen.oversized, "known by its lengths, not by a text"


def test_the_annotation_beside_the_model_is_taken(drawer: Path) -> None:
    joint_line = "<https://example.org/id/k/joint/slide> sdt:accelerationLimit 0.5 .\n"
    drawer.with_suffix(".ttl").write_text(KITCHEN + joint_line, encoding="utf-8")
    twin = load_twin(drawer)
    assert twin.kitchen().start == (1.0, 2.0, pytest.approx(3.141592653589793))
    assert twin.kitchen().acceleration == {"slide": 0.5}
    assert twin.container("cupboard_drawer").acceleration == 0.5
    assert twin.mechanism(twin.environment).joint("slide").limits.acceleration == 0.5


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (
            "<https://example.org/id/k/joint/slide> sdt:upperLimit 9.0 .",
            "upperLimit of 'slide' is 0.5 and 9.0",
        ),
        ("<https://example.org/id/k/joint/slide> sdt:accelerationLimit 0.5, 0.7 .", "0.5 and 0.7"),
    ],
)
def test_a_number_that_is_said_twice_is_refused(drawer: Path, line: str, said: str) -> None:
    drawer.with_suffix(".ttl").write_text(KITCHEN + line, encoding="utf-8")
    with pytest.raises(AnnotationError, match=said):
        load_twin(drawer)


def test_an_explicit_annotation_comes_first_and_may_have_another_name(drawer: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.ttl"
    other.write_text(KITCHEN.replace("id:k", "id:somewhere"), encoding="utf-8")
    assert load_twin(drawer, annotation=other).kitchen().start[:2] == (1.0, 2.0)


def copied(robot: str, folder: Path, name: str) -> Path:
    path = folder / f"{name}.urdf"
    shutil.copy(bundled("robot", robot), path)
    return path


def test_a_copy_of_a_bundled_robot_gets_its_annotation_under_its_own_name(tmp_path: Path) -> None:
    twin = load_twin("b", [copied("stretch", tmp_path, "mine")])
    mine, theirs = twin.robot(twin.robots[0]), load_twin("b", ["stretch"])
    original = theirs.robot(theirs.robots[0])
    assert mine.robot == "mine"
    assert (mine.grippers, mine.parked, mine.held) == (original.grippers, original.parked, original.held)
    assert any("that of the bundled 'stretch' fits and is used" in note for note in twin.notes)


def test_a_bundled_annotation_applies_to_a_kitchen_with_the_same_joints(tmp_path: Path) -> None:
    shutil.copy(bundled("kitchen", "a"), tmp_path / "mine.urdf")
    twin = load_twin(tmp_path / "mine.urdf")
    assert twin.kitchen().start == (1.5, 2.0, 0.0)
    assert any("its start pose included" in note for note in twin.notes)


@pytest.mark.reference
@pytest.mark.parametrize(
    ("robot", "path"),
    [
        ("pr2", "robot_pr2/pr2_with_ft2_cableguide.urdf"),
        ("tiago_dual", "robot_tiago_dual/tiago_dual.urdf"),
        ("stretch", "robot_stretch/stretch_description_local.urdf"),
    ],
)
def test_reference_robots_work_with_the_bundled_annotation(robot: str, path: str, reference: Path) -> None:
    twin, ours = load_twin("b", [reference / path]), load_twin("b", [robot])
    assert twin.robot(twin.robots[0]).grippers == ours.robot(ours.robots[0]).grippers


def test_a_robot_without_annotation_is_refused_with_what_to_do(write: Write) -> None:
    path = write(link("base"), name="bot.urdf")
    with pytest.raises(AnnotationError, match=r"no annotation; allowed: .*bot.ttl.*sdt robot describe"):
        load_twin("b", [path])


WRONG: dict[str, tuple[str, str, str]] = {
    "unknown joint": (r"joint_lift>", "joint_lft>", "names joint 'joint_lft', which 'stretch' does not have"),
    "nearest name": (r"joint_lift>", "joint_lft>", "did you mean 'joint_lift'"),
    "unknown property": (
        r"sdt:opening",
        "sdt:openning",
        "no such property; did you mean sdt:opening",
    ),
    "no opening": (r"sdt:opening [\d.]+ \.", 'rdfs:comment "x" .', "lacks: gripper sdt:opening"),
    "no drive": (r"sdt:drive sdt:\w+ ;", "", "lacks: stretch sdt:drive; robots/README.md"),
    "unknown drive": (
        r"sdt:drive sdt:\w+",
        "sdt:drive sdt:Wings",
        "allowed: sdt:Omni, sdt:Differential, sdt:Fixed",
    ),
    "parked outside": (r"sdt:parkedPosition [\d.]+", "sdt:parkedPosition 55", "outside its limits"),
    "no acceleration": (
        r"joint_lift> sdt:accelerationLimit [\d.]+ \.",
        'joint_lift> rdfs:comment "x" .',
        "has no sdt:accelerationLimit for joint 'joint_lift'",
    ),
    "acceleration 0": (
        r"joint_lift> sdt:accelerationLimit [\d.]+",
        "joint_lift> sdt:accelerationLimit 0.0",
        "has no sdt:accelerationLimit for joint 'joint_lift'; allowed: one above 0",
    ),
    "no robot": (
        r"a sdt:Robot",
        "a sdt:Toaster",
        "describes no sdt:Robot; add '<https://example.org/id/stretch> a sdt:Robot .'",
    ),
    "blank node": (r"sdt:hasGripper <", "sdt:hasGripper _:b , <", "blank node"),
    "syntax": (r"a sdt:Robot ;", "a sdt:Robot", "is not Turtle"),
    "text for a number": (r"sdt:baseHeight [\d.]+", 'sdt:baseHeight "low"', "allowed: a finite number"),
    "text for a body": (r"sdt:baseBody <[^>]+>", 'sdt:baseBody "base_link"', "allowed: an IRI"),
    "a word for a truth": (r"sdt:held true", 'sdt:held "yes"', "allowed: true or false"),
}


def test_a_robots_annotation_beside_a_kitchen_is_named_as_such_and_the_other_way_round(
    tmp_path: Path,
) -> None:
    kitchen, robot = tmp_path / "kitchen.urdf", copied("stretch", tmp_path, "robot")
    shutil.copy(bundled("kitchen", "b"), kitchen)
    shutil.copy(bundled("robot", "stretch").with_suffix(".ttl"), kitchen.with_suffix(".ttl"))
    with pytest.raises(AnnotationError, match=r"is a robot's annotation .sdt:Robot.*delete it or move it"):
        load_twin(kitchen)
    shutil.copy(bundled("kitchen", "b").with_suffix(".ttl"), robot.with_suffix(".ttl"))
    with pytest.raises(AnnotationError, match=r"is a kitchen's annotation .sdt:Environment.*move it"):
        load_twin("b", [robot])


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_annotation_is_refused_with_its_reason(tmp_path: Path, case: str) -> None:
    pattern, replacement, reason = WRONG[case]
    path = copied("stretch", tmp_path, "stretch")
    text = bundled("robot", "stretch").with_suffix(".ttl").read_text(encoding="utf-8")
    changed, count = re.subn(pattern, replacement, text)
    assert count
    path.with_suffix(".ttl").write_text(changed, encoding="utf-8")
    with pytest.raises(AnnotationError) as caught:
        load_twin("b", [path])
    assert reason in str(caught.value)


def test_a_joint_whose_velocity_limit_is_0_is_asked_for_one(tmp_path: Path) -> None:
    path = copied("stretch", tmp_path, "stretch")
    (tmp_path / path.with_suffix(".ttl").name).write_bytes(
        bundled("robot", "stretch").with_suffix(".ttl").read_bytes()
    )
    lift = r'(<joint name="joint_lift".*?velocity=")[^"]*'
    path.write_text(
        re.sub(lift, r"\g<1>0", path.read_text(encoding="utf-8"), flags=re.DOTALL), encoding="utf-8"
    )
    with pytest.raises(
        AnnotationError, match=r"joint 'joint_lift' of .* has no velocity limit; allowed: one above 0"
    ):
        load_twin("b", [path])


def test_two_grippers_of_one_name_are_refused_since_what_is_said_of_one_would_be_of_both(
    tmp_path: Path,
) -> None:
    path = copied("pr2", tmp_path, "pr2")
    text = bundled("robot", "pr2").with_suffix(".ttl").read_text(encoding="utf-8")
    for side in ("left", "right"):
        assert f'rdfs:label "{side}"' in text
        text = text.replace(f'rdfs:label "{side}"', 'rdfs:label "hand"')
    path.with_suffix(".ttl").write_text(text, encoding="utf-8")
    with pytest.raises(AnnotationError, match=r"lacks: right .*label of its own \('hand' is that of left\)"):
        load_twin("b", [path])


def test_a_finger_that_follows_another_needs_a_velocity_above_0_too(tmp_path: Path) -> None:
    path = copied("pr2", tmp_path, "pr2")
    path.with_suffix(".ttl").write_bytes(bundled("robot", "pr2").with_suffix(".ttl").read_bytes())
    finger = r'(<joint name="l_gripper_r_finger_joint".*?velocity=")[^"]*'
    text, count = re.subn(finger, r"\g<1>0", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert count == 1
    path.write_text(text, encoding="utf-8")
    with pytest.raises(AnnotationError, match="'l_gripper_r_finger_joint' of 'pr2' has no velocity limit"):
        load_twin("b", [path])


def test_an_annotation_of_something_else_is_refused(drawer: Path, tmp_path: Path) -> None:
    file = tmp_path / "x.ttl"
    file.write_text(PREFIX, encoding="utf-8")
    with pytest.raises(AnnotationError, match="describes 0 models"):
        load_twin(drawer, annotation=file)
    with pytest.raises(AnnotationError, match="no annotation file"):
        load_twin(drawer, annotation=tmp_path / "nowhere.ttl")
    pr2 = bundled("robot", "pr2").with_suffix(".ttl")
    with pytest.raises(AnnotationError, match="describes robot 'pr2', which is not loaded"):
        load_twin(drawer, annotation=pr2)
    with pytest.raises(AnnotationError, match="'stretch' does not have"):
        load_twin(drawer, ["stretch"], annotation=pr2)


def test_a_robots_annotation_reads_as_it_is_written(tmp_path: Path) -> None:
    path = copied("stretch", tmp_path, "stretch")
    text = bundled("robot", "stretch").with_suffix(".ttl").read_text(encoding="utf-8")
    for pattern, replacement in (
        (r"sdt:opening [\d.]+", "sdt:opening 0.077"),
        (r"sdt:parkedPosition [\d.]+", "sdt:parkedPosition 0.25"),
        (r"sdt:z [\d.]+", "sdt:z 0.003"),
    ):
        text = re.sub(pattern, replacement, text)
    path.with_suffix(".ttl").write_text(text, encoding="utf-8")
    twin = load_twin("b", [path])
    annotation = twin.robot(twin.robots[0])
    (gripper,) = annotation.grippers
    assert gripper.tool == Pose((0.0, 0.0, 0.003))
    assert gripper.opening == 0.077
    assert annotation.coupled == (("joint_arm_l0", "joint_arm_l1", "joint_arm_l2", "joint_arm_l3"),)
    assert annotation.parked["joint_lift"] == 0.25
    assert annotation.base_limits.linear_velocity == 0.2


@pytest.mark.parametrize(
    ("given", "name"), [("a", "a"), ("/x/my.urdf", "my"), ("my.urdf.xacro", "my"), (Path("/x/k.xacro"), "k")]
)
def test_a_model_is_called_by_its_stem(given: str | Path, name: str) -> None:
    assert model_name(given) == name


@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_a_robot_that_was_read_stands_in_a_kitchen_as_if_it_was_loaded_with_it(kitchen: str) -> None:
    read, there = read_robot("stretch"), load_twin(kitchen)
    joined, loaded = with_robot(there, read), load_twin(kitchen, ["stretch"])
    assert joined.robots == loaded.robots == (read.environment,)
    assert joined.notes == loaded.notes
    for model in (joined.environment, *joined.robots):
        assert joined.mechanism(model) == loaded.mechanism(model)
        assert joined.content_hash(model) == loaded.content_hash(model)
    assert sorted(joined.serialize("nquads").splitlines()) == sorted(loaded.serialize("nquads").splitlines())
    assert with_robot(joined, read) is joined
    assert not there.robots


STATED = f"""{PREFIX}<{{k}}> a sdt:Environment ; sdt:startPose <{{k}}/start> .
<{{k}}/start> a sdt:Pose ; sdt:x 0.0 ; sdt:y 0.0 ; sdt:z 0.0 ;
  sdt:qx 0.0 ; sdt:qy 0.0 ; sdt:qz 0.0 ; sdt:qw 1.0 .
<{{k}}/body/leaf> a sdt:Door, sdt:Container ;
  sdt:hasHandle <{{k}}/body/{{handle}}> ; sdt:hasJoint <{{k}}/joint/turn> .
"""


@pytest.mark.parametrize(
    ("handle", "said"), [("grip", ""), ("post", "handle 'post' of 'leaf' is not fixed to what moves 'leaf'")]
)
def test_a_container_that_no_name_tells_can_be_stated(write: Write, handle: str, said: str) -> None:
    path = write(
        link("world"),
        link("leaf", '<box size="0.02 0.4 0.6"/>'),
        link("grip", '<box size="0.01 0.01 0.1"/>'),
        link("post", '<box size="0.01 0.01 0.1"/>'),
        joint("turn", "revolute", "world", "leaf", limit(0, 1.5)),
        joint("mount", "fixed", "leaf", "grip"),
        joint("stand", "fixed", "world", "post"),
    )
    assert load_twin(path).containers() == ()
    path.with_suffix(".ttl").write_text(STATED.format(k=model_iri("k"), handle=handle), encoding="utf-8")
    if said:
        with pytest.raises(AnnotationError, match=said):
            load_twin(path)
    else:
        (container,) = load_twin(path).containers()
        assert (container.name, container.handle) == ("leaf", body_iri("k", "grip"))
