"""How far what an arm carries moves along a direction: no farther than is said, and less than lengths say."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Link, Placement, Swing
from services.embodiment.proof_check.target import Target

JOINTS = 6
BOXES = 40
INSIDE = 200  # positions that are tried in each box
SIZE = np.array([0.05, 0.1, 0.02])  # [m] half extents of what is carried


def chain(rng: np.random.Generator) -> tuple[Chain, np.ndarray]:
    """Hinges, and slides among them, of any direction; which are hinges."""
    turns = rng.random(JOINTS) < 0.7
    links = []
    for k in range(JOINTS):
        axis = rng.normal(size=3)
        turn = Rotation.from_rotvec(rng.uniform(-2, 2, 3)).as_matrix()
        before = Placement(exact(turn), exact(rng.uniform(-0.4, 0.4, 3)))
        links.append(Link(f"joint{k}", before, axis / np.linalg.norm(axis), bool(turns[k]), -3.0, 3.0))
    return Chain(tuple(links), Placement(HERE.rotation, exact(rng.uniform(-0.2, 0.2, 3)))), turns


def corners(at: Placement) -> np.ndarray:
    """Of the box that is carried, shape (L, 8, 3)."""
    ends = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T * SIZE
    return ends @ at.rotation.lo.swapaxes(1, 2) + at.translation.lo[:, None]


@pytest.mark.parametrize("width", [1e-3, 0.03, 0.3, 1.5])
@pytest.mark.parametrize("seed", range(3))
def test_nothing_that_is_carried_moves_farther_along_a_direction_than_is_said(
    width: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    arm, turns = chain(rng)
    middle, half = rng.uniform(-2, 2, (BOXES, JOINTS)), width * rng.random((BOXES, JOINTS))
    d = rng.normal(size=(BOXES, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True) * (1 + 1e-12)
    origins, axes, at = arm.frames(middle)
    most = Swing(origins, axes, half, turns).along(d, at, SIZE)
    for _ in range(INSIDE):
        _, _, moved = arm.frames(middle + half * rng.choice([-1.0, 1.0, rng.uniform(-1, 1)], half.shape))
        way = np.einsum("lci,li->lc", corners(moved) - corners(at), d)
        assert (np.abs(way).max(axis=1) <= most + 1e-9).all()


@pytest.mark.parametrize("width", [1e-3, 0.03, 0.3, 1.5])
def test_nothing_is_seen_to_move_farther_than_is_said(width: float) -> None:
    rng = np.random.default_rng(7)
    arm, turns = chain(rng)
    middle, half = rng.uniform(-2, 2, (BOXES, JOINTS)), width * rng.random((BOXES, JOINTS))
    origins, axes, at = arm.frames(middle)
    points = at.translation.lo + rng.uniform(-0.1, 0.1, (BOXES, 3))
    most = Swing(origins, axes, half, turns).seen(exact(points), at)
    first = np.einsum("lji,lj->li", at.rotation.lo, points - at.translation.lo)
    for _ in range(INSIDE):
        _, _, moved = arm.frames(middle + half * rng.choice([-1.0, 1.0, rng.uniform(-1, 1)], half.shape))
        seen = np.einsum("lji,lj->li", moved.rotation.lo, points - moved.translation.lo)
        assert (np.abs(seen - first) <= most + 1e-9).all()


def test_it_is_said_more_closely_than_by_the_lengths_of_the_arms() -> None:
    rng = np.random.default_rng(4)
    arm, turns = chain(rng)
    middle, half = rng.uniform(-2, 2, (BOXES, JOINTS)), np.full((BOXES, JOINTS), 0.01)
    d = np.tile([0.0, 0.0, 1 - 1e-12], (BOXES, 1))
    origins, axes, at = arm.frames(middle)
    most = Swing(origins, axes, half, turns).along(d, at, np.zeros(3))
    arms = np.linalg.norm(np.cross(axes.lo, at.translation.lo[:, None] - origins.lo), axis=2)
    lengths = (np.where(turns, arms, 1.0) * half).sum(axis=1)
    assert (most <= lengths * (1 + 1e-9)).all()
    assert most.mean() < 0.7 * lengths.mean()


@pytest.mark.parametrize(("height", "holds"), [(0.1001, True), (0.0999, False)])
def test_a_box_that_turns_about_the_direction_does_not_come_nearer(height: float, holds: bool) -> None:
    """A disc's worth of turning under a plate: 0.1 m between them, to within the half turn's own rounding."""
    axis = np.array([0.0, 0.0, 1.0])
    arm = Chain((Link("turn", HERE, axis, True, -3.0, 3.0),), HERE)
    origins, axes, at = arm.frames(np.zeros((1, 1)))
    still = Swing(origins, axes, np.full((1, 1), 1e-4), np.array([True]))
    plate = Placement(HERE.rotation, exact([0.0, 0.0, height + 0.01]))
    target = Target((plate,), np.array([[1.0, 1.0, 0.01]]), np.zeros(1))
    own = np.array([0.3, 0.3, 0.1])
    apart = target.apart(at, own, still, level=False)
    assert (apart > -1e-6).all() == holds
