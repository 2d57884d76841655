"""Proofs of infeasibility: what they refute contains what certification accepts; damage is seen."""

import json
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.geometry.interval import apply, exact
from services.embodiment.proof_check.geometry.mechanics import Placement, Swing
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.target import Target
from services.embodiment.prove.prover import Proved, Prover, needed
from services.physics.model import Scene

DOOR = "iai_fridge_door"
BASE = (0.0, 0.0, -0.5)
ROBOTS = ("pr2", "tiago_dual", "stretch")
BOXES = 4000
NONE = exact(np.zeros((1, 0, 3)))
STILL = Swing(NONE, NONE, np.zeros((1, 0)), np.zeros(0, dtype=np.bool_))
"""A box of positions of no joint."""


@pytest.fixture(scope="module")
def twin() -> Twin:
    return load_twin("b", list(ROBOTS))


def prover(twin: Twin, robot: str, drive: Drive, start: tuple[float, float, float]) -> Prover:
    door = twin.container(DOOR)
    (iri,) = (one for one in twin.robots if twin.name(one) == robot)
    return Prover(twin, iri, door, drive, start, np.array([0.0, 0.92 * door.upper]))


@pytest.fixture(scope="module")
def far(twin: Twin) -> Proved:
    """No hand of a TIAGo comes from that base to the fridge."""
    found = prover(twin, "tiago_dual", Drive.FIXED, BASE).prove(BOXES)
    assert found is not None
    return found


def postures(arm: Arm, rng: np.random.Generator, count: int) -> np.ndarray:
    """Joint positions, one in five of them at a limit."""
    low, high = (np.array([getattr(one, end) for one in arm.chain.links]) for end in ("lower", "upper"))
    q = rng.uniform(low, high, (count, len(low)))
    ends = np.where(rng.random(q.shape) < 0.5, low, high)
    return np.where(rng.random(q.shape) < 0.2, ends, q)


@pytest.mark.parametrize("robot", ROBOTS)
def test_joints_are_where_pinocchio_has_them_and_no_finger_is_farther_than_the_reach(
    twin: Twin, robot: str
) -> None:
    check_joints(twin, robot, 10)


def check_joints(twin: Twin, robot: str, count: int) -> None:
    """In so many postures joints are where Pinocchio has them, and no finger is farther than the reach."""
    (iri,) = (one for one in twin.robots if twin.name(one) == robot)
    scene = Scene(twin, iri)
    world = World(scene)
    rng = np.random.default_rng(3)
    statement = Statement(twin, iri, twin.container(DOOR), Drive.FIXED, BASE, Tolerances())
    for gripper in statement.grippers:
        arm = statement.arm(gripper)
        assert arm is not None
        q = postures(arm, rng, count)
        origins, _, tool = arm.chain.frames(q)
        fingers = world.shapes_of([f"{iri}/body/{name}" for name in gripper.fingers])
        for i, one in enumerate(q):
            named = {link.name: x for link, x in zip(arm.chain.links[3:], one[3:], strict=True)}
            for finger in gripper.finger_joints:
                k = scene.coordinate[joint_iri(robot, finger.joint)]
                named[finger.joint] = rng.uniform(scene.bounds.lower[k], scene.bounds.upper[k])
            full = scene.q(one[:3], named)
            frame = scene.placement(full, scene.tool_frame(gripper.name)).homogeneous
            assert np.allclose(frame[:3, 3], tool.translation.lo[i], rtol=0, atol=1e-9)
            assert np.allclose(frame[:3, :3], tool.rotation.hi[i], rtol=0, atol=1e-9)
            rotations, places = world.frames(full)
            for shape in fingers:
                joint = world.boxes[0][shape]
                turn = rotations[joint] @ world.boxes[1][shape]
                middle = rotations[joint] @ world.boxes[2][shape] + places[joint]
                corners = (
                    middle
                    + (np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T * world.half[shape]) @ turn.T
                )
                apart = np.linalg.norm(corners[:, None] - origins.lo[i][None], axis=2)
                assert (apart <= arm.reach + 1e-9).all()
                held = Target((Placement(exact(np.eye(3)), exact(middle)),), np.zeros((1, 3)), np.zeros(1))
                centre = apply(tool.rotation, exact(arm.middle)) + tool.translation
                grasp = Placement(tool.rotation[i : i + 1], centre[i : i + 1])
                assert held.apart(grasp, arm.half, STILL, level=False) < 0
                assert held.apart(grasp, arm.half, STILL, level=True) < 0


def test_a_proof_is_found_verified_and_says_what_it_assumes(twin: Twin, far: Proved) -> None:
    (tiago,) = (one for one in twin.robots if twin.name(one) == "tiago_dual")
    checked = check(twin, tiago, twin.container(DOOR), far.artefact.content)
    assert checked.holds, checked.reasons
    assert checked.leaves == far.boxes
    assert any("fixed" in each for each in checked.assumptions)
    assert far.diagnosis.proof


@pytest.mark.parametrize("schema", ["sdt proof 2", "sdt proof 4"])
def test_a_proof_of_an_older_version_is_read_and_holds(twin: Twin, far: Proved, schema: str) -> None:
    def older(whole: dict[str, Any]) -> None:
        whole["schema"] = schema
        del whole["claim"]["within"], whole["claim"]["declared"], whole["claim"]["one_hold"]
        for one in whole["refutations"]:
            del one["places"], one["pinched"]

    (tiago,) = (one for one in twin.robots if twin.name(one) == "tiago_dual")
    content = changed(far.artefact.content, older)
    assert check(twin, tiago, twin.container(DOOR), content).holds


def test_a_handle_above_a_free_stretch_is_refuted_by_height_alone() -> None:
    twin = load_twin("a", ["stretch"])
    panel = twin.container("cabinet4_door_bottom")
    found = Prover(twin, twin.robots[0], panel, Drive.OMNI, BASE, np.array([0.0, 0.92 * panel.upper])).prove(
        BOXES
    )
    assert found is not None
    assert check(twin, twin.robots[0], panel, found.artefact.content).holds


@pytest.mark.parametrize("robot", ROBOTS)
def test_what_can_be_held_is_not_refuted(twin: Twin, robot: str) -> None:
    # With a free base all three open this door (Table 1).
    assert prover(twin, robot, Drive.OMNI, BASE).prove(BOXES) is None


def changed(content: bytes, change: Callable[[dict[str, Any]], None]) -> bytes:
    whole = json.loads(zlib.decompress(content))
    change(whole)
    return zlib.compress(json.dumps(whole).encode())


def narrower(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["box"][3][1] -= 0.01


def one_gripper_less(whole: dict[str, Any]) -> None:
    whole["refutations"].pop()


def other_gripper_twice(whole: dict[str, Any]) -> None:
    whole["refutations"][1] = whole["refutations"][0]


def nearer(whole: dict[str, Any]) -> None:
    whole["claim"]["start"] = [0.25, -0.45, -0.5]


def free(whole: dict[str, Any]) -> None:
    whole["claim"]["drive"] = "omni"


def tighter(whole: dict[str, Any]) -> None:
    whole["claim"]["tolerances"]["contact"] = 0.0


def ajar(whole: dict[str, Any]) -> None:
    joint = next(each for each in whole["claim"]["state"] if each.endswith(f"{DOOR}_joint"))
    whole["claim"]["state"][joint] = 0.1


def beyond_need(whole: dict[str, Any]) -> None:
    whole["claim"]["span"][1] = 1.6
    whole["refutations"][0]["value"] = 1.55


def another_robot(whole: dict[str, Any]) -> None:
    whole["claim"]["models"][1][0] += "2"


def another_version(whole: dict[str, Any]) -> None:
    whole["claim"]["models"][0][1] = "0" * 64


def shorter_tree(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["tree"] = ""


def longer_tree(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["tree"] = "hICA"  # 132, 128, 128


def careless_leaf(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["tree"] = "ig=="  # 138: that the wrist never comes near, wherever the arm is


def careless_fingers(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["tree"] = "iw=="  # 139: that the fingers never come near


def no_such_joint(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["tree"] = "/w=="  # 255


CHANGES = (
    narrower,
    one_gripper_less,
    other_gripper_twice,
    nearer,
    free,
    tighter,
    ajar,
    beyond_need,
    another_robot,
    another_version,
    shorter_tree,
    longer_tree,
    careless_leaf,
    careless_fingers,
    no_such_joint,
)


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_proof_does_not_hold(
    twin: Twin, far: Proved, change: Callable[[dict[str, Any]], None]
) -> None:
    content = far.artefact.content
    (tiago,) = (one for one in twin.robots if twin.name(one) == "tiago_dual")
    assert not check(twin, tiago, twin.container(DOOR), changed(content, change)).holds


@pytest.mark.parametrize(
    "content", [b"", b"nonsense", zlib.compress(b"[]"), zlib.compress(b'{"schema": "sdt proof 1"}')]
)
def test_what_is_no_proof_is_refused_by_name(twin: Twin, content: bytes) -> None:
    with pytest.raises(InputError, match="proof"):
        check(twin, twin.robots[0], twin.container(DOOR), content)


def test_flipped_bytes_never_hold(twin: Twin, far: Proved) -> None:
    content = far.artefact.content
    (tiago,) = (one for one in twin.robots if twin.name(one) == "tiago_dual")
    rng = np.random.default_rng(5)
    for at in rng.choice(len(content), 40, replace=False):
        damaged = bytearray(content)
        damaged[at] ^= 1 << int(rng.integers(8))
        try:
            checked = check(twin, tiago, twin.container(DOOR), bytes(damaged))
        except InputError:
            continue
        assert not checked.holds


def test_only_what_opens_or_closes_is_needed(twin: Twin) -> None:
    door = twin.container(DOOR)
    assert needed(door, 0.0, np.array([0.0, door.upper])) == (0.0, door.open_from)
    assert needed(door, 1.0, np.array([1.0, 0.0])) == (door.closed_to, 1.0)
    assert needed(door, 0.0, np.array([0.0, 0.3])) == (0.0, 0.3)
