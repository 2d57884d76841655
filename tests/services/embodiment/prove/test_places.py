"""One hold at all values of a container: found, verified, and never against a hold that is certified."""

import base64
import json
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from predicates.case import Artefact, ArtefactKind, Outcome
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Twin
from services.app import Policy, load
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.places import region, too_far, wrist_of
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.tree import all_far
from services.embodiment.prove import Proved, Prover
from services.viewer.judging.measure import region as drawn
from tests.small import beside
from tests.soak.doors import draw, write

HERE = (0.0, 0.0, 0.0)
LASTS_NOT = 12
"""A door that tips over, 0.97 m away: a TIAGo++ holds it at each angle, and in no way that it can keep."""
HELD = 3
"""A front that a TIAGo++ opens."""
BOXES = 1000
SAMPLES = 6  # of a motion
SLIP = 0.006  # [m] 2 mm, and a turn by 1° of a wrist that is 0.22 m from the tool
WIDTHS = (0.0, 1e-3, 0.03, 0.3)  # [rad or m]


def front(folder: Path, number: int) -> Path:
    return write(draw(np.random.default_rng(number)), folder, f"front{number}")


def prover(twin: Twin) -> Prover:
    door = twin.container("front_door")
    values = np.array([0.0, door.open_from])
    return Prover(twin, twin.robots[0], door, Drive.FIXED, HERE, values)


@pytest.fixture(scope="module")
def lost(tmp_path_factory: pytest.TempPathFactory) -> tuple[Twin, Proved]:
    """A front that no single value refutes, and the proof."""
    twin = beside(front(tmp_path_factory.mktemp("front"), LASTS_NOT), "tiago_dual")
    assert prover(twin).prove(BOXES) is None
    proved = prover(twin).prove(BOXES, one_hold=True)
    assert proved is not None
    return twin, proved


def checked(twin: Twin, content: bytes) -> bool:
    return check(twin, twin.robots[0], twin.container("front_door"), content).holds


def test_a_door_that_is_reached_at_each_angle_is_refuted_if_no_hold_of_it_lasts(
    lost: tuple[Twin, Proved],
) -> None:
    twin, proved = lost
    found = check(twin, twin.robots[0], twin.container("front_door"), proved.artefact.content)
    assert found.holds, found.reasons
    assert found.leaves == proved.boxes
    assert any("one hold" in each for each in found.assumptions)
    assert "can keep one hold of front_handle with front_door at 0 and" in proved.diagnosis.reason
    assert not proved.diagnosis.proof, "it may be let go on the way, and held anew"
    (lasting,) = (one for one in read_proof(proved.artefact.content).refutations if one.places is not None)
    assert len(lasting.values) > 1, "no single value refutes every place"


def test_a_picture_of_it_says_that_the_hold_does_not_last(lost: tuple[Twin, Proved]) -> None:
    twin, proved = lost
    mark = drawn(twin, Artefact(ArtefactKind.PROOF, proved.artefact.content))
    assert mark is not None
    assert mark.text.startswith("proved: no gripper keeps one hold all along")


def lasting(whole: dict[str, Any]) -> dict[str, Any]:
    (found,) = (one for one in whole["refutations"] if one["places"] is not None)
    return found


def fewer_places(whole: dict[str, Any]) -> None:
    lasting(whole)["places"]["box"][1][0] += 0.01


def no_places(whole: dict[str, Any]) -> None:
    lasting(whole)["places"] = None


def other_values(whole: dict[str, Any]) -> None:
    lasting(whole)["places"]["values"][0] = 0.7


def a_value_that_need_not_be_passed(whole: dict[str, Any]) -> None:
    lasting(whole)["places"]["values"][-1] = 1.55


def one_value(whole: dict[str, Any]) -> None:
    del lasting(whole)["places"]["values"][1:]


def nothing_to_hold(whole: dict[str, Any]) -> None:
    lasting(whole)["tree"] = "/w=="  # 255: that no hold has the wrist anywhere


def cut(whole: dict[str, Any]) -> None:
    lasting(whole)["tree"] = lasting(whole)["tree"][:-8]


def longer(whole: dict[str, Any]) -> None:
    lasting(whole)["tree"] = lasting(whole)["tree"].rstrip("=") + "////"


def nearer(whole: dict[str, Any]) -> None:
    whole["claim"]["start"] = [0.3, 0.0, 0.0]


def free(whole: dict[str, Any]) -> None:
    whole["claim"]["drive"] = "omni"


def other_door(whole: dict[str, Any]) -> None:
    whole["claim"]["models"][0][1] = "0" * 64


def every_hold(whole: dict[str, Any]) -> None:
    whole["claim"]["one_hold"] = False


def not_told(whole: dict[str, Any]) -> None:
    del whole["claim"]["one_hold"]


CHANGES = (
    every_hold,
    not_told,
    fewer_places,
    no_places,
    other_values,
    a_value_that_need_not_be_passed,
    one_value,
    nothing_to_hold,
    cut,
    longer,
    nearer,
    free,
    other_door,
)


def test_an_older_proof_of_it_is_read_and_is_about_one_hold(lost: tuple[Twin, Proved]) -> None:
    twin, proved = lost
    whole = json.loads(zlib.decompress(proved.artefact.content))
    whole["schema"] = "sdt proof 11"
    del whole["claim"]["one_hold"]
    content = zlib.compress(json.dumps(whole).encode())
    assert checked(twin, content)
    assert read_proof(content).claim.partial


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_proof_does_not_hold(
    lost: tuple[Twin, Proved], change: Callable[[dict[str, Any]], None]
) -> None:
    twin, proved = lost
    whole = json.loads(zlib.decompress(proved.artefact.content))
    change(whole)
    content = zlib.compress(json.dumps(whole).encode())
    try:
        assert not checked(twin, content)
    except InputError as error:
        assert "damaged" in str(error)  # noqa: PT017  # either is a refusal


def test_no_byte_of_the_tree_can_be_left_out(lost: tuple[Twin, Proved]) -> None:
    twin, proved = lost
    about = prover(twin).statement
    proof = read_proof(proved.artefact.content)
    (one,) = (each for each in proof.refutations if each.places is not None)
    assert about.tolerances == proof.claim.tolerances
    leaf = next(k for k, node in enumerate(one.tree) if node >= LEAF)
    for at in {0, leaf, len(one.tree) // 2, len(one.tree) - 1}:
        whole = json.loads(zlib.decompress(proved.artefact.content))
        tree = one.tree[:at] + one.tree[at + 1 :]
        lasting(whole)["tree"] = base64.b64encode(tree).decode("ascii")
        assert not checked(twin, zlib.compress(json.dumps(whole).encode()))


@pytest.mark.oracle
def test_a_certified_motion_keeps_its_wrist_in_one_cell_which_no_value_refutes(tmp_path: Path) -> None:
    service = load(front(tmp_path, HELD), ["tiago_dual"], policy=Policy(Drive.FIXED, HERE, 10.0))
    (verdict,) = service.achieve("open:front_door")
    assert verdict.outcome is Outcome.CERTIFIED
    assert verdict.can_perform is not None
    twin, body = service.twin, verdict.can_perform.case.body_motion
    assert isinstance(body, BodyMotion)
    door = twin.container("front_door")
    about = Statement(twin, twin.robots[0], door, Drive.FIXED, HERE, Tolerances())
    (gripper,) = (one for one in about.grippers if one.name == body.gripper)
    arm = about.arm(gripper)
    assert arm is not None
    values = body.kitchen_q[:, body.kitchen_joints.index(door.joint)]
    moving = np.flatnonzero((values > 0.0) & (values < door.open_from))
    moving = moving[:: len(moving) // SAMPLES]
    postures = np.array([posture(arm, twin, body, k) for k in (moving[0] - 1, *moving)])
    origins, _, _ = arm.chain.frames(postures)
    wrists = (origins.lo[:, -1] + origins.hi[:, -1]) / 2
    seen = np.array(
        [seen_from_handle(about, arm, float(values[k]), at) for k, at in zip(moving, wrists[1:], strict=True)]
    )
    low, high = region(about, arm)
    first = seen[0]
    assert np.linalg.norm(seen - first, axis=1).max() < SLIP
    assert ((low < first) & (first < high)).all()
    assert not too_far(about, arm, first - 1e-3, first + 1e-3)
    for k, q in zip(moving, postures[1:], strict=True):
        cell = about.cell(arm, float(values[k]), first - 1e-4, first + 1e-4)
        for width in WIDTHS:
            for leaf in range(len(arm.chain.links) + 1):
                with pytest.raises(InputError, match=r"come as near|come to the handle"):
                    all_far(wrist_of(arm), cell, [(q - width, q + width, leaf)], level=False)


def posture(arm: Arm, twin: Twin, body: BodyMotion, k: int) -> np.ndarray:
    """Positions of the arm's joints, the base's first, at a sample."""
    parked = twin.robot(body.robot).parked
    named = dict(zip(body.joints, body.q[k], strict=True))
    return np.array(
        [*body.base[k], *(named.get(one.name, parked.get(one.name, 0.0)) for one in arm.chain.links[3:])]
    )


def seen_from_handle(about: Statement, arm: Arm, value: float, point: np.ndarray) -> np.ndarray:
    """A point of the world in the handle's frame."""
    (box,) = about.cell(arm, value, np.zeros(3), np.zeros(3)).boxes
    rotation, translation = ((one.lo + one.hi) / 2 for one in (box.rotation, box.translation))
    return rotation.T @ (point - translation)
