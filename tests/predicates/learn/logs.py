"""Synthetic logs with force: a drawer or door with a latch, pushed to open, or plain."""

from dataclasses import dataclass, replace

import numpy as np

from predicates.learn import Track
from tests.predicates.learn.observed import Array, door, drawer, seen

FORCE_NOISE = 2.0
"""[N] Standard deviation of each component of the observed force."""


@dataclass(frozen=True)
class Truth:
    """What was put into a log: forces [N], ways [m]."""

    kind: str
    force: float = 0.0
    friction: float = 0.0
    depth: float = 0.0
    spring_out: float = 0.0


def log(kind: str, seed: int) -> tuple[Track, Truth]:
    """A log of that kind, its figures drawn by the seed."""
    draw = np.random.default_rng(1000 + seed)
    rate, friction = draw.uniform(50, 100), draw.uniform(2, 8)
    if kind == "push_to_open":
        way, force, truth = _pushed(draw, rate, friction)
    else:
        way, force, truth = _pulled(draw, rate, friction, kind)
    return _seen(way, force, seed, rate), truth


def _pushed(draw: np.random.Generator, rate: float, friction: float) -> tuple[Array, Array, Truth]:
    depth, push, out = draw.uniform(0.004, 0.010), draw.uniform(10, 30), draw.uniform(0.02, 0.06)
    still, press = (
        np.zeros(int(0.5 * rate)),
        np.sin(np.linspace(0, np.pi, int(draw.uniform(0.5, 1.0) * rate))),
    )
    springs = out * (1 - np.exp(-np.linspace(0, 6, int(0.4 * rate))))
    waits = np.full(int(0.4 * rate), out)
    pulls = out + (0.4 - out) * _smoothly(int(2 * rate))
    way = np.concatenate([still, -depth * press, springs, waits, pulls])
    force = np.concatenate([still, -push * press, 0 * springs, 0 * waits, np.full(len(pulls), friction)])
    return way, force, Truth("push_to_open", push, friction, depth, out)


def _pulled(draw: np.random.Generator, rate: float, friction: float, kind: str) -> tuple[Array, Array, Truth]:
    top = friction + draw.uniform(8, 35) if kind == "latch" else friction
    give = draw.uniform(0.0, 0.003) if kind == "latch" else 0.0
    still, rise = np.zeros(int(0.5 * rate)), np.linspace(0, 1, int(draw.uniform(0.3, 0.8) * rate))
    moves = _smoothly(int(2.5 * rate))
    way = np.concatenate([still, give * rise, give + (0.4 - give) * moves])
    force = np.concatenate([still, top * rise, np.full(len(moves), friction)])
    return way, force, Truth(kind, top, friction)


def _smoothly(samples: int) -> Array:
    return (1 - np.cos(np.linspace(0, np.pi, samples))) / 2


def _seen(way: Array, force: Array, seed: int, rate: float) -> Track:
    """The log with noise: even seeds are drawers, odd ones doors of 0.4 m."""
    noise = np.random.default_rng(seed).normal(0, FORCE_NOISE, (len(way), 3))
    if seed % 2 == 0:
        points, tangents = drawer(way), np.tile([0.6, -0.8, 0.0], (len(way), 1))
    else:
        angle = way / 0.4
        points = door(angle, 0.4)
        tangents = np.column_stack([-np.sin(angle), np.cos(angle), np.zeros(len(way))])
    track = seen(points, seed)
    return replace(track, forces=force[:, None] * tangents + noise, times=np.arange(len(way)) / rate)
