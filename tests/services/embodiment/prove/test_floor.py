"""The floor is solid for what certification keeps above it, and for nothing else."""

from pathlib import Path

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.iri import body_iri
from sdt_kg.twin import Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Placement
from services.embodiment.proof_check.inside.boxes import Core
from services.embodiment.proof_check.inside.cores import pierced
from services.embodiment.proof_check.inside.solids import FLOOR, Around
from services.embodiment.proof_check.statement import Statement
from services.physics.model import Scene
from tests.services.embodiment.prove.standing import up_to_its_stops
from tests.small import beside
from tests.soak.doors import draw, write

ROBOTS = ("pr2", "tiago_dual")
HALF = 0.05  # [m] of a box that is held near the floor
WIDE = 1e-4  # [rad or m] half of what a box of one posture is wide
POSTURES = 600


def asked(folder: Path, robot: str) -> tuple[Twin, Arm, Around]:
    """A front, an arm, and what stands around it."""
    twin = beside(write(draw(np.random.default_rng(21)), folder, "front"), robot)
    about = Statement(
        twin, twin.robots[0], twin.container("front_door"), Drive.FIXED, (0.0, 0.0, 0.0), Tolerances()
    )
    arm = about.arm(about.grippers[0])
    assert arm is not None
    kitchen = about.around(arm, 0.0)[0]
    assert kitchen.carrier == -1
    return twin, arm, kitchen


@pytest.mark.parametrize("robot", ROBOTS)
def test_what_certification_keeps_off_the_floor_is_what_the_floor_refutes(tmp_path: Path, robot: str) -> None:
    twin, arm, kitchen = asked(tmp_path, robot)
    scene = Scene(twin, twin.robots[0])
    pairs = scene.environment_pairs
    off = {scene.solids[one].body for one, other in pairs.tolist() if other == scene.floor}
    floor = kitchen.solids.bodies.index(FLOOR)
    kept = [body_iri(robot, core.body) in off for core in arm.cores]
    assert kitchen.keeps[:, floor].tolist() == kept
    assert any(kept)
    assert not all(kept), "the base stands on it"


@pytest.mark.parametrize(("above", "meets"), [(-1e-3, True), (-1e-5, True), (1e-5, False), (1e-3, False)])
def test_a_box_that_is_held_too_low_is_in_the_floor(tmp_path: Path, above: float, meets: bool) -> None:
    _, arm, kitchen = asked(tmp_path, "tiago_dual")
    base = float(arm.chain.links[0].before.translation.lo[2])
    core = Core("box", 2, Placement(HERE.rotation, exact([0.0, 0.0, HALF + above - base])), np.full(3, HALF))
    floor = kitchen.solids.bodies.index(FLOOR)
    alone = Around(-1, kitchen.solids, np.arange(len(kitchen.solids.bodies))[None] == floor)
    still = np.zeros((1, len(arm.chain.links)))
    assert (pierced((core,), 0, arm.chain, (alone,), (still, still)) > 0).all() == meets


@pytest.mark.parametrize("robot", ROBOTS)
def test_of_many_postures_those_with_a_core_below_the_floor_are_refuted_by_it(
    tmp_path: Path, robot: str
) -> None:
    _, arm, kitchen = asked(tmp_path, up_to_its_stops(tmp_path, robot))
    floor = np.array([body == FLOOR for body in kitchen.solids.bodies])
    alone = Around(-1, kitchen.solids, kitchen.keeps & floor)
    low, high = (np.array([getattr(one, end) for one in arm.chain.links]) for end in ("lower", "upper"))
    q = np.random.default_rng(5).uniform(low, high, (POSTURES, len(low)))
    ends = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
    refuted = below = 0
    for c, core in enumerate(arm.cores):
        if not alone.keeps[c].any():
            continue
        _, _, at = type(arm.chain)(arm.chain.links[: core.link + 1], core.middle).frames(
            q[:, : core.link + 1]
        )
        lowest = ((ends * core.half) @ at.rotation.lo[:, 2].T + at.translation.lo[:, 2]).min(axis=0)
        met = pierced(arm.cores, c, arm.chain, (alone,), (q, np.full_like(q, WIDE))) > 0
        assert not met[lowest > 0].any()
        refuted, below = refuted + int(met.sum()), below + int((lowest < -0.01).sum())
    assert refuted > 0.9 * below > 3
