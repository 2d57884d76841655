"""Compiled inner loops for a hand without its arm: does it touch the kitchen, how near are its fingers."""

import math

import numpy as np
from numba import njit  # pyright: ignore[reportMissingImports]  # compiled, no stubs

from services.embodiment.body.contacts import parting
from services.embodiment.body.kernels import forward, matmul, moved
from services.physics.geometry.convex import parted
from services.physics.geometry.packed import bounds_of

_compiled = njit(cache=True, fastmath=False)


@_compiled
def touching(hand, at, kitchen, split, radius, shapes, margins):
    """A shape of the hand and one of the kitchen's to which it is too near, or (−1, −1).

    `hand` are indices of shapes, `at` their poses; `kitchen` is (indices, rotations, centres).
    """
    work = np.zeros((8, 4))
    for n in range(kitchen[0].shape[0]):
        e = kitchen[0][n]
        for i in range(hand.shape[0]):
            s = hand[i]
            margin = margins[s - split, e]
            x, y, z = (
                at[1][i, 0] - kitchen[2][n, 0],
                at[1][i, 1] - kitchen[2][n, 1],
                at[1][i, 2] - kitchen[2][n, 2],
            )
            if margin < 0.0 or math.sqrt(x * x + y * y + z * z) > radius[s] + radius[e] + margin:
                continue
            there = kitchen[1][n], kitchen[2][n]
            if parting(shapes, s, e, at[0][i], at[1][i], *there, margin, work) <= margin:
                return s, e
    return -1, -1


@_compiled
def touching_many(hand, seen, tools, kitchen, split, radius, shapes, margins, found):
    """What `touching` says of each tool pose (G, 3, 3), (G, 3) is in `found` (G, 2).

    `seen` are poses of the hand's shapes in the tool's frame.
    """
    at_r, at_c = np.empty_like(seen[0]), np.empty_like(seen[1])
    for g in range(found.shape[0]):
        for i in range(hand.shape[0]):
            matmul(tools[0][g], seen[0][i], at_r[i])
            moved(tools[0][g], tools[1][g], seen[1][i], at_c[i])
        found[g] = touching(hand, (at_r, at_c), kitchen, split, radius, shapes, margins)


@_compiled
def gaps(q, tree, boxes, shapes, fingers, handle, tool, goal, out):
    """Distance of each finger shape from the handle's is in `out`; negative where they are in each other.

    How deep they are is that of their own boxes, at least. The hand is moved so that `tool`, its tool's
    pose (rotation, translation) at q, becomes `goal`.
    """
    joint, local_r, local_c = boxes
    count = tree[0].shape[0]
    r, p = np.empty((count, 3, 3)), np.empty((count, 3))
    forward(q, tree, r, p)
    work, turn, frame = np.zeros((8, 4)), np.empty((3, 3)), np.empty((3, 3))
    ra, ca, rb, cb, at = np.empty((3, 3)), np.empty(3), np.empty((3, 3)), np.empty(3), np.empty(3)
    matmul(goal[0], tool[0].T, turn)
    for n in range(fingers.shape[0]):
        s, out[n] = fingers[n], math.inf
        matmul(r[joint[s]], local_r[s], frame)
        moved(r[joint[s]], p[joint[s]], local_c[s], at)
        matmul(turn, frame, ra)
        moved(turn, goal[1], at - tool[1], ca)
        for m in range(handle.shape[0]):
            h = handle[m]
            matmul(r[joint[h]], local_r[h], rb)
            moved(r[joint[h]], p[joint[h]], local_c[h], cb)
            low, _ = bounds_of(shapes, s, h, ra, ca, rb, cb, math.inf, -math.inf, work)
            if low == -math.inf:
                low = min(parted(shapes, s, h, ra, ca, rb, cb), 0.0)
            out[n] = min(out[n], low)


@_compiled
def closing(opened, way, tree, boxes, shapes, fingers, handle, tool, goal, sides, touch, rounds):
    """Share in [0, 1] of `way` from `opened` at which the gap has fallen to `touch`; −1 if it does not.

    The gap is that of the side, of the two in `sides` (2, fingers), whose nearest finger is farther
    away. Regula falsi (Illinois).
    """
    out = np.empty(fingers.shape[0])
    low, at_low, high, at_high = 0.0, 0.0, 1.0, 0.0
    for n in range(rounds + 2):
        share = float(n) if n < 2 else (low * at_high - high * at_low) / (at_high - at_low)
        gaps(opened + share * way, tree, boxes, shapes, fingers, handle, tool, goal, out)
        at = -math.inf
        for side in range(2):
            nearest = math.inf
            for i in range(out.shape[0]):
                if sides[side, i]:
                    nearest = min(nearest, out[i])
            at = max(at, nearest - touch)
        if n == 0:
            at_low = at
            if at <= 0.0:
                return -1.0
        elif n == 1:
            at_high = at
            if at > 0.0:
                return -1.0
        elif at > 0.0:
            low, at_low, at_high = share, at, at_high / 2
        else:
            high, at_high, at_low = share, at, at_low / 2
            if at > -touch:
                break
    return high
