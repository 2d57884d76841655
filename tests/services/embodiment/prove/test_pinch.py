"""Proofs that two fingers do not both come to a handle: what certification accepts is never refuted."""

import base64
import json
import zlib
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import body_iri, joint_iri
from sdt_kg.mechanism import ShapeType
from sdt_kg.twin import Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.grasp import Grasp
from services.embodiment.hold.sets import FREE_MOST
from services.embodiment.proof_check import check
from services.embodiment.proof_check.pinch.fingers import Hand, handle_span
from services.embodiment.proof_check.pinch.refuted import refuted_pinches
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove import Proved, Prover
from services.embodiment.prove.pinch import Search
from services.physics.model import Scene
from services.physics.tree import se3
from tests.services.embodiment.front import Front, free_grasp, front
from tests.services.embodiment.test_fit import held
from tests.small import beside
from tests.soak.doors import draw, write

pytestmark = pytest.mark.oracle

HERE = (0.0, 0.0, 0.0)
ROBOTS = ("pr2", "tiago_dual", "stretch")
FRONT = 14
HIGH, HIGHEST_CERTIFIED = 880, 697  # level bars, 1.4072 m and 1.3671 m above the floor
WIDTHS = (0.0, 1e-3, 0.05, 1.0)  # [rad or m]
OPENED = (0.0105, 0.008, 0.005, 0.0019, 0.0017, 0.0)  # [rad or m] by which closed fingers are opened again
FAR_NUMBER = 90_000
GRASPS, HELD = 150, 8
TRIES = 1500


def statement_of(twin: Twin) -> Statement:
    return Statement(twin, twin.robots[0], twin.container("front_door"), Drive.OMNI, HERE, Tolerances())


def proof(twin: Twin) -> Proved | None:
    door = twin.container("front_door")
    return Prover(twin, twin.robots[0], door, Drive.OMNI, HERE, np.array([0.0, door.open_from])).prove(100)


def stretch(folder: Path, number: int) -> Twin:
    return beside(write(draw(np.random.default_rng(number)), folder, f"front{number}"), "stretch")


@pytest.fixture(scope="module")
def high(tmp_path_factory: pytest.TempPathFactory) -> tuple[Twin, bytes]:
    """A handle that one finger of Stretch can touch, and not two."""
    twin = stretch(tmp_path_factory.mktemp("front"), HIGH)
    proved = proof(twin)
    assert proved is not None
    assert proved.diagnosis.proof
    assert "bring two fingers to front_handle" in proved.diagnosis.reason
    return twin, proved.artefact.content


def test_a_handle_that_only_one_finger_comes_to_is_refuted(high: tuple[Twin, bytes]) -> None:
    twin, content = high
    checked = check(twin, twin.robots[0], twin.container("front_door"), content)
    assert checked.holds, checked.reasons
    assert checked.leaves > 100
    assert any("two of them are at the handle" in each for each in checked.assumptions)


def test_the_highest_handle_that_is_certified_is_not_refuted(tmp_path: Path) -> None:
    assert proof(stretch(tmp_path, HIGHEST_CERTIFIED)) is None


def just_held(seen: Front, rng: np.random.Generator) -> Iterator[tuple[Grasp, np.ndarray]]:
    """Grasps that certification accepts, with the scene, the fingers as far from the bar as they may be."""
    scene, gripper = seen.world.scene, seen.kit.limb.gripper
    own = [
        scene.coordinate[joint_iri(scene.robot.mechanism.name, one.joint)] for one in gripper.finger_joints
    ]
    ways = np.sign([one.open - one.closed for one in gripper.finger_joints])
    for number in range(FAR_NUMBER, FAR_NUMBER + GRASPS):
        grasp = free_grasp(seen.fitter.bar, rng.uniform(-FREE_MOST, FREE_MOST), 1, number)
        fitted = seen.fitter.fitted((grasp, 0.0))
        for more in OPENED if fitted is not None else ():
            assert fitted is not None
            q = fitted[1].copy()
            q[own] += more * ways
            q = scene.coupling.positions(q)
            if held(seen, fitted[0], q):
                yield fitted[0], q
                break


def handle_heights(seen: Front, grasp: Grasp, tool_r: np.ndarray, tool_p: np.ndarray) -> tuple[float, float]:
    """Of the lowest and the highest point of the handle that a tool there holds in a grasp [m]."""
    own, turns, middles = seen.fitter.room.handle
    turn = tool_r @ (seen.problem.handle_r[0] @ grasp.rotation).T
    at = grasp.tool(seen.problem.handle_r[0], seen.problem.handle_p[0])[1]
    heights = ((middles - at) @ turn.T + tool_p)[:, 2]
    reach = (np.abs((turn @ turns)[:, 2]) * seen.world.half[own]).sum(axis=1)
    return float((heights - reach).min()), float((heights + reach).max())


@pytest.mark.parametrize("robot", ROBOTS)
def test_no_hold_that_certification_just_accepts_is_in_a_refuted_box(tmp_path: Path, robot: str) -> None:
    seen, rng = front(tmp_path, FRONT, robot, 7), np.random.default_rng(1)
    scene, gripper = seen.world.scene, seen.kit.limb.gripper
    hand = statement_of(scene.twin).hand(gripper)
    assert hand is not None
    name, tool = scene.robot.mechanism.name, scene.tool_frame(gripper.name)
    columns = np.array([scene.coordinate[joint_iri(name, one)] for one in hand.names])
    arm = columns < min(columns[hand.names.index(one.joint)] for one in gripper.finger_joints)
    near, holds = hand.near(Tolerances(), begins=True), [*islice(just_held(seen, rng), HELD)]
    assert len(holds) == HELD
    for grasp, q in holds:
        truth = np.where(arm, rng.uniform(hand.low, hand.high), q[columns])
        at = q.copy()
        at[columns] = truth
        placed = scene.placement(scene.coupling.positions(at), tool)
        span = handle_heights(seen, grasp, placed.rotation, placed.translation)
        for width in WIDTHS:
            box = truth - width * rng.random(len(truth)), truth + width * rng.random(len(truth))
            for leaf in range(len(hand.fingers) + 1):
                with pytest.raises(InputError, match="can"):
                    refuted_pinches(hand, span, near, iter([LEAF + leaf]), box)


@pytest.mark.parametrize(("robot", "parts"), [("pr2", 2), ("tiago_dual", 1), ("stretch", 1)])
def test_a_finger_is_what_follows_one_joint_of_the_hand(tmp_path: Path, robot: str, parts: int) -> None:
    twin = beside(write(draw(np.random.default_rng(FRONT)), tmp_path, "front"), robot)
    statement = statement_of(twin)
    for gripper in statement.grippers:
        hand = statement.hand(gripper)
        assert hand is not None
        assert [len(finger) for finger in hand.fingers] == [parts, parts]


def top(scene: Scene, q: np.ndarray, body: str) -> float:
    """Height of the highest point of a body's boxes and cylinders [m]."""
    (found,) = (one for one in scene.robot.mechanism.bodies if one.name == body)
    world_T_body, heights = scene.placement(q, body_iri(scene.robot.mechanism.name, body)), list[float]()
    for geometry in found.collision:
        at = world_T_body * se3(geometry.pose)
        up, size = at.rotation[2], np.array(geometry.size)
        if geometry.shape is ShapeType.BOX:
            reach = float(np.abs(up) @ size / 2)
        else:
            assert geometry.shape is ShapeType.CYLINDER
            reach = float(np.hypot(*up[:2]) * size[0] + abs(up[2]) * size[1] / 2)
        heights.append(float(at.translation[2]) + reach)
    return max(heights)


def test_two_fingers_are_found_just_below_what_is_refuted_and_never_above(high: tuple[Twin, bytes]) -> None:
    twin, _ = high
    scene, rng = Scene(twin, twin.robots[0]), np.random.default_rng(2)
    statement = statement_of(twin)
    (gripper,) = scene.annotation.grippers
    hand = statement.hand(gripper)
    assert hand is not None
    lowest, _ = handle_span(statement.target(0.0))
    columns = [scene.coordinate[joint_iri(scene.robot.mechanism.name, one)] for one in hand.names]
    best, q, highest = (hand.low + hand.high) / 2, scene.q(HERE, {}), -np.inf
    for k in range(TRIES):
        drawn = (best + rng.normal(size=len(best)) * (hand.high - hand.low) * 0.5 ** (k % 12)).clip(
            hand.low, hand.high
        )
        q[columns] = drawn
        tops = [
            max(top(scene, q, one) for one in gripper.fingers if side in one) for side in ("left", "right")
        ]
        if abs(np.diff(q[columns[-2:]])[0]) <= gripper.difference and min(tops) > highest:
            best, highest = drawn, min(tops)
    assert highest < lowest - Tolerances().contact
    assert not refutable(hand, highest)
    assert refutable(hand, lowest)


def refutable(hand: Hand, lowest: float) -> bool:
    """Whether no two fingers come to a handle whose lowest point is there [m]."""
    return Search(hand, (lowest, lowest + 1.0)).tree() is not None


def narrower(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["box"][-1][1] = 0.5


def without_fingers(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["pinched"] = False


def shorter(whole: dict[str, Any]) -> None:
    tree = base64.b64decode(whole["refutations"][0]["tree"])
    whole["refutations"][0]["tree"] = base64.b64encode(tree[:-1]).decode()


def all_uneven(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["tree"] = base64.b64encode(bytes([LEAF + 2])).decode()


def one_finger(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["tree"] = base64.b64encode(bytes([LEAF])).decode()


def unknown_finger(whole: dict[str, Any]) -> None:
    whole["refutations"][0]["tree"] = base64.b64encode(bytes([LEAF + 3])).decode()


def swapped(whole: dict[str, Any]) -> None:
    joints = whole["refutations"][0]["joints"]
    joints[-1], joints[-2] = joints[-2], joints[-1]


def standing(whole: dict[str, Any]) -> None:
    whole["claim"]["drive"] = "fixed"


CHANGES = (narrower, without_fingers, shorter, all_uneven, one_finger, unknown_finger, swapped, standing)


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_proof_does_not_hold(
    high: tuple[Twin, bytes], change: Callable[[dict[str, Any]], None]
) -> None:
    twin, content = high
    whole = json.loads(zlib.decompress(content))
    change(whole)
    changed = zlib.compress(json.dumps(whole).encode())
    assert not check(twin, twin.robots[0], twin.container("front_door"), changed).holds
