"""Compiled inner loop: where a robot whose joints stand still can be, among a kitchen that stands still."""

import math

import numpy as np
from numba import njit  # pyright: ignore[reportMissingImports]  # compiled, no stubs

from services.embodiment.body.contacts import FREE, UNSURE, judged
from services.embodiment.body.kernels import forward, place_boxes

_compiled = njit(cache=True, fastmath=False)


@_compiled
def _reach(r, half, radius, i):
    return abs(r[i, 0]) * half[0] + abs(r[i, 1]) * half[1] + abs(r[i, 2]) * half[2] + radius


@_compiled
def standing(qs, tree, boxes, split, radius, shapes, margins, states):
    """FREE, HIT or UNSURE of robot against kitchen at each of qs (K, nq) is in `states` (K,).

    The kitchen's part of qs is the same in all of them. The rest is as in `contacts.contacts`.
    """
    count = boxes[0].shape[0]
    r, p = np.empty((tree[0].shape[0], 3, 3)), np.empty((tree[0].shape[0], 3))
    at_r, at_c = np.empty((count, 3, 3)), np.empty((count, 3))
    low, high, work, largest = np.empty((split, 3)), np.empty((split, 3)), np.zeros((8, 4)), margins.max()
    for k in range(qs.shape[0]):
        forward(qs[k], tree, r, p)
        place_boxes(r, p, boxes, at_r, at_c)
        bottom, top = np.full(3, math.inf), np.full(3, -math.inf)
        for s in range(split if k > 0 else 0, count):
            for i in range(3):
                reach = _reach(at_r[s], shapes[1][s], shapes[2][s], i)
                if s < split:
                    low[s, i], high[s, i] = at_c[s, i] - reach, at_c[s, i] + reach
                else:
                    bottom[i] = min(bottom[i], at_c[s, i] - reach - largest)
                    top[i] = max(top[i], at_c[s, i] + reach + largest)
        states[k] = FREE
        for e in range(split):
            beside = low[e, 0] > top[0] or high[e, 0] < bottom[0] or low[e, 1] > top[1]
            if beside or high[e, 1] < bottom[1] or low[e, 2] > top[2] or high[e, 2] < bottom[2]:
                continue
            for s in range(split, count):
                margin = margins[s - split, e]
                x, y, z = at_c[s, 0] - at_c[e, 0], at_c[s, 1] - at_c[e, 1], at_c[s, 2] - at_c[e, 2]
                near = radius[s] + radius[e] + margin
                if margin < 0.0 or x * x + y * y + z * z > near * near:
                    continue
                state, _ = judged(shapes, s, e, at_r[s], at_c[s], at_r[e], at_c[e], margin, work)
                if state != FREE:
                    states[k] = state
                    if state != UNSURE:
                        break
            if states[k] != FREE and states[k] != UNSURE:
                break
