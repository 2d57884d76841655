"""Branch and bound over an arm's joints and a grasp: boxes in which both do not have the tool at one place.

Compiled. Nothing here is trusted: what it finds is a tree that `proof_check` verifies (`loop.py` there).
"""

import math

import numpy as np

from services.embodiment.body.kernels import matmul, moved
from services.embodiment.prove.tree.boxes import DEEPEST, FOUND, GAVE_UP, LEAF, REACHED, amid, forward, halved
from services.embodiment.prove.tree.cores import close, pierced, room_for
from services.embodiment.prove.tree.inner import sunk
from services.embodiment.prove.tree.stretch import behind, offset
from services.embodiment.prove.tree.swing import FINEST, LEEWAY, TINY, near, swing, turned
from services.kernel import kernel, subkernel

LATER = 0.3  # [1] so much as gaps between places count those between directions: the wrist is halved late
SOON = 0.3  # [1] so near as a gap has to be what a core reaches across, to be halved for
FINEST_TURN = 5e-4  # [rad] halved is not for what turns by no more
ASKEW = 1e-6  # [1] by which directions must differ, so that interval arithmetic finds so too
AXES = 3


@subkernel
def unit(one, other, d):
    """How far a place is from another; the direction from that to it is in d."""
    far = 0.0
    for i in range(3):
        d[i] = one[i] - other[i]
        far += d[i] ** 2
    far = math.sqrt(far)
    for i in range(3):
        d[i] /= max(far, TINY)
    return far


@subkernel
def larger(mine, other, count, room):
    """Joint that adds most, of so many of the arm and then of the grasp's coordinates, and what it adds.

    `mine` is the arm's, `other` the grasp's, as `swing` leaves them in `best`; it is in `room`.
    """
    if other[1] > mine[1]:
        room[0], room[1] = other[0] + count, other[1]
    else:
        room[0], room[1] = mine[0], mine[1]


@subkernel
def axes_apart(frames, arm, bar, off, leeway, spare, best):
    """(Axis that points elsewhere in all of a box or −1; how near; way); joint to halve for it is in best.

    `frames` are how the tool is turned in the middle, by the arm and by the grasp; its axes may be `off`. Of
    how near a gap is, which is wanted with this `leeway`, see `near`.
    """
    d, u, w, mine, other, _ = spare
    nearest, closing, split = 0.0, 0.0, -1.0
    for j in range(AXES):
        for i in range(3):
            u[i], w[i] = frames[0][i, j], frames[1][i, j]
        gap = unit(u, w, d) - off
        if gap <= 0.0:
            continue
        way = turned(u, d, arm[0], arm[2], arm[3], mine) + turned(w, d, bar[0], bar[2], bar[3], other)
        if gap > way + ASKEW:
            return j, 0.0, 0.0
        one = LATER * near(gap, way, leeway)
        if way > FINEST_TURN and one > nearest:
            larger(mine, other, arm[0].shape[0], best)
            nearest, closing, split = one, way, best[0]
    best[0] = split
    return -1, nearest, closing


@subkernel
def end_apart(about, arm, bar, eye, least, leeway, spare, best):
    """(Joint, or n for the end itself, that is too far in all of a box or −1; how near; way).

    Args:
        about: How far the arm reaches to the end from its joints, and how far apart both may have it; where
            the grasp has it in the middle of the box, the arm at the last of its origins; and places of each
            joint's origin in the frame of the joint before.
        arm: Half the widths, origins, axes, hinges and 0.
        bar: The same of the grasp's coordinates.
        eye: No rotation, of one box of no size at no place.
        least: What is no nearer to refuting the box is not told.
        leeway: As `axes_apart` has it.
        spare: Room.
        best: The joint to halve, and what it moves: set where what is told is nearer.
    """
    (reach, off), there, places = about
    d, none, _, mine, other, room = spare
    n = arm[0].shape[0]
    nearest, closing, split = least, 0.0, -1.0
    middles = eye[1]
    for i in range(3):
        middles[0, i], none[i] = there[i], 0.0
    for k in range(n, -1, -1):
        own = 0.0 if k == n else reach[k]
        far = unit(arm[1][k], there, d)
        if far <= off:
            continue
        count = min(k + 1, n)
        nearer = swing(d, there, eye[0][0], none, bar[0].shape[0], bar, other)
        mine[0], mine[1] = -1.0, -1.0
        gap, way = far - own - off, nearer + swing(d, arm[1][k], eye[0][0], none, count, arm, mine)
        larger(mine, other, n, best)
        if gap > 0.0 and (gap > way or best[1] > FINEST):
            one = near(gap, way, leeway)
            if one > 1.0:
                return k, 0.0, 0.0
            if one > nearest:
                nearest, closing, split = one, way, best[0]
        if k < n - 1 and offset(places[k + 1]):
            aim = reach, (eye[0][0], none, none), eye
            target = nearer, other[0] + n, other[1]
            one = behind(k, aim, 0, eye[0][0], places, arm, off, leeway, target, (d, none, room), best)
            if one > 1.0:
                return k, 0.0, 0.0
            if one > nearest:
                nearest, closing, split = one, best[1], best[0]
    best[0] = split
    return -1, nearest, closing


@subkernel
def in_something(arm, bar, frames, solids, rooms, leeway, ratio, way, split):
    """(Core of the arm that meets something solid in all of a box, or behind these one of the hand, or −1).

    Besides the joint to halve.

    Args:
        arm: As `end_apart` has it.
        bar: Likewise.
        frames: Of the joints of both in the middle of the box.
        solids: Of both, as `boxes.divide` has `inner`.
        rooms: What `room_for` made of them.
        leeway: As `axes_apart` has it.
        ratio: How near to refuting the box is what is halved for.
        way: By which that may close.
        split: The joint to halve for it, −1 if there is none.
    """
    n = arm[0].shape[0]
    cores = solids[0][0][0].shape[0]
    least = SOON * ratio * (way + leeway) / (way + LEEWAY)
    if solids[1][0][0].shape[0]:
        mine = split - n if split >= n else -1
        core, other = pierced(bar, frames[1], solids[1], rooms[1], mine, least)
        if core >= 0:
            return cores + core, -1
        if other != mine and (split < 0 or split >= n):
            split = other + n
    if cores:
        mine = split if split < n else 0
        core, other = pierced(arm, frames[0], solids[0], rooms[0], mine, least)
        if core >= 0:
            return core, -1
        split = other if other != mine else split
        _, other = sunk(arm, solids[0], rooms[0], close(rooms[0]), leeway, ratio)
        split = other if other >= 0 else split
    return -1, split


@kernel
def divide_loop(low, high, chains, tool, ends, turned_off, solids, leeway, tree):
    """(FOUND, REACHED or GAVE_UP; how much of `tree` was written).

    Args:
        low: Of the arm's joints, then of the grasp's coordinates.
        high: Likewise.
        chains: The arm's and the bar's, as `boxes.divide` has one.
        tool: Where it is in the last frame of both (rotation, place); where it has the last joint's origin.
        ends: How far the arm reaches to the tool from each joint, and how far apart both may have it; the
            same of the last joint's origin.
        turned_off: How differently both may have an axis of the tool [1].
        solids: What both may meet, as `boxes.divide` has `inner`.
        leeway: Added to how far a gap may close, where one is chosen to halve for [m, rad]. With none boxes
            follow the edge of what one rule refutes, ever smaller; with much they shrink in all coordinates.
        tree: Room for it.
    """
    n, m = chains[0][0].shape[0], chains[1][0].shape[0]
    lows, highs = np.empty((DEEPEST, n + m)), np.empty((DEEPEST, n + m))
    middle, half = np.empty(n + m), np.empty(n + m)
    origins, axes, frames = np.empty((n + 1, 3)), np.empty((n, 3)), np.empty((n, 3, 3))
    starts, ways, turns = np.empty((m, 3)), np.empty((m, 3)), np.empty((m, 3, 3))
    turned_so, step, carried = (np.empty((3, 3)), np.empty((3, 3))), np.empty((3, 3)), np.empty((3, 3))
    there = np.empty((2, 3))
    spare = np.empty(3), np.empty(3), np.empty(3), np.empty(2), np.empty(2), np.empty(2)
    eye, best = (np.eye(3).reshape(1, 3, 3), np.zeros((1, 3)), np.zeros((1, 3))), np.empty(2)
    rooms = room_for(solids[0], n), room_for(solids[1], m)
    for j in range(n + m):
        lows[0, j], highs[0, j] = low[j], high[j]
    depth, written = 1, 0
    while depth > 0:
        depth -= 1
        if written >= tree.shape[0] or depth + 2 >= DEEPEST:
            return GAVE_UP, written
        amid(lows[depth], highs[depth], middle, half)
        forward(middle[:n], chains[0], origins, axes, frames, step, carried)
        forward(middle[n:], chains[1], starts, ways, turns, step, carried)
        matmul(frames[n - 1], tool[0][0], turned_so[0])
        matmul(turns[m - 1], tool[1][0], turned_so[1])
        moved(turns[m - 1], starts[m - 1], tool[1][1], there[0])
        moved(turned_so[1], there[0], tool[2], there[1])
        arm, bar = (half[:n], origins, axes, chains[0][3], 0), (half[n:], starts, ways, chains[1][3], 0)
        code, ratio, way = axes_apart(turned_so, arm, bar, turned_off, leeway, spare, best)
        split = int(best[0])
        code += 2 * n + 2 if code >= 0 else 0
        for e in range(2):
            if code >= 0:
                break
            if e == 0:
                moved(frames[n - 1], origins[n - 1], tool[0][1], origins[n])
            else:
                origins[n] = origins[n - 1]
            about = ends[e], there[e], chains[0][1]
            code, nearer, closing = end_apart(about, arm, bar, eye, ratio, leeway, spare, best)
            code += e * (n + 1) if code >= 0 else 0
            if nearer > ratio:
                split, ratio, way = int(best[0]), nearer, closing
        if code < 0:
            code, split = in_something(arm, bar, (frames, turns), solids, rooms, leeway, ratio, way, split)
            code += 2 * n + 2 + AXES if code >= 0 else 0
        if code >= 0:
            tree[written] = LEAF + code
            written += 1
            continue
        if split < 0:
            return REACHED, written
        tree[written] = split
        written += 1
        halved(lows, highs, depth, split, middle)
        depth += 2
    return FOUND, written
