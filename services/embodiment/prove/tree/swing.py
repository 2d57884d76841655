"""How far what joints carry moves in a box of their positions, and how near that is to refuting the box.

Compiled; in floats, not trusted.
"""

import math

from services.kernel import subkernel

FINEST = 1e-4
"""[m] A box in which nothing moves by more is not halved for that: it lies at the edge of the reach."""
LEEWAY = 0.02
"""[m] That is added to how far a gap may close, where one is chosen that is to refute a box."""
TINY = 1e-300  # in place of 0, by which nothing can be divided


@subkernel
def extent(d, turn, half):
    """How far a box reaches from its middle along d."""
    reach = 0.0
    for k in range(3):
        reach += abs(d[0] * turn[0, k] + d[1] * turn[1, k] + d[2] * turn[2, k]) * half[k]
    return reach


@subkernel
def toward(point, turn, place, half, d):
    """Distance of a point from a box; the unit direction from the box to it is in d."""
    far = 0.0
    for i in range(3):
        d[i] = 0.0
    for k in range(3):
        local = 0.0
        for i in range(3):
            local += turn[i, k] * (point[i] - place[i])
        beyond = math.copysign(max(abs(local) - half[k], 0.0), local)
        far += beyond * beyond
        for i in range(3):
            d[i] += turn[i, k] * beyond
    far = math.sqrt(far)
    for i in range(3):
        d[i] /= max(far, TINY)
    return far


@subkernel
def near(gap, way, leeway):
    """Above 1 if a gap stays, which can close by so much; else how near to that a few halvings are.

    A gap of a millimetre that may close by two is half of it, too, but lies at the edge of what it refutes:
    halved for it, boxes become ever smaller along that edge. One of centimetres is better halved for.
    """
    return gap / max(way, TINY) if gap > way else gap / max(way + leeway, TINY)


@subkernel
def along(d, point, turn, own, a, o):
    """How far a point, and a box about it, moves for a unit of a hinge: first order along d, and in all."""
    x, y, z = point[0] - o[0], point[1] - o[1], point[2] - o[2]
    u, v, w = a[1] * z - a[2] * y, a[2] * x - a[0] * z, a[0] * y - a[1] * x
    whole, first = math.sqrt(u * u + v * v + w * w), abs(d[0] * u + d[1] * v + d[2] * w)
    radius = own[0] ** 2 + own[1] ** 2 + own[2] ** 2
    if radius > 0.0:
        u, v, w = d[1] * a[2] - d[2] * a[1], d[2] * a[0] - d[0] * a[2], d[0] * a[1] - d[1] * a[0]
        for k in range(3):
            first += abs(u * turn[0, k] + v * turn[1, k] + w * turn[2, k]) * own[k]
    return first, whole + math.sqrt(radius)


@subkernel
def swing(d, point, turn, own, count, joints, best):
    """How far a box that so many joints carry moves along d at most; the joint that adds most is in best.

    `joints` are half the widths, origins, axes, which are hinges, and how many only lift: of heights alone.
    """
    half, origins, axes, turns, upright = joints
    total, turned, most = 0.0, 0.0, -1.0
    for j in range(count):
        if j < upright:
            one = 0.0 if turns[j] else abs(axes[j, 2])
        elif turns[j]:
            first, whole = along(d, point, turn, own, axes[j], origins[j])
            one = min(whole, first + whole * (half[j] / 2 + turned))
        else:
            one = min(1.0, abs(d[0] * axes[j, 0] + d[1] * axes[j, 1] + d[2] * axes[j, 2]) + turned)
        if turns[j]:
            turned += half[j]
        one *= half[j]
        total += one
        if one > most:
            most, best[0] = one, j
    best[1] = most
    return total


@subkernel
def turned(u, d, half, axes, hinges, best):
    """How much of a direction u along d all joints turn at most [1]; the joint that adds most is in best."""
    total, before, most = 0.0, 0.0, -1.0
    best[0] = -1.0
    for j in range(half.shape[0]):
        if not hinges[j]:
            continue
        x = axes[j, 1] * u[2] - axes[j, 2] * u[1]
        y = axes[j, 2] * u[0] - axes[j, 0] * u[2]
        z = axes[j, 0] * u[1] - axes[j, 1] * u[0]
        whole, first = math.sqrt(x * x + y * y + z * z), abs(d[0] * x + d[1] * y + d[2] * z)
        one = min(whole, first + whole * (half[j] / 2 + before)) * half[j]
        before += half[j]
        total += one
        if one > most:
            most, best[0] = one, j
    best[1] = most
    return total


@subkernel
def refutes(gap, d, point, turn, own, count, joints, best, room):
    """Gap along d, over how far it can close; 0 where there is none. In best: joint to halve, that way."""
    if gap <= 0.0:
        return 0.0
    way = swing(d, point, turn, own, count, joints, room)
    if room[1] <= FINEST and gap <= way:
        return 0.0
    best[0], best[1] = room[0], way
    return gap / max(way, TINY)
