"""Compiled inner loops: forward kinematics of the scene.

Plain arrays in and out; `services.embodiment.body.world` gives them meaning. Poses are a rotation
(3, 3) and a translation (3,) in the world frame.
"""

import math

import numpy as np

from services.kernel import kernel, subkernel

REVOLUTE = 1


@kernel(makes=False)
def rotation(axis, angle, out):
    """Rotation matrix about a unit axis is in `out`."""
    c, s = math.cos(angle), math.sin(angle)
    t = 1.0 - c
    x, y, z = axis[0], axis[1], axis[2]
    out[0, 0], out[0, 1], out[0, 2] = t * x * x + c, t * x * y - s * z, t * x * z + s * y
    out[1, 0], out[1, 1], out[1, 2] = t * x * y + s * z, t * y * y + c, t * y * z - s * x
    out[2, 0], out[2, 1], out[2, 2] = t * x * z - s * y, t * y * z + s * x, t * z * z + c


@subkernel
def matmul(a, b, out):
    """Product of two (3, 3) matrices is in `out`, which is neither of them.

    What is read is read once: LLVM cannot know that `out` is another.
    """
    b00, b01, b02 = b[0, 0], b[0, 1], b[0, 2]
    b10, b11, b12 = b[1, 0], b[1, 1], b[1, 2]
    b20, b21, b22 = b[2, 0], b[2, 1], b[2, 2]
    for i in range(3):
        x, y, z = a[i, 0], a[i, 1], a[i, 2]
        out[i, 0] = x * b00 + y * b10 + z * b20
        out[i, 1] = x * b01 + y * b11 + z * b21
        out[i, 2] = x * b02 + y * b12 + z * b22


@subkernel
def copied(a, out):
    """A (3, 3) matrix is in `out`: an array that is set to another is compiled with the words of an error."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, j]


@subkernel
def moved(r, p, local, out):
    """A point (3,) of the frame (r, p) is in `out`, in the world."""
    x, y, z = local[0], local[1], local[2]
    for i in range(3):
        out[i] = r[i, 0] * x + r[i, 1] * y + r[i, 2] * z + p[i]


@subkernel
def joint_pose(j, q, tree, turn, carried, r, p):
    """World pose of joint j's frame is in r[j], p[j]; its parent's is there already."""
    parent, place_r, place_p, axis, kind = tree
    up = parent[j]
    moved(r[up], p[up], place_p[j], p[j])
    matmul(r[up], place_r[j], carried)
    if kind[j] == REVOLUTE:
        rotation(axis[j], q[j - 1], turn)
        matmul(carried, turn, r[j])
        return
    x, y, z, way = axis[j, 0], axis[j, 1], axis[j, 2], q[j - 1]
    for i in range(3):
        a, b, c = carried[i, 0], carried[i, 1], carried[i, 2]
        p[j, i] += (a * x + b * y + c * z) * way
        r[j, i, 0], r[j, i, 1], r[j, i, 2] = a, b, c


@kernel
def forward(q, tree, r, p):
    """World poses of all joint frames are in r (J, 3, 3), p (J, 3); joint 0 is the world."""
    turn, carried = np.empty((3, 3)), np.empty((3, 3))
    _at_world(r, p)
    for j in range(1, r.shape[0]):
        joint_pose(j, q, tree, turn, carried, r, p)


@subkernel
def _at_world(r, p):
    """The pose of joint 0 is in r[0], p[0]."""
    for i in range(3):
        p[0, i] = 0.0
        for k in range(3):
            r[0, i, k] = 1.0 if i == k else 0.0


@kernel
def poses(qs, tree, joint, to_r, to_p):
    """World poses of one joint's frame at each of qs (T, nq) are in to_r (T, 3, 3), to_p (T, 3)."""
    count = tree[0].shape[0]
    r, p, above = np.empty((count, 3, 3)), np.empty((count, 3)), np.zeros(count, np.bool_)
    turn, carried, j = np.empty((3, 3)), np.empty((3, 3)), joint
    while j > 0:
        above[j], j = True, tree[0][j]
    _at_world(r, p)
    for t in range(qs.shape[0]):
        for k in range(1, joint + 1):
            if above[k]:
                joint_pose(k, qs[t], tree, turn, carried, r, p)
        copied(r[joint], to_r[t])
        for i in range(3):
            to_p[t, i] = p[joint, i]


@subkernel
def seen_from(r, p, frame, centre, seen_r, seen_p):
    """A pose (frame, centre) as it is seen from another, (r, p), is in `seen_r`, `seen_p`."""
    f00, f01, f02 = frame[0, 0], frame[0, 1], frame[0, 2]
    f10, f11, f12 = frame[1, 0], frame[1, 1], frame[1, 2]
    f20, f21, f22 = frame[2, 0], frame[2, 1], frame[2, 2]
    x, y, z = centre[0] - p[0], centre[1] - p[1], centre[2] - p[2]
    for i in range(3):
        a, b, c = r[0, i], r[1, i], r[2, i]
        seen_p[i] = a * x + b * y + c * z
        seen_r[i, 0] = a * f00 + b * f10 + c * f20
        seen_r[i, 1] = a * f01 + b * f11 + c * f21
        seen_r[i, 2] = a * f02 + b * f12 + c * f22


@subkernel(makes=True)
def carried(qs, tree, boxes, r, p, at):
    """(carrier of each joint, number of carriers, their indices, tree and boxes on these carriers alone).

    A joint that stands still along qs is carried by the nearest before it that does not, the rest by the
    world, 0. Frames (r, p) and poses of the boxes, `at`, are those at qs[0].
    """
    size, shapes = r.shape[0], at[0].shape[0]
    carrier, moving, many = np.zeros(size, np.int64), np.empty(size, np.int64), 0
    up, place_r, place_p = np.zeros(size, np.int64), np.empty((size, 3, 3)), np.empty((size, 3))
    joint, local_r, local_c = np.empty(shapes, np.int64), np.empty((shapes, 3, 3)), np.empty((shapes, 3))
    turn, where = np.empty((3, 3)), np.empty(3)
    for j in range(1, size):
        before = tree[0][j]
        carrier[j] = carrier[before]
        for k in range(1, qs.shape[0]):
            if qs[k, j - 1] != qs[0, j - 1]:
                carrier[j] = j
                break
        if carrier[j] == j:
            moving[many], many, up[j] = j, many + 1, carrier[before]
            matmul(r[before], tree[1][j], turn)
            moved(r[before], p[before], tree[2][j], where)
            seen_from(r[up[j]], p[up[j]], turn, where, place_r[j], place_p[j])
    for s in range(shapes):
        joint[s] = j = carrier[boxes[0][s]]
        seen_from(r[j], p[j], at[0][s], at[1][s], local_r[s], local_c[s])
    return carrier, many, moving, (up, place_r, place_p, tree[3], tree[4]), (joint, local_r, local_c)


@kernel(makes=False)
def place_boxes(r, p, boxes, box_r, box_c):
    """World poses of all boxes are in box_r, box_c."""
    joint, local_r, local_c = boxes
    for k in range(joint.shape[0]):
        matmul(r[joint[k]], local_r[k], box_r[k])
        moved(r[joint[k]], p[joint[k]], local_c[k], box_c[k])
