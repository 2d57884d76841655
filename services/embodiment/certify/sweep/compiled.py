"""Compiled inner loops of the certifier: placements, bounds on motion, depths.

The formulas are those of `Kinematics.bounds`, one item at a time. Nothing here is shared with planning.
"""

import math

import numpy as np

from services.kernel import kernel, subkernel


@subkernel
def _turned(axis, angle, out):
    c, s = math.cos(angle), math.sin(angle)
    t, x, y, z = 1.0 - c, axis[0], axis[1], axis[2]
    out[0, 0], out[0, 1], out[0, 2] = t * x * x + c, t * x * y - s * z, t * x * z + s * y
    out[1, 0], out[1, 1], out[1, 2] = t * x * y + s * z, t * y * y + c, t * y * z - s * x
    out[2, 0], out[2, 1], out[2, 2] = t * x * z - s * y, t * y * z + s * x, t * z * z + c


@subkernel
def _product(a, b, out):
    """What is read is read once: LLVM cannot know that `out` is another."""
    b00, b01, b02 = b[0, 0], b[0, 1], b[0, 2]
    b10, b11, b12 = b[1, 0], b[1, 1], b[1, 2]
    b20, b21, b22 = b[2, 0], b[2, 1], b[2, 2]
    for i in range(3):
        x, y, z = a[i, 0], a[i, 1], a[i, 2]
        out[i, 0] = x * b00 + y * b10 + z * b20
        out[i, 1] = x * b01 + y * b11 + z * b21
        out[i, 2] = x * b02 + y * b12 + z * b22


@kernel
def place(q, v, parents, offsets, axes, revolute, rotation, origin, axis, omega, linear):
    """Carriers at U configurations are in the last five; what they hold is said by `Placed`."""
    spare = np.empty((3, 3)), np.empty((3, 3))
    for u in range(q.shape[0]):
        for k in range(3):
            origin[u, 0, k] = axis[u, 0, k] = omega[u, 0, k] = linear[u, 0, k] = 0.0
            for n in range(3):
                rotation[u, 0, k, n] = 1.0 if k == n else 0.0
        _placed(u, q, v, parents, offsets, axes, revolute, spare, rotation, origin, axis, omega, linear)


@subkernel
def _placed(u, q, v, parents, offsets, axes, revolute, spare, rotation, origin, axis, omega, linear):
    """The same of all carriers but the world at configuration u."""
    frame, turn = spare
    for i in range(1, parents.shape[0]):
        parent, way, rate = parents[i], q[u, i - 1], v[u, i - 1]
        _product(rotation[u, parent], offsets[i], frame)
        x, y, z, a, b, c = (
            offsets[i, 0, 3],
            offsets[i, 1, 3],
            offsets[i, 2, 3],
            axes[i, 0],
            axes[i, 1],
            axes[i, 2],
        )
        for k in range(3):
            r = rotation[u, parent]
            origin[u, i, k] = origin[u, parent, k] + r[k, 0] * x + r[k, 1] * y + r[k, 2] * z
            axis[u, i, k] = frame[k, 0] * a + frame[k, 1] * b + frame[k, 2] * c
        x, y, z, a, b, c = (
            origin[u, i, 0],
            origin[u, i, 1],
            origin[u, i, 2],
            axis[u, i, 0],
            axis[u, i, 1],
            axis[u, i, 2],
        )
        if revolute[i]:
            _turned(axes[i], way, turn)
            _product(frame, turn, rotation[u, i])
            omega[u, i, 0] = omega[u, parent, 0] + rate * a
            omega[u, i, 1] = omega[u, parent, 1] + rate * b
            omega[u, i, 2] = omega[u, parent, 2] + rate * c
            linear[u, i, 0] = linear[u, parent, 0] + rate * (y * c - z * b)
            linear[u, i, 1] = linear[u, parent, 1] + rate * (z * a - x * c)
            linear[u, i, 2] = linear[u, parent, 2] + rate * (x * b - y * a)
            continue
        origin[u, i, 0], origin[u, i, 1], origin[u, i, 2] = x + way * a, y + way * b, z + way * c
        linear[u, i, 0] = linear[u, parent, 0] + rate * a
        linear[u, i, 1] = linear[u, parent, 1] + rate * b
        linear[u, i, 2] = linear[u, parent, 2] + rate * c
        for k in range(3):
            omega[u, i, k] = omega[u, parent, k]
            for n in range(3):
                rotation[u, i, k, n] = frame[k, n]


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


@kernel
def moments(piece, s, half, c, q, v, shift, v_max, a_max):
    """What coordinates do at s into pieces, and within `half` of it, is in the last five; see `Spans`."""
    for u in range(q.shape[0]):
        n, t, h = piece[u], s[u], half[u]
        for k in range(q.shape[1]):
            c0, c1, c2, c3 = c[0, n, k], c[1, n, k], c[2, n, k], c[3, n, k]
            q[u, k] = c0 + t * (c1 + t * (c2 + t * c3))
            v[u, k] = c1 + t * (2 * c2 + 3 * t * c3)
            speed, bend, cubic = abs(v[u, k]), abs(2 * c2 + 6 * t * c3) / 2, abs(c3)
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


@kernel
def swept(shapes, placed, spans, path, revolute, low, high):
    """Corners of boxes that contain each shape all through each span are in low, high (U, S, 3)."""
    r, c, half, levers = np.empty((3, 3)), np.empty(3), np.empty(3), np.empty(path.shape[0])
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


@kernel
def deepest_points(points, mesh, own, box, normals, offsets, found):
    """Depth of the deepest of some points (K, 3) in a convex shape at each time is in `found` (T,); or 0.

    `mesh` and `own` are poses of the points and of the shape at these times, `box` the corners of its own
    box; a point x lies inside where normals · x <= offsets.
    """
    turn, way, y = np.empty((3, 3)), np.empty(3), np.empty(3)
    for t in range(found.shape[0]):
        found[t] = 0.0
        for i in range(3):
            way[i] = 0.0
            for k in range(3):
                way[i] += own[0][t, k, i] * (mesh[1][t, k] - own[1][t, k])
                turn[i, k] = 0.0
                for m in range(3):
                    turn[i, k] += own[0][t, m, i] * mesh[0][t, m, k]
        for n in range(points.shape[0]):
            inside = True
            for i in range(3):
                y[i] = (
                    way[i] + turn[i, 0] * points[n, 0] + turn[i, 1] * points[n, 1] + turn[i, 2] * points[n, 2]
                )
                inside = inside and box[0][i] < y[i] < box[1][i]
            if not inside:
                continue
            depth = math.inf
            for f in range(normals.shape[0]):
                off = normals[f, 0] * y[0] + normals[f, 1] * y[1] + normals[f, 2] * y[2]
                depth = min(depth, offsets[f] - off)
            found[t] = max(found[t], depth)
