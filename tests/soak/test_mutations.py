"""10,000 mutations of good motions, a third of which let go at last or on the way. `make soak`."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from services.embodiment.certify import Certified
from tests.services.embodiment.dense import judged
from tests.services.embodiment.gantry import LETTING_GO, RESTS, TWICE
from tests.services.embodiment.mutations import Judge, mutations

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

COARSE = 0.004  # [m] of travel between looks
FINE = 1e-4  # [m] the same, for the dense check
SEEDS, EACH = range(100, 120), 500
DRAWN = 10  # of each seed


@pytest.mark.parametrize("seed", SEEDS)
def test_of_500_mutations_the_wrong_are_refused_the_right_certified_and_none_refuted(
    tmp_path: Path, seed: int
) -> None:
    judge, counts, odd, certified = Judge(tmp_path), Counter[str](), [], []
    for k, mutation in enumerate(mutations(seed, EACH, (RESTS, LETTING_GO, TWICE)[seed % 3])):
        truth = judged(mutation.world, mutation.motion, COARSE)
        holds = isinstance(judge(mutation), Certified)
        if holds:
            certified.append(mutation)
        counts["wrong" if truth.wrong else "right" if truth.right else "between"] += 1
        if (truth.wrong and holds) or (truth.right and not holds):
            odd.append((k, mutation.name, holds, truth.slack))
    assert not odd
    assert min(counts["wrong"], counts["right"]) > EACH / 10
    assert counts["between"] < EACH / 10
    for k in np.random.default_rng(seed).choice(len(certified), DRAWN, replace=False):
        truth = judged(certified[k].world, certified[k].motion, FINE)
        assert not truth.wrong, (certified[k].name, truth.slack)
