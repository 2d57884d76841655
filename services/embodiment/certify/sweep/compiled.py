"""Compiled inner loops of the certifier: placements, bounds on motion, distances.

The formulas are those of `Kinematics.bounds` and of `clearance`, one item at a time. Nothing here is
shared with planning but the distance of two shapes, which comes with its own proof (`convex`, `packed`).
"""

import math

import numpy as np

from services.kernel import kernel
from services.physics.geometry.convex import parted
from services.physics.geometry.packed import bounds_of

SHUT, ASKED, LEFT = 0, 1, 2
"""Of an item: a bound says enough, its distance is known, its distance is left to be asked for."""


@kernel
def _turned(axis, angle, out):
    c, s = math.cos(angle), math.sin(angle)
    t, x, y, z = 1.0 - c, axis[0], axis[1], axis[2]
    out[0, 0], out[0, 1], out[0, 2] = t * x * x + c, t * x * y - s * z, t * x * z + s * y
    out[1, 0], out[1, 1], out[1, 2] = t * x * y + s * z, t * y * y + c, t * y * z - s * x
    out[2, 0], out[2, 1], out[2, 2] = t * x * z - s * y, t * y * z + s * x, t * z * z + c


@kernel
def _product(a, b, out):
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@kernel
def place(q, v, parents, offsets, axes, revolute, rotation, origin, axis, omega, linear):
    """Carriers at U configurations are in the last five; what they hold is said by `Placed`."""
    frame, turn = np.empty((3, 3)), np.empty((3, 3))
    for u in range(q.shape[0]):
        for i in range(1, parents.shape[0]):
            parent, rate = parents[i], v[u, i - 1]
            _product(rotation[u, parent], offsets[i, :3, :3], frame)
            for k in range(3):
                origin[u, i, k] = origin[u, parent, k]
                axis[u, i, k] = 0.0
                for n in range(3):
                    origin[u, i, k] += rotation[u, parent, k, n] * offsets[i, n, 3]
                    axis[u, i, k] += frame[k, n] * axes[i, n]
            a, o = axis[u, i], origin[u, i]
            if revolute[i]:
                _turned(axes[i], q[u, i - 1], turn)
                _product(frame, turn, rotation[u, i])
                moment = o[1] * a[2] - o[2] * a[1], o[2] * a[0] - o[0] * a[2], o[0] * a[1] - o[1] * a[0]
                for k in range(3):
                    omega[u, i, k] = omega[u, parent, k] + rate * a[k]
                    linear[u, i, k] = linear[u, parent, k] + rate * moment[k]
            else:
                for k in range(3):
                    origin[u, i, k] += q[u, i - 1] * a[k]
                    omega[u, i, k] = omega[u, parent, k]
                    linear[u, i, k] = linear[u, parent, k] + rate * a[k]
                    for n in range(3):
                        rotation[u, i, k, n] = frame[k, n]


@kernel
def shift(u, i, j, c, radius, path, revolute, placed, spans, levers):
    """How far points of a ball about c on carrier i can move against carrier j during span u [m].

    `levers` is room, shape (K,).
    """
    moved = _first_order(u, i, j, c, radius, path, revolute, placed, spans, levers)
    return _second_order(u, i, j, c, radius, path, revolute, placed, spans, levers, moved)


@kernel
def _first_order(u, i, j, c, radius, path, revolute, placed, spans, levers):
    """The bound from positions alone; each joint's lever is in `levers`."""
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


@kernel
def _second_order(u, i, j, c, radius, path, revolute, placed, spans, levers, moved):
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


@kernel
def _middle(u, s, shapes, placed, c):
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


@kernel
def _turn(u, s, shapes, placed, r, half):
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
            _middle(u, s, shapes, placed, c)
            _turn(u, s, shapes, placed, r, half)
            moved = shift(u, carrier, 0, c, shapes[4][s], path, revolute, placed, spans, levers)
            for i in range(3):
                low[u, s, i], high[u, s, i] = c[i] - half[i] - moved, c[i] + half[i] + moved


@kernel
def starting(pairs, low, high, least, which, pair):
    """How many pairs of boxes come nearer than `least`; those for which there is room are in the last two."""
    count, near = 0, np.empty(low.shape[1], np.bool_)
    for u in range(low.shape[0]):
        bottom, top = np.full(3, math.inf), np.full(3, -math.inf)
        for n in range(pairs.shape[0]):
            s = pairs[n, 0]
            if n == 0 or s != pairs[n - 1, 0]:
                for i in range(3):
                    bottom[i], top[i] = min(bottom[i], low[u, s, i]), max(top[i], high[u, s, i])
        for s in range(low.shape[1]):
            near[s] = True
            for i in range(3):
                beside = low[u, s, i] - least > top[i] or bottom[i] > high[u, s, i] + least
                near[s] = near[s] and not beside
        for n in range(pairs.shape[0]):
            s, e = pairs[n, 0], pairs[n, 1]
            if near[e] and _meet(low, high, u, s, e, least):
                if count < which.shape[0]:
                    which[count], pair[count] = u, n
                count += 1
    return count


@kernel
def _meet(low, high, u, s, e, least):
    for i in range(3):
        if low[u, s, i] - least > high[u, e, i] or low[u, e, i] > high[u, s, i] + least:
            return False
    return True


@kernel
def look(items, pairs, keep, shapes, convex, placed, spans, path, revolute, slack, open_until, limits, out):
    """What each item tells: (done, distance, approach, distance of centres) in the four arrays `out`.

    `items` is (index of the pair, index of the span); `keep` is (least, least_held, held_from), `limits`
    (PRECISION, HOPELESS, SHORTEST). Items with a bound on their slack of at least `slack` − PRECISION
    that is above 0, or that begin after `open_until`, tell nothing more: their distance is a bound.
    """
    done, distance, approach, between = out
    precision, hopeless, shortest = limits
    one_r, one_c, one_half = np.empty((3, 3)), np.empty(3), np.empty(3)
    two_r, two_c, two_half = np.empty((3, 3)), np.empty(3), np.empty(3)
    work, levers = np.zeros((8, 4)), np.empty(path.shape[0])
    for n in range(items[0].shape[0]):
        p, u = items[0][n], items[1][n]
        a, b = pairs[p, 0], pairs[p, 1]
        i, j, radius = shapes[0][a], shapes[0][b], shapes[4][a]
        _middle(u, a, shapes, placed, one_c)
        _middle(u, b, shapes, placed, two_c)
        x, y, z = two_c[0] - one_c[0], two_c[1] - one_c[1], two_c[2] - one_c[2]
        between[n] = math.sqrt(x * x + y * y + z * z)
        floor = between[n] - radius - shapes[4][b]
        least = keep[1][p] if spans[0][u] >= keep[2] else keep[0][p]
        enough = max(slack - precision, 0.0)
        moved = _first_order(u, i, j, one_c, radius, path, revolute, placed, spans, levers)
        if floor - moved - least <= enough:
            moved = _second_order(u, i, j, one_c, radius, path, revolute, placed, spans, levers, moved)
        approach[n], distance[n], done[n] = moved, floor, SHUT
        if floor - moved - least > enough:
            continue
        wide = spans[1][u] - spans[0][u] > shortest
        if between[n] < moved + least and moved > hopeless and wide:
            continue
        _turn(u, a, shapes, placed, one_r, one_half)
        _turn(u, b, shapes, placed, two_r, two_half)
        floor = max(floor, _apart(one_c, one_half, two_c, two_half))
        floor = max(floor, parted(convex, a, b, one_r, one_c, two_r, two_c))
        distance[n] = floor
        low = floor - moved - least
        if low >= slack - precision and (low > 0.0 or spans[0][u] >= open_until):
            continue
        done[n] = LEFT
        enough = moved + least + max(slack, 0.0)
        low, _ = bounds_of(convex, a, b, one_r, one_c, two_r, two_c, enough, -math.inf, work)
        if low > -math.inf:
            done[n], distance[n] = ASKED, low


@kernel
def _apart(one_c, one_half, two_c, two_half):
    """Distance of two boxes along the world's axes; negative is what parts them where they overlap."""
    outside, deepest = 0.0, -math.inf
    for i in range(3):
        gap = abs(two_c[i] - one_c[i]) - one_half[i] - two_half[i]
        outside += max(gap, 0.0) ** 2
        deepest = max(deepest, gap)
    return math.sqrt(outside) if outside > 0.0 else deepest


@kernel
def deepest_points(points, mesh, own, box, normals, offsets, found):
    """Depth of the deepest of some points (K, 3) in a convex shape at each time is in `found` (T,); or 0.

    `mesh` and `own` are poses of the points and of the shape at these times, `box` the corners of its own
    box; a point x lies inside where normals · x <= offsets.
    """
    x, y = np.empty(3), np.empty(3)
    for t in range(found.shape[0]):
        found[t] = 0.0
        for n in range(points.shape[0]):
            for i in range(3):
                x[i] = mesh[1][t, i] - own[1][t, i]
                for k in range(3):
                    x[i] += mesh[0][t, i, k] * points[n, k]
            inside = True
            for i in range(3):
                y[i] = own[0][t, 0, i] * x[0] + own[0][t, 1, i] * x[1] + own[0][t, 2, i] * x[2]
                inside = inside and box[0][i] < y[i] < box[1][i]
            depth = math.inf if inside else 0.0
            for f in range(normals.shape[0] if inside else 0):
                depth = min(
                    depth, offsets[f] - normals[f, 0] * y[0] - normals[f, 1] * y[1] - normals[f, 2] * y[2]
                )
            found[t] = max(found[t], depth)
