"""Proofs of infeasibility: time to find, to verify, to see that there is none. No assertions on time."""

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.proof_check import check
from services.embodiment.prove import Prover

FAR, NEAR = (0.0, 0.0, -0.5), (0.4127, 0.3252, -0.3038)
DOOR, DRAWER = "iai_fridge_door", "sink_area_left_middle_drawer_main"
BOXES = 4000

pytestmark = pytest.mark.oracle


@pytest.fixture(scope="module")
def twin() -> Twin:
    return load_twin("b", ["pr2", "tiago_dual"])


def prover(twin: Twin, robot: int, container: str, start: tuple[float, float, float]) -> Prover:
    one = twin.container(container)
    return Prover(twin, twin.robots[robot], one, Drive.FIXED, start, np.array([0.0, one.open_from]))


def test_finding_a_proof(twin: Twin, benchmark: BenchmarkFixture) -> None:
    found = benchmark(lambda: prover(twin, 1, DOOR, FAR).prove(BOXES))
    assert found is not None
    benchmark.extra_info["boxes"] = found.boxes


def test_verifying_a_proof(twin: Twin, benchmark: BenchmarkFixture) -> None:
    found = prover(twin, 1, DOOR, FAR).prove(BOXES)
    assert found is not None
    content = found.artefact.content
    assert benchmark(lambda: check(twin, twin.robots[1], twin.container(DOOR), content)).holds
    benchmark.extra_info["bytes"] = len(content)


def test_seeing_that_there_is_no_proof(twin: Twin, benchmark: BenchmarkFixture) -> None:
    assert benchmark(lambda: prover(twin, 0, DRAWER, NEAR).prove(BOXES)) is None
