"""The examples that take longer: each runs, and says what its page promises."""

import asyncio
import runpy

import pytest

from tests.services.examples.test_examples import FOLDER, SLOWER, keeps_its_promise


@pytest.mark.oracle
@pytest.mark.slow
@pytest.mark.parametrize("name", SLOWER)
def test_an_example_that_takes_longer_says_what_it_promises(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    keeps_its_promise(name, capsys)


@pytest.mark.oracle
@pytest.mark.slow
def test_a_spoiled_motion_is_refused_repaired_by_its_diagnoses_and_certified() -> None:
    found = runpy.run_path(str(FOLDER / "12_verify_and_repair.py"))
    assert asyncio.run(found["main"]()) == ["not_certified", "not_certified", "not_certified", "certified"]
