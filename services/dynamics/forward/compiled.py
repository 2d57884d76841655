"""Compiled inner loop: a joint, and those that move with it, under forces, friction and stops, step by step.

Moreau's midpoint rule with friction and stops as impulses: in one dimension the complementarity problem of a
step has a closed form. Second order where nothing sticks, slips or strikes, first order there.
"""

import math

import numpy as np

from services.kernel import kernel, subkernel

REST = 1e-12  # [rad/s or m/s] what a speed is set to is exactly 0; more than rounding


@subkernel
def resisting(q, values, load, shape, lower):
    """Forces of a joint that depend on the position alone, against opening: weight, spring, latch, closer."""
    mass, weight, stiffness, latch, closer = values[0], values[2], values[6], values[7], values[8]
    total = mass * weight * (load[1] * math.cos(q) + load[2] * math.sin(q) + load[3])
    total += stiffness * (q - shape[0])
    if shape[1] > 0 and q - lower < shape[1]:
        total += latch * min(1.0, 1.0 - (q - lower) / shape[1])
    if q - lower < shape[2]:
        total += closer
    return total


@subkernel
def summed(waves, q):
    """A sum of size · cos(rate · q + phase), of rows size, rate, phase, and its slope."""
    value, slope = 0.0, 0.0
    for k in range(waves.shape[0]):
        angle = waves[k, 1] * q + waves[k, 2]
        value += waves[k, 0] * math.cos(angle)
        slope -= waves[k, 0] * waves[k, 1] * math.sin(angle)
    return value, slope


@subkernel
def advanced(q, v, force, h, joints, folded, lifted, stops):
    """Position and speed after h, under a constant force of the first joint; a row of `joints` for each.

    Of panels that others carry, `folded` is the inertia M(q), whose M' v² / 2 is taken as M' v v⁺ / 2, v⁺ the
    speed after the step, and `lifted` the force that holds their weight: waves of the first joint's position.
    """
    middle = q + 0.5 * h * v
    inertia, slope = summed(folded, middle)
    damping, push, sliding, held = 0.0, force - summed(lifted, middle)[0], 0.0, 0.0
    for k in range(joints.shape[0]):
        ratio, values, load, shape = joints[k, 0], joints[k, 2:12], joints[k, 12:16], joints[k, 16:19]
        own, lower = ratio * middle + joints[k, 1], ratio * stops[0] + joints[k, 1]
        inertia += ratio * ratio * values[0] * values[1] * load[0]
        damping += ratio * ratio * values[5]
        if v < 0 and own - lower < shape[2]:
            damping += ratio * ratio * values[9]
        push -= ratio * resisting(own, values, load, shape, lower)
        sliding, held = sliding + ratio * values[3], held + ratio * values[4]
    heavy = inertia + 0.5 * h * (damping + slope * v)
    free = (inertia * v + h * (push - 0.5 * damping * v)) / heavy
    resting = abs(v) < REST
    bearable = h * (held if resting else sliding) / heavy
    after = 0.0 if abs(free) <= bearable else free - math.copysign(h * sliding / heavy, free)
    if not resting and after * v < 0:  # it comes to rest within the step, and break-away holds from there
        after = 0.0
    if (middle <= stops[0] and after < 0) or (middle >= stops[1] and after > 0):
        after = 0.0
    return min(max(middle + 0.5 * h * after, stops[0]), stops[1]), after


@kernel
def simulated(times, force, start, speed, step, joints, folded, lifted, stops):
    """Positions and speeds at the times, shape (T,) each, under forces (T,) linear between them."""
    q, v = start, speed
    qs, vs = np.empty(times.shape[0]), np.empty(times.shape[0])
    qs[0], vs[0] = q, v
    for i in range(times.shape[0] - 1):
        span = times[i + 1] - times[i]
        count = max(1, math.ceil(span / step - 1e-9))
        h = span / count
        for k in range(count):
            share = (k + 0.5) / count
            now = force[i] + share * (force[i + 1] - force[i])
            q, v = advanced(q, v, now, h, joints, folded, lifted, stops)
        qs[i + 1], vs[i + 1] = q, v
    return qs, vs
