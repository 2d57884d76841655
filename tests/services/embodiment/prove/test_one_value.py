"""A proof is about one value for all grippers: refuted at values of their own, one may take over."""

import json
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Outcome
from sdt_kg.annotation import Drive, Gripper
from sdt_kg.twin import Twin
from services.app import Policy, load
from services.embodiment.proof_check import check
from services.embodiment.proof_check.proof.claim import claim_about
from services.embodiment.proof_check.proof.content import Places, Proof, Refutation, Steps, at_one_value
from services.embodiment.proof_check.proof.written import read_proof, to_bytes
from services.embodiment.prove import Prover
from services.embodiment.prove.values import at_one
from tests.small import beside
from tests.soak.doors import draw, write

pytestmark = pytest.mark.oracle

HERE = (0.0, 0.0, 0.0)
SHUT_AND_OPEN = 27
"""A door whose handle a TIAGo++'s left gripper does not reach shut and open, nor the right one open."""
TAKEN_OVER = 222
"""A door that the left gripper does not hold open, nor the right one shut."""
BOXES = 1000


def front(folder: Path, number: int) -> Path:
    return write(draw(np.random.default_rng(number)), folder, f"front{number}")


def prover(twin: Twin) -> Prover:
    door = twin.container("front_door")
    return Prover(twin, twin.robots[0], door, Drive.FIXED, HERE, np.array([0.0, door.open_from]))


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return beside(front(tmp_path_factory.mktemp("front"), SHUT_AND_OPEN), "tiago_dual")


def refutation(twin: Twin, gripper: str, *, opened: bool) -> Refutation:
    """Of one gripper, with the door shut or just before it is open."""
    span = prover(twin).span
    assert span is not None
    (named,) = (one for one in twin.robot(twin.robots[0]).grippers if one.name == gripper)
    found = prover(twin)._at(named, span[1] - 0.0025 if opened else span[0], BOXES)
    assert found is not None
    return found


def proof(twin: Twin, *refutations: Refutation, one_hold: bool) -> bytes:
    span = prover(twin).span
    assert span is not None
    about = twin, twin.robots[0], twin.container("front_door"), span, Drive.FIXED, HERE
    return to_bytes(Proof(claim_about(*about, one_hold=one_hold), refutations))


def reasons(twin: Twin, content: bytes) -> tuple[str, ...]:
    return check(twin, twin.robots[0], twin.container("front_door"), content).reasons


def test_grippers_are_refuted_at_one_value(twin: Twin) -> None:
    proved = prover(twin).prove(BOXES)
    assert proved is not None
    assert proved.diagnosis.proof
    assert len({one.value for one in read_proof(proved.artefact.content).refutations}) == 1


def test_at_values_of_their_own_one_hold_is_refuted_and_not_several(twin: Twin) -> None:
    apart = refutation(twin, "left", opened=False), refutation(twin, "right", opened=True)
    assert reasons(twin, proof(twin, *apart, one_hold=True)) == ()
    (said,) = reasons(twin, proof(twin, *apart, one_hold=False))
    assert said == "not every gripper is refuted at one value, and the proof is about several holds"
    together = refutation(twin, "left", opened=True), apart[1]
    assert reasons(twin, proof(twin, *together, one_hold=False)) == ()


def test_an_older_proof_at_values_of_their_own_is_read_as_one_of_one_hold(twin: Twin) -> None:
    apart = refutation(twin, "left", opened=False), refutation(twin, "right", opened=True)
    whole = json.loads(zlib.decompress(proof(twin, *apart, one_hold=True)))
    whole["schema"] = "sdt proof 11"
    del whole["claim"]["one_hold"]
    content = zlib.compress(json.dumps(whole).encode())
    assert reasons(twin, content) == ()
    assert read_proof(content).claim.one_hold


def test_steps_of_limbs_are_about_no_gripper(twin: Twin) -> None:
    one, other = refutation(twin, "left", opened=False), refutation(twin, "right", opened=True)
    assert not at_one_value((one, other))
    assert at_one_value((replace(one, steps=Steps((0.1, 0.2), (1, 1))), other))
    assert at_one_value((one, replace(other, value=one.value)))


def test_what_nobody_looks_at_is_no_reason_to_take_values_of_their_own_for_one(twin: Twin) -> None:
    # Grippers that are refuted at values of their own may yet hold a door in turn.
    apart = refutation(twin, "left", opened=False), refutation(twin, "right", opened=True)
    steps = Steps((0.1, 0.2), (1, 1))
    for unseen in (replace(apart[0], steps=steps), replace(apart[0], gripper="third", steps=steps)):
        found = reasons(twin, proof(twin, unseen, *apart, one_hold=False))
        assert found == ("a refutation is of no gripper, or of one that another is of",)


def test_places_at_one_value_count_by_that_value(twin: Twin) -> None:
    one, other = refutation(twin, "left", opened=False), refutation(twin, "right", opened=True)
    placed = replace(other, value=one.value, places=Places((other.value,), ()))
    assert not at_one_value((one, placed))
    assert at_one_value((one, replace(placed, places=Places((one.value, one.value), ()))))


def test_the_first_value_at_which_all_are_refuted_is_taken(twin: Twin) -> None:
    grippers, some = twin.robot(twin.robots[0]).grippers, refutation(twin, "left", opened=True)
    refuted = {"left": {1.0, 3.0, 4.0}, "right": {2.0, 3.0, 4.0}}

    def look(gripper: Gripper, value: float) -> Refutation | None:
        return replace(some, gripper=gripper.name, value=value) if value in refuted[gripper.name] else None

    found = at_one(grippers, (1.0, 2.0, 3.0, 4.0), look)
    assert found is not None
    assert [(one.gripper, one.value) for one in found] == [("left", 3.0), ("right", 3.0)]
    assert at_one(grippers, (1.0, 2.0), look) is None


def test_what_is_proved_of_one_hold_at_values_of_their_own_is_certified_by_both_in_turn(
    tmp_path: Path,
) -> None:
    path = front(tmp_path, TAKEN_OVER)
    twin = beside(path, "tiago_dual")
    assert prover(twin).prove(BOXES) is None
    partial = prover(twin).prove(BOXES, one_hold=True)
    assert partial is not None
    assert not partial.diagnosis.proof
    (verdict,) = load(path, ["tiago_dual"], policy=Policy(Drive.FIXED, HERE, 60.0)).achieve("open:front_door")
    assert verdict.outcome is Outcome.CERTIFIED
