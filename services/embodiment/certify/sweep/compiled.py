"""Compiled inner loops of the certifier: placements, bounds on motion, depths.

The formulas of bounds are told by `Kinematics.bounds`. Nothing here is shared with planning.
"""

import math

from services.kernel import kernel, subkernel


@kernel(makes=False)
def place(q, v, parents, offsets, axes, revolute, rotation, origin, axis, omega, linear):
    """Carriers at U configurations are in the last five; what they hold is said by `Placed`."""
    for u in range(q.shape[0]):
        for k in range(3):
            origin[u, 0, k] = axis[u, 0, k] = omega[u, 0, k] = linear[u, 0, k] = 0.0
            for n in range(3):
                rotation[u, 0, k, n] = 1.0 if k == n else 0.0
        for i in range(1, parents.shape[0]):
            _turn(u, i, parents[i], q[u, i - 1], offsets, axes, revolute, rotation, origin, axis)
            _move(u, i, parents[i], v[u, i - 1], revolute, origin, axis, omega, linear)


@subkernel
def _turn(u, i, parent, way, offsets, axes, revolute, rotation, origin, axis):
    """Where carrier i is at configuration u: its parent's frame, its offset, and then its joint's way."""
    a, b, c = axes[i, 0], axes[i, 1], axes[i, 2]
    cos, sin, slid = (math.cos(way), math.sin(way), 0.0) if revolute[i] else (1.0, 0.0, way)
    t = 1.0 - cos
    t00, t01, t02 = t * a * a + cos, t * a * b - sin * c, t * a * c + sin * b
    t10, t11, t12 = t * a * b + sin * c, t * b * b + cos, t * b * c - sin * a
    t20, t21, t22 = t * a * c - sin * b, t * b * c + sin * a, t * c * c + cos
    o00, o01, o02, o03 = offsets[i, 0, 0], offsets[i, 0, 1], offsets[i, 0, 2], offsets[i, 0, 3]
    o10, o11, o12, o13 = offsets[i, 1, 0], offsets[i, 1, 1], offsets[i, 1, 2], offsets[i, 1, 3]
    o20, o21, o22, o23 = offsets[i, 2, 0], offsets[i, 2, 1], offsets[i, 2, 2], offsets[i, 2, 3]
    for k in range(3):
        x, y, z = rotation[u, parent, k, 0], rotation[u, parent, k, 1], rotation[u, parent, k, 2]
        at = origin[u, parent, k] + x * o03 + y * o13 + z * o23
        x, y, z = x * o00 + y * o10 + z * o20, x * o01 + y * o11 + z * o21, x * o02 + y * o12 + z * o22
        along = x * a + y * b + z * c
        axis[u, i, k], origin[u, i, k] = along, at + slid * along
        rotation[u, i, k, 0] = x * t00 + y * t10 + z * t20
        rotation[u, i, k, 1] = x * t01 + y * t11 + z * t21
        rotation[u, i, k, 2] = x * t02 + y * t12 + z * t22


@subkernel
def _move(u, i, parent, rate, revolute, origin, axis, omega, linear):
    """How it moves there: as its parent does, and about or along its axis."""
    a, b, c = axis[u, i, 0], axis[u, i, 1], axis[u, i, 2]
    x, y, z = a, b, c
    spin = 0.0
    if revolute[i]:
        spin, x, y, z = rate, origin[u, i, 0], origin[u, i, 1], origin[u, i, 2]
        x, y, z = y * c - z * b, z * a - x * c, x * b - y * a
    omega[u, i, 0] = omega[u, parent, 0] + spin * a
    omega[u, i, 1] = omega[u, parent, 1] + spin * b
    omega[u, i, 2] = omega[u, parent, 2] + spin * c
    linear[u, i, 0] = linear[u, parent, 0] + rate * x
    linear[u, i, 1] = linear[u, parent, 1] + rate * y
    linear[u, i, 2] = linear[u, parent, 2] + rate * z


@kernel(makes=False)
def merge(parents, links, own, carrier, fixed, parent, offset, path):
    """Joints that stand still are merged with the carriers that bear them; see `Kinematics`.

    `links` is parent_T_joint of each joint, and of one that stands still also what it does where it stands.
    `own` is the carrier that a joint moves, 0 for one that stands still.
    """
    for joint in range(1, parents.shape[0]):
        above, i = parents[joint], own[joint]
        carrier[joint] = carrier[above] if i == 0 else i
        for k in range(3):
            for n in range(4):
                at = fixed[above, k, 3] if n == 3 else 0.0
                for m in range(3):
                    at += fixed[above, k, m] * links[joint, m, n]
                if i == 0:
                    fixed[joint, k, n] = at
                else:
                    offset[i, k, n] = at
        if i > 0:
            parent[i] = carrier[above]
            for k in range(path.shape[1]):
                path[i, k] = path[parent[i], k] or k == i


@kernel(makes=False)
def hermite(times, q, v, c):
    """Coefficients of cubic pieces through samples q, v (T, nq) at times (T,) are in c (4, T - 1, nq)."""
    for n in range(c.shape[1]):
        h = times[n + 1] - times[n]
        for k in range(c.shape[2]):
            step, one, other = q[n + 1, k] - q[n, k], v[n, k], v[n + 1, k]
            c[0, n, k], c[1, n, k] = q[n, k], one
            c[2, n, k] = (3 * step / h - 2 * one - other) / h
            c[3, n, k] = (one + other - 2 * step / h) / (h * h)


@kernel(makes=False)
def at(piece, s, c, q, v, a):
    """What coordinates do at s into pieces with coefficients c (4, N, nq) is in the last three, (U, nq)."""
    for u in range(q.shape[0]):
        n, t = piece[u], s[u]
        for k in range(q.shape[1]):
            c1, c2, c3 = c[1, n, k], c[2, n, k], c[3, n, k]
            q[u, k] = c[0, n, k] + t * (c1 + t * (c2 + t * c3))
            v[u, k] = c1 + t * (2 * c2 + 3 * t * c3)
            a[u, k] = 2 * c2 + 6 * t * c3


@kernel(makes=False)
def extremes(c, duration, values, s):
    """Candidates for the extreme positions of pieces, and where they are, are in the last two (4, N, nq)."""
    for n in range(c.shape[1]):
        h = duration[n]
        for k in range(c.shape[2]):
            c0, c1, c2, c3 = c[0, n, k], c[1, n, k], c[2, n, k], c[3, n, k]
            root = math.sqrt(max(c2 * c2 - 3 * c1 * c3, 0.0))
            far = -(c2 + math.copysign(root, c2))  # the form of the quadratic's roots that does not cancel
            one, other = far / (3 * c3) if c3 != 0.0 else 0.0, c1 / far if far != 0.0 else 0.0
            s[0, n, k], s[1, n, k] = 0.0, h
            s[2, n, k] = min(max(one, 0.0), h) if math.isfinite(one) else 0.0
            s[3, n, k] = min(max(other, 0.0), h) if math.isfinite(other) else 0.0
            for i in range(4):
                t = s[i, n, k]
                values[i, n, k] = c0 + t * (c1 + t * (c2 + t * c3))


@kernel(makes=False)
def spans(level, depth, index, knots, c, low, high, times, q, v, shift, v_max, a_max):
    """What coordinates do on intervals of one level is in the last six; see `Timeline` and `Spans`.

    `times` is (start, end, middle). Above `depth` an interval is of several pieces with coefficients c
    (4, N, nq), between whose `low` and `high` its coordinates are.
    """
    start, end, middle = times
    above, count = level < depth, c.shape[1]
    for u in range(index.shape[0]):
        if level <= depth:
            width = 1 << (depth - level)
            start[u], end[u] = knots[index[u] * width], knots[(index[u] + 1) * width]
            n = min(index[u], count - 1)
        else:
            n, parts = index[u] >> (level - depth), 1 << (level - depth)
            part, length = index[u] - n * parts, knots[n + 1] - knots[n]
            start[u] = knots[n] + length * part / parts
            end[u] = knots[n] + length * (part + 1) / parts
            n = min(n, count - 1)
        middle[u] = (start[u] + end[u]) / 2
        if above:
            n, beyond = 0, count
            while beyond - n > 1:
                half = (n + beyond) // 2
                n, beyond = (half, beyond) if knots[half] <= middle[u] else (n, half)
        t, h = middle[u] - knots[n], (end[u] - start[u]) / 2
        row = (1 << level) - 1 + index[u]
        for k in range(q.shape[1]):
            c0, c1, c2, c3 = c[0, n, k], c[1, n, k], c[2, n, k], c[3, n, k]
            x, rate = c0 + t * (c1 + t * (c2 + t * c3)), c1 + t * (2 * c2 + 3 * t * c3)
            q[u, k], v[u, k] = x, rate
            if above:
                shift[u, k] = max(high[row, k] - x, x - low[row, k])
                v_max[u, k] = a_max[u, k] = math.inf
                continue
            speed, bend, cubic = abs(rate), abs(2 * c2 + 6 * t * c3) / 2, abs(c3)
            shift[u, k] = h * (speed + h * (bend + h * cubic))
            v_max[u, k] = speed + h * (2 * bend + 3 * h * cubic)
            a_max[u, k] = 2 * bend + 6 * h * cubic


@subkernel
def first_order(u, i, j, c, radius, path, revolute, placed, spans, levers):
    """How far points of a ball about c on carrier i can move against carrier j during span u [m].

    The bound is from positions alone; each joint's lever is in `levers`, shape (K,).
    """
    origin, axis, moves = placed[1], placed[2], spans[2]
    moved = 0.0
    for k in range(1, path.shape[0]):
        if path[i, k] == path[j, k]:
            continue
        levers[k] = 1.0
        if revolute[k]:
            ax, ay, az = axis[u, k, 0], axis[u, k, 1], axis[u, k, 2]
            x, y, z = c[0] - origin[u, k, 0], c[1] - origin[u, k, 1], c[2] - origin[u, k, 2]
            x, y, z = y * az - z * ay, z * ax - x * az, x * ay - y * ax
            levers[k] = math.sqrt(x * x + y * y + z * z) + radius
        moved += levers[k] * moves[u, k - 1]
    return moved


@subkernel
def second_order(u, i, j, c, radius, path, revolute, placed, spans, levers, moved):
    """The bound `moved`, or the sharper one of Taylor's formula."""
    omega, linear = placed[3], placed[4]
    start, end, _, v_max, a_max = spans
    if path.shape[0] == 1 or not math.isfinite(v_max[u, 0]):
        return moved
    gain, speed, rate = 0.0, 0.0, 0.0
    for k in range(1, path.shape[0]):
        if path[i, k] != path[j, k]:
            reach = levers[k] + (moved if revolute[k] else 0.0)
            rate += v_max[u, k - 1] if revolute[k] else 0.0
            gain += reach * a_max[u, k - 1]
            speed += reach * v_max[u, k - 1]
    bend = gain + 2.0 * rate * speed
    wx, wy, wz = (
        omega[u, i, 0] - omega[u, j, 0],
        omega[u, i, 1] - omega[u, j, 1],
        omega[u, i, 2] - omega[u, j, 2],
    )
    x = linear[u, i, 0] - linear[u, j, 0] + wy * c[2] - wz * c[1]
    y = linear[u, i, 1] - linear[u, j, 1] + wz * c[0] - wx * c[2]
    z = linear[u, i, 2] - linear[u, j, 2] + wx * c[1] - wy * c[0]
    spin = math.sqrt(wx * wx + wy * wy + wz * wz)
    half = (end[u] - start[u]) / 2.0
    return min(moved, half * (math.sqrt(x * x + y * y + z * z) + spin * radius + half * bend / 2.0))


@kernel(makes=False)
def bounds(i, j, centre, radius, path, revolute, placed, spans, levers, moved, turned):
    """How far points of balls (U, 3) on carrier i move, and turn, against carrier j is in the last two."""
    omega, (start, end, shift, v_max, a_max) = placed[3], spans
    for u in range(moved.shape[0]):
        c = centre[u]
        first = first_order(u, i, j, c, radius, path, revolute, placed, spans, levers)
        moved[u] = second_order(u, i, j, c, radius, path, revolute, placed, spans, levers, first)
        way, rate, gain = 0.0, 0.0, 0.0
        for k in range(1, path.shape[0]):
            if revolute[k] and path[i, k] != path[j, k]:
                way += shift[u, k - 1]
                rate += v_max[u, k - 1]
                gain += a_max[u, k - 1]
        x, y, z = (
            omega[u, i, 0] - omega[u, j, 0],
            omega[u, i, 1] - omega[u, j, 1],
            omega[u, i, 2] - omega[u, j, 2],
        )
        half = (end[u] - start[u]) / 2.0
        sharp = half * (math.sqrt(x * x + y * y + z * z) + half * (gain + rate * rate) / 2.0)
        turned[u] = min(way, sharp) if math.isfinite(rate) else way


@subkernel
def middle_of(u, s, shapes, placed, c):
    """The centre of shape s in the world is in c."""
    carrier, centre = shapes[0][s], shapes[2]
    rotation, origin = placed[0], placed[1]
    x, y, z = centre[s, 0], centre[s, 1], centre[s, 2]
    for i in range(3):
        c[i] = (
            origin[u, carrier, i]
            + rotation[u, carrier, i, 0] * x
            + rotation[u, carrier, i, 1] * y
            + rotation[u, carrier, i, 2] * z
        )


@subkernel
def turn_of(u, s, shapes, placed, r, half):
    """Rotation of shape s in the world is in r; half extents of its box along the world's axes in half."""
    carrier, own, size, rotation = shapes[0][s], shapes[1], shapes[3], placed[0]
    for i in range(3):
        half[i] = 0.0
        for k in range(3):
            r[i, k] = (
                rotation[u, carrier, i, 0] * own[s, 0, k]
                + rotation[u, carrier, i, 1] * own[s, 1, k]
                + rotation[u, carrier, i, 2] * own[s, 2, k]
            )
            half[i] += abs(r[i, k]) * size[s, k]


@kernel(makes=False)
def swept(shapes, placed, spans, path, revolute, room, low, high):
    """Corners of boxes that contain each shape all through each span are in low, high (U, S, 3).

    `room` is room: shapes (3, 3), (3,), (3,) and (K,).
    """
    r, c, half, levers = room
    for u in range(low.shape[0]):
        for s in range(low.shape[1]):
            carrier = shapes[0][s]
            if carrier == 0 and u > 0:
                for i in range(3):
                    low[u, s, i], high[u, s, i] = low[0, s, i], high[0, s, i]
                continue
            middle_of(u, s, shapes, placed, c)
            turn_of(u, s, shapes, placed, r, half)
            moved = first_order(u, carrier, 0, c, shapes[4][s], path, revolute, placed, spans, levers)
            for i in range(3):
                low[u, s, i], high[u, s, i] = c[i] - half[i] - moved, c[i] + half[i] + moved
