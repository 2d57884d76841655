"""Compiled inner loops: contacts of a scene's shapes along many configurations.

A pair that is far apart at one configuration is not looked at again before the two shapes have come
far enough to meet.
"""

import math

import numpy as np

from services.embodiment.body.kernels import (
    carried,
    copied,
    forward,
    joint_pose,
    matmul,
    moved,
    place_boxes,
    seen_from,
)
from services.kernel import kernel, subkernel
from services.physics.geometry.convex import ROOM, parted
from services.physics.geometry.packed import bounds_of


@subkernel(inline=True)
def parting(shapes, a, b, ra, ca, rb, cb, margin, work):
    """What the distance of two shapes is not below [m]; above the margin unless they are as near as that."""
    low = parted(shapes, a, b, ra, ca, rb, cb)
    if low > margin:
        return low
    return bounds_of(shapes, a, b, ra, ca, rb, cb, margin, margin, work)[0]


@subkernel
def clear(shapes, a, r, c, middle, reach):
    """Whether a ball about `middle` is beside the box of shape a, which is at (r, c)."""
    x, y, z, away = middle[0] - c[0], middle[1] - c[1], middle[2] - c[2], 0.0
    for i in range(3):
        gap = abs(r[0, i] * x + r[1, i] * y + r[2, i] * z) - shapes[1][a, i] - shapes[2][a]
        if gap > 0.0:
            away += gap * gap
    return away > reach * reach


@subkernel(makes=True)
def _way(size, moving, boxes, joints):
    """What `_tracked` writes to along so many configurations: what moves has a row in it, or −1."""
    carrier, count = boxes[0], 0
    rows = np.full(joints, -1, np.int64), np.full(carrier.shape[0], -1, np.int64)
    for n in range(moving.shape[0]):
        rows[0][moving[n]] = n
    for s in range(carrier.shape[0]):
        if carrier[s] > 0:
            rows[1][s] = count
            count += 1
    along = np.empty((size, moving.shape[0], 3, 3)), np.empty((size, count, 3))
    last = np.empty((joints, 3, 3)), np.empty((joints, 3, 3)), np.empty((count, 3))
    spare = np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.zeros(joints), np.zeros(joints)
    return rows, along, (np.zeros((size, count)), np.zeros((size, count))), last, spare


@subkernel
def _tracked(qs, stride, moving, tree, boxes, radius, base, frames, corners, way):
    """How many of qs were looked at, and in `way` and `corners` how everything moves along these.

    `moving`, `tree` and `boxes` are what `carried` gives, `base` is what carries the base. Along qs are the
    frames of joints that move, and centres of shapes that do; then the way that each shape has come [m]: that
    of its point which moves farthest, in the world and, for the robot's own pairs, as seen from the base.
    """
    joint, _, local_c = boxes
    (r, p), (low, high, _), (rows, (at_r, at_c), (far, own), last, spare) = frames, corners, way
    turn, now_r, now, turned, own_turned = spare
    row, size = rows[1], (qs.shape[0] + stride - 1) // stride
    for k in range(size):
        for n in range(moving.shape[0]):
            j = moving[n]
            joint_pose(j, qs[k * stride], tree, turn, now_r, r, p)
            turned[j] = _chord(last[0][j], r[j])
            copied(r[j], last[0][j])
            copied(r[j], at_r[k, n])
        for j in moving:
            if base > 0 and j != base:
                seen_from(r[base], p[base], r[j], p[j], now_r, now)
                own_turned[j] = _chord(last[1][j], now_r)
                copied(now_r, last[1][j])
        for s in range(joint.shape[0]):
            m, j = row[s], joint[s]
            if m < 0:
                continue
            moved(r[j], p[j], local_c[s], at_c[k, m])
            for i in range(3):
                at = at_c[k, m, i]
                low[s, i] = at - radius[s] if k == 0 else min(low[s, i], at - radius[s])
                high[s, i] = at + radius[s] if k == 0 else max(high[s, i], at + radius[s])
            if k > 0:
                far[k, m] = far[k - 1, m] + _shift(at_c[k - 1, m], at_c[k, m]) + radius[s] * turned[j]
            if base == 0:
                own[k, m] = far[k, m]
            elif j != base:
                x, y, z = at_c[k, m, 0] - p[base, 0], at_c[k, m, 1] - p[base, 1], at_c[k, m, 2] - p[base, 2]
                for i in range(3):  # baseᵀ · centre
                    now[i] = r[base, 0, i] * x + r[base, 1, i] * y + r[base, 2, i] * z
                if k > 0:
                    own[k, m] = own[k - 1, m] + _shift(last[2][m], now) + radius[s] * own_turned[j]
                for i in range(3):
                    last[2][m, i] = now[i]
    return size


@subkernel
def _shift(c, d):
    """How far one point is from another."""
    return math.sqrt((d[0] - c[0]) ** 2 + (d[1] - c[1]) ** 2 + (d[2] - c[2]) ** 2)


@subkernel
def _chord(r, s):
    """How far a point at 1 m from the axis of the turn between two rotations is moved by it."""
    squared = 0.0
    for i in range(3):
        for k in range(3):
            squared += (s[i, k] - r[i, k]) ** 2
    return math.sqrt(squared / 2)


@subkernel
def _turned(s, k, at_r, row, joint, local_r, out):
    """Rotation of shape s at configuration k is in `out`."""
    matmul(at_r[k, row[joint[s]]], local_r[s], out)


@subkernel(inline=True)
def walk(a, b, margin, size, shapes, radius, boxes, still, way, far, work):
    """First of so many configurations at which the pair is too near, or −1.

    From a configuration at which the pair is farther apart than the margin, those are left out in
    which the two cannot have come near enough. Shapes are turned only where their balls meet.
    """
    rows, (at_r, at_c), spare = way[0], way[1], way[4]
    i, j, near, k = rows[1][a], rows[1][b], radius[a] + radius[b], 0
    while k < size:
        x, y, z = still[1][a, 0], still[1][a, 1], still[1][a, 2]
        if i >= 0:
            x, y, z = at_c[k, i, 0], at_c[k, i, 1], at_c[k, i, 2]
        if j >= 0:
            x, y, z = x - at_c[k, j, 0], y - at_c[k, j, 1], z - at_c[k, j, 2]
        else:
            x, y, z = x - still[1][b, 0], y - still[1][b, 1], z - still[1][b, 2]
        apart = math.sqrt(x * x + y * y + z * z) - near
        if apart <= margin:
            ra, ca, rb, cb = still[0][a], still[1][a], still[0][b], still[1][b]
            if i >= 0:
                ra, ca = spare[0], at_c[k, i]
                _turned(a, k, at_r, rows[0], boxes[0], boxes[1], ra)
            if j >= 0:
                rb, cb = spare[1], at_c[k, j]
                _turned(b, k, at_r, rows[0], boxes[0], boxes[1], rb)
            apart = parting(shapes, a, b, ra, ca, rb, cb, margin, work)
            if apart <= margin:
                return k
        here = (far[k, i] if i >= 0 else 0.0) + (far[k, j] if j >= 0 else 0.0)
        k += 1
        while k < size and (
            (far[k, i] if i >= 0 else 0.0) + (far[k, j] if j >= 0 else 0.0) - here < apart - margin
        ):
            k += 1
    return -1


@subkernel
def boxed(shapes, carrier, still, low, high):
    """Corners of boxes along the world's axes that hold each shape that stands still."""
    size = shapes[1]
    for s in range(carrier.shape[0]):
        r, c = still[0][s], still[1][s]
        for i in range(3):
            if carrier[s] == 0:
                reach = (
                    abs(r[i, 0]) * size[s, 0] + abs(r[i, 1]) * size[s, 1] + abs(r[i, 2]) * size[s, 2]
                ) + shapes[2][s]
                low[s, i], high[s, i] = c[i] - reach, c[i] + reach


@subkernel
def beside(low, high, s, e, margin):
    """Whether the boxes of two shapes are farther apart than the margin along an axis of the world."""
    apart = low[s, 0] > high[e, 0] + margin or high[s, 0] < low[e, 0] - margin
    apart = apart or low[s, 1] > high[e, 1] + margin or high[s, 1] < low[e, 1] - margin
    return apart or low[s, 2] > high[e, 2] + margin or high[s, 2] < low[e, 2] - margin


@kernel
def contacts(qs, strides, tree, boxes, split, radius, shapes, base, own, margins, largest):
    """(configuration of a contact or −1, the two shapes) along qs (K, nq).

    Shapes before `split` are the kitchen's. margins[robot shape, kitchen shape] is the distance
    demanded, negative where the pair may touch, and `largest` the largest of them; `own` is (the robot's
    own pairs, their margins). Of many configurations those of each of `strides` are looked at first.
    """
    count, joints = boxes[0].shape[0], tree[0].shape[0]
    r, p = np.empty((joints, 3, 3)), np.empty((joints, 3))
    still = (np.empty((count, 3, 3)), np.empty((count, 3)))
    forward(qs[0], tree, r, p)
    place_boxes(r, p, boxes, still[0], still[1])
    carrier, many, moving, tree, boxes = carried(qs, tree, boxes, r, p, still)
    corners, work = (np.empty((count, 3)), np.empty((count, 3)), np.empty((2, 3))), np.zeros(ROOM)
    boxed(shapes, boxes[0], still, corners[0], corners[1])
    way = _way(qs.shape[0], moving[:many], boxes, joints)
    for stride in strides:
        if stride > 1 and stride >= qs.shape[0]:
            continue
        along = moving[:many], tree, boxes, radius, carrier[base], (r, p)
        size = _tracked(qs, stride, *along, corners, way)
        rest = size, shapes, radius, boxes, still, way
        k, one, other = _met(split, margins, largest, corners, work, *rest)
        if k < 0:
            k, one, other = _met_itself(own, work, *rest)
        if k >= 0:
            return k * stride, one, other
    return -1, -1, -1


@subkernel
def _met(split, margins, largest, corners, work, size, shapes, radius, boxes, still, way):
    """The first configuration found at which robot and kitchen are too near, and the two shapes; or −1."""
    low, high, (bottom, top) = corners[0], corners[1], (corners[2][0], corners[2][1])
    for i in range(3):
        bottom[i], top[i] = math.inf, -math.inf
    count = low.shape[0]
    for s in range(split, count):
        for i in range(3):
            bottom[i], top[i] = min(bottom[i], low[s, i]), max(top[i], high[s, i])
    for e in range(split):
        far = False
        for i in range(3):
            far = far or low[e, i] > top[i] + largest or high[e, i] < bottom[i] - largest
        if far:
            continue
        for s in range(split, count):
            margin = margins[s - split, e]
            if margin < 0.0 or beside(low, high, s, e, margin):
                continue
            k = walk(s, e, margin, size, shapes, radius, boxes, still, way, way[2][0], work)
            if k >= 0:
                return k, s, e
    return -1, -1, -1


@subkernel
def _met_itself(own, work, size, shapes, radius, boxes, still, way):
    """The same of the robot's own pairs."""
    row, centre, ways = way[0][1], still[1], way[2][1]
    for n in range(own[0].shape[0]):
        a, b = own[0][n, 0], own[0][n, 1]
        x, y, z = centre[a, 0] - centre[b, 0], centre[a, 1] - centre[b, 1], centre[a, 2] - centre[b, 2]
        near = radius[a] + radius[b] + own[1][n]
        near += (ways[size - 1, row[a]] if row[a] >= 0 else 0.0) + (
            ways[size - 1, row[b]] if row[b] >= 0 else 0.0
        )
        if x * x + y * y + z * z > near * near:
            continue
        k = walk(a, b, own[1][n], size, shapes, radius, boxes, still, way, ways, work)
        if k >= 0:
            return k, a, b
    return -1, -1, -1


@kernel
def distances(shapes, boxes, pairs, r, p, low, high):
    """Bounds of the distances of pairs of shapes (M, 2) at joint frames r, p are in low and high (M,)."""
    joint, local_r, local_c = boxes
    work, at_r, at_c = np.zeros(ROOM), np.empty((2, 3, 3)), np.empty((2, 3))
    for n in range(pairs.shape[0]):
        for i in range(2):
            s = pairs[n, i]
            matmul(r[joint[s]], local_r[s], at_r[i])
            moved(r[joint[s]], p[joint[s]], local_c[s], at_c[i])
        low[n], high[n] = bounds_of(
            shapes,
            pairs[n, 0],
            pairs[n, 1],
            at_r[0],
            at_c[0],
            at_r[1],
            at_c[1],
            math.inf,
            -math.inf,
            work,
        )
