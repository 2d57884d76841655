"""At values that a container passes its own joint is exactly there: what that refutes, and where not."""

import json
import zlib
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.check import refuted
from services.embodiment.proof_check.geometry.mechanics import HERE, Link
from services.embodiment.proof_check.passing import Passing, passes
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from tests.services.embodiment.prove.standing import HERE as START
from tests.services.embodiment.prove.standing import front, swept

PAIR = Path(__file__).parents[2] / "dynamics" / "pair.urdf"  # a drawer that another follows half as far
GRAZES = 145  # front whose door comes 1 mm into the edge of the PR2's base, at the end of its way
PASSING = (47, 51, 109)  # fronts whose doors are certified, or come into no body that stands
OFF = 1e-3 + 1e-3 + Tolerances().position


def test_values_near_the_ends_of_the_way_need_not_be_passed() -> None:
    assert passes((0.0, 1.0), 0.5, OFF)
    assert not passes((0.0, 1.0), OFF, OFF)
    assert not passes((0.0, 1.0), 1.0 - OFF, OFF)
    assert not passes(None, 0.5, OFF)


def test_only_the_joint_of_the_container_is_exactly_there(tmp_path: Path) -> None:
    container = front(tmp_path, "pr2", GRAZES).container("front_door")
    links = tuple(Link(name, HERE, np.eye(3)[2], True, 0.0, 1.0) for name in ("front_door_joint", "other"))
    kept = Tolerances()
    passing = Passing(container, {}, (0.0, 1.4), kept)
    amid = passing.slacks(0.7, 0.0, links)
    assert amid[0] == 0.0
    assert amid[1] == kept.position + kept.start_position
    assert (passing.slacks(1.4, 0.0, links) == amid[1]).all()
    assert (Passing(container, {}, None, kept).slacks(0.7, 0.0, links) == amid[1]).all()


def test_joints_are_as_much_farther_off_as_they_move_more_than_a_container_that_is_off() -> None:
    twin, kept = load_twin(PAIR), Tolerances()
    container, off = twin.container("lower_drawer"), kept.position + kept.start_position
    names = ("lower_drawer_joint", "upper_drawer_joint", "left_leaf_joint")
    links = tuple(Link(name, HERE, np.eye(3)[2], False, 0.0, 1.0) for name in names)
    passing = Passing.of(twin, container, (0.0, 0.25), kept)
    assert passing.slacks(0.25, 0.0, links) == pytest.approx([off, 2 * off, off])
    assert passing.slacks(0.25, 0.0, links)[1] > 2 * off
    assert passing.slacks(0.1, 0.0, links) == pytest.approx([off, 2 * off, off])  # it follows the other
    assert passing.slacks(0.25, 0.0, links, 0.01) == pytest.approx([off + 0.01, 2 * (off + 0.01), off])
    leads = Passing.of(twin, twin.container("upper_drawer"), (0.0, 0.5), kept)
    assert leads.slacks(0.5, 0.0, links) == pytest.approx([off] * 3)  # what moves less is as near as ever
    assert leads.slacks(0.2, 0.0, links, 0.01) == pytest.approx([0.005, 0.01, off])


def test_what_grazes_a_standing_robot_is_proved_where_it_passes(tmp_path: Path) -> None:
    twin = front(tmp_path, "pr2", GRAZES)
    proved = swept(twin, declared=False)
    assert proved is not None
    assert proved.diagnosis.proof
    content = proved.artefact.content
    about = twin, twin.robots[0], twin.container("front_door")
    assert check(*about, content).holds
    proof = read_proof(content)
    loose = Statement(*about, Drive.FIXED, START, Tolerances())
    assert refuted(loose, proof.claim.span, proof.refutations)[0], (
        "where it need not be passed, it is not refuted"
    )
    whole = json.loads(zlib.decompress(content))
    whole["claim"]["span"][1] = max(proof.refutations[0].values)
    assert not check(*about, zlib.compress(json.dumps(whole).encode())).holds


@pytest.mark.parametrize("seed", PASSING)
def test_what_passes_a_standing_robot_is_not_refuted(tmp_path: Path, seed: int) -> None:
    assert swept(front(tmp_path, "pr2", seed), declared=False) is None
