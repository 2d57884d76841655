"""How far a gripper is from each joint at most: no posture has it farther; lengths that add up say more."""

from pathlib import Path

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.arm import Arm, make_arm
from services.embodiment.proof_check.geometry.interval import apply, exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Link, Placement
from services.embodiment.proof_check.places import at_value, wrist_of
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove.arrays import loosely
from tests.services.embodiment.gantry import FOLDER

POSTURES = 2_000
CHAINS = 40
NEAR = 1e-6  # [m] boxes are some 0.1 µm wider than what a reach is of, and axes not quite of length 1


def farthest(arm: Arm, q: np.ndarray) -> np.ndarray:
    """Largest distance from each joint to a corner of the grasp box in these postures [m], shape (n,)."""
    origins, _, tool = arm.chain.frames(q)
    signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    corners = [apply(tool.rotation, exact(arm.middle + sign * arm.half)) + tool.translation for sign in signs]
    gaps = [np.linalg.norm(one.lo[:, None] - origins.lo, axis=2) for one in corners]
    return np.max(gaps, axis=(0, 1))


def arms(robot: str) -> list[Arm]:
    """Of each gripper, with a fixed and with a free base."""
    twin = load_twin("b", [robot])
    door = twin.container("iai_fridge_door")
    about = twin, twin.robots[0], door
    each = [Statement(*about, drive, (0.0, 0.0, 0.0), Tolerances()) for drive in (Drive.FIXED, Drive.OMNI)]
    found = [one.arm(gripper) for one in each for gripper in one.grippers]
    return [one for one in found if one is not None]


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_no_posture_reaches_farther(robot: str) -> None:
    rng = np.random.default_rng(0)
    for arm in arms(robot):
        for one in (arm, wrist_of(arm)):
            q = rng.uniform(*one.chain.ranges(), (POSTURES, len(one.chain.links)))
            assert (farthest(one, q) <= one.reach + NEAR).all()


def test_no_random_chain_reaches_farther_than_is_said() -> None:
    """Hinges and slides anyhow, limits anyhow."""
    rng = np.random.default_rng(1)
    for _ in range(CHAINS):
        links = []
        for k in range(int(rng.integers(1, 7))):
            axis = rng.normal(size=3)
            turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
            low, span = rng.uniform(-2, 1), rng.uniform(0.1, 3)
            place = Placement(exact(turn * np.sign(np.linalg.det(turn))), exact(rng.normal(size=3)))
            hinge = bool(rng.integers(2))
            links.append(Link(f"j{k}", place, axis / np.linalg.norm(axis), hinge, low, low + span))
        end = Placement(HERE.rotation, exact(rng.normal(size=3)))
        corners = np.array(np.meshgrid(*rng.normal(size=(3, 2)))).reshape(3, -1).T
        arm = make_arm("any", Chain(tuple(links), end), corners, 0)
        low, high = arm.chain.ranges()
        q = rng.uniform(low, high, (POSTURES, len(low)))
        assert (farthest(arm, q) <= arm.reach + NEAR).all()


def test_what_lies_along_a_hinge_stays_where_it_is() -> None:
    """A point 3 m along the axis and 0.1 m beside it, 1 m beside a joint: 3.26 m at most, not 4 m away."""
    axis = np.array([0.0, 0.0, 1.0])
    first = Link("first", HERE, axis, True, -1.0, 1.0)
    second = Link("second", Placement(HERE.rotation, exact([1.0, 0.0, 0.0])), axis, True, -3.0, 3.0)
    chain = Chain((first, second), Placement(HERE.rotation, exact([0.1, 0.0, 3.0])))
    arm = make_arm("any", chain, np.zeros((8, 3)), 0)
    assert arm.reach == pytest.approx([np.hypot(1, 3) + 0.1, np.hypot(0.1, 3)], abs=1e-9)
    assert farthest(arm, np.zeros((1, 2))) == pytest.approx([np.hypot(1.1, 3), np.hypot(0.1, 3)], abs=NEAR)


def test_lengths_that_add_up_are_longer() -> None:
    twin = load_twin("b", ["tiago_dual"])
    door = twin.container("iai_fridge_door")
    statement = Statement(twin, twin.robots[0], door, Drive.FIXED, (0.0, 0.0, 0.0), Tolerances())
    for gripper in statement.grippers:
        arm = statement.arm(gripper)
        assert arm is not None
        loose = loosely(arm, at_value(statement, arm, 0.0).target)[0]
        assert (loose >= arm.reach).all()
        shoulder = 4
        assert loose[shoulder] > arm.reach[shoulder] + 0.004


@pytest.mark.parametrize(("tilt", "upright"), [(0.0, True), (5e-7, False), (1e-3, False)])
def test_a_hinge_that_is_tilted_by_a_little_is_not_upright(
    tmp_path: Path, tilt: float, upright: bool
) -> None:
    # Heights beyond it are taken for known: to less than a micrometre in each metre.
    urdf = (FOLDER / "gantry.urdf").read_text()
    there = '<origin xyz="0.1 0 0"/><axis xyz="1 0 0"/>'
    assert there in urdf
    tilted = f'<origin xyz="0.1 0 0" rpy="{tilt} 0 0"/><axis xyz="0 0 1"/>'
    (tmp_path / "gantry.urdf").write_text(urdf.replace(there, tilted))
    (tmp_path / "gantry.ttl").write_text((FOLDER / "gantry.ttl").read_text())
    twin = load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])
    about = Statement(
        twin, twin.robots[0], twin.container("drawer_main"), Drive.OMNI, (0.0, 0.0, 0.0), Tolerances()
    )
    arm = about.arm(about.grippers[0])
    assert arm is not None
    assert (arm.upright == len(arm.chain.links)) == upright
