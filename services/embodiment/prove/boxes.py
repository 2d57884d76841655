"""Branch and bound over joint positions: boxes in which a joint is too far off, or a core meets a solid.

Compiled. Nothing here is trusted: what it finds is a tree that `proof_check` verifies.
"""

import math

import numpy as np

from services.embodiment.body.kernels import copied, matmul, moved, rotation
from services.embodiment.prove.inner import meets
from services.kernel import kernel, subkernel

FOUND, REACHED, GAVE_UP = 0, 1, 2
"""The tree is whole; some posture reaches; the nodes were spent."""

LEAF = 128
DEEPEST = 400  # halvings of one box
FINEST = 1e-4  # [m] a box in which nothing moves by more is not halved: it lies at the edge of the reach


@subkernel
def forward(q, chain, origins, axes, frames, step, carried):
    """Origins, axes (n, 3) and frames (n, 3, 3) of the joints in the world at q are in the outputs."""
    rotations, translations, axis, turns = chain
    for k in range(q.shape[0]):
        if k == 0:
            copied(rotations[0], carried)
            for i in range(3):
                origins[0, i] = translations[0, i]
        else:
            moved(frames[k - 1], origins[k - 1], translations[k], origins[k])
            matmul(frames[k - 1], rotations[k], carried)
        for i in range(3):
            axes[k, i] = carried[i, 0] * axis[k, 0] + carried[i, 1] * axis[k, 1] + carried[i, 2] * axis[k, 2]
        if turns[k]:
            rotation(axis[k], q[k], step)
            matmul(carried, step, frames[k])
            continue
        copied(carried, frames[k])
        for i in range(3):
            origins[k, i] += axes[k, i] * q[k]


@subkernel
def distance(point, box_r, box_p, half, level):
    """Of a point from the nearest box; of heights alone where level."""
    nearest = math.inf
    for b in range(box_p.shape[0]):
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
    return math.sqrt(nearest)


@subkernel
def gap(box, half, box_r, box_p, own, level):
    """Largest gap along an axis between a box (rotation, middle) and the nearest of the others."""
    turn, middle = box
    nearest = math.inf
    for b in range(box_p.shape[0]):
        x, y, z = middle[0] - box_p[b, 0], middle[1] - box_p[b, 1], middle[2] - box_p[b, 2]
        if level:
            widest = abs(z)
            for k in range(3):
                widest -= abs(box_r[b, 2, k]) * own[b, k] + abs(turn[2, k]) * half[k]
        else:
            widest = -math.inf
            for k in range(3):
                here = abs(box_r[b, 0, k] * x + box_r[b, 1, k] * y + box_r[b, 2, k] * z) - own[b, k]
                there = abs(turn[0, k] * x + turn[1, k] * y + turn[2, k] * z) - half[k]
                for i in range(3):
                    across = along = 0.0
                    for m in range(3):
                        across += box_r[b, m, k] * turn[m, i]
                        along += box_r[b, m, i] * turn[m, k]
                    here -= abs(across) * half[i]
                    there -= abs(along) * own[b, i]
                widest = max(widest, here, there)
        nearest = min(nearest, widest)
    return nearest


@subkernel
def lever(origins, axes, j, k, turns, upright, level):
    """How far origin k moves for a unit of joint j."""
    if level and j < upright:
        return 0.0 if turns[j] else abs(axes[j, 2])
    if not turns[j]:
        return 1.0
    x, y, z = origins[k, 0] - origins[j, 0], origins[k, 1] - origins[j, 1], origins[k, 2] - origins[j, 2]
    a, b, c = axes[j, 0], axes[j, 1], axes[j, 2]
    return math.sqrt((y * c - z * b) ** 2 + (z * a - x * c) ** 2 + (x * b - y * a) ** 2)


@subkernel
def look(middle, half, chain, aim, upright, level, slack, room):
    """(What is too far in the whole box, a joint or n for the fingers, or −1; joint to halve or −1).

    Both are −1 where the middle may reach. `aim` is how far the arm reaches from its joints, the grasp box in
    the last frame (rotation, middle, half extents), and the handle's boxes. Where the joints are in the
    middle is in `room`: arms, origins, axes, frames, two turns.
    """
    n = middle.shape[0]
    reach, tool, boxes = aim
    arms, origins, axes, frames, turn, carried = room
    forward(middle, chain, origins, axes, frames, turn, carried)
    moved(frames[n - 1], origins[n - 1], tool[1], origins[n])
    matmul(frames[n - 1], tool[0], turn)
    radius = math.sqrt(tool[2][0] ** 2 + tool[2][1] ** 2 + tool[2][2] ** 2)
    chosen = -1
    for k in range(n + 1):
        if k < n:
            apart = distance(origins[k], boxes[0], boxes[1], boxes[2], level) - reach[k] - slack
        else:
            apart = gap((turn, origins[n]), tool[2], boxes[0], boxes[1], boxes[2], level) - slack
        if apart <= 0:
            continue
        way = 0.0
        for j in range(min(k + 1, n)):
            one = lever(origins, axes, j, k, chain[3], upright, level)
            if k == n and chain[3][j] and not (level and j < upright):
                one += radius
            way += one * half[j]
        if apart > way:
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


@kernel
def divide(low, high, chain, upright, aims, both, level, slack, inner, tree):
    """(FOUND, REACHED or GAVE_UP; how much of `tree` was written).

    `aims` are two: the handle and, looked at where both count, the wrist's place. Each is how far the arm
    reaches from its joints, what comes there in the last frame, and boxes where it has to come.

    `inner` is cores (link, rotation, middle, half extents), solids (rotation, middle, half extents, radius,
    and the link that carries it or −1), and which of these are kept apart.
    """
    n = low.shape[0]
    lows, highs = np.empty((DEEPEST, n)), np.empty((DEEPEST, n))
    origins, axes, frames = np.empty((n + 1, 3)), np.empty((n, 3)), np.empty((n, 3, 3))
    arms, middle, half = np.empty(n), np.empty(n), np.empty(n)
    work = arms, origins, axes, frames, np.empty((3, 3)), np.empty((3, 3))
    for j in range(n):
        lows[0, j], highs[0, j] = low[j], high[j]
    depth, written = 1, 0
    while depth > 0:
        depth -= 1
        if written >= tree.shape[0] or depth + 2 >= DEEPEST:
            return GAVE_UP, written
        for j in range(n):
            middle[j], half[j] = (
                (lows[depth, j] + highs[depth, j]) / 2,
                (highs[depth, j] - lows[depth, j]) / 2,
            )
        far, split = look(middle, half, chain, aims[0], upright, level, slack, work)
        if both and far < 0:
            short, other = look(middle, half, chain, aims[1], upright, level, slack, work)
            far = n + 1 + inner[0][0].shape[0] + short if short >= 0 else -1
            split = other if other >= 0 else split
        if far < 0 and inner[0][0].shape[0]:
            core, other = meets(half, chain[3], inner, origins, axes, frames, arms, split < 0)
            far, split = n + 1 + core if core >= 0 else -1, other if split < 0 else split
        if far >= 0:
            tree[written] = LEAF + far
            written += 1
            continue
        if split < 0:
            return REACHED, written
        tree[written] = split
        written += 1
        for j in range(n):
            lows[depth + 1, j], highs[depth + 1, j] = lows[depth, j], highs[depth, j]
        lows[depth, split] = middle[split]
        highs[depth + 1, split] = middle[split]
        depth += 2
    return FOUND, written


def warm() -> None:
    """`divide` has run once, with the types in which it is used."""
    turn, zero, one = np.eye(3)[None], np.zeros((1, 3)), np.zeros(1)
    chain = turn, zero, zero, np.zeros(1, np.bool_)
    tool, boxes = (np.eye(3), np.zeros(3), np.zeros(3)), (turn, zero, zero)
    world = np.full(1, -1, np.int64)
    inner = (np.zeros(1, np.int64), turn, zero, zero), (*boxes, one, world), np.ones((1, 1), np.bool_)
    aim = one, tool, boxes
    divide(one, one, chain, 0, (aim, aim), False, False, 0.0, inner, np.zeros(1, dtype=np.uint8))
