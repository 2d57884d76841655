"""Branch and bound over joint positions: boxes in which a joint is too far off, or a core meets a solid.

Compiled. Nothing here is trusted: what it finds is a tree that `proof_check` verifies.
"""

import math

import numpy as np

from services.embodiment.body.kernels import copied, matmul, moved, rotation
from services.embodiment.prove.tree.cores import pierced, room_for
from services.embodiment.prove.tree.stretch import behind, offset
from services.embodiment.prove.tree.swing import LEEWAY, extent, near, refutes, toward
from services.kernel import kept, kernel, subkernel

FOUND, REACHED, GAVE_UP = 0, 1, 2
"""The tree is whole; some posture reaches; the nodes were spent."""

LEAF = 128
DEEPEST = 400  # halvings of one box


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
def short(point, reach, boxes, b, level, count, joints, room, best):
    """How near to refuted a box is by a joint that does not come to box b of the handle."""
    turns, places, sizes = boxes
    d, none, other = room
    if level:
        d[0], d[1], d[2] = 0.0, 0.0, 1.0
        far = abs(point[2] - places[b, 2]) - extent(d, turns[b], sizes[b])
    else:
        far = toward(point, turns[b], places[b], sizes[b], d)
    return refutes(far - reach, d, point, turns[b], none, count, joints, best, other)


@subkernel
def clear(middle, turn, own, boxes, b, level, slack, joints, room, best):
    """How near to refuted a box is by the grasp box, apart from box b of the handle along an axis of both."""
    turns, places, sizes = boxes
    d, _, other = room
    most, chosen, way, count = 0.0, -1.0, 0.0, joints[0].shape[0]
    for k in range(1 if level else 6):
        for i in range(3):
            d[i] = (1.0 if i == 2 else 0.0) if level else turns[b, i, k] if k < 3 else turn[i, k - 3]
        gap = 0.0
        for i in range(3):
            gap += d[i] * (middle[i] - places[b, i])
        gap = abs(gap) - extent(d, turns[b], sizes[b]) - extent(d, turn, own) - slack
        one = refutes(gap, d, middle, turn, own, count, joints, best, other)
        if one > most:
            most, chosen, way = one, best[0], best[1]
    best[0], best[1] = chosen, way
    return most


@subkernel
def look(middle, half, chain, aim, upright, level, slack, room):
    """(What is too far in all of a box, a joint, n for fingers, or −1; joint to halve or −1; how near; way).

    Halved is the joint that moves most what is nearest to refute the box: its gap is so large a part of the
    way by which it may close. The joint is −1 where the middle may reach. `aim` is how far the arm reaches
    from its joints, the grasp box in the last frame (rotation, middle, half extents), and the handle's boxes.
    Where the joints are in the middle is in `room`: origins, axes, frames, two turns, room for others.
    """
    n = middle.shape[0]
    reach, tool, boxes = aim
    origins, axes, frames, turn, carried, spare, best = room
    forward(middle, chain, origins, axes, frames, turn, carried)
    moved(frames[n - 1], origins[n - 1], tool[1], origins[n])
    matmul(frames[n - 1], tool[0], turn)
    joints = half, origins, axes, chain[3], upright if level else 0
    split, nearest, closing = -1, 0.0, 0.0
    for rule in range(n + 1 if level else 2 * n):
        bent = rule > n
        k = rule - n - 1 if bent else rule
        if bent and not offset(chain[1][k + 1]):
            continue  # the next joint's origin is the same, and less is behind that
        worst, here, way = math.inf, -1, 0.0
        for b in range(boxes[1].shape[0]):
            if bent:
                still = 0.0, -1.0, 0.0
                one = behind(k, aim, b, turn, chain[1], joints, slack, 0.0, still, spare, best)
            elif k < n:
                one = short(origins[k], reach[k] + slack, boxes, b, level, k + 1, joints, spare, best)
            else:
                one = clear(origins[n], turn, tool[2], boxes, b, level, slack, joints, spare, best)
            if one < worst:
                worst, here, way = one, int(best[0]), best[1]
            if worst <= nearest:
                break
        if worst > 1.0:
            return k, -1, 0.0, 0.0
        if worst > nearest:
            nearest, split, closing = worst, here, way
    return -1, split, nearest, closing


@subkernel
def amid(low, high, middle, half):
    """The middle of a box, and half its widths, are in the outputs."""
    for j in range(low.shape[0]):
        middle[j], half[j] = (low[j] + high[j]) / 2, (high[j] - low[j]) / 2


@subkernel
def halved(lows, highs, depth, split, middle):
    """The box at so deep a place is halved there: its upper half, and on it the lower one."""
    for j in range(middle.shape[0]):
        lows[depth + 1, j], highs[depth + 1, j] = lows[depth, j], highs[depth, j]
    lows[depth, split] = middle[split]
    highs[depth + 1, split] = middle[split]


@kernel
def divide(low, high, chain, upright, aims, both, level, slack, inner, tree):
    """(FOUND, REACHED or GAVE_UP; how much of `tree` was written).

    `aims` are two: the handle and, looked at where both count, the wrist's place. Each is how far the arm
    reaches from its joints, what comes there in the last frame, and boxes where it has to come.

    `inner` is cores (link, rotation, middle, half extents), solids (rotation, middle, half extents,
    and the link that carries it or −1), and which of these are kept apart.
    """
    n = low.shape[0]
    lows, highs = np.empty((DEEPEST, n)), np.empty((DEEPEST, n))
    origins, axes, frames = np.empty((n + 1, 3)), np.empty((n, 3)), np.empty((n, 3, 3))
    middle, half = np.empty(n), np.empty(n)
    spare = np.empty(3), np.zeros(3), np.empty(2)
    work = origins, axes, frames, np.empty((3, 3)), np.empty((3, 3)), spare, np.empty(2)
    for j in range(n):
        lows[0, j], highs[0, j] = low[j], high[j]
    cores, hidden = inner[0][0].shape[0], room_for(inner, n)
    depth, written = 1, 0
    while depth > 0:
        depth -= 1
        if written >= tree.shape[0] or depth + 2 >= DEEPEST:
            return GAVE_UP, written
        amid(lows[depth], highs[depth], middle, half)
        far, split, ratio, way = look(middle, half, chain, aims[0], upright, level, slack, work)
        if both and far < 0:
            place, other, nearer, closing = look(middle, half, chain, aims[1], upright, level, slack, work)
            far = n + 1 + cores + place if place >= 0 else -1
            if nearer > ratio:
                split, ratio, way = other, nearer, closing
        if far < 0 and cores:
            hinged = half, origins, axes, chain[3], 0
            core, split = pierced(hinged, frames, inner, hidden, split, near(ratio * way, way, LEEWAY))
            far = n + 1 + core if core >= 0 else -1
        if far >= 0:
            tree[written] = LEAF + far
            written += 1
            continue
        if split < 0:
            return REACHED, written
        tree[written] = split
        written += 1
        halved(lows, highs, depth, split, middle)
        depth += 2
    return FOUND, written


def warm() -> None:
    """`divide` is loaded if it was ever compiled: compiling takes seconds, and few who ask need a proof."""
    if kept(divide):
        _run()


def _run() -> None:
    """`divide` has run once, with the types in which it is used."""
    turn, zero, one = np.eye(3)[None], np.zeros((1, 3)), np.zeros(1)
    chain = turn, zero, zero, np.zeros(1, np.bool_)
    tool, boxes = (np.eye(3), np.zeros(3), np.zeros(3)), (turn, zero, zero)
    world = np.full(1, -1, np.int64)
    inner = (np.zeros(1, np.int64), turn, zero, zero), (*boxes, world), np.ones((1, 1), np.bool_)
    aim = one, tool, boxes
    divide(one, one, chain, 0, (aim, aim), False, False, 0.0, inner, np.zeros(1, dtype=np.uint8))
