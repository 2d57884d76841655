"""Which boxes of a kitchen the search for a proof compares with which cores: all to which these can come."""

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove.arrays import inner

pytestmark = pytest.mark.oracle

STANDS = (1.156666792, 2.620160164, -0.632993932)
LOOKS = 300


def test_a_core_is_far_from_what_it_is_not_compared_with() -> None:
    twin = load_twin("a", ["tiago_dual"])
    drawer = twin.container("cabinet5_drawer_top")
    statement = Statement(twin, twin.robots[0], drawer, Drive.FIXED, STANDS, Tolerances())
    arm = statement.arm(statement.grippers[0])
    assert arm is not None
    kitchen, *others = statement.around(arm, 0.1)
    _, (_, places, _, carrier), keeps = inner(arm, (kitchen, *others))
    still = carrier < 0
    assert not still.all(), "the robot's own are there"
    assert 0 < keeps[:, still].sum() < len(arm.cores) * len(kitchen.solids.half) / 5

    rng, (low, high) = np.random.default_rng(1), arm.chain.ranges()
    origins = arm.chain.frames(rng.uniform(low, high, (LOOKS, len(low))))[0].middle
    where, turns = kitchen.solids.at.translation.middle, kitchen.solids.at.rotation.middle
    left_out = ~(where[:, None] == places[still]).all(axis=2).any(axis=1)
    assert left_out.any()
    for core in arm.cores:
        own = np.linalg.norm(core.middle.translation.middle) + np.linalg.norm(core.half)
        local = np.einsum("lsi,sij->lsj", origins[:, core.link, None] - where[left_out], turns[left_out])
        gap = np.linalg.norm(np.maximum(np.abs(local) - kitchen.solids.half[left_out], 0.0), axis=2)
        assert (gap > own).all(), "no posture brings it there"
