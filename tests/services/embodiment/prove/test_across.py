"""Where a core reaches across a panel it is in contact, wherever the joints are; a check finds that out."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.twin import Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check import check
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.check import leaves_of_one
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import Placement
from services.embodiment.proof_check.inside.across import reaches_across
from services.embodiment.proof_check.inside.cores import pierced
from services.embodiment.proof_check.inside.solids import Around, Solids
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove.prover import Proved, Prover
from tests.services.embodiment.prove.test_cores import HERE, front, postures, statement, touching
from tests.soak.doors import draw

Array = NDArray[np.float64]

AROUND_IT = 601
"""A front whose open door the PR2 would have to reach round, or through the wall."""
AJAR = 0.9  # [rad] its door there
BOXES = 5_000
ROBOTS = {"pr2": 160, "tiago_dual": 400}
"""By middles of boxes of joint positions: those of more cores take longer, and are met more often."""
WIDTHS = (0.0, 0.02, 0.1)  # [rad or m]
STANDS = 1e-3  # the same, of a base


def found(about: Statement, arm: Arm, middle: Array, half: Array) -> Iterator[tuple[Array, Array]]:
    """Of each core: in which boxes it reaches across something, and in which a point of it stays in that."""
    around = about.around(arm, AJAR)
    for c in range(len(arm.cores)):
        of = arm.cores, c, arm.chain, around, (middle, half)
        yield reaches_across(*of), pierced(*of) > 0


@pytest.mark.parametrize(("robot", "middles"), ROBOTS.items())
def test_all_postures_of_a_box_in_which_a_core_reaches_across_are_in_contact(
    tmp_path: Path, robot: str, middles: int
) -> None:
    twin = front(tmp_path, robot, draw(np.random.default_rng(AROUND_IT)))
    about, rng = statement(twin), np.random.default_rng(3)
    arm = about.arm(about.grippers[0])
    assert arm is not None
    middle = postures(arm, rng, middles)
    for width in WIDTHS:
        half = np.full_like(middle, width)
        half[:, :3] = np.minimum(half[:, :3], STANDS)
        across, inside = (np.any(each, axis=0) for each in zip(*found(about, arm, middle, half), strict=True))
        assert across.sum() >= 10
        if width == WIDTHS[-1]:
            assert across.sum() > 2 * inside.sum(), "a panel is too thin for a point to stay in it"
        some = np.flatnonzero(across)[:30]
        postures_there = [middle[k] + half[k] * rng.uniform(-1, 1, (10, middle.shape[1])) for k in some]
        assert touching(twin, about, arm, np.concatenate(postures_there), AJAR).all()


@pytest.fixture(scope="module")
def lost(tmp_path_factory: pytest.TempPathFactory) -> tuple[Twin, Proved]:
    twin = front(tmp_path_factory.mktemp("front"), "pr2", draw(np.random.default_rng(AROUND_IT)))
    door = twin.container("front_door")
    values = np.array([0.0, door.open_from])
    proved = Prover(twin, twin.robots[0], door, Drive.FIXED, HERE, values).prove(BOXES)
    assert proved is not None
    return twin, proved


def test_a_door_that_no_arm_gets_round_is_refuted(lost: tuple[Twin, Proved]) -> None:
    twin, proved = lost
    asked = twin, twin.robots[0], twin.container("front_door")
    assert check(*asked, proved.artefact.content).holds
    assert proved.diagnosis.proof
    assert "upper_arm_link" in proved.diagnosis.reason
    assert proved.boxes < BOXES


def test_a_leaf_that_names_another_core_does_not_hold(lost: tuple[Twin, Proved]) -> None:
    twin, proved = lost
    proof = read_proof(proved.artefact.content)
    asked = twin, twin.robots[0], twin.container("front_door"), Drive.FIXED, HERE, Tolerances()
    about = Statement(*asked, span=proof.claim.span)
    for one in proof.refutations:
        cores = LEAF + len(one.joints) + 1
        where = next(i for i, node in enumerate(one.tree) if node >= cores)
        base = one.tree[:where] + bytes([cores]) + one.tree[where + 1 :]
        (arm,) = (about.arm(gripper) for gripper in about.grippers if gripper.name == one.gripper)
        assert arm is not None
        with pytest.raises(InputError, match="base_link can be clear of everything solid"):
            leaves_of_one(about, arm, replace(one, tree=base))


@pytest.fixture
def arm(tmp_path: Path) -> Arm:
    """The PR2's left one, of which the forearm reaches some 0.2 m across what is looked at."""
    about = statement(front(tmp_path, "pr2"))
    found = about.arm(about.grippers[0])
    assert found is not None
    return found


FAR = 0.5  # [m] from the middle of a core to the rim of a plate
THIN = 1e-3  # [m] half of its thickness


@pytest.mark.parametrize(
    ("off", "half", "across"),
    [
        ((0.0, 0.0, 0.0), (THIN, FAR, FAR), True),  # through its middle
        ((0.0, FAR - 0.002, 0.0), (THIN, FAR, FAR), True),  # 2 mm inside of its rim
        ((0.0, FAR + 0.06, 0.0), (THIN, FAR, FAR), False),  # beyond that
        ((0.2, 0.0, 0.0), (THIN, FAR, FAR), False),  # before it
        ((0.0, 0.0, 0.0), (5e-8, FAR, FAR), False),  # too thin for what is known of it
    ],
)
def test_what_a_plate_is_crossed_by(
    arm: Arm, off: tuple[float, ...], half: tuple[float, ...], across: bool
) -> None:
    """A plate across the longest way of a forearm's core, moved against it, with all joints still."""
    c = next(k for k, core in enumerate(arm.cores) if core.body == "l_forearm_link")
    core, q = arm.cores[c], np.array([[(link.lower + link.upper) / 2 for link in arm.chain.links]])
    assert core.half.argmax() == 0
    assert core.half[1] < 0.05
    links = type(arm.chain)(arm.chain.links[: core.link + 1], core.middle)
    _, _, at = links.frames(q)
    turn, place = ((one.lo + one.hi)[0] / 2 for one in (at.rotation, at.translation))
    plate = Placement(exact(turn[None]), exact((place + turn @ np.array(off))[None]))
    keeps = np.ones((len(arm.cores), 1), dtype=np.bool_)
    around = (Around(-1, Solids(("plate",), plate, np.array([half])), keeps),)
    boxes = q, np.zeros_like(q)
    assert reaches_across(arm.cores, c, arm.chain, around, boxes).tolist() == [across]
