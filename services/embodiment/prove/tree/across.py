"""Where a core of the robot reaches across something solid in all of a box of joint positions.

A plate is a solid seen along its shortest side. A chord of a core that has one end on each side of a plane of
the plate crosses that, wherever the joints are, if its ends stay there; where it does so is in the plate, if
what lies between the ends is. So nothing has to stay *in* a panel, which may be a few millimetres thick.

Compiled; in floats, not trusted.
"""

import math

import numpy as np

from services.embodiment.prove.tree.inner import SLACK, into, parted, sway
from services.embodiment.prove.tree.swing import FINEST, LEEWAY, extent, near
from services.kernel import subkernel

SHARES = (2.0, 1.4, 1.0, 0.7, 0.4, 0.2, 0.0)
"""Of how far a core sways along a plate, and `LEEWAY`: so far from its rim a chord is, if any is there."""
PARTLY = 0.25  # [1] of how far a core sways at most, it is taken to do so across a plate at least
WIDER = 0.5  # [1] of how far the middle of a core moves, its ends are taken to do so at least


@subkernel
def shortest(half):
    """Index of the shortest side."""
    k = 0
    for i in range(1, 3):
        if half[i] < half[k]:
            k = i
    return k


@subkernel
def upright(core, plate, n, less, ends):
    """Whether a line across a plate, far from its rim and near a core's middle, meets that; ends: where."""
    turn, place, half = core
    sides, there, sizes = plate
    for share in SHARES:
        low, high = -np.inf, np.inf
        for i in range(3):
            ends[0, i] = place[i]
        for j in range(3):
            if j == n:
                continue
            at, room = 0.0, max(sizes[j] - share * less[j], 0.0)
            for i in range(3):
                at += sides[i, j] * (place[i] - there[i])
            for i in range(3):
                ends[0, i] += sides[i, j] * (min(max(at, -room), room) - at)
        for m in range(3):
            at, way = 0.0, 0.0
            for i in range(3):
                at += turn[i, m] * (ends[0, i] - place[i])
                way += turn[i, m] * sides[i, n]
            if abs(way) > SLACK:
                one, other = (-half[m] - at) / way, (half[m] - at) / way
                low, high = max(low, min(one, other)), min(high, max(one, other))
            elif abs(at) > half[m]:
                low = np.inf
        if low < high:
            for i in range(3):
                ends[1, i] = ends[0, i] + high * sides[i, n]
                ends[0, i] += low * sides[i, n]
            return True
    return False


@subkernel
def slanting(core, plate, n, ends):
    """The diagonal of a core from the corner that is lowest across a plate to the one that is highest."""
    turn, place, half = core
    for i in range(3):
        ends[0, i], ends[1, i] = place[i], place[i]
    for m in range(3):
        way = 0.0
        for i in range(3):
            way += turn[i, m] * plate[0][i, n]
        for i in range(3):
            off = math.copysign(half[m], way) * turn[i, m]
            ends[0, i], ends[1, i] = ends[0, i] - off, ends[1, i] + off


@subkernel
def ways_of(point, count, turn, joints, ways, most):
    """How far a point that so many joints carry moves along each axis of a frame; which adds most is in most.

    As `swing` says it of one direction.
    """
    half, origins, axes, turns, _ = joints
    turned = 0.0
    for i in range(3):
        ways[i], most[i], most[i + 3] = 0.0, -1.0, -1.0
    for j in range(count):
        a, b, c, whole = axes[j, 0], axes[j, 1], axes[j, 2], 1.0
        if turns[j]:
            x, y, z = point[0] - origins[j, 0], point[1] - origins[j, 1], point[2] - origins[j, 2]
            a, b, c = b * z - c * y, c * x - a * z, a * y - b * x
            whole = math.sqrt(a * a + b * b + c * c)
        second = whole * (half[j] / 2 + turned) if turns[j] else turned
        for i in range(3):
            one = half[j] * min(whole, abs(turn[0, i] * a + turn[1, i] * b + turn[2, i] * c) + second)
            ways[i] += one
            if one > most[i + 3]:
                most[i], most[i + 3] = j, one
        if turns[j]:
            turned += half[j]


@subkernel
def crosses(n, half, spreads):
    """(How near to refuted a box is by a chord whose ends are on both sides along side n; joint to halve)."""
    at, ways, most = spreads
    total = ways[0, n] + ways[1, n]
    level = (at[0, n] + at[1, n]) / 2
    if total > 0.0:
        level = (at[0, n] * ways[1, n] + at[1, n] * ways[0, n]) / total
    level = min(max(level, SLACK - half[n]), half[n] - SLACK)
    below, above = level - at[0, n] - SLACK, at[1, n] - level - SLACK
    worst, split = near(below, ways[0, n], LEEWAY), most[0, n]
    one = near(above, ways[1, n], LEEWAY)
    if one < worst:
        worst, split = one, most[1, n]
    if worst <= 0.0:
        return 0.0, -1.0
    first, last = 0.0, 1.0  # of the way from end to end, where the level may be
    if worst > 1.0:
        low, high = at[0, n] - ways[0, n], at[0, n] + ways[0, n]
        first = (level - high) / (at[1, n] + ways[1, n] - high)
        last = (level - low) / (at[1, n] - ways[1, n] - low)
    amid = (level - at[0, n]) / (at[1, n] - at[0, n])
    for i in range(3):
        if i == n:
            continue
        e = 0 if ways[0, i] > ways[1, i] else 1
        for sign in (-1.0, 1.0):
            here = sign * ((1 - amid) * at[0, i] + amid * at[1, i])
            most_far = here
            for share in (first, last):
                far = sign * ((1 - share) * at[0, i] + share * at[1, i])
                most_far = max(most_far, far + (1 - share) * ways[0, i] + share * ways[1, i])
            one = near(half[i] - here - SLACK, most_far - here, LEEWAY)
            if one < worst:
                worst, split = one, most[e, i]
    return max(worst, 0.0), split


@subkernel(makes=True)
def across(joints, inner, room, count, least):
    """(Core that reaches across a solid in the whole box or −1; joint to halve or −1).

    All is as `meets` has it. What robots carry is no plate. Only what is nearer to refuting the box than
    `least` is looked for.
    """
    half, origins, axes, hinges, _ = joints
    (links, _, _, sizes), (_, _, halves, carriers), _ = inner
    where, (radii, _), _, pairs, arms = room
    point, ends, rim, at = np.empty(3), np.empty((2, 3)), np.empty(3), np.empty((2, 3))
    ways, most, spreads = np.empty(3), np.empty(6), (at, np.empty((2, 3)), np.empty((2, 6)))
    nearest, split, seen, swayed = least, -1, -1, 0.0
    for p in range(count):
        c, s = pairs[p, 0], pairs[p, 1]
        if carriers[s] >= 0:
            continue
        k, place, radius = links[c], where[1][c], radii[c]
        plate, n = (where[2][s], where[3][s], halves[s]), shortest(halves[s])
        if parted(place, radius, plate, point):
            continue
        if seen != c:
            swayed, seen = sway(place, 0, k, origins, axes, hinges, half, arms), c
        if radius <= nearest * (PARTLY * swayed + LEEWAY):
            continue
        for i in range(3):
            point[i] = plate[0][i, n]
        reach, off = extent(point, where[0][c], sizes[c]), 0.0
        for i in range(3):
            off += point[i] * (place[i] - plate[1][i])
        if abs(off) >= reach + halves[s, n]:
            continue
        ways_of(place, k + 1, plate[0], joints, ways, most)
        if reach <= nearest * (WIDER * ways[n] + LEEWAY):
            continue
        for i in range(3):
            rim[i] = ways[i] + LEEWAY
        core = where[0][c], place, sizes[c]
        for kind in range(2):
            if kind == 0 and not upright(core, plate, n, rim, ends):
                continue
            if kind == 1:
                slanting(core, plate, n, ends)
            largest = 0.0
            for e in range(2):
                into(plate[0], plate[1], ends[e], at[e])
                ways_of(ends[e], k + 1, plate[0], joints, spreads[1][e], spreads[2][e])
                for i in range(3, 6):
                    largest = max(largest, spreads[2][e, i])
            one, joint = crosses(n, halves[s], spreads)
            if one > 1.0:
                return c, -1
            if one > nearest and largest > FINEST:
                nearest, split = one, int(joint)
    return -1, split
