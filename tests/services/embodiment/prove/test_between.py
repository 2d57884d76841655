"""A handle between two fingers: what no gripper can have so is refuted, and no hold that is certified."""

import base64
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from predicates.case import Outcome, Quantity
from predicates.meant import unit_of
from sdt_kg.annotation import Drive, Gripper
from sdt_kg.errors import InputError
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Twin
from services.app import Policy, load
from services.embodiment.certify.held import moved
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import HERE as SAME
from services.embodiment.proof_check.geometry.mechanics import Placement, Tree
from services.embodiment.proof_check.geometry.shapes import finger_box, finger_shapes
from services.embodiment.proof_check.pinch import between
from services.embodiment.proof_check.pinch.between import Along, about_all, places, slab
from services.embodiment.proof_check.pinch.fingers import groups
from services.embodiment.proof_check.proof.content import BETWEEN, ENDS, IN_HAND, LEAF
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.tree import all_far
from services.embodiment.prove import Proved, Prover
from tests.services.embodiment.gantry import gantry_twin
from tests.services.embodiment.prove.grasping import checked
from tests.services.embodiment.prove.standing import changed
from tests.small import beside
from tests.soak.doors import draw, write

HERE = (0.0, 0.0, 0.0)
OUT_OF_REACH = {"pr2": 41, "tiago_dual": 89}
"""Fronts whose handle a fingertip's side comes to, and not what is between two."""
OUT_OF_REACH_PARTED = {"pr2": 484, "tiago_dual": 611}
"""Fronts whose handle is amid the slab about whole fingers, not between their ends, nor at their roots."""
HELD = {"pr2": 22, "tiago_dual": 3}
"""Fronts that are opened."""
LASTS_NOT = 98
"""A front whose holds a TIAGo++ cannot keep: of one gripper no single value refutes them."""
BOXES = 1000  # against what is certified `make soak` looks with more
NARROW = {
    "pr2": 0.008,
    "tiago_dual": 0.03,
}  # [m] half of the slab; a TIAGo++'s fingers overlap at their roots
SAMPLES = 2  # of a motion, and the last at rest; `make soak` looks at more
PARTED = 4  # one of so many places at which fingers are parted; `make soak` looks at all
WIDTHS = (0.0, 1e-3, 0.03, 0.3)  # [rad or m]


def test_the_checker_counts_with_the_step_of_certification() -> None:
    assert between.STEP >= moved.STEP


def front(folder: Path, number: int) -> Path:
    return write(draw(np.random.default_rng(number)), folder, f"front{number}")


def prover(twin: Twin) -> Prover:
    door = twin.container("front_door")
    return Prover(twin, twin.robots[0], door, Drive.FIXED, HERE, np.array([0.0, door.open_from]))


@pytest.fixture(scope="module", params=OUT_OF_REACH)
def lost(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Twin, Proved]:
    """A front that is refuted only since a handle has to be between two fingers, and the proof."""
    robot = request.param
    twin = beside(front(tmp_path_factory.mktemp("front"), OUT_OF_REACH[robot]), robot)
    proved = prover(twin).prove(BOXES)
    assert proved is not None
    return twin, proved


def check_rests_on(assumption: str, twin: Twin, proved: Proved) -> None:
    """The checker finds what the prover said, and that it rests on this."""
    found = check(twin, twin.robots[0], twin.container("front_door"), proved.artefact.content)
    assert found.holds, found.reasons
    assert found.leaves == proved.boxes
    assert assumption in found.assumptions
    assert proved.diagnosis.proof


def test_a_handle_that_no_two_fingers_have_between_them_is_refuted(lost: tuple[Twin, Proved]) -> None:
    twin, proved = lost
    check_rests_on(BETWEEN, twin, proved)
    assert "can bring two fingers to front_handle with front_door at 0 " in proved.diagnosis.reason
    measured, way = proved.diagnosis.evidence, prover(twin).statement.span
    assert measured is not None
    assert way is not None
    assert measured.quantity is Quantity.DEMANDED_POSITION
    assert measured.unit == unit_of(twin, twin.container("front_door"))
    assert (measured.value, measured.bound) == (way[1], 0.0)
    assert any(one.between for one in read_proof(proved.artefact.content).refutations)


def test_a_hold_that_does_not_last_is_refuted_of_every_hold(tmp_path: Path) -> None:
    twin = beside(front(tmp_path, LASTS_NOT), "tiago_dual")
    proved = prover(twin).prove(BOXES, one_hold=True)
    assert proved is not None
    assert checked(twin, proved.artefact.content)
    assert not proved.diagnosis.proof, "it may be let go on the way, and held anew"
    lasting = [one for one in read_proof(proved.artefact.content).refutations if one.places is not None]
    assert max(len(one.values) for one in lasting) > 1, "no single value refutes every place"
    assert all(one.between for one in lasting)


def amid(whole: dict[str, Any]) -> dict[str, Any]:
    """The refutation that needs it: of the arm that comes nearer."""
    return max(whole["refutations"], key=lambda one: len(one["tree"]))


def anywhere(whole: dict[str, Any]) -> None:
    amid(whole)["between"] = False


def not_a_truth(whole: dict[str, Any]) -> None:
    amid(whole)["between"] = "yes"


def one_by_one(whole: dict[str, Any]) -> None:
    amid(whole)["pinched"] = True


def in_hand(whole: dict[str, Any]) -> None:
    whole["claim"]["within"] = IN_HAND


def later(whole: dict[str, Any]) -> None:
    amid(whole)["value"] = 0.7


def nearer(whole: dict[str, Any]) -> None:
    whole["claim"]["start"] = [0.3, 0.0, 0.0]


def shorter(whole: dict[str, Any]) -> None:
    tree = base64.b64decode(amid(whole)["tree"])
    amid(whole)["tree"] = base64.b64encode(tree[:-1]).decode()


def one_gripper(whole: dict[str, Any]) -> None:
    del whole["refutations"][0]


CHANGES = (anywhere, not_a_truth, one_by_one, in_hand, later, nearer, shorter, one_gripper)


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_proof_does_not_hold(
    lost: tuple[Twin, Proved], change: Callable[[dict[str, Any]], None]
) -> None:
    twin, proved = lost
    assert not checked(twin, changed(proved.artefact.content, change))


@pytest.fixture(scope="module", params=OUT_OF_REACH_PARTED)
def parted(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Twin, Proved]:
    """A front that is refuted only where fingers are parted, and the proof."""
    robot = request.param
    twin = beside(front(tmp_path_factory.mktemp("front"), OUT_OF_REACH_PARTED[robot]), robot)
    whole = prover(twin)
    whole.parts = False
    assert whole.prove(BOXES) is None
    proved = prover(twin).prove(BOXES)
    assert proved is not None
    return twin, proved


def test_a_handle_that_is_neither_between_ends_of_fingers_nor_at_their_roots_is_refuted(
    parted: tuple[Twin, Proved],
) -> None:
    twin, proved = parted
    check_rests_on(ENDS, twin, proved)
    assert any(one.ends is not None for one in read_proof(proved.artefact.content).refutations)


def farther_in(whole: dict[str, Any]) -> None:
    amid(whole)["ends"] -= 0.05


def farther_out(whole: dict[str, Any]) -> None:
    amid(whole)["ends"] += 0.08


def beyond_all(whole: dict[str, Any]) -> None:
    amid(whole)["ends"] = 1.0


def not_parted(whole: dict[str, Any]) -> None:
    amid(whole)["ends"] = None


def not_a_place(whole: dict[str, Any]) -> None:
    amid(whole)["ends"] = "the tips"


def of_an_older_reader(whole: dict[str, Any]) -> None:
    whole["schema"] = "sdt proof 1"


def one_part(whole: dict[str, Any]) -> None:
    """The first tree alone, which is what both fingers have beyond the place."""
    tree, ends = base64.b64decode(amid(whole)["tree"]), 1
    for end, node in enumerate(tree, 1):
        ends += 1 if node < LEAF else -1
        if not ends:
            amid(whole)["tree"] = base64.b64encode(tree[:end]).decode()
            return


PARTED_CHANGES = [farther_in, farther_out, beyond_all, not_parted, one_part]


@pytest.mark.parametrize("change", [*PARTED_CHANGES, anywhere, one_by_one, later, shorter])
def test_a_changed_proof_of_parted_fingers_does_not_hold(
    parted: tuple[Twin, Proved], change: Callable[[dict[str, Any]], None]
) -> None:
    twin, proved = parted
    assert not checked(twin, changed(proved.artefact.content, change))


@pytest.mark.parametrize("change", [not_a_place, of_an_older_reader])
def test_one_of_another_form_is_not_read(
    parted: tuple[Twin, Proved], change: Callable[[dict[str, Any]], None]
) -> None:
    with pytest.raises(InputError, match="the proof is damaged"):
        checked(parted[0], changed(parted[1].artefact.content, change))


def of(gripper: Gripper, bodies: Iterable[str]) -> Gripper:
    """The gripper with these fingers alone."""
    return replace(gripper, fingers=tuple(bodies))


@pytest.mark.parametrize("robot", NARROW)
def test_between_any_points_of_two_fingers_is_one_in_the_slab(tmp_path: Path, robot: str) -> None:
    twin, rng = beside(front(tmp_path, 0), robot), np.random.default_rng(1)
    tree = Tree(twin.mechanism(twin.robots[0]))
    for gripper in twin.robot(twin.robots[0]).grippers:
        found = slab(tree, gripper, Tolerances())
        assert found is not None
        low, high = found
        assert max(-low[1], high[1]) < NARROW[robot]
        parts = groups(tree, gripper).values()
        fingers = [[body for bodies in one.values() for body in bodies] for one in parts]
        boxes = [finger_box(tree.mechanism, of(gripper, bodies), Tolerances()) for bodies in fingers]
        (a_low, a_high), (b_low, b_high) = (box for box in boxes if box is not None)
        kept, back = Tolerances(), np.array([Tolerances().engaged, 0.0, 0.0])
        a, b = (rng.uniform(*box, (1000, 3)) - back for box in ((a_low, a_high), (b_low, b_high)))
        a[:, 1] += rng.uniform(-2 * kept.contact, 2 * kept.contact, 1000)
        b[:, 1] += rng.uniform(-2 * kept.contact, 2 * kept.contact, 1000)
        shares = np.linspace(0.0, 1.0, 2001)[:, None, None]
        way = a + shares * (b - a)
        assert ((way >= low - 1e-4) & (way <= high + 1e-4)).all(axis=2).any(axis=0).all()


@pytest.mark.parametrize("robot", NARROW)
def test_points_of_two_fingers_are_beyond_a_place_and_amid_its_slab_or_one_is_before(
    tmp_path: Path, robot: str
) -> None:
    twin, rng, kept = beside(front(tmp_path, 0), robot), np.random.default_rng(5), Tolerances()
    tree = Tree(twin.mechanism(twin.robots[0]))
    for gripper in twin.robot(twin.robots[0]).grippers:
        parts = groups(tree, gripper).values()
        fingers = [[body for bodies in one.values() for body in bodies] for one in parts]
        drawn = list[np.ndarray]()
        for bodies in fingers:
            boxes = finger_shapes(tree.mechanism, of(gripper, bodies), kept)
            assert boxes is not None
            each = [boxes[k] for k in rng.integers(len(boxes), size=1000)]
            points = np.array([rng.uniform(*box) for box in each]) - (kept.engaged, 0.0, 0.0)
            points[:, 1] += rng.uniform(-2 * kept.contact, 2 * kept.contact, 1000)
            drawn.append(points)
        a, b = drawn
        way = a + np.linspace(0.0, 1.0, 2001)[:, None, None] * (b - a)
        seen = set[bool]()
        for at in places(tree.mechanism, gripper, kept):
            beyond, before = (slab(tree, gripper, kept, Along(at, one)) for one in (True, False))
            assert beyond is not None
            assert before is not None
            amid_it = ((way >= beyond[0] - 1e-4) & (way <= beyond[1] + 1e-4)).all(axis=2).any(axis=0)
            behind = [
                (one[:, 0] < at) & ((one >= before[0]) & (one <= before[1])).all(axis=1) for one in (a, b)
            ]
            both = (a[:, 0] >= at) & (b[:, 0] >= at)
            assert (amid_it | ~both).all()
            assert (behind[0] | behind[1] | both).all()
            seen |= set(both.tolist())
        assert seen == {False, True}


def test_a_gripper_of_one_finger_has_nothing_between_two(tmp_path: Path) -> None:
    twin = beside(front(tmp_path, 0), "tiago_dual")
    tree = Tree(twin.mechanism(twin.robots[0]))
    gripper = twin.robot(twin.robots[0]).grippers[0]
    assert slab(tree, of(gripper, gripper.fingers[:1]), Tolerances()) is None


def test_a_box_about_boxes_holds_every_point_between_them() -> None:
    rng = np.random.default_rng(3)
    places = [rng.uniform(-1, 1, 3) for _ in range(3)]
    halves = [rng.uniform(0.01, 0.2, 3) for _ in range(3)]
    at, half = about_all(
        [(Placement(SAME.rotation, exact(p)), h) for p, h in zip(places, halves, strict=True)]
    )
    corners = np.array(
        [p + np.array(s) * h for p, h in zip(places, halves, strict=True) for s in product((-1, 1), repeat=3)]
    )
    shares = rng.dirichlet(np.ones(len(corners)), 500)
    assert (np.abs(np.vstack((corners, shares @ corners)) - at.translation.lo) <= half).all()


def refuted(about: Statement, gripper: Gripper, value: float, q: np.ndarray) -> bool:
    """Whether some rule of distances refutes a posture."""
    arm = about.arm(gripper)
    assert arm is not None
    for leaf in range(len(arm.chain.links) + 1):
        with suppress(InputError):
            all_far(arm, about.target(value), [(q, q, leaf)], level=False)
            return True
    return False


@pytest.mark.oracle
@pytest.mark.parametrize("robot", HELD)
def test_what_a_certified_motion_holds_is_between_its_fingers(tmp_path: Path, robot: str) -> None:
    check_between(tmp_path, robot, BOXES, SAMPLES, PARTED)


def check_between(folder: Path, robot: str, boxes: int, samples: int, parted: int) -> None:
    """No proof of so many boxes is found against a certified motion, and no rule refutes its postures."""
    service = load(front(folder, HELD[robot]), [robot], policy=Policy(Drive.FIXED, HERE, 10.0))
    (verdict,) = service.achieve("open:front_door")
    assert verdict.outcome is Outcome.CERTIFIED
    assert verdict.can_perform is not None
    twin, body = service.twin, verdict.can_perform.case.body_motion
    assert isinstance(body, BodyMotion)
    assert prover(twin).prove(boxes) is None
    door = twin.container("front_door")
    about = Statement(twin, twin.robots[0], door, Drive.FIXED, HERE, Tolerances())
    (gripper,) = (one for one in about.grippers if one.name == body.gripper)
    values = body.kitchen_q[:, body.kitchen_joints.index(door.joint)]
    moving = np.flatnonzero((values > 0.0) & (values < door.open_from))
    moving = moving[:: len(moving) // samples]
    for k in (moving[0] - 1, *moving):
        other = about.between(begins=bool(values[k] == 0.0))
        arm = other.arm(gripper)
        assert arm is not None
        named = twin.robot(body.robot).parked | dict(zip(body.joints, body.q[k], strict=True))
        q = np.array([*body.base[k], *(named[one.name] for one in arm.chain.links[3:])])
        for width, leaf in product(WIDTHS, range(len(arm.chain.links) + 1)):
            with pytest.raises(InputError, match=r"come as near|come to the handle"):
                all_far(arm, other.target(float(values[k])), [(q - width, q + width, leaf)], level=False)
        for at in [*places(twin.mechanism(body.robot), gripper, Tolerances())][::parted]:
            parts = [
                other.between(begins=bool(values[k] == 0.0), along=Along(at, one)) for one in (True, False)
            ]
            assert not all(refuted(part, gripper, float(values[k]), q) for part in parts)


def test_fingers_behind_a_joint_without_limits_have_no_box(tmp_path: Path) -> None:
    twin = gantry_twin(tmp_path)
    mechanism, (gripper, *_) = twin.mechanism(twin.robots[0]), twin.robot(twin.robots[0]).grippers
    assert finger_box(mechanism, gripper, Tolerances()) is not None
    assert finger_box(mechanism, replace(gripper, tool_body="arm"), Tolerances()) is None  # and nothing warns
