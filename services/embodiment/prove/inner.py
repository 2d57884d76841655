"""Where a core of the robot meets something solid in all of a box of joint positions.

Compiled; in floats, not trusted.
"""

import math

import numpy as np

from services.embodiment.body.kernels import matmul, moved
from services.kernel import kernel

SLACK = 1e-5  # [m] by which a box must be refuted, so that interval arithmetic finds so too
DEEP = 0.004  # [m] less deep in each other, a core and a solid are no reason to halve a box
ROUNDS = 6  # of projections between a core and a solid


@kernel
def into(r, p, point, out):
    """A point of the world is in `out`, in the frame (r, p)."""
    x, y, z = point[0] - p[0], point[1] - p[1], point[2] - p[2]
    for i in range(3):
        out[i] = r[0, i] * x + r[1, i] * y + r[2, i] * z


@kernel
def deepest(turn, place, half, less, solid, s, point, local):
    """How deep a point of solid s is in a box less `less`; the point is in `point`."""
    for i in range(3):
        point[i] = place[i]
    for _ in range(ROUNDS):
        into(turn, place, point, local)
        for i in range(3):
            most = max(half[i] - less, 0.0)
            local[i] = min(max(local[i], -most), most)
        moved(turn, place, local, point)
        into(solid[0][s], solid[1][s], point, local)
        for i in range(3):
            local[i] = min(max(local[i], -solid[2][s, i]), solid[2][s, i])
        moved(solid[0][s], solid[1][s], local, point)
    into(turn, place, point, local)
    depth = math.inf
    for i in range(3):
        depth = min(depth, half[i] - abs(local[i]))
    return depth


@kernel
def sway(point, k, origins, axes, turns, half, arms):
    """How far a point moves at most, as link k sees it; what each joint adds is in `arms`."""
    total = 0.0
    for j in range(k + 1):
        arms[j] = half[j]
        if turns[j]:
            u, v, w = point[0] - origins[j, 0], point[1] - origins[j, 1], point[2] - origins[j, 2]
            a, b, c = axes[j, 0], axes[j, 1], axes[j, 2]
            x, y, z = v * c - w * b, w * a - u * c, u * b - v * a
            arms[j] *= math.sqrt(x * x + y * y + z * z)
        total += arms[j]
    return total


@kernel
def meets(half, turns, inner, origins, axes, frames, arms, asked):
    """(Core that meets a solid in the whole box or −1; joint to halve where one does in the middle or −1).

    Unless a joint is asked for, cores that move too far to refute the box are not looked at. `inner` is as
    `boxes.divide` has it.
    """
    (links, turned, placed, sizes), solids, keeps = inner
    turn, place, point, local = np.empty((3, 3)), np.empty(3), np.empty(3), np.empty(3)
    split, most = -1, DEEP
    for c in range(links.shape[0]):
        k = links[c]
        moved(frames[k], origins[k], placed[c], place)
        least = min(sizes[c, 0], sizes[c, 1], sizes[c, 2])
        radius = math.sqrt(sizes[c, 0] ** 2 + sizes[c, 1] ** 2 + sizes[c, 2] ** 2)
        swayed, width = sway(place, k, origins, axes, turns, half, arms), 0.0
        for j in range(k + 1):
            width += half[j]
        if not asked and swayed - radius * width > least:
            continue
        matmul(frames[k], turned[c], turn)
        less = min(swayed, least - DEEP)
        for s in range(solids[1].shape[0]):
            if not keeps[c, s]:
                continue
            away = 0.0
            for i in range(3):
                away += (solids[1][s, i] - place[i]) ** 2
            if away > (radius + solids[3][s]) ** 2:
                continue
            depth = deepest(turn, place, sizes[c], less, solids, s, point, local)
            if depth <= SLACK:
                continue
            if depth > sway(point, k, origins, axes, turns, half, arms) + SLACK:
                return c, -1
            if depth > most:
                most, split = depth, 0
                for j in range(k + 1):
                    if arms[j] > arms[split]:
                        split = j
    return -1, split
