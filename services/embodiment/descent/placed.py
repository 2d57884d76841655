"""Compiled inner loops of a descent: where a handle is between fingers, and how far a tool is off a pose."""

import math

from services.kernel import subkernel

ANGLE = 0.1  # [m] what one radian counts as
TURNED = math.radians(24)  # [rad] between a face and the way in which fingers close, at most


@subkernel
def _dot(a, b):
    """Product of two vectors (3,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@subkernel
def _across(ax, ay, az, rates, k):
    """How the product of an arm with the turn of variable k goes, the arm from the left."""
    u, v, w = rates[3, k], rates[4, k], rates[5, k]
    return ay * w - az * v, az * u - ax * w, ax * v - ay * u


@subkernel
def _turned(r, normal, rates, values, rows, count):
    """By how much a face is turned too far from how fingers close [m], if it is, as one row more."""
    cx, cy, cz = r[0, 1], r[1, 1], r[2, 1]
    along = min(max(cx * normal[0] + cy * normal[1] + cz * normal[2], -1.0), 1.0)
    angle = math.acos(along)
    if angle <= TURNED:
        return count
    x, y, z = (
        normal[1] * cz - normal[2] * cy,
        normal[2] * cx - normal[0] * cz,
        normal[0] * cy - normal[1] * cx,
    )
    size = math.sqrt(x * x + y * y + z * z)
    if size > 1e-9:
        x, y, z = x / size, y / size, z / size
    else:
        x, y, z = r[0, 0], r[1, 0], r[2, 0]
    values[count] = ANGLE * (angle - TURNED)
    for k in range(rates.shape[1]):
        rows[count, k] = ANGLE * (x * rates[3, k] + y * rates[4, k] + z * rates[5, k])
    return count + 1


@subkernel
def pinched(r, p, rates, part, pads, values, rows):
    """How far a part's face is from the middle of the fingers [m], and its normal from how they close.

    Args:
        r: Rotation of the tool in the world.
        p: Its place there.
        rates: Of both, linear over angular, shape (6, n).
        part: Direction and middle of a line in the world (3,), a face's normal (3,), and how far that goes
            from the middle, along the line and across it [m].
        pads: Middle and corners of the room between the fingers, as the tool sees it, (3,) each [m].
        values: What is lacked is written to, shape (4 or more,).
        rows: And how that changes with each variable, shape (4 or more, n).

    Returns:
        How many rows there are.
    """
    (along, centre, normal, half, wide), (middle, low, high) = part, pads
    bx, by, bz = (
        r[0, 0] * middle[0] + r[0, 1] * middle[1] + r[0, 2] * middle[2],
        r[1, 0] * middle[0] + r[1, 1] * middle[1] + r[1, 2] * middle[2],
        r[2, 0] * middle[0] + r[2, 1] * middle[1] + r[2, 2] * middle[2],
    )
    sx, sy, sz = (
        normal[1] * along[2] - normal[2] * along[1],
        normal[2] * along[0] - normal[0] * along[2],
        normal[0] * along[1] - normal[1] * along[0],
    )
    x, y, z = p[0] + bx - centre[0], p[1] + by - centre[1], p[2] + bz - centre[2]
    there, beside = x * along[0] + y * along[1] + z * along[2], x * sx + y * sy + z * sz
    at, off = min(max(there, -half), half), min(max(beside, -wide), wide)
    x, y, z = (
        centre[0] + at * along[0] + off * sx - p[0],
        centre[1] + at * along[1] + off * sy - p[1],
        centre[2] + at * along[2] + off * sz - p[2],
    )
    goes, slides, count = abs(there) < half, abs(beside) < wide, 0
    for i in range(3):
        seen = r[0, i] * x + r[1, i] * y + r[2, i] * z
        aim = min(max(seen, low[i]), high[i]) if i != 1 else 0.0
        if seen == aim:
            continue
        values[count] = seen - aim
        for k in range(rates.shape[1]):
            u, v, w = _across(x, y, z, rates, k)
            u, v, w = u - rates[0, k], v - rates[1, k], w - rates[2, k]
            if goes or slides:  # the place on the face goes with the fingers
                a, b, c = _across(bx, by, bz, rates, k)
                a, b, c = rates[0, k] - a, rates[1, k] - b, rates[2, k] - c
                far = along[0] * a + along[1] * b + along[2] * c if goes else 0.0
                aside = sx * a + sy * b + sz * c if slides else 0.0
                u, v, w = (
                    u + far * along[0] + aside * sx,
                    v + far * along[1] + aside * sy,
                    w + far * along[2] + aside * sz,
                )
            rows[count, k] = r[0, i] * u + r[1, i] * v + r[2, i] * w
        count += 1
    return _turned(r, normal, rates, values, rows, count)


@subkernel
def led(r, p, rates, aim, values, rows):
    """How far a tool is from a pose (rotation, place) [m, and rad · ANGLE], in six rows, as above."""
    turn, place = aim
    for i in range(3):
        j, m = (i + 1) % 3, (i + 2) % 3
        values[i] = p[i] - place[i]
        values[3 + i] = ANGLE / 2 * (_dot(r[m], turn[j]) - _dot(r[j], turn[m]))
        for k in range(rates.shape[1]):
            rows[i, k], rows[3 + i, k] = rates[i, k], ANGLE * rates[3 + i, k]
    return 6
