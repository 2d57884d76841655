"""Postures led while the hand holds: each base along its own heading, where it does not move sideways."""

from pathlib import Path

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from services.embodiment.hold.following import Following
from services.embodiment.hold.holding import Searcher
from tests.services.embodiment.front import front

pytestmark = pytest.mark.oracle

FRONT, OPEN = 5, 1.45
"""A door that tips over; [rad]."""
STEP = 0.05  # [m, rad]


def searcher(folder: Path, drive: Drive) -> Searcher:
    one = front(folder, FRONT, "stretch", 61, last=OPEN)
    return Searcher(one.world, one.kit.limb, one.problem, one.fitter.demands[0], drive)


def postures(one: Searcher) -> np.ndarray:
    return np.clip(one.seeds(30, np.random.default_rng(0)), one.lower + STEP, one.upper - STEP)


def tools(one: Searcher, xs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    r, p = zip(*(one.limb.tool(x) for x in xs), strict=True)
    return np.stack(r), np.stack(p)


def test_a_differential_base_meets_its_target_straight_ahead_or_back(tmp_path: Path) -> None:
    one = searcher(tmp_path, Drive.DIFFERENTIAL)
    xs, follows = postures(one), Following(one)
    ahead = np.stack([np.cos(xs[:, 2]), np.sin(xs[:, 2])], axis=1)
    target_r, target_p = tools(one, xs)
    target_p[:, :2] += STEP * ahead
    moved = xs.copy()
    met = follows.met(moved, target_r, target_p)
    assert met.all()
    way = moved[:, :2] - xs[:, :2]
    np.testing.assert_allclose(way, (way * ahead).sum(axis=1, keepdims=True) * ahead, atol=1e-12)
    np.testing.assert_array_equal(moved[:, 2], xs[:, 2])
    np.testing.assert_allclose(tools(one, moved)[0], target_r, atol=1e-6)
    np.testing.assert_allclose(tools(one, moved)[1], target_p, atol=1e-6)


def test_beside_a_posture_a_differential_base_is_ahead_or_behind_and_an_omni_one_anywhere(
    tmp_path: Path,
) -> None:
    across = {}
    for drive in (Drive.DIFFERENTIAL, Drive.OMNI):
        one = searcher(tmp_path, drive)
        xs = postures(one)
        way = Following(one).beside(xs, np.full_like(xs, STEP))[:, :3] - xs[:, :3]
        across[drive] = np.abs(way[:, 0] * -np.sin(xs[:, 2]) + way[:, 1] * np.cos(xs[:, 2])).max()
        assert (way[:, 2] == 0.0).all() == (drive is Drive.DIFFERENTIAL)
    assert across[Drive.DIFFERENTIAL] < 1e-12
    assert across[Drive.OMNI] > STEP


def test_a_base_that_stands_stays(tmp_path: Path) -> None:
    one = searcher(tmp_path, Drive.FIXED)
    one.stand(np.zeros(3))
    xs = postures(one)
    xs[:, :3] = 0.0
    follows = Following(one)
    assert (follows.beside(xs, np.full_like(xs, STEP))[:, :3] == 0.0).all()
    target_r, target_p = tools(one, xs)
    follows.met(xs, target_r, target_p + np.array([0.0, 0.0, 0.01]))
    assert (xs[:, :3] == 0.0).all()
