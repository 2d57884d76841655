"""Compiled inner loops: forward kinematics of the scene and separation of oriented boxes.

Plain arrays in and out; `services.embodiment.body.world` gives them meaning. Poses are a rotation
(3, 3) and a translation (3,) in the world frame. Box separation is exact for boxes but for the
margin, where it errs towards "too near".
"""

import math

import numpy as np
from numba import njit  # pyright: ignore[reportMissingImports]  # compiled, no stubs

FREE, HIT, UNSURE = 0, 1, 2
"""What a check of one configuration says; UNSURE leaves pairs for an exact check."""

REVOLUTE = 1
OTHER, BOX, BALL = 0, 1, 2
"""What a shape is: its oriented box contains it, is it, or is that of a sphere of the radius given."""
PARALLEL = 1e-9  # [1] squared length under which a cross product of unit vectors says nothing

_compiled = njit(cache=True, fastmath=False)


@_compiled
def squared(v):
    """Squared length of v (3,)."""
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]


@_compiled
def rotation(axis, angle, out):
    """Rotation matrix about a unit axis is in `out`."""
    c, s = math.cos(angle), math.sin(angle)
    t = 1.0 - c
    x, y, z = axis[0], axis[1], axis[2]
    out[0, 0], out[0, 1], out[0, 2] = t * x * x + c, t * x * y - s * z, t * x * z + s * y
    out[1, 0], out[1, 1], out[1, 2] = t * x * y + s * z, t * y * y + c, t * y * z - s * x
    out[2, 0], out[2, 1], out[2, 2] = t * x * z - s * y, t * y * z + s * x, t * z * z + c


@_compiled
def matmul(a, b, out):
    """Product of two (3, 3) matrices is in `out`, which is neither of them."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@_compiled
def joint_pose(j, q, tree, turn, carried, r, p):
    """World pose of joint j's frame is in r[j], p[j]; its parent's is there already."""
    parent, place_r, place_p, axis, kind = tree
    up = parent[j]
    for i in range(3):
        p[j, i] = (
            r[up, i, 0] * place_p[j, 0] + r[up, i, 1] * place_p[j, 1] + r[up, i, 2] * place_p[j, 2] + p[up, i]
        )
    matmul(r[up], place_r[j], carried)
    if kind[j] == REVOLUTE:
        rotation(axis[j], q[j - 1], turn)
        matmul(carried, turn, r[j])
        return
    for i in range(3):
        r[j, i] = carried[i]
        along = carried[i, 0] * axis[j, 0] + carried[i, 1] * axis[j, 1] + carried[i, 2] * axis[j, 2]
        p[j, i] += along * q[j - 1]


@_compiled
def forward(q, tree, r, p):
    """World poses of all joint frames are in r (J, 3, 3), p (J, 3); joint 0 is the world."""
    turn, carried = np.empty((3, 3)), np.empty((3, 3))
    r[0] = np.eye(3)
    p[0] = 0.0
    for j in range(1, r.shape[0]):
        joint_pose(j, q, tree, turn, carried, r, p)


@_compiled
def place_boxes(r, p, boxes, box_r, box_c):
    """World poses of all boxes are in box_r, box_c."""
    joint, local_r, local_c = boxes
    for k in range(joint.shape[0]):
        j = joint[k]
        matmul(r[j], local_r[k], box_r[k])
        for i in range(3):
            box_c[k, i] = (
                r[j, i, 0] * local_c[k, 0] + r[j, i, 1] * local_c[k, 1] + r[j, i, 2] * local_c[k, 2] + p[j, i]
            )


@_compiled
def point_to_box(point, centre, r, half):
    """Squared distance of a point from a box."""
    total = 0.0
    for i in range(3):
        local = 0.0
        for k in range(3):
            local += r[k, i] * (point[k] - centre[k])
        beyond = abs(local) - half[i]
        if beyond > 0.0:
            total += beyond * beyond
    return total


@_compiled
def apart(ca, ra, ha, cb, rb, hb, margin):
    """Whether some axis shows the two boxes more than `margin` apart: sound, exact at margin 0."""
    m, am = np.empty((3, 3)), np.empty((3, 3))
    t = np.empty(3)
    for i in range(3):
        t[i] = 0.0
        for k in range(3):
            t[i] += ra[k, i] * (cb[k] - ca[k])
        for j in range(3):
            m[i, j] = ra[0, i] * rb[0, j] + ra[1, i] * rb[1, j] + ra[2, i] * rb[2, j]
            am[i, j] = abs(m[i, j])
    for i in range(3):
        if abs(t[i]) > ha[i] + hb[0] * am[i, 0] + hb[1] * am[i, 1] + hb[2] * am[i, 2] + margin:
            return True
    for j in range(3):
        along = abs(t[0] * m[0, j] + t[1] * m[1, j] + t[2] * m[2, j])
        if along > hb[j] + ha[0] * am[0, j] + ha[1] * am[1, j] + ha[2] * am[2, j] + margin:
            return True
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            sine2 = 1.0 - m[i, j] * m[i, j]
            if sine2 < PARALLEL:
                continue
            j1, j2 = (j + 1) % 3, (j + 2) % 3
            along = abs(t[i2] * m[i1, j] - t[i1] * m[i2, j])
            reach = ha[i1] * am[i2, j] + ha[i2] * am[i1, j] + hb[j1] * am[i, j2] + hb[j2] * am[i, j1]
            if along > reach + margin * math.sqrt(sine2):
                return True
    return False


@_compiled
def _note(found, count, a, b):
    if count < found.shape[0]:
        found[count, 0], found[count, 1] = a, b
    return count + 1


@_compiled
def check_environment(split, pose, half, radius, exact, margins, found):
    """(FREE | HIT | UNSURE, number of pairs noted in `found`) of robot against kitchen boxes.

    Boxes before `split` are the kitchen's. margins[robot box, kitchen box] is the distance
    demanded; negative: the pair may touch.
    """
    box_r, box_c = pose
    n = box_c.shape[0]
    middle = np.zeros(3)
    for k in range(split, n):
        middle += box_c[k]
    middle /= max(n - split, 1)
    reach = 0.0
    for k in range(split, n):
        away = box_c[k] - middle
        reach = max(reach, math.sqrt(squared(away)) + radius[k])
    largest = margins.max()
    count = 0
    for e in range(split):
        if point_to_box(middle, box_c[e], box_r[e], half[e]) > (reach + largest) ** 2:
            continue
        for k in range(split, n):
            margin = margins[k - split, e]
            if margin < 0.0 or (
                point_to_box(box_c[k], box_c[e], box_r[e], half[e]) > (radius[k] + margin) ** 2
            ):
                continue
            ball = exact[k] == BALL and exact[e] == BOX
            if not ball and apart(box_c[e], box_r[e], half[e], box_c[k], box_r[k], half[k], margin):
                continue
            count = _note(found, count, k, e)
            if ball or (exact[k] == BOX and exact[e] == BOX):
                found[0, 0], found[0, 1] = k, e
                return HIT, 1
    return (UNSURE if count else FREE), count


@_compiled
def check_self(pairs, pose, half, radius, exact, margins, found, count):
    """(FREE | HIT | UNSURE, pairs noted) of the robot's own pairs; `count` pairs are there already."""
    box_r, box_c = pose
    for k in range(pairs.shape[0]):
        a, b = pairs[k, 0], pairs[k, 1]
        away = box_c[a] - box_c[b]
        if squared(away) > (radius[a] + radius[b] + margins[k]) ** 2:
            continue
        balls = exact[a] == BALL and exact[b] == BALL
        if not balls and apart(box_c[a], box_r[a], half[a], box_c[b], box_r[b], half[b], margins[k]):
            continue
        count = _note(found, count, a, b)
        if balls or (exact[a] == BOX and exact[b] == BOX):
            found[0, 0], found[0, 1] = a, b
            return HIT, 1
    return (UNSURE if count else FREE), count


@_compiled
def check(q, tree, boxes, split, half, radius, exact, own, margins, found):
    """(FREE | HIT | UNSURE, pairs noted) of one configuration; `own` is (pairs, their margins)."""
    joints, n = tree[0].shape[0], half.shape[0]
    r, p = np.empty((joints, 3, 3)), np.empty((joints, 3))
    box_r, box_c = np.empty((n, 3, 3)), np.empty((n, 3))
    forward(q, tree, r, p)
    place_boxes(r, p, boxes, box_r, box_c)
    pose = (box_r, box_c)
    state, count = check_environment(split, pose, half, radius, exact, margins, found)
    if state == HIT:
        return state, count
    return check_self(own[0], pose, half, radius, exact, own[1], found, count)


@_compiled
def check_many(configurations, tree, boxes, split, half, radius, exact, own, margins, found, owner):
    """(index of the first configuration with a HIT or −1, number of unsure pairs).

    Unsure pairs are in `found`, the configuration of each in `owner`; after a HIT found[0] is its pair.
    More unsure pairs than `few` holds count as a HIT; more than `found` holds: the number returned tells.
    """
    total = 0
    few = np.empty((256, 2), np.int64)
    for i in range(configurations.shape[0]):
        state, count = check(configurations[i], tree, boxes, split, half, radius, exact, own, margins, few)
        if state == HIT or count > few.shape[0]:
            found[0] = few[0]
            return i, 1
        for k in range(min(count, few.shape[0])):
            if total < found.shape[0]:
                found[total] = few[k]
                owner[total] = i
            total += 1
    return -1, total
