"""A mutation that makes a motion wrong is refused, one that leaves it right certified (10,000 in soak)."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from services.embodiment.certify import Certified
from tests.services.embodiment.dense import World, judged
from tests.services.embodiment.gantry import LETTING_GO, RESTS, TWICE, opening
from tests.services.embodiment.mutations import Judge, mutations

pytestmark = pytest.mark.oracle

COARSE = 0.004  # [m] of travel between looks


MOTIONS = pytest.mark.parametrize("rests", [RESTS, LETTING_GO, TWICE], ids=["held", "let go", "twice"])


@MOTIONS
def test_other_code_finds_the_motion_right(rests: np.ndarray) -> None:
    assert judged(World(), opening(rests=rests), 0.001).right


@MOTIONS
def test_of_30_mutations_the_wrong_are_refused_and_the_right_certified(
    tmp_path: Path, rests: np.ndarray
) -> None:
    judge, counts, odd = Judge(tmp_path), Counter[str](), []
    for k, mutation in enumerate(mutations(7, 30, rests)):
        truth = judged(mutation.world, mutation.motion, COARSE)
        certified = isinstance(judge(mutation), Certified)
        counts["wrong" if truth.wrong else "right" if truth.right else "between"] += 1
        if (truth.wrong and certified) or (truth.right and not certified):
            odd.append((k, mutation.name, certified, truth.slack))
    assert not odd
    assert counts["wrong"] > 6
    assert counts["right"] > 6
