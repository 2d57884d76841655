"""Compiled inner loops of the certifier: what pairs of shapes tell of an interval of time.

The formulas are those of `clearance`, one item at a time. Nothing here is shared with planning but the
distance of two shapes, which comes with its own proof (`convex`, `packed`).
"""

import math

from services.embodiment.certify.sweep.compiled import first_order, middle_of, second_order, turn_of
from services.kernel import kernel, subkernel
from services.physics.geometry.convex import parted
from services.physics.geometry.packed import bounds_of

SHUT, ASKED, LEFT = 0, 1, 2
"""Of an item: a bound says enough, its distance is known, its distance is left to be asked for."""


@kernel(makes=False)
def each(interval, intervals, which):
    """How many intervals items have, in the order of time; these, and which each has, are in the last two."""
    count = 0
    for n in range(interval.shape[0]):
        if n == 0 or interval[n] != interval[n - 1]:
            intervals[count] = interval[n]
            count += 1
        which[n] = count - 1
    return count


@kernel(makes=False)
def starting(pairs, low, high, least, room, which, pair):
    """How many pairs of boxes come nearer than `least`; those for which there is room are in the last two.

    `room` is room: corners of each shape's box all through the spans, shape (1, S, 3) each, and pairs of
    which these come so near, shape (P,).
    """
    lowest, highest, some = room
    for s in range(low.shape[1]):
        for i in range(3):
            lowest[0, s, i], highest[0, s, i] = math.inf, -math.inf
    for u in range(low.shape[0]):
        for s in range(low.shape[1]):
            for i in range(3):
                lowest[0, s, i] = min(lowest[0, s, i], low[u, s, i])
                highest[0, s, i] = max(highest[0, s, i], high[u, s, i])
    asked, count = 0, 0
    for n in range(pairs.shape[0]):
        if _meet(lowest, highest, 0, pairs[n, 0], pairs[n, 1], least):
            some[asked] = n
            asked += 1
    for u in range(low.shape[0]):
        for k in range(asked):
            n = some[k]
            if _meet(low, high, u, pairs[n, 0], pairs[n, 1], least):
                if count < which.shape[0]:
                    which[count], pair[count] = u, n
                count += 1
    return count


@subkernel
def _meet(low, high, u, s, e, least):
    for i in range(3):
        if low[u, s, i] - least > high[u, e, i] or low[u, e, i] > high[u, s, i] + least:
            return False
    return True


@kernel(makes=False)
def look(
    items, pairs, keep, sets, shapes, convex, placed, spans, path, revolute, slacks, until, limits, room, out
):
    """What each item tells: (done, distance, approach, distance of centres) in the four arrays `out`.

    `items` is (index of the pair, index of the span); `keep` is (least, least_held, held_from) and `sets` the
    set of each pair, `limits` (PRECISION, HOPELESS, SHORTEST). Items with a bound on their slack of at least
    that of their set in `slacks` − PRECISION that is above 0, or that begin after its `until`, tell nothing
    more: their distance is a bound. So is that of items which are halved whatever it is: those that move by
    more than HOPELESS, and whose boxes may meet so.
    What items that follow one another have in common is worked out once. `room` is that of two shapes, shapes
    (3, 3), (3,) and (3,) each, of `bounds_of`, and of as many numbers as there are carriers.
    """
    done, distance, approach, between = out
    precision, hopeless, shortest = limits
    one_r, one_c, one_half, two_r, two_c, two_half, work, levers = room
    span, shape, against, turned = -1, -1, -1, False  # what is known of the first shape of the item before
    first, second = 0.0, 0.0
    for n in range(items[0].shape[0]):
        p, u = items[0][n], items[1][n]
        a, b, slack, open_until = pairs[p, 0], pairs[p, 1], slacks[sets[p]], until[sets[p]]
        i, j, radius = shapes[0][a], shapes[0][b], shapes[4][a]
        if u != span or a != shape:
            span, shape, against, turned = u, a, -1, False
            middle_of(u, a, shapes, placed, one_c)
        if j != against:
            against, second = j, math.inf
            first = first_order(u, i, j, one_c, radius, path, revolute, placed, spans, levers)
        middle_of(u, b, shapes, placed, two_c)
        x, y, z = two_c[0] - one_c[0], two_c[1] - one_c[1], two_c[2] - one_c[2]
        between[n] = math.sqrt(x * x + y * y + z * z)
        floor, moved = between[n] - radius - shapes[4][b], first
        least = keep[1][p] if spans[0][u] >= keep[2][p] else keep[0][p]
        enough = max(slack - precision, 0.0)
        if floor - moved - least <= enough:
            if second == math.inf:
                second = second_order(u, i, j, one_c, radius, path, revolute, placed, spans, levers, first)
            moved = second
        approach[n], distance[n], done[n] = moved, floor, SHUT
        if floor - moved - least > enough:
            continue
        wide = spans[1][u] - spans[0][u] > shortest
        if between[n] < moved + least and moved > hopeless and wide:
            continue
        if not turned:
            turn_of(u, a, shapes, placed, one_r, one_half)
            turned = True
        turn_of(u, b, shapes, placed, two_r, two_half)
        floor = max(floor, _apart(one_c, one_half, two_c, two_half))
        distance[n] = floor = max(floor, parted(convex, a, b, one_r, one_c, two_r, two_c))
        low = floor - moved - least
        if low >= slack - precision and (low > 0.0 or spans[0][u] >= open_until):
            continue
        if low < 0.0 and moved > hopeless and wide:
            continue
        enough = moved + least + max(slack, 0.0)
        low, _ = bounds_of(convex, a, b, one_r, one_c, two_r, two_c, enough, -math.inf, work)
        done[n] = LEFT
        if low > -math.inf:
            done[n], distance[n] = ASKED, low


@kernel(makes=False)
def settle(items, interval, pairs, keep, sets, radius, spans, middle, found, known, limits, halves):
    """How many halves there are of items that can still tell something; they are in `halves`, shape (2, …).

    -1 if a distance of what was looked at is larger than it can be.
    `found` is what `look` gives, `limits` (resolution, SHORTEST, PRECISION, PROMPT). Of each set `known` has
    its least slack; when its first violation is; the items that tell of these, shape (2, sets), or -1 where
    none here does; whether these cannot be shown to be kept, nor to be missed; and how many distances were
    asked for. Items of one interval follow one another, and so do those of each half. An item is halved if
    its bound on its slack, which takes the place of its distance of centres, is less by PRECISION than the
    least of its set, or not above 0 where a violation PROMPT before the first one is looked for.
    """
    done, distance, approach, between = found
    slack, first, telling, unshown, queries = known
    resolution, shortest, precision, prompt = limits
    count = items[0].shape[0]
    for n in range(slack.shape[0]):
        telling[0, n] = telling[1, n] = -1
    for n in range(count):
        p, u = items[0][n], items[1][n]
        own = sets[p]
        least = keep[1][p] if spans[0][u] >= keep[2][p] else keep[0][p]
        most = between[n] + radius[pairs[p, 0]] + radius[pairs[p, 1]]
        if not distance[n] <= most + precision:  # also what is not a number
            return -1
        low = distance[n] - approach[n] - least
        between[n] = low
        if done[n] == SHUT:
            continue
        queries[own] += 1
        room = distance[n] - (keep[1][p] if middle[u] >= keep[2][p] else keep[0][p])
        last = approach[n] <= resolution or spans[1][u] - spans[0][u] <= shortest
        lost = last and low <= 0.0 and room >= 0.0
        if room < slack[own]:
            slack[own], telling[0, own], unshown[0, own] = room, n, lost
        if (lost or room < 0.0) and middle[u] < first[own]:
            first[own], telling[1, own], unshown[1, own] = middle[u], n, lost
        if last:
            between[n] = math.inf
    total, n = 0, 0
    while n < count:
        end = n
        while end < count and interval[end] == interval[n]:
            end += 1
        for part in range(2):
            for m in range(n, end):
                own, low = sets[items[0][m]], between[m]
                begin = spans[0][items[1][m]]
                if low < slack[own] - precision or (low <= 0.0 and begin < first[own] - prompt):
                    halves[0, total], halves[1, total] = items[0][m], 2 * interval[m] + part
                    total += 1
        n = end
    return total


@subkernel
def _apart(one_c, one_half, two_c, two_half):
    """Distance of two boxes along the world's axes; negative is what parts them where they overlap."""
    outside, deepest = 0.0, -math.inf
    for i in range(3):
        gap = abs(two_c[i] - one_c[i]) - one_half[i] - two_half[i]
        outside += max(gap, 0.0) ** 2
        deepest = max(deepest, gap)
    return math.sqrt(outside) if outside > 0.0 else deepest
