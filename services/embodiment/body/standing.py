"""Compiled inner loops: where a robot whose joints stand still can be, among a kitchen that stands still."""

import math

import numpy as np

from services.embodiment.body.kernels import matmul
from services.kernel import kernel, subkernel
from services.physics.geometry.convex import ROOM, parted
from services.physics.geometry.packed import bounds_of

TOUCHES = -1.0
"""As a clearance: two shapes are nearer than their margin."""


@kernel
def extents(at_r, at_c, shapes, first, low, high):
    """Corners of boxes along the world's axes that hold shapes `first` and those after it, at their poses."""
    for n in range(at_r.shape[0]):
        s = first + n
        for i in range(3):
            reach = shapes[2][s]
            for k in range(3):
                reach += abs(at_r[n, i, k]) * shapes[1][s, k]
            low[n, i], high[n, i] = at_c[n, i] - reach, at_c[n, i] + reach


@subkernel
def _apart(low, high, s, bottom, top, e):
    """Distance of two boxes along the world's axes, squared."""
    squared = 0.0
    for i in range(3):
        gap = max(low[s, i] - top[e, i], bottom[e, i] - high[s, i], 0.0)
        squared += gap * gap
    return squared


@kernel
def turned(yaw, own, shapes, split, row, to):
    """Row `row` of `to` has the robot's shapes with its base at the origin, turned by so much [rad].

    `own` is (rotations, centres) of these shapes where it is not turned; `to` is (rotations, centres, low and
    high corners of their boxes along the world's axes), of the last two one more than there are shapes: the
    box of them all.
    """
    turn, count, c, s = np.empty((3, 3)), own[0].shape[0], math.cos(yaw), math.sin(yaw)
    turn[0, 0], turn[0, 1], turn[0, 2] = c, -s, 0.0
    turn[1, 0], turn[1, 1], turn[1, 2] = s, c, 0.0
    turn[2, 0], turn[2, 1], turn[2, 2] = 0.0, 0.0, 1.0
    at_r, at_c, low, high = to[0][row], to[1][row], to[2][row], to[3][row]
    for n in range(count):
        matmul(turn, own[0][n], at_r[n])
        for i in range(3):
            at_c[n, i] = turn[i, 0] * own[1][n, 0] + turn[i, 1] * own[1][n, 1] + turn[i, 2] * own[1][n, 2]
    extents(at_r, at_c, shapes, split, low, high)
    for i in range(3):
        low[count, i], high[count, i] = math.inf, -math.inf
        for n in range(count):
            low[count, i], high[count, i] = min(low[count, i], low[n, i]), max(high[count, i], high[n, i])


@subkernel
def _clearance(x, y, robot, row, there, some, shapes, margins, largest, most, room):
    """How much farther than their margins all shapes are apart at least, up to `most` [m]; or TOUCHES.

    `robot` is what `turned` writes to, and the base at x, y is turned as in its row; `there` are (rotations,
    centres) of the kitchen's shapes, with the corners of their boxes; of these `some`, (first, last + 1), are
    looked at. `margins` and `largest` are as in `contacts.contacts`. The pair that was nearest at the pose
    before is looked at first: it rules out most others.
    """
    at_c, low, high, work, nearest = room
    split, count, at_r = there[0].shape[0], robot[1].shape[1], robot[0][row]
    for n in range(count + 1):
        for i in range(3):
            by = x if i == 0 else (y if i == 1 else 0.0)
            low[n, i], high[n, i] = robot[2][row, n, i] + by, robot[3][row, n, i] + by
            if n < count:
                at_c[n, i] = robot[1][row, n, i] + by
    best, n, e = most, nearest[0], nearest[1]
    if some[0] <= e < some[1] and margins[n, e] >= 0.0:
        best = _beyond(n, e, best, split, (at_r, at_c), there, (low, high), shapes, margins[n, e], work)
        if best == TOUCHES:
            return TOUCHES
    for e in range(some[0], some[1]):
        far = best + largest
        if _apart(low, high, count, there[2], there[3], e) > far * far:
            continue
        for n in range(count):
            if margins[n, e] < 0.0:
                continue
            gap = _beyond(n, e, best, split, (at_r, at_c), there, (low, high), shapes, margins[n, e], work)
            if gap < best:
                best, nearest[0], nearest[1] = gap, n, e
            if best == TOUCHES:
                return TOUCHES
    return best


@subkernel(inline=True)
def _beyond(n, e, best, split, at, there, corners, shapes, margin, work):
    """How much farther than the margin shapes n and e are apart at least, up to `best` [m]; or TOUCHES."""
    far = best + margin
    if _apart(corners[0], corners[1], n, there[2], there[3], e) > far * far:
        return best
    gap = parted(shapes, split + n, e, at[0][n], at[1][n], there[0][e], there[1][e])
    if gap < far:
        gap, _ = bounds_of(
            shapes, split + n, e, at[0][n], at[1][n], there[0][e], there[1][e], far, margin, work
        )
    return TOUCHES if gap <= margin else min(best, gap - margin)


@subkernel(makes=True)
def _room(count):
    """What `_clearance` writes to."""
    corners = np.empty((count + 1, 3)), np.empty((count + 1, 3))
    return np.empty((count, 3)), *corners, np.zeros(ROOM), np.array([0, -1])


@kernel
def standing(places, rows, robot, there, some, shapes, margins, largest, free):
    """Whether robot and kitchen keep their margins, at places (K, 2) and turned as in rows, is in `free`."""
    room = _room(robot[1].shape[1])
    for k in range(places.shape[0]):
        where = places[k, 0], places[k, 1], robot, rows[k]
        free[k] = _clearance(*where, there, some, shapes, margins, largest, 0.0, room) != TOUCHES


@kernel
def driving(poses, own, robot, there, some, shapes, margins, largest, reach, most):
    """Whether they keep them at all base poses (K, 3); `reach` is of the farthest point from the axis [m].

    Poses to which the robot cannot have come nearer than it is clear are left out. The first row of `robot`
    is written to.
    """
    room, k, here = _room(own[0].shape[0]), 0, 0
    while k < poses.shape[0]:
        if k == 0 or poses[k, 2] != poses[here, 2]:
            turned(poses[k, 2], own, shapes, there[0].shape[0], 0, robot)
        where = poses[k, 0], poses[k, 1], robot, 0
        clear = _clearance(*where, there, some, shapes, margins, largest, most, room)
        if clear == TOUCHES:
            return False
        here = k
        while k < poses.shape[0] and (
            math.hypot(poses[k, 0] - poses[here, 0], poses[k, 1] - poses[here, 1])
            + reach * abs(poses[k, 2] - poses[here, 2])
            < clear
        ):
            k += 1
        k = max(k, here + 1)
    return True
