"""Where a core of the robot meets something solid in all of a box of joint positions.

Compiled; in floats, not trusted.
"""

import math

import numpy as np

from services.embodiment.body.kernels import moved
from services.kernel import subkernel

SLACK = 1e-5  # [m] by which a box must be refuted, so that interval arithmetic finds so too
DEEP = 0.004  # [m] less deep in each other, a core and a solid are no reason to halve a box
MOSTLY = 0.5  # [1] of how far a core sways at most: it rarely goes less far along each of its own axes
SUNK = 3.0  # [1] so much more than its gap counts how deep a core is, where a joint to halve is chosen
ROUNDS = 100  # of projections between a core and a solid, at most
STILL = 1e-7  # [m] by which a point moves that stands still
LEAP = 6  # projections after which the way that is left is taken at once
FARTHEST = 0.5  # [m] of that


@subkernel
def into(r, p, point, out):
    """A point of the world is in `out`, in the frame (r, p)."""
    x, y, z = point[0] - p[0], point[1] - p[1], point[2] - p[2]
    for i in range(3):
        out[i] = r[0, i] * x + r[1, i] * y + r[2, i] * z


@subkernel
def deepest(box, less, solid, point, local):
    """How deep a point of a solid lies in a box; it is looked for where that is smaller by `less` (3,).

    Both are rotation, middle, half extents; the point is in `point`.
    """
    turn, place, half = box
    for i in range(3):
        point[i] = place[i]
    last = 0.0
    for n in range(ROUNDS):
        x, y, z = point[0], point[1], point[2]
        into(turn, place, point, local)
        for i in range(3):
            most = max(half[i] - less[i], 0.0)
            local[i] = min(max(local[i], -most), most)
        moved(turn, place, local, point)
        into(solid[0], solid[1], point, local)
        for i in range(3):
            local[i] = min(max(local[i], -solid[2][i]), solid[2][i])
        moved(solid[0], solid[1], local, point)
        x, y, z = point[0] - x, point[1] - y, point[2] - z
        step = math.sqrt(x * x + y * y + z * z)
        if step < STILL:
            break
        if n % LEAP == LEAP - 1 and step < last:  # between two faces each step is a share of the one before
            far = min(step / (last - step), FARTHEST / step)
            point[0], point[1], point[2] = point[0] + x * far, point[1] + y * far, point[2] + z * far
        last = step
    into(solid[0], solid[1], point, local)
    for i in range(3):
        local[i] = min(max(local[i], -solid[2][i]), solid[2][i])
    moved(solid[0], solid[1], local, point)
    into(turn, place, point, local)
    depth = math.inf
    for i in range(3):
        depth = min(depth, half[i] - abs(local[i]))
    return depth


@subkernel
def sway(point, first, k, origins, axes, turns, half, arms):
    """How far joints from `first` on move a point at most, as link k sees it; what each adds is in `arms`."""
    total = 0.0
    for j in range(first, k + 1):
        arms[j] = half[j]
        if turns[j]:
            u, v, w = point[0] - origins[j, 0], point[1] - origins[j, 1], point[2] - origins[j, 2]
            a, b, c = axes[j, 0], axes[j, 1], axes[j, 2]
            x, y, z = v * c - w * b, w * a - u * c, u * b - v * a
            arms[j] *= math.sqrt(x * x + y * y + z * z)
        total += arms[j]
    return total


@subkernel
def stays(point, first, k, box, origins, axes, turns, half, arms, lost):
    """How deep a point stays in a box (rotation, middle, half extents), with what `sway` left in arms.

    How far it moves along each axis is in `lost`.
    """
    turn, place, sizes = box
    depth = math.inf
    for i in range(3):
        inside, behind = 0.0, 0.0
        for m in range(3):
            inside += turn[m, i] * (point[m] - place[m])
        inside, lost[i] = sizes[i] - abs(inside), 0.0
        for j in range(k, first - 1, -1):
            a, b, c = axes[j, 0], axes[j, 1], axes[j, 2]
            if turns[j]:
                u, v, w = point[0] - origins[j, 0], point[1] - origins[j, 1], point[2] - origins[j, 2]
                a, b, c = b * w - c * v, c * u - a * w, a * v - b * u
            one = half[j] * abs(turn[0, i] * a + turn[1, i] * b + turn[2, i] * c)
            if turns[j]:
                lost[i] += min(arms[j], one + arms[j] * (half[j] / 2 + behind))
                behind += half[j]
            else:
                lost[i] += min(arms[j], one + arms[j] * behind)
        depth = min(depth, inside - lost[i])
    return depth


@subkernel
def sways(k, half, arms, swayed, turned):
    """What joints from j on sway and turn is in swayed[j], turned[j], given each one's share."""
    swayed[k + 1], turned[k + 1] = 0.0, 0.0
    for j in range(k, -1, -1):
        swayed[j], turned[j] = swayed[j + 1] + arms[j], turned[j + 1] + half[j]


@subkernel
def parted(point, radius, solid, local):
    """Whether a ball is apart from a solid (rotation, middle, half extents)."""
    into(solid[0], solid[1], point, local)
    away = 0.0
    for i in range(3):
        away += max(abs(local[i]) - solid[2][i], 0.0) ** 2
    return away > radius**2


@subkernel(makes=True)
def meets(joints, inner, room, count, asked):
    """(Core that meets a solid in the whole box or −1; joint to halve where one does in the middle or −1).

    Unless a joint is asked for, cores that move too far to refute the box are not looked at. `joints` are as
    `swing` has them, `inner` as `boxes.divide` has it, `room` as `cores` has it; so many pairs are close.
    """
    half, origins, axes, turns, _ = joints
    (links, _, _, sizes), (_, _, halves, carriers), _ = inner
    where, (radii, _), _, pairs, arms = room
    point, local, lost = np.empty(3), np.empty(3), np.empty(3)
    swayed, widths = np.empty(half.shape[0] + 1), np.empty(half.shape[0] + 1)
    split, most, seen = -1, DEEP, -1
    for n in range(count):
        c, s = pairs[n, 0], pairs[n, 1]
        k, place, solid = links[c], where[1][c], (where[2][s], where[3][s], halves[s])
        if parted(place, radii[c], solid, local):
            continue
        if seen != c:
            sway(place, 0, k, origins, axes, turns, half, arms)
            sways(k, half, arms, swayed, widths)
            seen = c
        first, least = carriers[s] + 1, min(sizes[c, 0], sizes[c, 1], sizes[c, 2])
        if not asked and MOSTLY * (swayed[first] - radii[c] * widths[first]) > least:
            continue
        for i in range(3):
            lost[i] = min(swayed[first], least - DEEP)
        core = where[0][c], place, sizes[c]
        depth = deepest(core, lost, solid, point, local)
        if depth <= SLACK:
            continue
        for again in range(2):  # less deep where it moves less
            if again and deepest(core, lost, solid, point, local) <= SLACK:
                break
            sway(point, first, k, origins, axes, turns, half, arms)
            if stays(point, first, k, core, origins, axes, turns, half, arms, lost) > SLACK:
                return c, -1
        if depth > most:
            most, split = depth, first
            for j in range(first, k + 1):
                if arms[j] > arms[split]:
                    split = j
    return -1, split


@subkernel(makes=True)
def sunk(joints, inner, room, count, leeway, least):
    """(How near to refuted a box is by a core deep in a solid in its middle; joint to halve or −1).

    All is as `meets` has it; only what is nearer than `least` is looked for.
    """
    half, origins, axes, turns, _ = joints
    (links, _, _, sizes), (_, _, halves, carriers), _ = inner
    where, (radii, _), _, pairs, arms = room
    point, local, none = np.empty(3), np.empty(3), np.zeros(3)
    nearest, split = least, -1
    for n in range(count):
        c, s = pairs[n, 0], pairs[n, 1]
        k, place, solid = links[c], where[1][c], (where[2][s], where[3][s], halves[s])
        first, most = carriers[s] + 1, min(sizes[c, 0], sizes[c, 1], sizes[c, 2])
        if parted(place, radii[c], solid, local):
            continue
        if SUNK * most <= nearest * (
            MOSTLY * sway(place, first, k, origins, axes, turns, half, arms) + leeway
        ):
            continue
        depth = deepest((where[0][c], place, sizes[c]), none, solid, point, local)
        if depth <= DEEP:
            continue
        one = SUNK * depth / (sway(point, first, k, origins, axes, turns, half, arms) + leeway)
        if one > nearest:
            nearest, split = one, first
            for j in range(first, k + 1):
                if arms[j] > arms[split]:
                    split = j
    return nearest, split
