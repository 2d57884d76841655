"""Certified motions of tables, and mutations of some, against an audit that shares no code. `make soak`."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import trimesh
from trimesh import transformations

import kitchens
import robots
from predicates.case import Outcome
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin, model_name
from sdt_kg.motion import BodyMotion
from services.app import Policy, load
from services.edits import parse_edit
from services.embodiment.certify import Certified, Tolerances, certify
from services.motions import arrays_of, motion_of
from services.requests import parse_state
from services.sweep.cell import CellResult
from services.table import cells, run
from tests.soak.annotated import Note, accelerations
from tests.soak.audit import Stage, audited
from tests.soak.machine import Machine, gap
from tests.soak.rewritten import Variant, variants, with_box, with_limit, with_origin
from tests.soak.test_tables import REFERENCE_KITCHENS, REFERENCE_ROBOTS, ROBOTS

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

STEP, COARSE = 0.001, 0.004  # [m] of travel between looks
NO_LESS = -0.01  # [1] slack of a rule that is kept, but for rounding
EACH = 40  # mutations of a motion
DATA = {"kitchens": kitchens, "robots": robots}


def bundled(folder: str, model: str, suffix: str) -> Path:
    """A file of the model, or of the bundled one that it is like."""
    likely = {"apartment": "a", "kitchen": "b", "pr2": "pr2", "tiago": "tiago_dual", "stretch": "stretch"}
    name = next((ours for theirs, ours in likely.items() if model_name(model).startswith(theirs)), model)
    return DATA[folder].path(f"{name}/{name}{suffix}")


@cache
def machine(file: Path, turned: bool) -> Machine:
    return Machine(file, turned)


def broken_rules(judged: Stage, motion: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Rules that a motion does not keep, and by how much."""
    return {rule: one for rule, one in audited(judged, motion, STEP).slack.items() if one < NO_LESS}


def stage(
    kitchen: Path, robot: Path, about: Mapping[str, str], container: str, states: tuple[str, ...]
) -> Stage:
    """What a motion of the container is judged against.

    Args:
        kitchen: URDF file, whose annotation is that of `about["kitchen"]`, if it has one.
        robot: URDF file, likewise.
        about: Kitchen, robot, verb and drive.
        container: Its name.
        states: As `sdt table --state` takes them; which container is which is all that is believed.
    """
    twin, noted = load_twin(kitchen), bundled("kitchens", about["kitchen"], ".ttl")
    one = twin.container(container)
    state = {joint.rsplit("/", 1)[1]: q for joint, q in parse_state(twin, states).positions}
    return Stage(
        machine(kitchen, True),
        machine(robot, False),
        Note(bundled("robots", about["robot"], ".ttl")),
        accelerations(noted) if noted.is_file() else {},
        state,
        one.joint.rsplit("/", 1)[1],
        one.handle.rsplit("/", 1)[1],
        about["verb"],
        about["drive"],
    )


def broken(result: CellResult, motions: Path, drive: Drive | None) -> dict[str, float]:
    """Rules that a certified motion does not keep, and by how much."""
    cell = result.cell
    kitchen, robot = (
        Path(model) if "/" in model else bundled(folder, model, ".urdf")
        for folder, model in (("kitchens", cell.kitchen), ("robots", cell.robot))
    )
    about = {"kitchen": cell.kitchen, "robot": cell.robot, "verb": cell.task.partition(":")[0]}
    about["drive"] = str(result.verdict["drive"]) if drive is None else drive.value
    judged = stage(kitchen, robot, about, cell.container, cell.states)
    with np.load(motions / cell.file_name) as motion:
        return broken_rules(judged, motion)


def audit(
    kitchen: str, robots: tuple[str, ...], asked: tuple[str, tuple[str, ...], Drive | None], folder: Path
) -> dict[str, dict[str, float]]:
    """Case → rules that its certified motion breaks."""
    verb, states, drive = asked
    result = run(cells((kitchen,), robots, verb, states, Policy(drive=drive)), 2, lambda _: None, folder)
    certified = [each for each in result.results if each.verdict["outcome"] == "certified"]
    assert certified
    found = {str(each.cell): broken(each, folder, drive) for each in certified}
    return {case: rules for case, rules in found.items() if rules}


def test_the_judge_places_joints_of_equal_limits_and_what_follows_in_a_chain(tmp_path: Path) -> None:
    """A lift that stands at 0.2, and a rod that follows one which follows a motor listed last."""
    wide = '<limit lower="-9" upper="9" velocity="1" effort="1"/>'
    slides = {
        "lift": '<limit lower="0.2" upper="0.2" velocity="1" effort="1"/>',
        "rod": f'{wide}<mimic joint="cam" multiplier="-2" offset="0.1"/>',
        "cam": f'{wide}<mimic joint="motor" multiplier="3" offset="0.2"/>',
        "motor": wide,
    }
    joints = "".join(
        f'<link name="{name}_link"/><joint name="{name}" type="prismatic"><parent link="base"/>'
        f'<child link="{name}_link"/><axis xyz="0 0 1"/>{limits}</joint>'
        for name, limits in slides.items()
    )
    (tmp_path / "robot.urdf").write_text(f'<robot name="chain"><link name="base"/>{joints}</robot>')
    found = Machine(tmp_path / "robot.urdf").place({"motor": 0.5}, [f"{name}_link" for name in slides])
    heights = [float(found[f"{name}_link"][0, 2, 3]) for name in slides]
    assert heights == pytest.approx([0.2, -2 * (3 * 0.5 + 0.2) + 0.1, 3 * 0.5 + 0.2, 0.5])


@pytest.mark.parametrize("deep", [-0.001, 0.001, 0.004])
def test_the_judge_tells_to_a_millimetre_how_deep_a_ball_is_in_a_mesh_wherever_the_two_are(
    tmp_path: Path, deep: float
) -> None:
    """A handle of a bar and two posts that are sunk into it."""
    sizes = (0.015, 0.3, 0.015), (0.06, 0.012, 0.012), (0.06, 0.012, 0.012)
    posts = [trimesh.creation.box(size) for size in sizes]
    for post, y in zip(posts[1:], (-0.12, 0.12), strict=True):
        post.apply_translation((-0.03, y, 0.0))
    trimesh.util.concatenate(posts).export(tmp_path / "handle.stl")
    shapes = {"handle": '<mesh filename="handle.stl"/>', "ball": '<sphere radius="0.01"/>'}
    links = "".join(
        f'<link name="{name}"><collision><geometry>{shape}</geometry></collision></link>'
        for name, shape in shapes.items()
    )
    joint = '<joint name="to" type="fixed"><parent link="handle"/><child link="ball"/></joint>'
    (tmp_path / "both.urdf").write_text(f'<robot name="both">{links}{joint}</robot>')
    handle, ball = Machine(tmp_path / "both.urdf").solids
    world, at = transformations.euler_matrix(0.3, 0.6, 0.2), np.eye(4)
    at[:3, 3] = 0.0075 + 0.01 - deep, 0.02, 0.001
    assert gap(ball, world @ at, handle, world) == pytest.approx(-deep, abs=1e-3)
    assert gap(handle, world, ball, world @ at) == pytest.approx(-deep, abs=1e-3)


@pytest.mark.reference
@pytest.mark.parametrize("drive", [Drive.OMNI, None])
@pytest.mark.parametrize("robot", REFERENCE_ROBOTS)
@pytest.mark.parametrize("kitchen", REFERENCE_KITCHENS)
def test_no_motion_certified_on_the_reference_models_is_refuted(
    reference: Path, tmp_path: Path, kitchen: str, robot: str, drive: Drive | None
) -> None:
    model = str(reference / REFERENCE_KITCHENS[kitchen])
    assert audit(model, (str(reference / robot),), ("open", (), drive), tmp_path) == {}


CLOSES = [("close", (f"all={state}",), None) for state in ("half-open:7", "open")]


@pytest.mark.parametrize("asked", [("open", (), None), *CLOSES])
@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_no_motion_certified_with_the_real_drives_is_refuted(
    tmp_path: Path, kitchen: str, asked: tuple[str, tuple[str, ...], Drive | None]
) -> None:
    assert audit(kitchen, ROBOTS, asked, tmp_path) == {}


DRAWER, DOOR = "sink_area_left_middle_drawer_main", "iai_fridge_door"
EDITED: tuple[tuple[str, str, Callable[[Path, Path], Path]], ...] = (
    (
        DRAWER,
        f"set:{DRAWER}_joint.upperLimit=0.3",
        lambda kitchen, folder: with_limit(kitchen, folder, f"{DRAWER}_joint", 0.3),
    ),
    (
        DOOR,
        f"pose:{DOOR}_handle_joint=0.06,-0.5,0.1",
        lambda kitchen, folder: with_origin(kitchen, folder, f"{DOOR}_handle_joint", "0.06 -0.5 0.1"),
    ),
    (
        DOOR,
        "box:crate=0.3,0.4,0.5@0.3,0.8,0.25",
        lambda kitchen, folder: with_box(kitchen, folder, "0.3 0.4 0.5", "0.3 0.8 0.25"),
    ),
)
"""Container, what is asked for as people type it, and the same done to the file that the audit reads."""


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("edit", EDITED)
def test_no_motion_certified_in_an_edited_world_is_refuted(
    tmp_path: Path, robot: str, edit: tuple[str, str, Callable[[Path, Path], Path]]
) -> None:
    container, text, rewrite = edit
    service = load("b", [robot])
    service = replace(service, twin=parse_edit(service.twin, text).applied(service.twin))
    (verdict,) = service.achieve(f"open:{container}")
    assert verdict.outcome is Outcome.CERTIFIED
    assert verdict.can_perform is not None
    body = verdict.can_perform.case.body_motion
    assert isinstance(body, BodyMotion)
    about = {
        "kitchen": "b",
        "robot": robot,
        "verb": "open",
        "drive": service.twin.robot(body.robot).drive.value,
    }
    kitchen = rewrite(kitchens.path("b/b.urdf"), tmp_path)
    judged = stage(kitchen, bundled("robots", robot, ".urdf"), about, container, ())
    assert broken_rules(judged, arrays_of(body)) == {}


def judge(variant: Variant, container: str, start: np.ndarray) -> bool:
    """Whether the certifier certifies a mutation."""
    twin = load_twin(variant.kitchen, [variant.robot])
    (robot,) = twin.robots
    motion = motion_of(variant.motion, twin, robot)
    assert isinstance(motion, BodyMotion)
    x, y, yaw = map(float, start)
    drive, one = Drive(variant.drive), twin.container(container)
    found = certify(twin, robot, motion, one, Tolerances(), drive=drive, start=(x, y, yaw))
    return isinstance(found, Certified)


@pytest.mark.parametrize("container", ["iai_fridge_door", "sink_area_left_middle_drawer_main"])
@pytest.mark.parametrize("robot", ROBOTS)
def test_mutations_of_certified_motions_are_refused_where_wrong_and_certified_where_right(
    tmp_path: Path, robot: str, container: str
) -> None:
    case = next(
        each
        for each in cells(("b",), (robot,), "open", (), Policy(drive=Drive.OMNI))
        if each.container == container
    )
    run([case], 1, lambda _: None, tmp_path)
    with np.load(tmp_path / case.file_name) as arrays:
        motion = dict(arrays)
    counts, odd = Counter[str](), []
    about = {"kitchen": "b", "robot": robot, "verb": "open"}
    handle = load_twin("b").container(container).handle.rsplit("/", 1)[1]
    for variant in variants(motion, robot, handle, tmp_path, EACH):
        judged = stage(variant.kitchen, variant.robot, {**about, "drive": variant.drive}, container, ())
        start = motion["base"][0]
        truth = audited(replace(judged, start=tuple(start)), variant.motion, COARSE)
        if variant.held_otherwise:
            truth.keeps("held", 0.0, 1.0)
        certified = judge(variant, container, start)
        counts["wrong" if truth.wrong else "right" if truth.right else "between"] += 1
        if (truth.wrong and certified) or (truth.right and not certified):
            odd.append((variant.name, certified, truth.slack))
    assert odd == []
    assert min(counts["wrong"], counts["right"]) > EACH / 10, counts
