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
    """Product of two (3, 3) matrices is in `out`, which is neither of them."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@subkernel
def copied(a, out):
    """A (3, 3) matrix is in `out`: an array that is set to another is compiled with the words of an error."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, j]


@subkernel
def moved(r, p, local, out):
    """A point (3,) of the frame (r, p) is in `out`, in the world."""
    for i in range(3):
        out[i] = r[i, 0] * local[0] + r[i, 1] * local[1] + r[i, 2] * local[2] + p[i]


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
    for i in range(3):
        along = carried[i, 0] * axis[j, 0] + carried[i, 1] * axis[j, 1] + carried[i, 2] * axis[j, 2]
        p[j, i] += along * q[j - 1]
        for k in range(3):
            r[j, i, k] = carried[i, k]


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
    x, y, z = centre[0] - p[0], centre[1] - p[1], centre[2] - p[2]
    for i in range(3):
        seen_p[i] = r[0, i] * x + r[1, i] * y + r[2, i] * z
        for k in range(3):
            seen_r[i, k] = r[0, i] * frame[0, k] + r[1, i] * frame[1, k] + r[2, i] * frame[2, k]


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
