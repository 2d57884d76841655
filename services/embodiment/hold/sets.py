"""Sets of grasps of a bar, as arrays: those that are listed, and any that somebody draws."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from services.embodiment.hold.grasp import TOUCH, Grasp
from services.embodiment.hold.handle import Bar

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

PITCHES = np.radians([0, -20, 20, -40, 40, -60, 60, -80, 80])  # [rad] about the bar
TILTS = np.radians([0, -25, 25, -50, 50])  # [rad] along the bar, the fingers still closing across it
FLIPS = np.array([1, -1])  # which way round a hand that is turned by half about its approach
PLACES = (0.0, 0.5, -0.5)  # [1] along the bar, as a share of what of it leaves the fingers on the bar
DEPTHS = (0.0, -0.008, 0.008, -0.016, 0.016)  # [m] the tool frame beyond the bar's middle, along the approach
WIDE_PITCHES = np.radians([0, -10, 10, -20, 20, -30, 30, -40, 40, -50, 50, -60, 60, -80, 80])
WIDE_TILTS = np.radians([0, -25, 25, -50, 50, -65, 65, -80, 80])
WIDE_DEPTHS = (0.0, -0.012, 0.012)  # [m]
"""The same of a set that is more than single paths have the time for."""
FREE_MOST = np.array([1.75, 1.57, 0.6, 1.0, 0.026])
"""[rad, rad, rad, 1, m] Pitch, tilt, roll about the approach, place and offset of any grasp, at most."""
ANY_MOST = np.array([np.pi, np.pi / 2, np.pi / 2, 1.0, 0.04])
"""The same of grasps of any part of a handle, turned anyhow."""
BEYOND = 0.02  # [m] that its tool may be beyond the end of the bar: half a finger's width, and more
FIRST_WIDE = 10_000  # number of the first grasp of that set
FINGER_HALF = 0.015  # [m] kept from the ends of a bar, half a finger's width


@dataclass(frozen=True, slots=True, eq=False)
class Grasps:
    """Many grasps, open: of most of them the hand alone tells that it has no room there.

    Attributes:
        rotations, translations: Tool poses in the frame of the bar's joint, shapes (N, 3, 3), (N, 3).
        numbers: Of each, shape (N,).
    """

    rotations: Array
    translations: Array
    numbers: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.numbers)

    def __iter__(self) -> Iterator[Grasp]:
        return map(Grasp, self.rotations, self.translations, self.numbers.tolist())

    def some(self, chosen: Indices | NDArray[np.bool_] | slice | list[int]) -> "Grasps":
        """Those of them."""
        return Grasps(self.rotations[chosen], self.translations[chosen], self.numbers[chosen])


def grasp_settings() -> str:
    """What the grasp set depends on, as text."""
    wide = (
        WIDE_PITCHES.tolist(),
        WIDE_TILTS.tolist(),
        WIDE_DEPTHS,
        FREE_MOST.tolist(),
        ANY_MOST.tolist(),
        BEYOND,
    )
    return repr((PITCHES.tolist(), TILTS.tolist(), PLACES, DEPTHS, wide, FINGER_HALF, TOUCH))


def grasp_set(bar: Bar, steep: bool = False) -> Grasps:
    """All grasps of a bar, straight ones first, or those that come from far above or below."""
    numbers, (pitch, tilt, flip, place, depth) = _choices(steep)
    turns = _turned_by(bar, PITCHES, TILTS)[pitch, tilt, flip]
    places = (_along(bar) * np.array(PLACES)[:, None])[place] + bar.centre
    return Grasps(turns, places + np.array(DEPTHS)[depth, None] * turns[:, :, 0], numbers)


def wide_set(bar: Bar) -> Grasps:
    """Grasps of a bar from more directions, also from beside it, nearly along the bar."""
    counts = (len(WIDE_PITCHES), len(WIDE_TILTS), len(FLIPS), len(PLACES), len(WIDE_DEPTHS))
    pitch, tilt, flip, place, depth = (each.ravel() for each in np.indices(counts))
    turns = _turned_by(bar, WIDE_PITCHES, WIDE_TILTS)[pitch, tilt, flip]
    places = (_along(bar) * np.array(PLACES)[:, None])[place] + bar.centre
    there = places + np.array(WIDE_DEPTHS)[depth, None] * turns[:, :, 0]
    return Grasps(turns, there, FIRST_WIDE + np.arange(len(turns)))


def free_grasps(
    bars: Sequence[Bar], genes: Array, flips: NDArray[np.int64], numbers: NDArray[np.int64]
) -> Grasps:
    """Grasps, each of one of the bars, with any pitch, tilt, roll, place and offset from it, shape (N, 5).

    The tool is off the bar along the approach as it is before the tilt: so it may lie beside the hand too.
    """
    pitch, tilt, roll, place, offset = genes.T
    along, outward, centre = (
        np.array([getattr(one, name) for one in bars]).reshape(-1, 3)
        for name in ("along", "outward", "centre")
    )
    turns = _turns((along, outward), pitch, tilt, flips)
    approach = turns[:, :, 0]
    rolled = np.stack([approach, *(_about(approach, roll, turns[:, :, k]) for k in (1, 2))], axis=2)
    reach = np.array([one.length / 2 + BEYOND for one in bars])
    straight = _about(along, pitch, -outward)
    at = centre + (place * reach)[:, None] * along + offset[:, None] * straight
    return Grasps(rolled, at, numbers)


@lru_cache(maxsize=2)
def _choices(steep: bool) -> tuple[NDArray[np.int64], Indices]:
    """Numbers (N,), and indices of pitch, tilt, flip, place and depth (5, N).

    The straightest has the first number.
    """
    counts = range(len(PITCHES)), range(len(TILTS)), (1, -1), range(len(PLACES)), range(len(DEPTHS))
    straight = sorted(
        itertools.product(*counts),
        key=lambda choice: (choice[0] + choice[1] * 2 + choice[3] + choice[4], choice),
    )
    numbered = [*enumerate(straight)]
    if steep:
        numbered.sort(key=lambda one: (one[1][3] + one[1][4], one[1][1], -one[1][0], one[0]))
    numbers, choices = zip(*numbered, strict=True)
    columns = np.array(choices).T
    columns[2] = columns[2] < 0
    return np.array(numbers), columns


@lru_cache(maxsize=1)
def _steep_ranks() -> dict[int, int]:
    return {number: rank for rank, number in enumerate(_choices(steep=True)[0].tolist())}


def steepness(index: int) -> int:
    """Where the grasp of this number comes among those that come from far above or below first."""
    return _steep_ranks()[index]


def _along(bar: Bar) -> Array:
    """From the bar's middle to the last place for the fingers' middle."""
    return max(bar.length / 2 - FINGER_HALF, 0.0) * bar.along


def _turned_by(bar: Bar, pitches: Array, tilts: Array) -> Array:
    """Rotations for each pitch, tilt and flip, shape (pitches, tilts, 2, 3, 3)."""
    every = np.meshgrid(pitches, tilts, FLIPS, indexing="ij")
    turns = _turns((bar.along, bar.outward), *(each.ravel() for each in every))
    return turns.reshape(*every[0].shape, 3, 3)


def _turns(bar: tuple[Array, Array], pitch: Array, tilt: Array, flip: NDArray) -> Array:
    """Rotations of the tool in the frame of the bar's joint, shape (N, 3, 3).

    `bar` is its directions along and outward, of one bar or of one for each.
    """
    along, outward = bar
    approach = _about(along, pitch, -outward)
    closing = flip[:, None] * _cross(along, approach)
    approach = _about(closing, tilt, approach)
    return np.stack([approach, closing, _cross(approach, closing)], axis=2)


def _about(axis: Array, angle: Array, vector: Array) -> Array:
    """Vectors turned by angles (N,) about unit axes, of which there may be one or N, shape (N, 3).

    Rodrigues' formula.
    """
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    on = (axis * vector).sum(axis=-1, keepdims=True)
    return c * vector + s * _cross(axis, vector) + (1 - c) * on * axis


def _cross(one: Array, other: Array) -> Array:
    """Cross products of vectors, of which there may be one or N: numpy spends most of its time on axes."""
    (a, b, c), (x, y, z) = one.T, other.T
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=-1)
