"""Boxes inside the robot against what is solid around it: where both meet, no certificate can be.

Collision shapes contain the real ones, so that they meet proves nothing. The robot's annotation gives
*cores*, boxes that its bodies contain; the kitchen's boxes, cylinders and spheres are taken as they are
declared, meshes are not used. A core is solid for those that joints farther out carry, too. A point that
lies in a core, wherever the joints are in a box of positions, and in such a solid, refutes the box.

With the joints between both moved one after the other from the last one inwards, the point as the core
sees it moves along each axis of the core by no more than a `Swing` says.
"""

import numpy as np
from numpy.typing import NDArray

from services.embodiment.proof_check.geometry.interval import apply, exact
from services.embodiment.proof_check.geometry.mechanics import Chain, Placement, Swing
from services.embodiment.proof_check.inside.boxes import Core
from services.embodiment.proof_check.inside.solids import ROUNDING, Around, Solids

Array = NDArray[np.float64]
ROUNDS, MORE_ROUNDS = 12, 96
"""Of projections between a core and a solid, more where these show nothing; any point is checked."""
LEAP, NEARBY = 6, 1e-3
"""Projections after which the way that is left is taken at once; a step is no smaller share of it."""
NEARLY = 0.004  # [m] outside of the core
LESS = 3  # times that points are looked for where the core is smaller by as much as it moves at the last ones


def pierced(
    cores: tuple[Core, ...], c: int, chain: Chain, around: tuple[Around, ...], boxes: tuple[Array, Array]
) -> Array:
    """How deep a point of a solid lies in core c in all of each box of positions [m], shape (L,).

    A lower bound; not above 0 where no such point was found.

    Args:
        cores: Boxes inside bodies of the arm.
        c: Index of the one that is meant.
        chain: The arm.
        around: What is solid.
        boxes: Middles and half widths of the positions of the chain's joints, shapes (L, n).
    """
    depth = np.full(len(boxes[0]), -np.inf)
    for one in around:
        if one.keeps[c].any():
            seen = cores[c].seen_from(one.carrier, chain, boxes)
            depth = np.maximum(depth, _pierced(cores[c], *seen, one.solids, one.keeps[c]))
    return depth


def _pierced(core: Core, at: Placement, swing: Swing, solids: Solids, keeps: NDArray[np.bool_]) -> Array:
    """The same, of the solids in one frame, in which the core is there and is carried so."""
    moved = swing.whole(at, np.zeros(3))
    met = _near(at, core.half, solids) & keeps
    points, near = np.zeros((*met.shape, 3)), np.full(met.shape, -np.inf)
    where, those = np.nonzero(met)
    points[met], near[met] = _points(at.some(where), core.half, solids, those, moved[where, None], ROUNDS)
    depth, rows, best = np.full(len(met), -np.inf), np.flatnonzero(met.any(axis=1)), near.argmax(axis=1)
    depth[rows] = _depth(
        core, at.some(rows), swing.some(rows), solids, (points[rows, best[rows]], best[rows])
    )
    for s in np.flatnonzero(met.any(axis=0)):
        left = np.flatnonzero((depth <= 0) & met[:, s])
        less = np.minimum(moved[left], max(float(core.half.min()) - NEARLY, 0.0))[:, None]
        for _ in range(LESS):  # less deep where it moves less
            if not len(left):
                break
            there, which, still = at.some(left), np.full(len(left), s), swing.some(left)
            found, _ = _points(there, core.half, solids, which, less, MORE_ROUNDS)
            depth[left] = np.maximum(depth[left], _depth(core, there, still, solids, (found, which)))
            on = depth[left] <= 0
            left, less = left[on], still.seen(exact(found), there)[on]
    return depth


def _near(at: Placement, half: Array, solids: Solids) -> NDArray[np.bool_]:
    """Which solids may come as near as `NEARLY` to a core, shape (L, S): no face of one of them divides both.

    Where one does, no point can be found. In floats.
    """
    turn, other = at.rotation.middle[:, None], solids.at.rotation.middle[None]
    between = np.matmul(turn.swapaxes(-1, -2), other)
    way = (solids.at.translation.middle[None] - at.translation.middle[:, None])[..., None]
    own, its = (np.abs(np.matmul(one.swapaxes(-1, -2), way))[..., 0] for one in (turn, other))
    size = np.abs(between)
    own -= half + np.matmul(size, solids.half[None, :, :, None])[..., 0]
    its -= solids.half + np.matmul(half, size)
    return np.maximum(own.max(axis=-1), its.max(axis=-1)) < 2 * NEARLY  # √3 · NEARLY, across a corner


def _depth(
    core: Core, at: Placement, swing: Swing, solids: Solids, found: tuple[Array, NDArray[np.intp]]
) -> Array:
    """How deep points (L, 3) of solids (L,) stay in a core [m], shape (L,); −inf where one is of none."""
    point, which = found
    local = apply(solids.at.rotation[which].T, exact(point) - solids.at.translation[which])
    inside = (local.magnitude().hi + ROUNDING <= solids.half[which]).all(axis=1)
    seen = apply(at.rotation.T, exact(point) - at.translation).magnitude().hi
    deep = (core.half - seen - swing.seen(exact(point), at)).min(axis=1) - ROUNDING
    return np.where(inside, deep, -np.inf)


def _points(  # noqa: PLR0913, PLR0917  # where a box is, what it may meet, and how far it is looked
    at: Placement, half: Array, solids: Solids, which: NDArray[np.intp], moved: Array, rounds: int
) -> tuple[Array, Array]:
    """A point of a solid in each box (L, 3), and how deep it lies there (L,); to be checked.

    The solids are those of `which`, shape (L,); it is looked for where a box is smaller by `moved`, shape
    (L, 1) or (L, 3). In floats.
    """
    turn, place = at.rotation.middle, at.translation.middle
    other, there = solids.at.rotation.middle[which], solids.at.translation.middle[which]
    own = np.maximum(half - moved, 0.0)
    room = solids.half[which] * (1 - 1e-9) - 2 * ROUNDING
    # Seen from the solid, whose box is then along the axes.
    turn = np.matmul(other.swapaxes(1, 2), turn)
    place = np.matmul((place - there)[:, None], other)[:, 0]
    point, last = place, np.zeros(len(place))
    for n in range(rounds):
        before = point
        seen = np.matmul((point - place)[:, None], turn)[:, 0]
        point = np.matmul(turn, np.clip(seen, -own, own)[..., None])[..., 0] + place
        point = np.clip(point, -room, room)
        step = np.linalg.norm(point - before, axis=1)
        if (
            n % LEAP == LEAP - 1 and n + 1 < rounds
        ):  # between two faces each step is a share of the one before
            far = np.where(step < last, step / np.maximum(last - step, NEARBY * last + ROUNDING), 0.0)
            point = point + (point - before) * far[:, None]
        last = step
    seen = np.matmul((point - place)[:, None], turn)[:, 0]
    return np.matmul(other, point[..., None])[..., 0] + there, (half - np.abs(seen)).min(axis=1)
