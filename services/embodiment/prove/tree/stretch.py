"""How far the grasp box can be from a joint in a box of positions: what is behind that joint may be bent.

Compiled; in floats, not trusted. Derived in `proof_check/stretch.py`.
"""

import math

from services.embodiment.prove.tree.swing import FINEST, TINY, along, near, swing, toward
from services.kernel import subkernel


@subkernel
def offset(place):
    """Whether a joint's origin is elsewhere than that of the joint before."""
    return abs(place[0]) + abs(place[1]) + abs(place[2]) > 0.0


@subkernel
def farthest(length, d, turn, own, ahead, aside):
    """How far off a box is whose middle is so far along d, if it may move on and aside by so much."""
    most, whole = 0.0, own[0] ** 2 + own[1] ** 2 + own[2] ** 2
    for n in range(8):
        at = 0.0
        for k in range(3):
            part = own[k] * (d[0] * turn[0, k] + d[1] * turn[1, k] + d[2] * turn[2, k])
            at += part if n >> k & 1 else -part
        beside = math.sqrt(max(whole - at * at, 0.0)) + aside
        most = max(most, (length + at + ahead) ** 2 + beside * beside)
    return math.sqrt(most)


@subkernel
def behind(k, aim, b, turn, places, joints, slack, leeway, target, room, best):
    """How near to refuted a box is by joint k, farther from box b of the handle than its arm comes.

    That comes to the grasp box as it is bent there, or to another joint's origin, and from that one as far as
    it ever does. The joint to halve and the way by which the gap may close are in `best`; `turn` is of the
    grasp box, whose middle is the last of the origins, and `places` are those of each joint's origin in the
    frame of the joint before. `target` is how far box b itself may come nearer, the coordinate that moves it
    most, and how far that does; of how near a gap is, which is wanted with this leeway, see `near`.
    """
    reach, tool, (turns, middles, sizes) = aim
    d, none, other = room
    half, origins, axes, hinges, _ = joints
    n, nearest = half.shape[0], 0.0
    far = toward(origins[k], turns[b], middles[b], sizes[b], d)
    if far <= 0.0:
        return 0.0
    nearer = swing(d, origins[k], turns[b], none, k + 1, joints, other) + target[0]
    before, widest = other[0], other[1]
    if target[2] > widest:
        before, widest = target[1], target[2]
    for m in range(k + 2, n + 1):
        if m < n and not offset(places[m]):
            continue  # that joint reaches no farther than the one before
        own, more = (none, reach[m]) if m < n else (tool[2], 0.0)
        length = 0.0
        for i in range(3):
            d[i] = origins[m, i] - origins[k, i]
            length += d[i] * d[i]
        length = math.sqrt(length)
        for i in range(3):
            d[i] /= max(length, TINY)
        start = farthest(length, d, turn, own, 0.0, 0.0)
        gap = far - start - more - slack
        if gap <= 0.0:
            continue
        split, most, up, out, turned = before, widest, 0.0, 0.0, 0.0
        for j in range(k + 1, min(m + 1, n)):
            first, whole = abs(d[0] * axes[j, 0] + d[1] * axes[j, 1] + d[2] * axes[j, 2]), 1.0
            if hinges[j]:
                first, whole = along(d, origins[m], turn, own, axes[j], origins[j])
                turned += half[j] / 2
            one = min(whole, first + whole * turned) * half[j]
            if hinges[j]:
                turned += half[j] / 2
            side = whole * half[j]
            share = one + side * (out + side / 2) / max(start, TINY)
            up, out = up + one, out + side
            if share > most:
                split, most = j, share
        way = nearer + farthest(length, d, turn, own, up, out) - start
        if most <= FINEST and gap <= way:
            continue
        ratio = near(gap, way, leeway)
        if ratio > nearest:
            nearest, best[0], best[1] = ratio, split, way
    return nearest
