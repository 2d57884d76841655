"""Branch and bound over joint positions: boxes in which some joint is too far from the handle.

Compiled. Nothing here is trusted: what it finds is a tree that `proof_check` verifies.
"""

import numpy as np
from numba import njit

FOUND, REACHED, GAVE_UP = 0, 1, 2
"""The tree is whole; some posture reaches; the nodes were spent."""

LEAF = 128
DEEPEST = 400  # halvings of one box


@njit(cache=True)
def forward(q, rotation, translation, axis, turns, origins, axes):
    """Origins and axes of the joints in the world at q (n,); both outputs (n, 3)."""
    r, p = np.eye(3), np.zeros(3)
    step = np.empty((3, 3))
    for k in range(len(q)):
        p = p + r @ translation[k]
        r = r @ rotation[k]
        u = r @ axis[k]
        if turns[k]:
            c, s = np.cos(q[k]), np.sin(q[k])
            x, y, z = axis[k]
            step[0, 0], step[0, 1], step[0, 2] = (
                c + x * x * (1 - c),
                x * y * (1 - c) - z * s,
                x * z * (1 - c) + y * s,
            )
            step[1, 0], step[1, 1], step[1, 2] = (
                y * x * (1 - c) + z * s,
                c + y * y * (1 - c),
                y * z * (1 - c) - x * s,
            )
            step[2, 0], step[2, 1], step[2, 2] = (
                z * x * (1 - c) - y * s,
                z * y * (1 - c) + x * s,
                c + z * z * (1 - c),
            )
            r = r @ step
        else:
            p = p + u * q[k]
        origins[k], axes[k] = p, u


@njit(cache=True)
def distance(point, box_r, box_p, half, level):
    """Of a point from the nearest box; of heights alone where level."""
    nearest = np.inf
    for b in range(len(box_p)):
        gap = 0.0
        if level:
            up = 0.0
            for k in range(3):
                up += abs(box_r[b, 2, k]) * half[b, k]
            gap = max(abs(point[2] - box_p[b, 2]) - up, 0.0) ** 2
        else:
            for k in range(3):
                local = 0.0
                for i in range(3):
                    local += box_r[b, i, k] * (point[i] - box_p[b, i])
                gap += max(abs(local) - half[b, k], 0.0) ** 2
        nearest = min(nearest, gap)
    return np.sqrt(nearest)


@njit(cache=True)
def lever(origins, axes, j, k, turns, upright, level):
    """How far origin k moves for a unit of joint j."""
    if level and j < upright:
        return 0.0 if turns[j] else abs(axes[j, 2])
    if not turns[j]:
        return 1.0
    x, y, z = origins[k] - origins[j]
    a, b, c = axes[j]
    return np.sqrt((y * c - z * b) ** 2 + (z * a - x * c) ** 2 + (x * b - y * a) ** 2)


@njit(cache=True)
def look(low, high, chain, reach, upright, boxes, level, slack, arms, origins, axes):
    """(joint that is too far in the whole box or −1, joint to halve or −1 where the middle reaches)."""
    middle, half = (low + high) / 2, (high - low) / 2
    forward(middle, chain[0], chain[1], chain[2], chain[3], origins, axes)
    chosen, found = -1, False
    for k in range(len(low)):
        apart = distance(origins[k], boxes[0], boxes[1], boxes[2], level) - reach[k] - slack
        if apart <= 0:
            continue
        moved = 0.0
        for j in range(k + 1):
            moved += lever(origins, axes, j, k, chain[3], upright, level) * half[j]
        if apart > moved:
            return k, -1
        if not found:
            chosen, found = k, True
    if not found:
        return -1, -1
    widest, most = 0, -1.0
    for j in range(chosen + 1):
        arms[j] = lever(origins, axes, j, chosen, chain[3], upright, level) * half[j]
        if arms[j] > most:
            widest, most = j, arms[j]
    return -1, widest


@njit(cache=True)
def divide(low, high, chain, reach, upright, boxes, level, slack, tree):
    """(FOUND, REACHED or GAVE_UP; how much of `tree` was written)."""
    n = len(low)
    lows, highs = np.empty((DEEPEST, n)), np.empty((DEEPEST, n))
    arms, origins, axes = np.empty(n), np.empty((n, 3)), np.empty((n, 3))
    lows[0], highs[0] = low, high
    depth, written = 1, 0
    while depth > 0:
        depth -= 1
        if written >= len(tree) or depth + 2 >= DEEPEST:
            return GAVE_UP, written
        a, b = lows[depth].copy(), highs[depth].copy()
        far, split = look(a, b, chain, reach, upright, boxes, level, slack, arms, origins, axes)
        if far >= 0:
            tree[written] = LEAF + far
            written += 1
            continue
        if split < 0:
            return REACHED, written
        tree[written] = split
        written += 1
        middle = (a[split] + b[split]) / 2
        lows[depth], highs[depth] = a, b
        lows[depth, split] = middle
        lows[depth + 1], highs[depth + 1] = a, b
        highs[depth + 1, split] = middle
        depth += 2
    return FOUND, written
