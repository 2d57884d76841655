"""Proofs about a set of grasps: cells hold every grasp in them, and nothing that is held is refuted."""

import base64
import json
import math
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Twin
from services.app import Policy, load
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.handle import Mechanics, find_bar
from services.embodiment.hold.sets import DEPTHS, PITCHES, TILTS, grasp_set
from services.embodiment.proof_check import check
from services.embodiment.proof_check.facing import WAYS, all_turned
from services.embodiment.proof_check.geometry.mechanics import HERE as NO_MORE
from services.embodiment.proof_check.grasps import SIGNS, Grasps
from services.embodiment.proof_check.proof.claim import DEPTH, GRASPS, PITCH, TILT, Bar
from services.embodiment.proof_check.proof.content import IN_HAND
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.target import Target
from services.embodiment.proof_check.tree import all_far
from services.embodiment.prove import Proved, Prover, claimed
from services.physics.model import Scene
from tests.small import beside
from tests.soak.doors import draw, write

Array = NDArray[np.float64]

HERE = (0.0, 0.0, 0.0)
NEVER_HELD, HELD = 515, 22
"""Fronts before a PR2: with its bar out of the way of the hand, and opened."""
CELLS, GRASPS_IN = 12, 24
OFTEN = 400  # boxes of positions of the arm
ENDS = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
USED = 0.999  # [1] of what certification lets the tool slip and turn


def twin_of(folder: Path, number: int) -> Twin:
    return beside(write(draw(np.random.default_rng(number)), folder, f"front{number}"), "pr2")


def bar_of(twin: Twin) -> Bar:
    world = World(Scene(twin, twin.robots[0]))
    bar = find_bar(world, Mechanics(world, twin.container("front_door")), world.scene.q(HERE, {}))
    assert bar is not None
    return claimed(bar)


def prover(twin: Twin, bar: Bar) -> Prover:
    door = twin.container("front_door")
    values = np.array([0.0, door.open_from])
    return Prover(twin, twin.robots[0], door, Drive.FIXED, HERE, values, bar=bar)


def statement(twin: Twin) -> Statement:
    door = twin.container("front_door")
    about = twin, twin.robots[0], door, Drive.FIXED, HERE, Tolerances()
    return Statement(*about, span=(0.0, door.open_from))


def grasps_at(twin: Twin, value: float, gripper: str = "left") -> Grasps:
    about = statement(twin)
    (one,) = (each for each in about.grippers if each.name == gripper)
    arm = about.arm(one)
    assert arm is not None
    return Grasps(about, arm, bar_of(twin), value)


@pytest.fixture(scope="module")
def never(tmp_path_factory: pytest.TempPathFactory) -> tuple[Twin, Proved]:
    """A front that no grasp opens, and the proof."""
    twin = twin_of(tmp_path_factory.mktemp("front"), NEVER_HELD)
    proved = prover(twin, bar_of(twin)).grasped()
    assert proved is not None
    return twin, proved


def checked(twin: Twin, content: bytes) -> bool:
    return check(twin, twin.robots[0], twin.container("front_door"), content).holds


def test_a_bar_that_no_grasp_has_all_along_is_refuted_of_these_alone(never: tuple[Twin, Proved]) -> None:
    twin, proved = never
    found = check(twin, twin.robots[0], twin.container("front_door"), proved.artefact.content)
    assert found.holds, found.reasons
    assert found.leaves == proved.boxes
    assert f"grasp set: {GRASPS}" in found.assumptions
    assert "in a grasp across the bar of front_handle" in found.statement
    assert not proved.diagnosis.proof, "other holds are not refuted"
    assert "have a grasp across the bar of front_handle" in proved.diagnosis.reason
    assert "other holds were searched" in proved.diagnosis.reason


def test_the_set_has_all_listed_grasps(never: tuple[Twin, Proved]) -> None:
    assert pytest.approx((np.abs(PITCHES).max(), np.abs(TILTS).max())) == (PITCH, TILT)
    assert pytest.approx(max(DEPTHS)) == DEPTH
    world = World(Scene(never[0], never[0].robots[0]))
    bar = find_bar(world, Mechanics(world, never[0].container("front_door")), world.scene.q(HERE, {}))
    assert bar is not None
    about, listed = claimed(bar), grasp_set(bar)
    frame = np.stack((about.outward, about.along, np.cross(about.outward, about.along)), axis=1)
    seen, places = frame.T @ listed.rotations, (listed.translations - about.centre) @ frame
    a, y = seen[:, :, 0], seen[:, :, 1]
    assert np.abs(y[:, 1]).max() < 1e-9, "fingers close across the bar"
    tilt, pitch = np.arcsin(a[:, 1]), np.arctan2(a[:, 2], -a[:, 0])
    depth = places[:, 0] / a[:, 0]
    place = places[:, 1] - depth * a[:, 1]
    assert np.abs(places[:, 2] - depth * a[:, 2]).max() < 1e-9
    for values, most in ((pitch, PITCH), (tilt, TILT), (depth, DEPTH), (place, about.reach)):
        assert np.abs(values).max() <= most + 1e-9


def drawn(rng: np.random.Generator, low: Array, high: Array) -> tuple[Array, Array]:
    """Ends of a cell of any width."""
    half = (high - low) / 2 * 10 ** rng.uniform(-3.0, 0.0, 4)
    middle = rng.uniform(low + half, high - half)
    return middle - half, middle + half


def grasp(bar: Bar, sign: float, at: Array) -> tuple[Array, Array]:
    """The tool's pose in the frame of the handle's joint, from the formula of the docstring."""
    place, pitch, tilt, depth = at
    o, b = np.array(bar.outward), np.array(bar.along)
    c = np.cross(o, b)
    a = math.cos(tilt) * (math.sin(pitch) * c - math.cos(pitch) * o) + math.sin(tilt) * b
    y = sign * (math.cos(pitch) * c + math.sin(pitch) * o)
    return np.stack((a, y, np.cross(a, y)), axis=1), np.array(bar.centre) + place * b + depth * a


def inside(target: Target, point: Array) -> bool:
    (box,) = target.boxes
    seen = (point - box.translation.middle) @ box.rotation.middle
    return bool((np.abs(seen) <= target.half[0]).all())


@pytest.mark.parametrize("value", [0.0, 0.7])
def test_a_cell_has_the_hand_of_each_of_its_grasps(never: tuple[Twin, Proved], value: float) -> None:
    twin, rng = never[0], np.random.default_rng(7)
    grasps, bar, kept = grasps_at(twin, value), bar_of(twin), Tolerances()
    world = World(Scene(twin, twin.robots[0]))
    mechanics = Mechanics(world, twin.container("front_door"))
    joint = int(world.boxes[0][world.shapes_of((twin.container("front_door").handle,))[0]])
    turned, moved = (
        each[0] for each in mechanics.handle_poses(world.scene.q(HERE, {}), joint, np.array([value]))
    )
    for _ in range(CELLS):
        low, high = drawn(rng, grasps.low, grasps.high)
        for sign in SIGNS:
            goal = grasps.goal(sign, low, high)
            assert goal.wrist is not None
            assert goal.facing is not None
            last = goal.arm.chain.end.inverse().translation.middle
            for _ in range(GRASPS_IN):
                at = np.clip(rng.uniform(2 * low - high, 2 * high - low), low, high)  # mostly at an end
                rotation, place = grasp(bar, sign, at)
                rotation, place = turned @ rotation, turned @ place + moved
                if value:  # the tool slips
                    ways = rng.normal(size=(2, 3))
                    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
                    place = place + USED * kept.tool_position * ways[0]
                    rotation = Rotation.from_rotvec(USED * kept.tool_angle * ways[1]).as_matrix() @ rotation
                assert inside(goal.target, place)
                assert inside(goal.wrist[1], place + rotation @ last)
                seen = goal.facing.ways @ rotation
                assert (seen >= goal.facing.low).all()
                assert (seen <= goal.facing.high).all()


@pytest.mark.parametrize("value", [0.0, 0.7])
def test_what_is_taken_for_the_hand_is_in_it_however_the_tool_slips(
    never: tuple[Twin, Proved], value: float
) -> None:
    twin, rng, kept = never[0], np.random.default_rng(11), Tolerances()
    grasps, slips = grasps_at(twin, value), USED if value else 0.0
    goal = grasps.goal(1.0, grasps.low, grasps.high)
    last = len(goal.arm.chain.links) - 1
    whole = [core for core in goal.arm.cores if core.link == last]
    back = goal.arm.chain.end.inverse()
    for sign in SIGNS:
        hand = grasps.hand(sign)
        assert len(hand.limb.cores) == len(whole) > 0
        assert hand.shared == len(hand.limb.chain.links)
        for at in rng.uniform(grasps.low, grasps.high, (GRASPS_IN, 4)):
            _, _, tool = hand.limb.chain.frames(at[None])
            rotation, place = tool.rotation.middle[0], tool.translation.middle[0]
            ways = rng.normal(size=(2, 3))
            ways /= np.linalg.norm(ways, axis=1, keepdims=True)
            turned = Rotation.from_rotvec(slips * kept.tool_angle * ways[1]).as_matrix() @ rotation
            moved = place + slips * kept.tool_position * ways[0]
            for less, core in zip(hand.limb.cores, whole, strict=True):
                corners = less.middle.rotation.middle @ (less.half * ENDS).T
                world = rotation @ (corners + less.middle.translation.middle[:, None]) + place[:, None]
                own = back @ core.middle
                seen = turned.T @ (world - moved[:, None]) - own.translation.middle[:, None]
                assert (np.abs(own.rotation.middle.T @ seen) <= core.half[:, None]).all()


def test_what_is_refuted_by_how_the_hand_is_turned_is_turned_otherwise(never: tuple[Twin, Proved]) -> None:
    grasps, rng, refuted = grasps_at(never[0], 0.7), np.random.default_rng(3), 0
    lowest, highest = grasps.low, grasps.high
    for _ in range(OFTEN):
        goal = grasps.goal(1.0, *drawn(rng, lowest, highest))
        assert goal.facing is not None
        least, most = goal.arm.chain.ranges()
        half = (most - least) / 2 * 10 ** rng.uniform(-4.0, -0.5)
        middle, code = rng.uniform(least + half, most - half), int(rng.integers(WAYS))
        try:
            all_turned(goal.arm, goal.facing, [(middle - half, middle + half, code)])
        except InputError:
            continue
        refuted += 1
        ends = middle + half * rng.choice([-1.0, 1.0], size=(32, len(half)))
        q = np.concatenate((ends, rng.uniform(middle - half, middle + half, (32, len(half)))))
        _, _, tool = goal.arm.chain.frames(q)
        i, j = divmod(code, 3)
        at = tool.rotation.middle[:, :, j] @ goal.facing.ways[i]
        assert ((at < goal.facing.low[i, j]) | (at > goal.facing.high[i, j])).all()
    assert refuted > OFTEN // 10


def test_no_rule_refutes_a_posture_of_a_certified_motion(tmp_path: Path) -> None:
    path = write(draw(np.random.default_rng(HELD)), tmp_path, "front")
    service = load(path, ["pr2"], policy=Policy(Drive.FIXED, HERE, 10.0))
    (verdict,) = service.achieve("open:front_door")
    assert verdict.can_perform is not None
    twin, body = service.twin, verdict.can_perform.case.body_motion
    assert isinstance(body, BodyMotion)
    door, bar = twin.container("front_door"), bar_of(twin)
    values = body.kitchen_q[:, body.kitchen_joints.index(door.joint)]
    moving = np.flatnonzero((values > 0.0) & (values < door.open_from))
    frame = np.stack((bar.outward, bar.along, np.cross(bar.outward, bar.along)), axis=1)
    for k in moving[:: len(moving) // 4]:
        grasps = grasps_at(twin, float(values[k]), body.gripper)
        arm = grasps.goal(1.0, grasps.low, grasps.high).arm
        named = twin.robot(body.robot).parked | dict(zip(body.joints, body.q[k], strict=True))
        q = np.array([*body.base[k], *(named[one.name] for one in arm.chain.links[3:])])
        chain, there, _ = statement(twin).before_handle(float(values[k]))
        _, _, joint = replace(chain, end=NO_MORE).frames(there)
        _, _, tool = arm.chain.frames(q[None])
        seen = frame.T @ joint.rotation.middle[0].T @ tool.rotation.middle[0]
        off = (tool.translation.middle - joint.translation.middle)[0]
        away = frame.T @ (joint.rotation.middle[0].T @ off - bar.centre)
        a, y = seen[:, 0], seen[:, 1]
        tilt, pitch = math.asin(a[1]), math.atan2(a[2], -a[0])
        depth = float(away[[0, 2]] @ a[[0, 2]] / (a[[0, 2]] @ a[[0, 2]]))
        at = np.array([away[1] - depth * a[1], pitch, tilt, depth])
        assert (np.abs(at) <= grasps.high + 1e-3).all(), "the motion was planned with a listed grasp"
        sign = 1.0 if math.cos(pitch) * y[2] + math.sin(pitch) * y[0] > 0 else -1.0
        for wide in (1e-3, 0.05, 1.0):
            low, high = np.maximum(at - wide, grasps.low), np.minimum(at + wide, grasps.high)
            goal = grasps.goal(sign, low, high)
            assert goal.wrist is not None
            assert goal.facing is not None
            for width in (0.0, 1e-3, 0.1):
                box = q - width, q + width
                for code in range(len(q) + 1):
                    for one in ((goal.arm, goal.target), goal.wrist):
                        with pytest.raises(InputError, match=r"come as near|come to the handle"):
                            all_far(*one, [(*box, code)], level=False)
                for code in range(WAYS):
                    with pytest.raises(InputError, match="can be turned"):
                        all_turned(goal.arm, goal.facing, [(*box, code)])


def changed(content: bytes, change: Callable[[dict[str, Any]], None]) -> bytes:
    whole = json.loads(zlib.decompress(content))
    change(whole)
    return zlib.compress(json.dumps(whole).encode())


def hard(whole: dict[str, Any]) -> dict[str, Any]:
    """The refutation that needs grasps: of the arm that comes nearer."""
    return max(whole["refutations"], key=lambda one: len(one["tree"]))


def of_every_hold(whole: dict[str, Any]) -> None:
    whole["claim"]["bar"] = None


def not_told(whole: dict[str, Any]) -> None:
    del whole["claim"]["bar"]


def of_another_bar(whole: dict[str, Any]) -> None:
    whole["claim"]["bar"]["centre"][2] += 0.3


def askew(whole: dict[str, Any]) -> None:
    whole["claim"]["bar"]["along"][0] += 0.1


def of_a_point(whole: dict[str, Any]) -> None:
    whole["claim"]["bar"]["reach"] = -0.01


def in_hand(whole: dict[str, Any]) -> None:
    whole["claim"]["within"] = IN_HAND


def all_holds(whole: dict[str, Any]) -> None:
    hard(whole)["grasped"] = False


def between(whole: dict[str, Any]) -> None:
    hard(whole)["between"] = True


def earlier(whole: dict[str, Any]) -> None:
    for one in whole["refutations"]:
        one["value"] = 0.0


def free(whole: dict[str, Any]) -> None:
    whole["claim"]["drive"] = Drive.OMNI.value


def shorter(whole: dict[str, Any]) -> None:
    tree = base64.b64decode(hard(whole)["tree"])
    hard(whole)["tree"] = base64.b64encode(tree[:-1]).decode()


def one_sign(whole: dict[str, Any]) -> None:
    tree = base64.b64decode(hard(whole)["tree"])
    hard(whole)["tree"] = base64.b64encode(tree[: len(tree) // 2]).decode()


def older(whole: dict[str, Any]) -> None:
    whole["schema"] = "sdt proof 15"


CHANGES = (of_every_hold, not_told, of_another_bar, askew, of_a_point, in_hand, all_holds, between, earlier)


@pytest.mark.parametrize("change", [*CHANGES, free, shorter, one_sign, older])
def test_a_changed_proof_does_not_hold(
    never: tuple[Twin, Proved], change: Callable[[dict[str, Any]], None]
) -> None:
    twin, proved = never
    try:
        assert not checked(twin, changed(proved.artefact.content, change))
    except InputError:
        assert change in {not_told, older}


def test_a_longer_bar_is_not_the_handles(never: tuple[Twin, Proved]) -> None:
    twin, about = never[0], statement(never[0])
    arm = about.arm(about.grippers[0])
    assert arm is not None
    bar = bar_of(twin)
    with pytest.raises(InputError, match="not the handle's"):
        Grasps(about, arm, replace(bar, reach=bar.reach + 0.03), 0.0)
