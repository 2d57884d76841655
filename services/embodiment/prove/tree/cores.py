"""Cores and solids in a box of joint positions: where they are in its middle, and which are near each other.

Compiled; in floats, not trusted.
"""

import math

import numpy as np

from services.embodiment.body.kernels import matmul, moved
from services.embodiment.prove.tree.across import across
from services.embodiment.prove.tree.inner import meets
from services.kernel import subkernel


@subkernel(makes=True)
def room_for(inner, n):
    """What looking at cores takes, of so many joints.

    Returns:
        Rotations and middles of cores, and of solids; how far these reach from their middles; pairs that are
        kept apart, core by core, and room for those that are near; room for a number for each joint.
    """
    (links, _, _, sizes), (turns, places, halves, _), keeps = inner
    reaches = np.empty(links.shape[0]), np.empty(places.shape[0])
    for half, reach in ((sizes, reaches[0]), (halves, reaches[1])):
        for i in range(half.shape[0]):
            reach[i] = math.sqrt(half[i, 0] ** 2 + half[i, 1] ** 2 + half[i, 2] ** 2)
    kept, count = np.empty((keeps.size, 2), np.int64), 0
    for c in range(keeps.shape[0]):
        for s in range(keeps.shape[1]):
            if keeps[c, s]:
                kept[count, 0], kept[count, 1] = c, s
                count += 1
    where = np.empty((links.shape[0], 3, 3)), np.empty((links.shape[0], 3)), turns.copy(), places.copy()
    return where, reaches, kept[:count], np.empty((count, 2), np.int64), np.empty(n)


@subkernel
def stands(inner, frames, origins, where):
    """Where cores and solids are with the joints in the middle of a box: rotations and middles of both.

    What the world carries is there already.
    """
    (links, turned, placed, _), (turns, places, _, carriers), _ = inner
    for c in range(links.shape[0]):
        matmul(frames[links[c]], turned[c], where[0][c])
        moved(frames[links[c]], origins[links[c]], placed[c], where[1][c])
    for s in range(carriers.shape[0]):
        if carriers[s] >= 0:
            matmul(frames[carriers[s]], turns[s], where[2][s])
            moved(frames[carriers[s]], origins[carriers[s]], places[s], where[3][s])


@subkernel
def close(room):
    """How many pairs there are of which the balls about both meet; they are in `room`, core by core."""
    where, reaches, kept, found, _ = room
    one, other, near = where[1], where[3], 0
    for n in range(kept.shape[0]):
        c, s, away = kept[n, 0], kept[n, 1], 0.0
        for i in range(3):
            away += (one[c, i] - other[s, i]) ** 2
        if away <= (reaches[0][c] + reaches[1][s]) ** 2:
            found[near, 0], found[near, 1] = c, s
            near += 1
    return near


@subkernel(makes=True)
def pierced(joints, frames, inner, room, split, least):
    """(Core that meets or reaches across a solid in the whole box or −1; joint to halve or −1).

    Args:
        joints: As `swing` has them.
        frames: Of the joints in the middle of the box (n, 3, 3).
        inner: As `boxes.divide` has it.
        room: What `room_for` made.
        split: Joint that would be halved, −1 where none is known.
        least: How near to refuting the box is what that joint is halved for.
    """
    stands(inner, frames, joints[1], room[0])
    count = close(room)
    core, other = across(joints, inner, room, count, least)
    split = other if other >= 0 else split
    if core < 0:
        core, other = meets(joints, inner, room, count, split < 0)
        split = other if split < 0 else split
    return core, split
