"""Proofs about a set of grasps that go over to limbs beside the arm where these are in the way."""

import base64
from collections.abc import Callable
from typing import Any

import pytest

from sdt_kg.errors import InputError
from sdt_kg.twin import Twin
from services.embodiment.proof_check import check
from services.embodiment.proof_check.grasps import Grasps
from services.embodiment.proof_check.loop import refuted_loop
from services.embodiment.proof_check.proof.content import BESIDE, LEAF
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.prove import Proved
from tests.services.embodiment.prove.grasping import bar_of, checked, refuted_grasps, statement
from tests.services.embodiment.prove.standing import changed

IN_THE_WAY = 914
"""A drawer that comes into a PR2 but in a part of its lift, in which no grasp can be had."""


@pytest.fixture(scope="module")
def blocked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Twin, Proved]:
    """That, and the proof."""
    return refuted_grasps(tmp_path_factory.mktemp("front"), IN_THE_WAY)


def test_where_limbs_are_in_the_way_but_in_a_part_of_the_lift_only_that_is_asked_of_grasps(
    blocked: tuple[Twin, Proved],
) -> None:
    twin, proved = blocked
    content = proved.artefact.content
    found = check(twin, twin.robots[0], twin.container("front_door"), content)
    assert found.holds, found.reasons
    assert found.leaves == proved.boxes
    refutations = read_proof(content).refutations
    assert all(one.grasped and one.parked and one.beside for one in refutations)
    assert BESIDE in found.assumptions
    assert not proved.diagnosis.proof, "other holds are not refuted"
    for one in refutations[0].beside:
        assert f"{one} or what carries it" in proved.diagnosis.reason


def alone(whole: dict[str, Any]) -> None:
    for one in whole["refutations"]:
        one["beside"] = []


def of_other_limbs(whole: dict[str, Any]) -> None:
    for one in whole["refutations"]:
        one["beside"] = ["head_mount_kinect2_link"] * len(one["beside"])


def of_no_limb(whole: dict[str, Any]) -> None:
    for one in whole["refutations"]:
        one["beside"] = ["no_such_link"] * len(one["beside"])


def of_two_fingers(whole: dict[str, Any]) -> None:
    for one in whole["refutations"]:
        one["between"] = True


def shorter(whole: dict[str, Any]) -> None:
    for one in whole["refutations"]:
        one["tree"] = base64.b64encode(base64.b64decode(one["tree"])[:-1]).decode()


def before_it_moves(whole: dict[str, Any]) -> None:
    for one in whole["refutations"]:
        one["value"] = 0.0


@pytest.mark.parametrize(
    "change", [alone, of_other_limbs, of_no_limb, of_two_fingers, shorter, before_it_moves]
)
def test_a_changed_proof_does_not_hold(
    blocked: tuple[Twin, Proved], change: Callable[[dict[str, Any]], None]
) -> None:
    twin, proved = blocked
    assert not checked(twin, changed(proved.artefact.content, change))


def test_a_limb_that_is_clear_refutes_no_grasp(blocked: tuple[Twin, Proved]) -> None:
    """With the drawer shut nothing is in the way: neither of a limb as a whole, nor by any of its cores."""
    twin, about = blocked[0], statement(blocked[0])
    arm = about.arm(about.grippers[0])
    assert arm is not None
    (body, *_) = read_proof(blocked[1].artefact.content).refutations[0].beside
    limb = about.beside(arm, body, 0.0, parked=True)
    loop = Grasps(about, arm, bar_of(twin), 0.0, (limb,)).loop(1.0)
    low, high = loop.ranges()
    near, over = len(limb.limb.chain.links) + 1, LEAF + loop.bounds[-1]
    for core in range(len(limb.limb.cores)):
        with pytest.raises(InputError, match="can be clear"):
            refuted_loop(loop, iter([over, LEAF + near + core]), low, high)
    with pytest.raises(InputError, match="refuted by its distance"):
        refuted_loop(loop, iter([over, LEAF]), low, high)
    with pytest.raises(InputError, match="damaged"):
        refuted_loop(loop, iter([over + 1]), low, high)
