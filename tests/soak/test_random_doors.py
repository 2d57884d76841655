"""1,000 random doors and drawers for each robot and base policy. `make soak`; SDT_DOORS asks for fewer."""

import os
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import pytest

from sdt_kg.annotation import Drive
from tests.soak.judge import POLICIES, ROBOTS, result, summary

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

FRONTS = int(os.environ.get("SDT_DOORS", "1000"))
BUDGET = float(os.environ.get("SDT_DOORS_BUDGET", "20"))  # [s] of search for one front
WORKERS = 2


@pytest.mark.parametrize("drive", POLICIES)
@pytest.mark.parametrize("robot", ROBOTS)
def test_no_random_front_is_both_certified_and_refuted(
    tmp_path: Path, robot: str, drive: Drive, capsys: pytest.CaptureFixture[str]
) -> None:
    ask = partial(result, tmp_path, robot=robot, drive=drive, budget=BUDGET, one_hold=True)
    with ProcessPoolExecutor(WORKERS) as pool:
        results = list(pool.map(ask, range(FRONTS)))
    with capsys.disabled():
        print(f"\n{summary(robot, drive, results)}")  # noqa: T201 - the figure is what is asked for
    assert len(results) == FRONTS
