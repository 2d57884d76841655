"""Branch and bound over joint positions: boxes in which some joint is too far from the handle.

Compiled. Nothing here is trusted: what it finds is a tree that `proof_check` verifies.
"""

import numpy as np
from numba import njit

FOUND, REACHED, GAVE_UP = 0, 1, 2
"""The tree is whole; some posture reaches; the nodes were spent."""

LEAF = 128
DEEPEST = 400  # halvings of one box
FINEST = 1e-4  # [m] a box in which nothing moves by more is not halved: it lies at the edge of the reach


@njit(cache=True)
def forward(q, rotation, translation, axis, turns, origins, axes):
    """Rotation of the last frame; origins and axes of the joints in the world at q, outputs (n, 3)."""
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
    return r


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
def gap(box, half, box_r, box_p, own, level):
    """Largest gap along an axis between a box (rotation, middle) and the nearest of the others."""
    turn, middle = box
    nearest = np.inf
    for b in range(len(box_p)):
        apart = middle - box_p[b]
        if level:
            widest = abs(apart[2])
            for k in range(3):
                widest -= abs(box_r[b, 2, k]) * own[b, k] + abs(turn[2, k]) * half[k]
        else:
            widest = -np.inf
            cross = box_r[b].T @ turn
            for k in range(3):
                here, there = -own[b, k], -half[k]
                for i in range(3):
                    here -= abs(cross[k, i]) * half[i]
                    there -= abs(cross[i, k]) * own[b, i]
                here += abs(box_r[b, 0, k] * apart[0] + box_r[b, 1, k] * apart[1] + box_r[b, 2, k] * apart[2])
                there += abs(turn[0, k] * apart[0] + turn[1, k] * apart[1] + turn[2, k] * apart[2])
                widest = max(widest, here, there)
        nearest = min(nearest, widest)
    return nearest


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
def look(low, high, chain, reach, upright, tool, boxes, level, slack, arms, origins, axes):
    """(What is too far in the whole box, a joint or n for the fingers, or −1; joint to halve or −1).

    Both are −1 where the middle may reach. `tool` is the grasp box in the last frame: rotation, middle,
    half extents.
    """
    n = len(low)
    middle, half = (low + high) / 2, (high - low) / 2
    last = forward(middle, chain[0], chain[1], chain[2], chain[3], origins[:n], axes)
    origins[n] = origins[n - 1] + last @ tool[1]
    radius = np.sqrt((tool[2] ** 2).sum())
    chosen = -1
    for k in range(n + 1):
        if k < n:
            apart = distance(origins[k], boxes[0], boxes[1], boxes[2], level) - reach[k] - slack
        else:
            box = (last @ tool[0], origins[n])
            apart = gap(box, tool[2], boxes[0], boxes[1], boxes[2], level) - slack
        if apart <= 0:
            continue
        moved = 0.0
        for j in range(min(k + 1, n)):
            one = lever(origins, axes, j, k, chain[3], upright, level)
            if k == n and chain[3][j] and not (level and j < upright):
                one += radius
            moved += one * half[j]
        if apart > moved:
            return k, -1
        if chosen < 0:
            chosen = k
    if chosen < 0:
        return -1, -1
    widest, most = 0, -1.0
    for j in range(min(chosen + 1, n)):
        arms[j] = lever(origins, axes, j, chosen, chain[3], upright, level) * half[j]
        if chosen == n and chain[3][j] and not (level and j < upright):
            arms[j] += radius * half[j]
        if arms[j] > most:
            widest, most = j, arms[j]
    return -1, widest if most > FINEST else -1


@njit(cache=True)
def divide(low, high, chain, reach, upright, tool, boxes, level, slack, tree):
    """(FOUND, REACHED or GAVE_UP; how much of `tree` was written)."""
    n = len(low)
    lows, highs = np.empty((DEEPEST, n)), np.empty((DEEPEST, n))
    arms, origins, axes = np.empty(n), np.empty((n + 1, 3)), np.empty((n, 3))
    lows[0], highs[0] = low, high
    depth, written = 1, 0
    while depth > 0:
        depth -= 1
        if written >= len(tree) or depth + 2 >= DEEPEST:
            return GAVE_UP, written
        a, b = lows[depth].copy(), highs[depth].copy()
        far, split = look(a, b, chain, reach, upright, tool, boxes, level, slack, arms, origins, axes)
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


def warm() -> None:
    """`divide` has run once, with the types in which it is used."""
    turn, zero, one = np.eye(3)[None], np.zeros((1, 3)), np.zeros(1)
    chain = turn, zero, zero, np.zeros(1, np.bool_)
    tool, boxes = (np.eye(3), np.zeros(3), np.zeros(3)), (turn, zero, zero)
    divide(one, one, chain, one, 0, tool, boxes, False, 0.0, np.zeros(1, dtype=np.uint8))
