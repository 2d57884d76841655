"""Compiled inverse kinematics of one chain, from the world over base and arm to a tool frame.

Damped least squares on a weighted, bounded problem; the damping follows the error (Sugihara 2011),
joints at a limit that would leave it are frozen for the step. Restarts are cheap, so completeness
comes from many seeds.
"""

import math

import numpy as np

from services.embodiment.body.kernels import REVOLUTE, copied, matmul, rotation
from services.kernel import kernel, subkernel

ARM = 0.2  # [m] what one radian of orientation error counts as
DAMPING = 1e-3  # [1] of the squared error, floor below
FLOOR = 1e-10  # [m²] keeps singular directions bounded
STEP = 0.4  # [rad or m] largest change of a variable in one step
CHECKED = 4  # steps after which the error is compared with what it was before them
PATIENCE = 8  # steps that are made in any case: far seeds first move as far as steps go
STALLED = 0.64  # [1] of the squared error that is left when a seed is given up: of those that would meet, 2 %


@kernel
def tool_pose(x, chain, r, p, z, o):
    """Tool pose is in r (3, 3), p (3,); each joint's world axis and origin in z, o (C, 3)."""
    _tool_pose(x, chain, r, p, z, o, np.empty((3, 3)), np.empty((3, 3)))


@subkernel
def _tool_pose(x, chain, r, p, z, o, turn, tmp):
    """The same, with room for two matrices."""
    place_r, place_p, axis, kind, var, mult, offset, end_r, end_p = chain
    for i in range(3):
        p[i] = 0.0
        for j in range(3):
            r[i, j] = 1.0 if i == j else 0.0
    for c in range(kind.shape[0] + 1):
        last = c == kind.shape[0]
        u, v, w = (end_p[0], end_p[1], end_p[2]) if last else (place_p[c, 0], place_p[c, 1], place_p[c, 2])
        for i in range(3):
            p[i] = p[i] + r[i, 0] * u + r[i, 1] * v + r[i, 2] * w
        matmul(r, end_r if last else place_r[c], tmp)
        if last:
            copied(tmp, r)
            return
        angle = offset[c] + (mult[c] * x[var[c]] if var[c] >= 0 else 0.0)
        u, v, w = axis[c, 0], axis[c, 1], axis[c, 2]
        for i in range(3):
            z[c, i], o[c, i] = tmp[i, 0] * u + tmp[i, 1] * v + tmp[i, 2] * w, p[i]
        if kind[c] == REVOLUTE:
            rotation(axis[c], angle, turn)
            matmul(tmp, turn, r)
        else:
            copied(tmp, r)
            for i in range(3):
                p[i] += z[c, i] * angle


@kernel(makes=False)
def jacobian(chain, p, z, o, out):
    """World Jacobian of the tool (linear over angular) is in out (6, n)."""
    kind, var, mult = chain[3], chain[4], chain[5]
    for i in range(6):
        for k in range(out.shape[1]):
            out[i, k] = 0.0
    for c in range(kind.shape[0]):
        k, m = var[c], mult[c]
        if k < 0:
            continue
        u, v, w = z[c, 0], z[c, 1], z[c, 2]
        if kind[c] == REVOLUTE:
            a, b, d = p[0] - o[c, 0], p[1] - o[c, 1], p[2] - o[c, 2]
            out[0, k] += m * (v * d - w * b)
            out[1, k] += m * (w * a - u * d)
            out[2, k] += m * (u * b - v * a)
            out[3, k], out[4, k], out[5, k] = out[3, k] + m * u, out[4, k] + m * v, out[5, k] + m * w
        else:
            out[0, k], out[1, k], out[2, k] = out[0, k] + m * u, out[1, k] + m * v, out[2, k] + m * w


@kernel(makes=False)
def pose_error(r, p, target_r, target_p, e):
    """Error twist that leads from (r, p) to the target is in e (6,), in the world frame."""
    x, y, z, trace = 0.0, 0.0, 0.0, -1.0
    for i in range(3):
        e[i] = target_p[i] - p[i]
        for k in range(3):
            trace += target_r[i, k] * r[i, k]
    # target_r · rᵀ, its skew part is 2 sin(angle) · axis
    for k in range(3):
        x += target_r[2, k] * r[1, k] - target_r[1, k] * r[2, k]
        y += target_r[0, k] * r[2, k] - target_r[2, k] * r[0, k]
        z += target_r[1, k] * r[0, k] - target_r[0, k] * r[1, k]
    sine2 = math.sqrt(x * x + y * y + z * z)
    angle = math.atan2(sine2, trace)
    scale = angle / sine2 if sine2 > 1e-9 else 0.5
    if sine2 <= 1e-9 and trace < 0.0:  # a half turn: any axis will do for one step
        x, scale = math.pi, 1.0
    e[3], e[4], e[5] = x * scale, y * scale, z * scale


@subkernel
def solve6(a, b):
    """b becomes the solution of a · y = b; a (6, 6) symmetric positive definite, is overwritten."""
    for i in range(6):
        for j in range(i + 1):
            s = a[i, j]
            for k in range(j):
                s -= a[i, k] * a[j, k]
            a[i, j] = math.sqrt(max(s, 1e-30)) if i == j else s / a[j, j]
    for i in range(6):
        s = b[i]
        for k in range(i):
            s -= a[i, k] * b[k]
        b[i] = s / a[i, i]
    for i in range(5, -1, -1):
        s = b[i]
        for k in range(i + 1, 6):
            s -= a[k, i] * b[k]
        b[i] = s / a[i, i]


@subkernel
def step(x, jac, e, error, weight, lower, upper, room):
    """x has made one damped step; False if nothing may move."""
    n = x.shape[0]
    a, y, free, dx = room
    for k in range(n):
        free[k] = True
    for _ in range(4):
        for i in range(6):
            y[i] = e[i]
            for j in range(i + 1):
                a[i, j] = 0.0
        for k in range(n):
            if free[k]:
                for i in range(6):
                    s = jac[i, k] * weight[k]
                    for j in range(i + 1):
                        a[i, j] += s * jac[j, k]
        for i in range(6):
            a[i, i] += DAMPING * error + FLOOR
        solve6(a, y)
        stuck = False
        largest = 0.0
        for k in range(n):
            dx[k] = 0.0
            if not free[k]:
                continue
            s = 0.0
            for i in range(6):
                s += weight[k] * jac[i, k] * y[i]
            dx[k] = s
            if (x[k] <= lower[k] and dx[k] < 0.0) or (x[k] >= upper[k] and dx[k] > 0.0):
                free[k], stuck = False, True
            largest = max(largest, abs(dx[k]))
        if not stuck:
            break
    if largest == 0.0:
        return False
    shrink = min(1.0, STEP / largest)
    for k in range(n):
        if free[k]:
            x[k] = min(max(x[k] + shrink * dx[k], lower[k]), upper[k])
    return True


@subkernel(makes=True)
def _room(joints, n):
    """What `solve` writes to, for so many joints and variables."""
    pose, twist = (np.empty((3, 3)), np.empty(3)), (np.empty((6, n)), np.empty(6))
    axes, spare = (np.empty((joints, 3)), np.empty((joints, 3))), (np.empty((3, 3)), np.empty((3, 3)))
    return pose, axes, spare, twist, (np.empty((6, 6)), np.empty(6), np.empty(n, np.bool_), np.empty(n))


@subkernel
def solve(x, target_r, target_p, chain, weight, lower, upper, steps, tolerance, room):
    """Whether x has been moved to where the tool meets the target within `tolerance` [m, and rad · ARM]."""
    n, before = x.shape[0], math.inf
    (r, p), (z, o), (turn, tmp), (jac, e), free = room
    for k in range(steps):
        _tool_pose(x, chain, r, p, z, o, turn, tmp)
        pose_error(r, p, target_r, target_p, e)
        jacobian(chain, p, z, o, jac)
        error = 0.0
        for i in range(6):
            if i >= 3:
                e[i] *= ARM
                for v in range(n):
                    jac[i, v] *= ARM
            error += e[i] * e[i]
        if error < tolerance * tolerance:
            return True
        if k % CHECKED == 0:
            if k > PATIENCE and error > STALLED * before:
                return False
            before = error
        if not step(x, jac, e, error, weight, lower, upper, free):
            return False
    return False


@kernel
def solve_many(seeds, target_r, target_p, chain, weight, lower, upper, steps, tolerance):
    """Which seeds (S, n) reached their target (S, 3, 3), (S, 3); the seeds become the solutions."""
    met, room = np.zeros(seeds.shape[0], np.bool_), _room(chain[3].shape[0], seeds.shape[1])
    rest = chain, weight, lower, upper, steps, tolerance, room
    for s in range(seeds.shape[0]):
        met[s] = solve(seeds[s], target_r[s], target_p[s], *rest)
    return met


@kernel
def misses(xs, target_r, target_p, chain):
    """How far the tool is from each target (S, 3, 3), (S, 3) at each of xs (S, n) [m, and rad · ARM]."""
    joints = chain[3].shape[0]
    r, p, turn, tmp = np.empty((3, 3)), np.empty(3), np.empty((3, 3)), np.empty((3, 3))
    z, o = np.empty((joints, 3)), np.empty((joints, 3))
    e, out = np.empty(6), np.empty(xs.shape[0])
    for s in range(xs.shape[0]):
        _tool_pose(xs[s], chain, r, p, z, o, turn, tmp)
        pose_error(r, p, target_r[s], target_p[s], e)
        error = 0.0
        for i in range(6):
            error += (e[i] if i < 3 else ARM * e[i]) ** 2
        out[s] = math.sqrt(error)
    return out


@kernel
def follow(x0, target_r, target_p, chain, weight, lower, upper, steps, tolerance, jump, path):
    """How many targets in a row could be followed from x0 with no variable jumping; path (K, n) has them."""
    x, before, room = x0.copy(), np.empty(x0.shape[0]), _room(chain[3].shape[0], x0.shape[0])
    rest = chain, weight, lower, upper, steps, tolerance, room
    for k in range(target_r.shape[0]):
        for i in range(x.shape[0]):
            before[i] = x[i]
        if not solve(x, target_r[k], target_p[k], *rest):
            return k
        for i in range(x.shape[0]):
            if abs(x[i] - before[i]) > jump:
                return k
        for i in range(x.shape[0]):
            path[k, i] = x[i]
    return target_r.shape[0]
