"""Random tracks with their truth: short arcs, large radii, noise, slips, outliers, rest, flipped signs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from predicates.learn import Track

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Seen:
    """A track, what moved in it, and by how much [m]."""

    track: Track
    joint_type: str
    way: float


def draw(number: int) -> Seen:
    """The track of that number."""
    rng = np.random.default_rng(number)
    kind = str(rng.choice(["fixed", "prismatic", "revolute"], p=[0.15, 0.4, 0.45]))
    shares = _shares(rng, int(rng.choice([20, 60, 200, 500])))
    points, turns = _moved(rng, kind, shares)
    way = float(np.linalg.norm(np.ptp(points, axis=0)))
    about = Rotation.from_euler("z", rng.uniform(0, 6.28)) * Rotation.from_rotvec(rng.normal(0, 0.009, 3))
    points, turns = about.apply(points) + rng.uniform(-2, 2, 3), about.apply(turns)
    count = len(points)
    points += rng.normal(0, rng.choice([0.0002, 0.001, 0.002, 0.004]), points.shape)
    if rng.random() < 0.3:  # a hand that slips
        points += np.outer(np.sin(np.linspace(0, rng.uniform(1, 6), count)), rng.normal(0, 0.002, 3))
    wrong = rng.random(count) < rng.choice([0.0, 0.0, 0.1, 0.3])
    points[wrong] += rng.uniform(-0.15, 0.15, (int(wrong.sum()), 3))
    orientations = _turned(rng, turns) if rng.random() < 0.4 else None
    times = np.cumsum(rng.uniform(0.005, 0.1, count))
    return Seen(Track(points, times, True, orientations, name=f"track {number}"), kind, way)


def _shares(rng: np.random.Generator, count: int) -> Array:
    """Of the way, at each sample."""
    still = count // 3
    shapes = {
        "steady": np.linspace(0, 1, count),
        "rests": np.concatenate([np.zeros(still), np.linspace(0, 1, count - 2 * still), np.ones(still)]),
        "smooth": (1 - np.cos(np.linspace(0, np.pi, count))) / 2,
        "back": np.sin(np.linspace(0, np.pi, count)),
    }
    return shapes[str(rng.choice(list(shapes)))]


def _moved(rng: np.random.Generator, kind: str, shares: Array) -> tuple[Array, Array]:
    """Points and rotation vectors about the first sample, the axis upright or level."""
    still = np.zeros_like(shares)
    if kind != "revolute":
        length = rng.uniform(0.05, 0.6) if kind == "prismatic" else 0.0
        return np.column_stack([length * shares, still, still]), np.column_stack([still, still, still])
    radius, angle = np.exp(rng.normal(np.log(0.45), 0.5)), rng.uniform(0.1, 1.8) * shares
    points = np.column_stack([radius * np.cos(angle) - radius, radius * np.sin(angle), still])
    turns = np.column_stack([still, still, angle])
    if rng.random() < 0.6:
        return points, turns
    level = Rotation.from_euler("x", 90, degrees=True)
    return level.apply(Rotation.from_euler("z", rng.uniform(0, 6.28)).apply(points)), level.apply(turns)


def _turned(rng: np.random.Generator, turns: Array) -> Array:
    """Unit quaternions of any sign, seen with noise, of a body that begins in any orientation."""
    noise = np.radians(rng.choice([0.5, 2])) * rng.normal(0, 1, turns.shape)
    begun = Rotation.random(random_state=int(rng.integers(1e9)))
    seen = (Rotation.from_rotvec(noise) * Rotation.from_rotvec(turns) * begun).as_quat()
    return seen * rng.choice([-1, 1], (len(turns), 1))
