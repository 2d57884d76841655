"""Compiled: a finger at a handle, moved a little. Whether it touches, from where on, and from what corners.

Shapes are `posed` at one configuration: (number in the scene, rotation, middle of its box) of each; pairs of
a finger's shape and one of the handle are rows of these. `room` is room, for a point and for `bounds_of`.
"""

import math

from services.kernel import kernel, subkernel
from services.physics.geometry.packed import bounds_of

STEP = 1e-3  # [m] what is thinner than this, finger and handle together, may be passed over, hence refused
EXACT = 1e-7  # [m] of the way until finger and handle touch
COARSE = 1e-5  # [m] of the way until they come as near as the handle may be elsewhere
TOUCH = 1e-6  # [m] what is nearer touches
ASIDE = 1e-3  # [m] a finger is moved to tell how the faces look that touch the handle
LEVEL = 2e-3  # [1] precision of that, a tenth of a degree
ROOM_STEPS = 6  # halvings of the tolerance of contact


@subkernel
def _touching(convex, pairs, posed, side, aside, inward, first, step, count, near, room):
    """Which of `count` ways inward, `first`, `first` + `step`, …, has a finger `near` the handle; -1 if none.

    The finger is moved `aside` to a side before [m].
    """
    every, rotation, middle = posed
    at, work = room
    for k in range(count):
        way = first + k * step
        for n in range(pairs.shape[0]):
            i, j = pairs[n, 0], pairs[n, 1]
            for m in range(3):
                at[m] = middle[i, m] + (aside * side[m] + way * inward[m])
            a, b = every[i], every[j]
            _, high = bounds_of(convex, a, b, rotation[i], at, rotation[j], middle[j], near, near, work)
            if -math.inf < high <= near:  # that of two meshes is −inf: nothing is known
                return k
    return -1


@subkernel
def _met(convex, pairs, posed, inward, contact, near, exact, room):
    """The finger's first way inward on which it comes `near` the handle: at least, and at most [m].

    NaN where it does not, by any way of at most `contact`, and where it begins so.
    """
    begin = -2.0 * contact - STEP
    count = math.ceil((contact - EXACT - begin) / STEP)
    found = _touching(convex, pairs, posed, inward, 0.0, inward, begin, STEP, count, near, room)
    clear, gap = begin + (found - 1) * STEP, begin + found * STEP
    if found < 0 and _touching(convex, pairs, posed, inward, 0.0, inward, contact, 0.0, 1, near, room) == 0:
        clear, gap = begin + (count - 1) * STEP, contact
    elif found <= 0:
        return math.nan, math.nan
    while gap - clear > exact:
        way = (clear + gap) / 2.0
        if _touching(convex, pairs, posed, inward, 0.0, inward, way, 0.0, 1, near, room) == 0:
            gap = way
        else:
            clear = way
    return clear, gap


@kernel(makes=False)
def press(convex, pairs, posed, inward, sides, contact, engaged, slope, room):
    """(gap, over): its way to the handle, and how far a finger then reaches over it to all sides [m].

    Gap is NaN where the finger does not press on the handle when moved inward.
    """
    _, gap = _met(convex, pairs, posed, inward, contact, TOUCH, EXACT, room)
    if math.isnan(gap):
        return math.nan, 0.0
    if gap < 0.0 and _touching(convex, pairs, posed, inward, 0.0, inward, 0.0, 0.0, 1, TOUCH, room) < 0:
        return math.nan, 0.0
    over = engaged
    for k in range(sides.shape[0]):
        moved, within, without = engaged, 0.0, engaged
        while without - within > EXACT:
            steps = max(math.ceil(moved * slope / STEP), 1)
            step = moved * slope / steps
            way = gap + steps * step
            side = sides[k]
            if _touching(convex, pairs, posed, side, moved, inward, way, -step, steps + 1, TOUCH, room) >= 0:
                within = moved
            else:
                without = moved
            moved = (without + within) / 2.0
        over = min(over, within)
    return gap, over


@subkernel
def _level(convex, pair, posed, inward, sides, axis, gap, slope, room):
    """Whether a finger, moved `ASIDE` both ways along an axis, touches after `gap`, but for `slope` of it."""
    more = ASIDE * slope
    later, sooner = gap + more, gap - more - 2.0 * TOUCH
    for k in range(2 * axis, 2 * axis + 2):
        side = sides[k]
        if _touching(convex, pair, posed, side, ASIDE, inward, later, 0.0, 1, TOUCH, room) < 0:
            return False
        if _touching(convex, pair, posed, side, ASIDE, inward, sooner, 0.0, 1, TOUCH, room) >= 0:
            return False
    return True


@kernel(makes=False)
def slope(convex, pair, posed, inward, sides, gap, most, room):
    """Tangent of how far the faces that meet after `gap` look away from inward; infinite above `most`.

    By how much more, or less, a finger goes until it touches if it is moved aside along one axis, or along
    the other; of both the root of the sum of squares.
    """
    total = 0.0
    for axis in range(2):
        level, steeper = 0.0, most
        if not _level(convex, pair, posed, inward, sides, axis, gap, most, room):
            return math.inf
        while steeper - level > LEVEL:
            middle = (level + steeper) / 2.0
            if _level(convex, pair, posed, inward, sides, axis, gap, middle, room):
                steeper = middle
            else:
                level = middle
        total += steeper * steeper
    return math.sqrt(total)


@kernel(makes=False)
def farthest(convex, pairs, posed, inward, contact, engaged, slope, error, room):
    """By what way from a corner a finger has to touch, wherever within `error` of here the handle is [m].

    No such way is as short as that where there is none.
    """
    clear, _ = _met(convex, pairs, posed, inward, contact, error, COARSE, room)
    return -2.0 * contact if math.isnan(clear) else min(contact - error, clear + engaged * slope)


@kernel(makes=False)
def tolerated(convex, both, posed, inwards, sides, contact, engaged, slope, room):
    """By how much the handle may be elsewhere and is still between two fingers [m].

    Pairs of either finger are in `both`, and its way inward in `inwards`. One of its pieces has to touch the
    same piece of the handle from every corner, by a way that is longer than where it then touches from the
    middle by no more than faces that look along it allow.
    """
    error, step = 0.0, contact
    for _ in range(ROOM_STEPS):
        step /= 2.0
        reach, kept = engaged + math.sqrt(2.0) * (error + step), 0
        for f in range(2):
            most = farthest(convex, both[f], posed, inwards[f], contact, engaged, slope, error + step, room)
            count = math.floor((most + contact) / STEP) + 1  # none below -contact
            stays = False
            for n in range(both[f].shape[0]):
                corners = 0
                for k in range(sides.shape[0]):
                    pair, inward = both[f][n : n + 1], inwards[f]
                    side = sides[k]
                    way = _touching(convex, pair, posed, side, reach, inward, most, -STEP, count, TOUCH, room)
                    corners += 1 if way >= 0 else 0
                    if way < 0:
                        break
                stays = stays or corners == sides.shape[0]
            kept += 1 if stays else 0
        if kept == 2:
            error += step
    return error
