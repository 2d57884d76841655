"""Compiled inner loops: contacts of a scene's shapes at configurations that are looked at one by one."""

import math

import numpy as np

from services.embodiment.body.contacts import beside, parting
from services.embodiment.body.kernels import carried, forward, joint_pose, matmul, moved, place_boxes
from services.kernel import kernel, subkernel
from services.physics.geometry.convex import ROOM


@kernel
def contacts_each(found, qs, tree, boxes, split, radius, shapes, base, own, margins, largest):
    """The two shapes of a contact at each of qs (N, nq) alone, or (−1, −1), are in `found` (N, 2).

    What all configurations have in common is placed once.
    """
    count, joints = boxes[0].shape[0], tree[0].shape[0]
    r, p = np.empty((joints, 3, 3)), np.empty((joints, 3))
    at, low, high = (
        (np.empty((count, 3, 3)), np.empty((count, 3))),
        np.empty((count, 3)),
        np.empty((count, 3)),
    )
    near = _apart(radius, own)
    turn, local, work, around = np.empty((3, 3)), np.empty((3, 3)), np.zeros(ROOM), np.empty((2, 3))
    forward(qs[0], tree, r, p)
    place_boxes(r, p, boxes, at[0], at[1])
    _, many, moving, tree, boxes = carried(qs, tree, boxes, r, p, at)
    for n in range(qs.shape[0]):
        for j in moving[:many]:
            joint_pose(j, qs[n], tree, turn, local, r, p)
        for s in range(count):
            if n == 0 or boxes[0][s] > 0:
                _placed(s, r, p, boxes, shapes, at, low, high)
        e, s = _near(split, shapes, at, low, high, margins, largest, around, work)
        if e < 0:
            e, s = _near_own(near, shapes, at, own, work)
        found[n, 0], found[n, 1] = e, s


@subkernel
def _placed(s, r, p, boxes, shapes, at, low, high):
    """Shape s is where its joint's frame is: its pose, and the corners of its box along the world's axes."""
    joint, local_r, local_c = boxes
    matmul(r[joint[s]], local_r[s], at[0][s])
    moved(r[joint[s]], p[joint[s]], local_c[s], at[1][s])
    for i in range(3):
        reach = shapes[2][s]
        for k in range(3):
            reach += abs(at[0][s, i, k]) * shapes[1][s, k]
        low[s, i], high[s, i] = at[1][s, i] - reach, at[1][s, i] + reach


@subkernel
def _near(split, shapes, at, low, high, margins, largest, around, work):
    """A shape of the robot and one of the kitchen nearer than their margin, or (−1, −1)."""
    bottom, top = around[0], around[1]
    for i in range(3):
        bottom[i], top[i] = math.inf, -math.inf
        for s in range(split, low.shape[0]):
            bottom[i], top[i] = min(bottom[i], low[s, i]), max(top[i], high[s, i])
    for e in range(split):
        far = False
        for i in range(3):
            far = far or low[e, i] > top[i] + largest or high[e, i] < bottom[i] - largest
        if far:
            continue
        for s in range(split, low.shape[0]):
            margin = margins[s - split, e]
            if margin < 0.0 or beside(low, high, s, e, margin):
                continue
            if parting(shapes, s, e, at[0][s], at[1][s], at[0][e], at[1][e], margin, work) <= margin:
                return s, e
    return -1, -1


@subkernel(makes=True)
def _apart(radius, own):
    """Square of the distance from which on the middles of two shapes of the robot are apart, of each pair."""
    pairs, margins = own
    near = np.empty(pairs.shape[0])
    for n in range(pairs.shape[0]):
        reach = radius[pairs[n, 0]] + radius[pairs[n, 1]] + margins[n]
        near[n] = reach * reach
    return near


@subkernel
def _near_own(near, shapes, at, own, work):
    """Two shapes of the robot nearer than their margin, or (−1, −1).

    `near` is what `_apart` gives; where a shape is the first of many pairs, its middle is read once.
    """
    pairs, margins = own
    first, x, y, z = -1, 0.0, 0.0, 0.0
    for n in range(pairs.shape[0]):
        a, b = pairs[n, 0], pairs[n, 1]
        if a != first:
            first, x, y, z = a, at[1][a, 0], at[1][a, 1], at[1][a, 2]
        u, v, w = x - at[1][b, 0], y - at[1][b, 1], z - at[1][b, 2]
        if u * u + v * v + w * w > near[n]:
            continue
        margin = margins[n]
        if parting(shapes, a, b, at[0][a], at[1][a], at[0][b], at[1][b], margin, work) <= margin:
            return a, b
    return -1, -1
