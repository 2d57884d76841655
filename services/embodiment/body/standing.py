"""Compiled inner loop: where a robot whose joints stand still can be, among a kitchen that stands still."""

import math

import numpy as np
from numba import njit  # pyright: ignore[reportMissingImports]  # compiled, no stubs

from services.embodiment.body.contacts import beside, parting
from services.embodiment.body.kernels import forward, place_boxes

_compiled = njit(cache=True, fastmath=False)


@_compiled
def standing(qs, tree, boxes, split, shapes, margins, largest, free):
    """Whether robot and kitchen keep their margins at each of qs (K, nq) is in `free` (K,).

    The kitchen's part of qs is the same in all of them, and `largest` is the largest of the margins; the
    rest is as in `contacts.contacts`.
    """
    count = boxes[0].shape[0]
    r, p = np.empty((tree[0].shape[0], 3, 3)), np.empty((tree[0].shape[0], 3))
    at_r, at_c = np.empty((count, 3, 3)), np.empty((count, 3))
    low, high, work = np.empty((count, 3)), np.empty((count, 3)), np.zeros((8, 4))
    for k in range(qs.shape[0]):
        forward(qs[k], tree, r, p)
        place_boxes(r, p, boxes, at_r, at_c)
        bottom, top = np.full(3, math.inf), np.full(3, -math.inf)
        for s in range(split if k > 0 else 0, count):
            for i in range(3):
                reach = shapes[2][s]
                for n in range(3):
                    reach += abs(at_r[s, i, n]) * shapes[1][s, n]
                low[s, i], high[s, i] = at_c[s, i] - reach, at_c[s, i] + reach
                if s >= split:
                    bottom[i] = min(bottom[i], low[s, i] - largest)
                    top[i] = max(top[i], high[s, i] + largest)
        free[k] = True
        for e in range(split):
            far = low[e, 0] > top[0] or high[e, 0] < bottom[0] or low[e, 1] > top[1]
            if far or high[e, 1] < bottom[1] or low[e, 2] > top[2] or high[e, 2] < bottom[2]:
                continue
            for s in range(split, count):
                margin = margins[s - split, e]
                if margin < 0.0 or beside(low, high, s, e, margin):
                    continue
                if parting(shapes, s, e, at_r[s], at_c[s], at_r[e], at_c[e], margin, work) <= margin:
                    free[k] = False
                    break
            if not free[k]:
                break
