"""Compiled inner loops: where a robot whose joints stand still can be, among a kitchen that stands still."""

import math

import numpy as np

from services.embodiment.body.kernels import matmul
from services.kernel import kernel, subkernel
from services.physics.geometry.convex import parted
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


@subkernel
def _clearance(pose, own, there, some, shapes, margins, largest, most, room):
    """How much farther than their margins all shapes are apart at least, up to `most` [m]; or TOUCHES.

    `own` is (rotations, centres) of the robot's shapes where its base is at the origin, `there` the same
    of the kitchen's with the corners of their boxes; of these `some`, (first, last + 1), are looked at.
    `margins` and `largest` are as in `contacts.contacts`. The pair that was nearest at the pose before is
    looked at first: it rules out most others.
    """
    at_r, at_c, low, high, turn, work, nearest = room
    split, count = there[0].shape[0], own[0].shape[0]
    turn[0, 0], turn[0, 1], turn[1, 0], turn[1, 1] = (
        math.cos(pose[2]),
        -math.sin(pose[2]),
        math.sin(pose[2]),
        math.cos(pose[2]),
    )
    for n in range(count):
        matmul(turn, own[0][n], at_r[n])
        for i in range(2):
            at_c[n, i] = pose[i] + turn[i, 0] * own[1][n, 0] + turn[i, 1] * own[1][n, 1]
        at_c[n, 2] = own[1][n, 2]
    extents(at_r, at_c, shapes, split, low, high)
    best, n, e = most, nearest[0], nearest[1]
    if some[0] <= e < some[1] and margins[n, e] >= 0.0:
        best = _beyond(n, e, best, split, (at_r, at_c), there, (low, high), shapes, margins[n, e], work)
        if best == TOUCHES:
            return TOUCHES
    for i in range(3):
        low[count, i], high[count, i] = low[:count, i].min(), high[:count, i].max()
    for e in range(some[0], some[1]):
        far = best + largest
        if _apart(low, high, count, there[2], there[3], e) >= far * far:
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


@subkernel
def _beyond(n, e, best, split, at, there, corners, shapes, margin, work):
    """How much farther than the margin shapes n and e are apart at least, up to `best` [m]; or TOUCHES."""
    far = best + margin
    if _apart(corners[0], corners[1], n, there[2], there[3], e) >= far * far:
        return best
    gap = parted(shapes, split + n, e, at[0][n], at[1][n], there[0][e], there[1][e])
    if gap < far:
        gap, _ = bounds_of(
            shapes, split + n, e, at[0][n], at[1][n], there[0][e], there[1][e], far, margin, work
        )
    return TOUCHES if gap <= margin else min(best, gap - margin)


@subkernel
def _room(count):
    """What `_clearance` writes to."""
    shapes, nearest = (np.empty((count, 3, 3)), np.empty((count, 3))), np.array([0, -1])
    return (*shapes, np.empty((count + 1, 3)), np.empty((count + 1, 3)), np.eye(3), np.zeros((8, 4)), nearest)


@kernel
def standing(poses, own, there, some, shapes, margins, largest, free):
    """Whether robot and kitchen keep their margins at each base pose (K, 3) is in `free` (K,)."""
    room = _room(own[0].shape[0])
    for k in range(poses.shape[0]):
        free[k] = _clearance(poses[k], own, there, some, shapes, margins, largest, 0.0, room) != TOUCHES


@kernel
def driving(poses, own, there, some, shapes, margins, largest, reach, most):
    """Whether they keep them at all base poses; `reach` is of the farthest point from the base's axis [m].

    Poses to which the robot cannot have come nearer than it is clear are left out.
    """
    room, k = _room(own[0].shape[0]), 0
    while k < poses.shape[0]:
        clear = _clearance(poses[k], own, there, some, shapes, margins, largest, most, room)
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
