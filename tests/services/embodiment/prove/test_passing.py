"""At values that a container passes its own joint is exactly there: what that refutes, and where not."""

import json
import zlib
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.check import refuted
from services.embodiment.proof_check.mechanics import HERE, Link
from services.embodiment.proof_check.passing import passes, slacks
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.written import read_proof
from tests.services.embodiment.prove.standing import HERE as START
from tests.services.embodiment.prove.standing import front, swept

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
    amid = slacks(container, (0.0, 1.4), kept, 0.7, 0.0, links)
    assert amid[0] == 0.0
    assert amid[1] == kept.position + kept.start_position
    assert (slacks(container, (0.0, 1.4), kept, 1.4, 0.0, links) == amid[1]).all()
    assert (slacks(container, None, kept, 0.7, 0.0, links) == amid[1]).all()


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
