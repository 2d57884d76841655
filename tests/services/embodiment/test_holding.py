"""Holdings of single paths: what a batch of seeds is asked for."""

from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from services.embodiment.hold.holding import SEEDS, Searcher
from tests.services.embodiment.front import front

pytestmark = pytest.mark.oracle

FRONT = 0
"""A front that is opened with the first posture that touches nothing."""
MIDDLE = 30  # waypoint


def test_of_a_batch_no_more_seeds_are_solved_than_lead_to_the_holdings_that_are_taken(tmp_path: Path) -> None:
    one = front(tmp_path, FRONT, "pr2", 61)
    searcher = Searcher(one.world, one.kit.limb, one.problem, one.fitter.demands[0], Drive.OMNI)
    batch = searcher.batch([*islice(one.fitter.fitting(), 6)], MIDDLE, np.random.default_rng(0))
    found = next(batch)
    assert found.xs.shape == (61, len(one.kit.limb.lower))
    assert 0 < searcher.tally.seeds < SEEDS
    assert [*batch]
    assert searcher.tally.seeds == SEEDS
