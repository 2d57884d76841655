"""Compiled inner loop of a descent: Levenberg and Marquardt's, within bounds, for few variables."""

import math

import numpy as np

from services.embodiment.body.ik import jacobian, tool_pose
from services.embodiment.descent.placed import led, pinched
from services.embodiment.descent.pressed import pressed
from services.kernel import kernel, subkernel

DAMPING, LEAST = 1e-4, 1e-7  # [1] at first, and at least
SOFTER, HARDER = 4.0, 6.0  # [1] by which damping falls after a step and grows before another
TRIES = 5  # dampings at one posture
STEP = 0.5  # [rad or m] largest change of a variable
GAIN = 1e-4  # [1] of the sum of squares that a step has to save
PLACES = 6  # rows that say where the tool is, at most


@subkernel
def _added(values, rows, count, square, gradient):
    """The sum of the squares of so many values; their rows are added to half of it and its gradient."""
    total, n = 0.0, rows.shape[1]
    for m in range(count):
        total += values[m] * values[m]
        for i in range(n):
            rate = rows[m, i]
            if rate == 0.0:
                continue
            gradient[i] += rate * values[m]
            for j in range(i + 1):
                square[i, j] += rate * rows[m, j]
    return total


@subkernel(makes=True)
def _lacks(x, goal, holds, about, room, square, gradient):
    """The sum of squares at x (n,); half of its second derivatives and of its gradient are in the last two.

    Arguments are as those of `descend`.
    """
    (chain, scene, pairs, levers, expansion), (place, q, tool, found, rows, spare) = about, room
    (r, p, z, o, rates), (values, slopes), (kind, part, pads, pose) = tool, place, goal
    n = x.shape[0]
    for i in range(n):
        gradient[i] = 0.0
        for j in range(i + 1):
            square[i, j] = 0.0
    tool_pose(x, chain, r, p, z, o)
    jacobian(chain, p, z, o, rates)
    if kind:
        count = led(r, p, rates, pose, values, slopes)
    else:
        count = pinched(r, p, rates, part, pads, values, slopes)
    total = _added(values, slopes, count, square, gradient)
    if holds[0]:
        for i in range(q.shape[0]):
            q[i] = holds[1][i]
            for k in range(n):
                q[i] += expansion[i, k] * x[k]
        tree, boxes, radius, half, shapes = scene
        count = pressed(q, tree, boxes, radius, half, shapes, pairs, levers, found, rows, spare)
        total += _added(found[1], rows, count, square, gradient)
    return total


@subkernel
def _solved(square, gradient, free, count, damping, low, change):
    """What changes of so many variables, in `free`, lead to the bottom, damped; `low` (n, n) is room."""
    for a in range(count):
        i = free[a]
        for b in range(a + 1):
            j = free[b]
            left = square[max(i, j), min(i, j)] + (damping if a == b else 0.0)
            for m in range(b):
                left -= low[a, m] * low[b, m]
            low[a, b] = math.sqrt(max(left, 1e-30)) if a == b else left / low[b, b]
    for a in range(count):
        left = -gradient[free[a]]
        for m in range(a):
            left -= low[a, m] * change[m]
        change[a] = left / low[a, a]
    for a in range(count - 1, -1, -1):
        left = change[a]
        for m in range(a + 1, count):
            left -= low[m, a] * change[m]
        change[a] = left / low[a, a]


@kernel
def descend(x, goal, holds, about, bounds, steps, enough, room):
    """Moves x (n,) downhill, and gives the root of the sum of squares there.

    Args:
        x: Within the bounds.
        goal: Whether the tool is led, or else a part is pinched, and what `placed` takes for both.
        holds: Whether shapes count, and the scene's configuration (nq,) at x = 0.
        about: Chain of the tool, and of shapes what `pressed` takes; how coordinates go with x, (nq, n).
        bounds: Which variables move, and between which limits, (n,) each.
        steps: At most.
        enough: The root with which it ends.
        room: What `_lacks` writes to.
    """
    (moves, lower, upper), n = bounds, x.shape[0]
    square, gradient, low = np.empty((n, n)), np.empty(n), np.empty((n, n))
    squared, slope, change = np.empty((n, n)), np.empty(n), np.empty(n)
    there, free = np.empty(n), np.empty(n, np.int64)
    cost, damping = _lacks(x, goal, holds, about, room, square, gradient), DAMPING
    for _ in range(steps):
        if cost < enough * enough:
            break
        count = 0
        for i in range(n):
            ends = (x[i] <= lower[i] and gradient[i] > 0) or (x[i] >= upper[i] and gradient[i] < 0)
            if moves[i] and not ends:
                free[count] = i
                count += 1
        stuck = True
        for _ in range(TRIES if count else 0):
            _solved(square, gradient, free, count, damping, low, change)
            most = STEP
            for a in range(count):
                most = max(most, abs(change[a]))
            for i in range(n):
                there[i] = x[i]
            for a in range(count):
                i = free[a]
                there[i] = min(max(x[i] + change[a] * STEP / most, lower[i]), upper[i])
            now = _lacks(there, goal, holds, about, room, squared, slope)
            if now < cost * (1 - GAIN):
                stuck = False
                break
            damping *= HARDER
        if stuck:
            break
        cost, damping = now, max(damping / SOFTER, LEAST)
        for i in range(n):
            x[i], gradient[i] = there[i], slope[i]
            for j in range(i + 1):
                square[i, j] = squared[i, j]
    return math.sqrt(cost)
