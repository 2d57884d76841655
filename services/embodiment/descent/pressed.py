"""Compiled inner loop of a descent: which pairs of shapes are too near, how much, and what changes that."""

from services.embodiment.body.kernels import forward, place_boxes
from services.embodiment.descent.witness import signed
from services.kernel import kernel, subkernel


@subkernel
def _beside(reach, a, b, half, at_r, at_c):
    """Whether a ball about the middle of shape a is clear of the box about shape b."""
    x, y, z, away = at_c[a, 0] - at_c[b, 0], at_c[a, 1] - at_c[b, 1], at_c[a, 2] - at_c[b, 2], 0.0
    for i in range(3):
        off = abs(at_r[b, 0, i] * x + at_r[b, 1, i] * y + at_r[b, 2, i] * z) - half[b, i]
        away += max(off, 0.0) ** 2
    return away > reach * reach


@subkernel
def _clear(a, b, margin, radius, half, at_r, at_c):
    """Whether a ball about one of two shapes is clear of one about the other, or of its box."""
    x, y, z = at_c[a, 0] - at_c[b, 0], at_c[a, 1] - at_c[b, 1], at_c[a, 2] - at_c[b, 2]
    if x * x + y * y + z * z > (radius[a] + radius[b] + margin) ** 2:
        return True
    if _beside(radius[a] + margin, a, b, half, at_r, at_c):
        return True
    return _beside(radius[b] + margin, b, a, half, at_r, at_c)


@subkernel
def _rate(point, direction, j, revolute, axes, r, p):
    """How fast a point that joint j carries moves along a direction, for a unit of that joint's rate."""
    x, y, z = 0.0, 0.0, 0.0
    for k in range(3):
        x += r[j, 0, k] * axes[j, k]
        y += r[j, 1, k] * axes[j, k]
        z += r[j, 2, k] * axes[j, k]
    if not revolute:
        return x * direction[0] + y * direction[1] + z * direction[2]
    u, v, w = point[0] - p[j, 0], point[1] - p[j, 1], point[2] - p[j, 2]
    return (y * w - z * v) * direction[0] + (z * u - x * w) * direction[1] + (x * v - y * u) * direction[2]


@subkernel
def _rates(a, b, out, levers, tree, r, p, rows, count):
    """One row: how what a pair lacks changes with each variable."""
    joints, variables, gains, carried = levers
    for k in range(rows.shape[1]):
        rows[count, k] = 0.0
    for m in range(joints.shape[0]):
        if carried[a, m] == carried[b, m]:
            continue
        point = out[3:6] if carried[a, m] else out[6:9]
        rate = _rate(point, out, joints[m], tree[4][joints[m]] == 1, tree[3], r, p) * gains[m]
        rows[count, variables[m]] += -rate if carried[a, m] else rate


@subkernel
def _apart(u, v, margin, balls, r, p):
    """Whether two balls, each of a joint, are farther from each other than a margin."""
    joints, middles, radius = balls
    i, j, away = joints[u], joints[v], 0.0
    for k in range(3):
        off = p[i, k] - p[j, k]
        for m in range(3):
            off += r[i, k, m] * middles[u, m] - r[j, k, m] * middles[v, m]
        away += off * off
    return away > (radius[u] + radius[v] + margin) ** 2


@kernel(shared=True)
def pressed(q, tree, boxes, radius, half, shapes, pairs, levers, found, rows, room):
    """How many pairs are nearer than is demanded of them at q; at most as many as there are rows.

    Args:
        q: Shape (nq,).
        tree: As of `World`, as are the next four.
        boxes: Of joints.
        radius: Of balls.
        half: Of boxes.
        shapes: Packed.
        pairs: Shapes (P, 2), the second any, and the distances demanded (P,) [m]; two balls about all shapes
            of those from the third to before the fourth, shape (G, 4), the widest distance demanded of these
            (G,); and of balls the joint (B,), the middle as that has it (B, 3), and the radius (B,) [m].
        levers: Joints (L,), the variables that move them (L,), how far each does for a unit (L,), and which
            shapes each carries (S, L).
        found: Which pairs (N,), and what they lack of their distances (N,) [m].
        rows: How that changes with each variable, shape (N, n).
        room: Frames, poses of boxes, one answer, and what `signed` writes to.
    """
    (r, p), (at_r, at_c), out, spare = room
    forward(q, tree, r, p)
    place_boxes(r, p, boxes, at_r, at_c)
    count = 0
    shapes_of, demands, groups, widest, balls = pairs
    for g in range(groups.shape[0]):
        if _apart(groups[g, 0], groups[g, 1], widest[g], balls, r, p):
            continue
        for n in range(groups[g, 2], groups[g, 3]):
            a, b, margin = shapes_of[n, 0], shapes_of[n, 1], demands[n]
            if _clear(a, b, margin, radius, half, at_r, at_c):
                continue
            apart = signed(shapes, a, b, at_r[a], at_c[a], at_r[b], at_c[b], margin, out, spare)
            if apart >= margin:
                continue
            found[0][count], found[1][count] = n, margin - apart
            _rates(a, b, out, levers, tree, r, p, rows, count)
            count += 1
            if count == rows.shape[0]:
                return count
    return count
