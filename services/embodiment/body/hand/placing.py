"""Compiled inner loops for a hand without its arm: where its shapes are, and what they touch there."""

import numpy as np

from services.embodiment.body.contacts import clear, parting
from services.embodiment.body.kernels import joint_pose, matmul, moved, seen_from
from services.kernel import kernel, subkernel
from services.physics.geometry.convex import ROOM


def room(shapes: int, coordinates: int) -> tuple:
    """What the loops write to, for a hand of so many shapes in a scene of so many coordinates.

    Poses of the shapes, gaps of the two sides of the fingers, work, a configuration, and spare matrices.
    """
    spare = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    at = np.empty((shapes, 3, 3)), np.empty((shapes, 3))
    return at, np.empty(2), np.zeros(ROOM), np.empty(coordinates), spare


@subkernel
def touching(hand, at, kitchen, split, radius, shapes, margins, work):
    """A shape of the hand and one of the kitchen's to which it is too near, or (−1, −1).

    `hand` are indices of shapes, `at` their poses; `kitchen` is (indices, rotations, centres).
    """
    for i in range(hand.shape[0]):
        s = hand[i]
        for n in range(kitchen[0].shape[0]):
            e = kitchen[0][n]
            margin = margins[s - split, e]
            if margin < 0.0 or clear(shapes, e, kitchen[1][n], kitchen[2][n], at[1][i], radius[s] + margin):
                continue
            there_r, there_c = kitchen[1][n], kitchen[2][n]
            if parting(shapes, s, e, at[0][i], at[1][i], there_r, there_c, margin, work) <= margin:
                return s, e
    return -1, -1


@kernel
def touching_many(hand, seen, tools, kitchen, split, radius, shapes, margins, found):
    """What `touching` says of each tool pose (G, 3, 3), (G, 3) is in `found` (G, 2).

    `seen` are poses of the hand's shapes in the tool's frame.
    """
    at_r, at_c, work = np.empty_like(seen[0]), np.empty_like(seen[1]), np.zeros(ROOM)
    for g in range(found.shape[0]):
        for i in range(hand.shape[0]):
            matmul(tools[0][g], seen[0][i], at_r[i])
            moved(tools[0][g], tools[1][g], seen[1][i], at_c[i])
        rest = split, radius, shapes, margins, work
        found[g, 0], found[g, 1] = touching(hand, (at_r, at_c), kitchen, *rest)


@kernel
def posed(q, hand, at):
    """Poses of a hand's shapes as its tool sees them, fingers as in q, are in `at` (rotations, centres)."""
    _posed(q, hand, at, (np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty(3)))


@subkernel
def _posed(q, hand, at, spare):
    """The same.

    `hand` is (indices of the shapes, fingers last; number of those that are no fingers; joints that q may
    move, from the root on; tree; boxes; tool's pose (rotation, translation); poses of all joint frames,
    into which the moved ones are written).
    """
    shapes, _, joints, tree, (joint, local_r, local_c), (tool_r, tool_p), (r, p) = hand
    turn, carried, frame, centre = spare
    for j in joints:
        joint_pose(j, q, tree, turn, carried, r, p)
    for i in range(shapes.shape[0]):
        s = shapes[i]
        matmul(r[joint[s]], local_r[s], frame)
        moved(r[joint[s]], p[joint[s]], local_c[s], centre)
        seen_from(tool_r, tool_p, frame, centre, at[0][i], at[1][i])


@subkernel
def closed_by(shares, hand, closing, room):
    """Poses of a hand's shapes as its tool sees them are in room[0], its finger joints closed by shares (F,).

    `closing` is (open configuration, what closing each finger joint adds to it).
    """
    at, _, _, q, spare = room
    for i in range(q.shape[0]):
        q[i] = closing[0][i]
        for k in range(shares.shape[0]):
            q[i] += closing[1][k, i] * shares[k]
    _posed(q, hand, at, spare)


@subkernel
def _put(tool, shares, hand, closing, room, at):
    """Poses of a hand's shapes in the world, its finger joints closed by these shares, are in `at`."""
    closed_by(shares, hand, closing, room)
    seen = room[0]
    for i in range(hand[0].shape[0]):
        matmul(tool[0], seen[0][i], at[0][i])
        moved(tool[0], tool[1], seen[1][i], at[1][i])


@kernel
def stays(tool, shares, hand, closing, kitchens, rest, margins, room):
    """What rules out that a closed hand stays as the container moves: a pair of shapes, or (−1, −1).

    The kitchen is at each value as in `kitchens` (indices, rotations, centres, where each value ends), seen
    from the handle; `rest` is (split, radius, shapes).
    """
    at = np.empty_like(room[0][0]), np.empty_like(room[0][1])
    _put(tool, shares, hand, closing, room, at)
    first = 0
    for last in kitchens[3]:
        there = kitchens[0][first:last], kitchens[1][first:last], kitchens[2][first:last]
        one, other = touching(hand[0], at, there, rest[0], rest[1], rest[2], margins, room[2])
        if one >= 0:
            return one, other
        first = last
    return -1, -1


@kernel
def swings(tool, shares, start, steps, hand, closing, kitchen, rest, margins, room):
    """What rules out that a hand closes from `start` to `shares`, in steps: a pair of shapes, or (−1, −1).

    `margins` are those of a hand that holds, and of an open one.
    """
    at, now = (np.empty_like(room[0][0]), np.empty_like(room[0][1])), np.empty_like(shares)
    for step in range(steps):
        for k in range(shares.shape[0]):
            now[k] = start[k] + (shares[k] - start[k]) * (step / steps)
        _put(tool, now, hand, closing, room, at)
        demanded = margins[1 if step == 0 else 0]
        one, other = touching(hand[0], at, kitchen, rest[0], rest[1], rest[2], demanded, room[2])
        if one >= 0:
            return one, other
    return -1, -1
