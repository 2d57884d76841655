"""Branch and bound over joint positions: boxes in which a joint is too far off, or a core meets a solid.

Compiled. Nothing here is trusted: what it finds is a tree that `proof_check` verifies.
"""

import numpy as np

from services.kernel import kernel

FOUND, REACHED, GAVE_UP = 0, 1, 2
"""The tree is whole; some posture reaches; the nodes were spent."""

LEAF = 128
SLACK = 1e-5  # [m] by which a box must be too far, so that interval arithmetic finds so too
DEEPEST = 400  # halvings of one box
FINEST = 1e-4  # [m] a box in which nothing moves by more is not halved: it lies at the edge of the reach
DEEP = 0.004  # [m] less deep in each other, a core and a solid are no reason to halve a box
ROUNDS = 6  # of projections between a core and a solid


@kernel
def forward(q, rotation, translation, axis, turns, origins, axes, frames):
    """Origins, axes (n, 3) and frames (n, 3, 3) of the joints in the world at q are in the outputs."""
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
        for i in range(3):
            origins[k, i], axes[k, i] = p[i], u[i]
            for j in range(3):
                frames[k, i, j] = r[i, j]


@kernel
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


@kernel
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


@kernel
def lever(origins, axes, j, k, turns, upright, level):
    """How far origin k moves for a unit of joint j."""
    if level and j < upright:
        return 0.0 if turns[j] else abs(axes[j, 2])
    if not turns[j]:
        return 1.0
    x, y, z = origins[k] - origins[j]
    a, b, c = axes[j]
    return np.sqrt((y * c - z * b) ** 2 + (z * a - x * c) ** 2 + (x * b - y * a) ** 2)


@kernel
def deepest(turn, place, half, less, solid):
    """A point of a solid (rotation, middle, half extents), and how deep it is in a box less `less`."""
    other, there, room = solid
    point = place.copy()
    for _ in range(ROUNDS):
        seen = turn.T @ (point - place)
        for i in range(3):
            most = max(half[i] - less, 0.0)
            seen[i] = min(max(seen[i], -most), most)
        local = other.T @ (turn @ seen + place - there)
        for i in range(3):
            local[i] = min(max(local[i], -room[i]), room[i])
        point = other @ local + there
    seen = turn.T @ (point - place)
    depth = np.inf
    for i in range(3):
        depth = min(depth, half[i] - abs(seen[i]))
    return point, depth


@kernel
def sway(point, k, origins, axes, turns, half, arms):
    """How far a point moves at most, as link k sees it; what each joint adds is in `arms`."""
    moved = 0.0
    x, y, z = point
    for j in range(k + 1):
        arms[j] = half[j]
        if turns[j]:
            u, v, w = x - origins[j, 0], y - origins[j, 1], z - origins[j, 2]
            a, b, c = axes[j]
            arms[j] *= np.sqrt((v * c - w * b) ** 2 + (w * a - u * c) ** 2 + (u * b - v * a) ** 2)
        moved += arms[j]
    return moved


@kernel
def meets(half, turns, inner, origins, axes, frames, arms, asked):
    """(Core that meets a solid in the whole box or −1; joint to halve where one does in the middle or −1).

    Unless a joint is asked for, cores that move too far to refute the box are not looked at.
    """
    (links, turned, placed, sizes), solids, keeps = inner
    split, most = -1, DEEP
    for c in range(len(links)):
        k = links[c]
        turn = frames[k] @ turned[c]
        place = origins[k] + frames[k] @ placed[c]
        least, radius = sizes[c].min(), np.sqrt((sizes[c] ** 2).sum())
        swayed = sway(place, k, origins, axes, turns, half, arms)
        if not asked and swayed - radius * half[: k + 1].sum() > least:
            continue
        less = min(swayed, least - DEEP)
        for s in range(len(solids[0])):
            if not keeps[c, s]:
                continue
            away = solids[1][s] - place
            if (away**2).sum() > (radius + np.sqrt((solids[2][s] ** 2).sum())) ** 2:
                continue
            point, depth = deepest(turn, place, sizes[c], less, (solids[0][s], solids[1][s], solids[2][s]))
            moved = sway(point, k, origins, axes, turns, half, arms)
            if depth > moved + SLACK:
                return c, -1
            if depth > most:
                most, split = depth, arms[: k + 1].argmax()
    return -1, split


@kernel
def look(low, high, chain, reach, upright, tool, boxes, level, slack, arms, origins, axes, frames):
    """(What is too far in the whole box, a joint or n for the fingers, or −1; joint to halve or −1).

    Both are −1 where the middle may reach. `tool` is the grasp box in the last frame: rotation, middle,
    half extents.
    """
    n = len(low)
    middle, half = (low + high) / 2, (high - low) / 2
    forward(middle, chain[0], chain[1], chain[2], chain[3], origins[:n], axes, frames)
    last = frames[n - 1]
    tip = origins[n - 1] + last @ tool[1]
    origins[n, 0], origins[n, 1], origins[n, 2] = tip[0], tip[1], tip[2]
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


@kernel
def divide(low, high, chain, reach, upright, tool, boxes, level, slack, inner, tree):
    """(FOUND, REACHED or GAVE_UP; how much of `tree` was written).

    `inner` is cores (link, rotation, middle, half extents), solids (rotation, middle, half extents), and
    which of these are kept apart.
    """
    n = len(low)
    lows, highs = np.empty((DEEPEST, n)), np.empty((DEEPEST, n))
    arms, origins, axes, frames = np.empty(n), np.empty((n + 1, 3)), np.empty((n, 3)), np.empty((n, 3, 3))
    for j in range(n):
        lows[0, j], highs[0, j] = low[j], high[j]
    depth, written = 1, 0
    while depth > 0:
        depth -= 1
        if written >= len(tree) or depth + 2 >= DEEPEST:
            return GAVE_UP, written
        a, b = lows[depth].copy(), highs[depth].copy()
        far, split = look(a, b, chain, reach, upright, tool, boxes, level, slack, arms, origins, axes, frames)
        if far < 0 and len(inner[0][0]):
            core, other = meets((b - a) / 2, chain[3], inner, origins, axes, frames, arms, split < 0)
            far, split = n + 1 + core if core >= 0 else -1, other if split < 0 else split
        if far >= 0:
            tree[written] = LEAF + far
            written += 1
            continue
        if split < 0:
            return REACHED, written
        tree[written] = split
        written += 1
        middle = (a[split] + b[split]) / 2
        for j in range(n):
            lows[depth, j], highs[depth, j] = a[j], b[j]
            lows[depth + 1, j], highs[depth + 1, j] = a[j], b[j]
        lows[depth, split] = middle
        highs[depth + 1, split] = middle
        depth += 2
    return FOUND, written


def warm() -> None:
    """`divide` has run once, with the types in which it is used."""
    turn, zero, one = np.eye(3)[None], np.zeros((1, 3)), np.zeros(1)
    chain = turn, zero, zero, np.zeros(1, np.bool_)
    tool, boxes = (np.eye(3), np.zeros(3), np.zeros(3)), (turn, zero, zero)
    inner = (np.zeros(1, np.int64), turn, zero, zero), boxes, np.ones((1, 1), np.bool_)
    divide(one, one, chain, one, 0, tool, boxes, False, 0.0, inner, np.zeros(1, dtype=np.uint8))
