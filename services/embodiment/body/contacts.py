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
def track(qs, moving, tree, boxes, radius, base, first):
    """(poses of the moving shapes along qs, the way that each has come [m], row of each shape in them or −1).

    `moving`, `tree` and `boxes` are what `carried` gives, `base` is what carries the base, `first` are the
    frames at qs[0], which are written to. The way is that of the point which moves farthest, in the world
    and, for the robot's own pairs, as seen from the base.
    """
    row, count = np.full(boxes[0].shape[0], -1, np.int64), 0
    for s in range(row.shape[0]):
        if boxes[0][s] > 0:
            row[s] = count
            count += 1
    size, joints = qs.shape[0], first[0].shape[0]
    along = np.empty((size, count, 3, 3)), np.empty((size, count, 3))
    ways = np.zeros((size, count)), np.zeros((size, count))
    last = first[0].copy(), np.zeros((joints, 3, 3)), np.empty((count, 3))
    spare = np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.zeros(joints), np.zeros(joints)
    _tracked(qs, moving, tree, boxes, radius, base, row, first, last, spare, along, ways)
    return along, ways, row


@subkernel
def _tracked(qs, moving, tree, boxes, radius, base, row, frames, last, spare, along, ways):
    """What `track` says is in `along` and `ways`; the joints' frames, `last` and `spare` are written to."""
    joint, local_r, local_c = boxes
    (r, p), (at_r, at_c), (way, own) = frames, along, ways
    turn, now_r, now, turned, own_turned = spare
    for k in range(qs.shape[0]):
        for j in moving:
            if k > 0:
                joint_pose(j, qs[k], tree, turn, now_r, r, p)
                turned[j] = _chord(last[0][j], r[j])
                copied(r[j], last[0][j])
        for j in moving:
            if base > 0 and j != base:
                seen_from(r[base], p[base], r[j], p[j], now_r, now)
                own_turned[j] = _chord(last[1][j], now_r)
                copied(now_r, last[1][j])
        for s in range(joint.shape[0]):
            m, j = row[s], joint[s]
            if m < 0:
                continue
            matmul(r[j], local_r[s], at_r[k, m])
            moved(r[j], p[j], local_c[s], at_c[k, m])
            if k > 0:
                way[k, m] = way[k - 1, m] + _shift(at_c[k - 1, m], at_c[k, m]) + radius[s] * turned[j]
            if base == 0:
                own[k, m] = way[k, m]
            elif j != base:
                x, y, z = at_c[k, m, 0] - p[base, 0], at_c[k, m, 1] - p[base, 1], at_c[k, m, 2] - p[base, 2]
                for i in range(3):  # baseᵀ · centre
                    now[i] = r[base, 0, i] * x + r[base, 1, i] * y + r[base, 2, i] * z
                if k > 0:
                    own[k, m] = own[k - 1, m] + _shift(last[2][m], now) + radius[s] * own_turned[j]
                for i in range(3):
                    last[2][m, i] = now[i]


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


@subkernel(inline=True)
def walk(a, b, margin, shapes, radius, row, still, along, way, work):
    """First configuration at which the pair is too near, or −1.

    From a configuration at which the pair is farther apart than the margin, those are left out in
    which the two cannot have come near enough.
    """
    at_r, at_c = along
    size, i, j = at_r.shape[0], row[a], row[b]
    near = radius[a] + radius[b]
    k = 0
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
            ra, ca = (at_r[k, i], at_c[k, i]) if i >= 0 else (still[0][a], still[1][a])
            rb, cb = (at_r[k, j], at_c[k, j]) if j >= 0 else (still[0][b], still[1][b])
            apart = parting(shapes, a, b, ra, ca, rb, cb, margin, work)
            if apart <= margin:
                return k
        here = (way[k, i] if i >= 0 else 0.0) + (way[k, j] if j >= 0 else 0.0)
        k += 1
        while k < size and (
            (way[k, i] if i >= 0 else 0.0) + (way[k, j] if j >= 0 else 0.0) - here < apart - margin
        ):
            k += 1
    return -1


@subkernel
def boxed(shapes, row, still, along, low, high):
    """Corners of boxes along the world's axes that hold each shape at all configurations."""
    size = shapes[1]
    for s in range(row.shape[0]):
        count = along[0].shape[0] if row[s] >= 0 else 1
        for k in range(count):
            r, c = (along[0][k, row[s]], along[1][k, row[s]]) if row[s] >= 0 else (still[0][s], still[1][s])
            for i in range(3):
                reach = (
                    abs(r[i, 0]) * size[s, 0] + abs(r[i, 1]) * size[s, 1] + abs(r[i, 2]) * size[s, 2]
                ) + shapes[2][s]
                if k == 0 or c[i] - reach < low[s, i]:
                    low[s, i] = c[i] - reach
                if k == 0 or c[i] + reach > high[s, i]:
                    high[s, i] = c[i] + reach


@subkernel
def beside(low, high, s, e, margin):
    """Whether the boxes of two shapes are farther apart than the margin along an axis of the world."""
    apart = low[s, 0] > high[e, 0] + margin or high[s, 0] < low[e, 0] - margin
    apart = apart or low[s, 1] > high[e, 1] + margin or high[s, 1] < low[e, 1] - margin
    return apart or low[s, 2] > high[e, 2] + margin or high[s, 2] < low[e, 2] - margin


@subkernel(makes=True)
def _first(row, still, along, way):
    """Each shape's centre at the first configuration, and the way that it comes in all [m]."""
    count, last = row.shape[0], way.shape[0] - 1
    centre, ways = still[1].copy(), np.zeros(count)
    for s in range(count):
        if row[s] >= 0:
            ways[s] = way[last, row[s]]
            for i in range(3):
                centre[s, i] = along[1][0, row[s], i]
    return centre, ways


@kernel
def contacts(qs, tree, boxes, split, radius, shapes, base, own, margins, largest):
    """(configuration of a contact or −1, the two shapes) along qs (K, nq).

    Shapes before `split` are the kitchen's. margins[robot shape, kitchen shape] is the distance
    demanded, negative where the pair may touch, and `largest` the largest of them; `own` is (the robot's
    own pairs, their margins).
    """
    count = boxes[0].shape[0]
    r, p = np.empty((tree[0].shape[0], 3, 3)), np.empty((tree[0].shape[0], 3))
    still = (np.empty((count, 3, 3)), np.empty((count, 3)))
    forward(qs[0], tree, r, p)
    place_boxes(r, p, boxes, still[0], still[1])
    carrier, many, moving, tree, boxes = carried(qs, tree, boxes, r, p, still)
    along, ways, row = track(qs, moving[:many], tree, boxes, radius, carrier[base], (r, p))
    corners, work = (np.empty((count, 3)), np.empty((count, 3)), np.empty((2, 3))), np.zeros(ROOM)
    centres = _first(row, still, along, ways[1])
    rest = shapes, radius, row, still, along
    found = _met(split, margins, largest, ways[0], corners, work, *rest)
    return found if found[0] >= 0 else _met_itself(own, centres, ways[1], work, *rest)


@subkernel
def _met(split, margins, largest, way, corners, work, shapes, radius, row, still, along):
    """The first configuration found at which robot and kitchen are too near, and the two shapes; or −1."""
    low, high, (bottom, top) = corners[0], corners[1], (corners[2][0], corners[2][1])
    boxed(shapes, row, still, along, low, high)
    for i in range(3):
        bottom[i], top[i] = math.inf, -math.inf
    count = row.shape[0]
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
            k = walk(s, e, margin, shapes, radius, row, still, along, way, work)
            if k >= 0:
                return k, s, e
    return -1, -1, -1


@subkernel
def _met_itself(own, centres, way, work, shapes, radius, row, still, along):
    """The same of the robot's own pairs."""
    centre, ways = centres
    for n in range(own[0].shape[0]):
        a, b = own[0][n, 0], own[0][n, 1]
        x, y, z = centre[a, 0] - centre[b, 0], centre[a, 1] - centre[b, 1], centre[a, 2] - centre[b, 2]
        near = radius[a] + radius[b] + own[1][n] + ways[a] + ways[b]
        if x * x + y * y + z * z > near * near:
            continue
        k = walk(a, b, own[1][n], shapes, radius, row, still, along, way, work)
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
