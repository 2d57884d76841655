"""Proofs about a set of grasps: cells hold every grasp in them, and nothing that is held is refuted."""

import math
from dataclasses import replace
from pathlib import Path

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
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import HERE as NO_MORE
from services.embodiment.proof_check.geometry.mechanics import Chain, Placement
from services.embodiment.proof_check.grasps import SIGNS, Grasps
from services.embodiment.proof_check.inside.solids import WORLD
from services.embodiment.proof_check.loop import Loop, refuted_loop
from services.embodiment.proof_check.proof.claim import DEPTH, GRASPS, PITCH, TILT, Bar
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.prove import Proved, claimed
from services.physics.model import Scene
from tests.services.embodiment.prove.grasping import (
    HERE,
    NEVER_HELD,
    bar_of,
    grasps_at,
    prover,
    statement,
    twin_of,
)
from tests.soak.doors import draw, write

Array = NDArray[np.float64]

ROBOTS = ("pr2", "tiago_dual", "stretch")
HELD = 22
"""A front that a PR2 opens."""
GRASPS_IN, POSTURES = 24, 12
CODES = 8  # of what a leaf can name, for each of these
OFTEN = 500  # boxes of positions of the arm and of the grasp
ENDS = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
USED = 0.999  # [1] of what certification lets the tool slip and turn


def test_a_bar_that_no_grasp_has_all_along_is_refuted_of_these_alone(never: tuple[Twin, Proved]) -> None:
    twin, proved = never
    found = check(twin, twin.robots[0], twin.container("front_door"), proved.artefact.content)
    assert found.holds, found.reasons
    assert found.leaves == proved.boxes
    (told,) = (one for one in found.assumptions if one.startswith(f"grasp set: {GRASPS}"))
    assert str(bar_of(twin)) in told
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


def drawn(rng: np.random.Generator, low: Array, high: Array, about: Array) -> tuple[Array, Array]:
    """Ends of a box of any width, with some positions in it."""
    wide = (high - low) * 10 ** rng.uniform(-4.0, 0.0)
    share = rng.random(len(low))
    return np.maximum(about - share * wide, low), np.minimum(about + (1 - share) * wide, high)


def grasp(bar: Bar, sign: float, at: Array) -> tuple[Array, Array]:
    """The tool's pose in the frame of the handle's joint, from the formula of the docstring."""
    place, pitch, tilt, depth = at
    o, b = np.array(bar.outward), np.array(bar.along)
    c = np.cross(o, b)
    a = math.cos(tilt) * (math.sin(pitch) * c - math.cos(pitch) * o) + math.sin(tilt) * b
    y = sign * (math.cos(pitch) * c + math.sin(pitch) * o)
    return np.stack((a, y, np.cross(a, y)), axis=1), np.array(bar.centre) + place * b + depth * a


def slipped(rng: np.random.Generator, rotation: Array, place: Array, share: float) -> tuple[Array, Array]:
    """A pose of the tool off by a share of what certification lets it slip and turn."""
    kept, ways = Tolerances(), rng.normal(size=(2, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    turned = Rotation.from_rotvec(share * kept.tool_angle * ways[1]).as_matrix() @ rotation
    return turned, place + share * kept.tool_position * ways[0]


def pose_of(chain: Chain, at: Array) -> tuple[Array, Array]:
    """Where the end of a chain is, shapes (3, 3) and (3,)."""
    _, _, end = chain.frames(at[None])
    return end.rotation.middle[0], end.translation.middle[0]


def meeting(loop: Loop, q: Array, at: Array, tool: tuple[Array, Array]) -> Loop:
    """The same with the bar elsewhere: so that a grasp of it has the tool there."""
    rotation, place = pose_of(loop.bar, at)
    first, *others = loop.bar.links
    turn = tool[0] @ rotation.T
    before = Placement(exact(turn), exact(tool[1] - turn @ place)) @ first.before
    return replace(loop, bar=Chain((replace(first, before=before), *others), loop.bar.end))


def is_refuted(loop: Loop, code: int, low: Array, high: Array) -> bool:
    try:
        return refuted_loop(loop, iter([LEAF + code]), low, high) == 1
    except InputError:
        return False


@pytest.mark.parametrize("sign", SIGNS)
def test_coordinates_of_a_grasp_are_those_of_the_formula(never: tuple[Twin, Proved], sign: float) -> None:
    twin, rng, value = never[0], np.random.default_rng(7), 0.7
    world = World(Scene(twin, twin.robots[0]))
    mechanics = Mechanics(world, twin.container("front_door"))
    joint = int(world.boxes[0][world.shapes_of((twin.container("front_door").handle,))[0]])
    turned, moved = (
        each[0] for each in mechanics.handle_poses(world.scene.q(HERE, {}), joint, np.array([value]))
    )
    bar = grasps_at(twin, value).loop(sign).bar
    for at in rng.uniform(*bar.ranges(), (GRASPS_IN, 4)):
        wanted, found = grasp(bar_of(twin), sign, at), pose_of(bar, at)
        assert np.abs(turned @ wanted[0] - found[0]).max() < 1e-9
        assert np.abs(turned @ wanted[1] + moved - found[1]).max() < 1e-9


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("value", [0.0, 0.7])
def test_no_box_with_a_grasp_in_it_is_refuted_however_the_tool_slips(
    tmp_path: Path, robot: str, value: float
) -> None:
    """The bar is put where the arm has it, in any posture; solids are elsewhere then, and are not asked."""
    rng, share = np.random.default_rng(3), USED if value else 0.0
    grasps = grasps_at(twin_of(tmp_path, NEVER_HELD, robot), value)
    for sign in SIGNS:
        loop = grasps.loop(sign)
        low, high = loop.ranges()
        for _ in range(POSTURES):
            there = rng.uniform(low, high)
            q, at = there[:-4], there[-4:]
            met = meeting(loop, q, at, slipped(rng, *pose_of(loop.arm.chain, q), share))
            box = drawn(rng, low, high, there)
            codes = rng.choice(loop.bounds[2], CODES, replace=False).tolist()
            assert not any(is_refuted(met, code, *box) for code in codes)


@pytest.mark.parametrize("robot", ROBOTS)
def test_what_is_refuted_has_no_grasp_in_it(tmp_path: Path, robot: str) -> None:
    rng = np.random.default_rng(5)
    loop = grasps_at(twin_of(tmp_path, NEVER_HELD, robot), 0.7).loop(1.0)
    low, high = loop.ranges()
    found = dict.fromkeys(range(3), 0)
    for _ in range(OFTEN):
        box = drawn(rng, low, high, rng.uniform(low, high))
        code = int(rng.integers(loop.bounds[2]))
        if not is_refuted(loop, code, *box):
            continue
        kind = int(np.digitize(code, loop.bounds[:2]))
        found[kind] += 1
        ends, amid = np.where(rng.random((32, len(low))) < 0.5, *box), rng.uniform(*box, (32, len(low)))
        some = np.concatenate((ends, amid))
        mine, there = (
            side.frames(each)[2] for side, each in ((loop.arm.chain, some[:, :-4]), (loop.bar, some[:, -4:]))
        )
        turned = mine.rotation.middle - there.rotation.middle
        if kind == 2:
            off = np.linalg.norm(turned, axis=1)[:, code - loop.bounds[1]]
            assert (off > loop.turned).all()
            continue
        end = loop.ends[kind]
        off = mine.translation.middle - there.translation.middle + turned @ end.seen
        assert (np.linalg.norm(off, axis=1) > end.near - 1e-9).all()
    assert min(found.values()) > OFTEN // 50, found


@pytest.mark.parametrize("value", [0.0, 0.7])
def test_what_is_taken_for_the_hand_is_in_it_however_the_tool_slips(
    never: tuple[Twin, Proved], value: float
) -> None:
    rng, grasps, slips = np.random.default_rng(11), grasps_at(never[0], value), USED if value else 0.0
    for sign in SIGNS:
        loop = grasps.loop(sign)
        last = len(loop.arm.chain.links) - 1
        whole = [core for core in loop.arm.cores if core.link == last]
        hand, back = loop.hand, loop.arm.chain.end.inverse()
        assert len(hand.limb.cores) == len(whole) > 0
        assert hand.shared == len(hand.limb.chain.links)
        for at in rng.uniform(*loop.bar.ranges(), (GRASPS_IN, 4)):
            turned, moved = slipped(rng, *pose_of(loop.bar, at), slips)
            for less, core in zip(hand.limb.cores, whole, strict=True):
                there, _ = less.seen_from(WORLD, hand.limb.chain, (at[None], np.zeros((1, 4))))
                world = there.rotation.middle[0] @ (less.half * ENDS).T + there.translation.middle[0][:, None]
                own = back @ core.middle
                seen = turned.T @ (world - moved[:, None]) - own.translation.middle[:, None]
                assert (np.abs(own.rotation.middle.T @ seen) <= core.half[:, None]).all()


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
        arm = grasps.loop(1.0).arm
        named = twin.robot(body.robot).parked | dict(zip(body.joints, body.q[k], strict=True))
        q = np.array([*body.base[k], *(named[one.name] for one in arm.chain.links[3:])])
        chain, there, _ = statement(twin).before_handle(float(values[k]))
        _, _, joint = replace(chain, end=NO_MORE).frames(there)
        rotation, place = pose_of(arm.chain, q)
        seen = frame.T @ joint.rotation.middle[0].T @ rotation
        off = place - joint.translation.middle[0]
        away = frame.T @ (joint.rotation.middle[0].T @ off - bar.centre)
        a, y = seen[:, 0], seen[:, 1]
        tilt, pitch = math.asin(a[1]), math.atan2(a[2], -a[0])
        depth = float(away[[0, 2]] @ a[[0, 2]] / (a[[0, 2]] @ a[[0, 2]]))
        at = np.array([away[1] - depth * a[1], pitch, tilt, depth])
        sign = 1.0 if math.cos(pitch) * y[2] + math.sin(pitch) * y[0] > 0 else -1.0
        loop = grasps.loop(sign)
        least, most = loop.ranges()
        assert (np.abs(at) <= most[-4:] + 1e-3).all(), "the motion was planned with a listed grasp"
        for wide in (1e-3, 0.05, 1.0):
            some = np.concatenate((q, at))
            box = np.maximum(some - wide, least), np.minimum(some + wide, most)
            assert not any(is_refuted(loop, code, *box) for code in range(loop.bounds[-1]))


def test_of_a_bar_that_the_handle_has_not_nothing_is_proved(never: tuple[Twin, Proved]) -> None:
    twin = never[0]
    bar = bar_of(twin)
    x, y, z = bar.outward
    assert prover(twin, replace(bar, outward=(-x, -y, -z))).grasped() is None


def test_a_longer_bar_is_not_the_handles(never: tuple[Twin, Proved]) -> None:
    twin, about = never[0], statement(never[0])
    arm = about.arm(about.grippers[0])
    assert arm is not None
    bar = bar_of(twin)
    with pytest.raises(InputError, match="not the handle's"):
        Grasps(about, arm, replace(bar, reach=bar.reach + 0.03), 0.0)
