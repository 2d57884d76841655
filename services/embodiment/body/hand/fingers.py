"""Compiled inner loops for a hand without its arm: how near its fingers are to a handle, closed on it."""

import math

import numpy as np

from services.embodiment.body.hand.placing import closed_by
from services.embodiment.body.kernels import seen_from
from services.kernel import kernel, subkernel
from services.physics.geometry.convex import parted
from services.physics.geometry.packed import bounds_of

CENTRED = 5  # times that a hand is centred and closed; two are usual


@subkernel
def _gaps(shares, sides, hand, closing, handle, shapes, room, near, most):
    """Distances of the handle from the nearest finger shape of each of two `sides` (2, fingers), in room[1].

    Negative where they are in each other: as deep as their own boxes are, at least. Of what is farther than
    `most` only that is told. `handle` is (indices, rotations, centres) as the tool sees it. The shapes in
    `near` (2,), which were the nearest before, are looked at first.
    """
    at, out, work = room[0], room[1], room[2]
    closed_by(shares, hand, closing, room)
    out[0] = out[1] = math.inf
    one, other = near[0], near[1]
    for turn in range(-2, sides.shape[1]):
        n = turn if turn >= 0 else (one if turn == -2 else other)
        if (turn > -2 and n == one) or (turn >= 0 and n == other):
            continue
        i = hand[1] + n
        s = hand[0][i]
        for m in range(handle[0].shape[0]):
            h, enough = handle[0][m], -math.inf
            for side in range(2):
                if sides[side, n]:  # what is farther than the nearest so far is not the nearest
                    enough = max(enough, min(out[side], most), 0.0)
            if enough < 0.0:
                break
            own_r, own_c, there_r, there_c = at[0][i], at[1][i], handle[1][m], handle[2][m]
            widest = parted(shapes, s, h, own_r, own_c, there_r, there_c)
            if widest > enough:
                continue
            low, _ = bounds_of(shapes, s, h, own_r, own_c, there_r, there_c, enough, -math.inf, work)
            if low == -math.inf:
                low = min(widest, 0.0)
            for side in range(2):
                if sides[side, n] and low < out[side]:
                    out[side], near[side] = low, n


@subkernel
def _closing(k, shares, sides, hand, closing, handle, shapes, touch, rounds, room, guess, near):
    """Whether finger joint k alone can be closed until it touches; shares[k], in [0, 1], says how far.

    Regula falsi (Illinois) for the gap of the side that is farther to fall to within `touch`. It begins at
    `guess`, (a share, by how much a share of 1 closes the gap or 0), which then is what was found.
    """
    low, at_low, high, at_high, before = -1.0, 0.0, 2.0, 0.0, 0.0  # ends outside [0, 1] are not known yet
    share, slope = guess[0], guess[1]
    for _ in range(rounds):
        for other in range(shares.shape[0]):
            shares[other] = share if other == k else 0.0
        _gaps(shares, sides, hand, closing, handle, shapes, room, near, math.inf)
        at = max(room[1][0], room[1][1]) - touch / 2  # what is accepted lies on both sides of 0
        if at > touch / 2:
            at_high = at_high / 2 if before > 0.0 else at_high
            low, at_low = share, at
        else:
            at_low = at_low / 2 if before < 0.0 else at_low
            high, at_high = share, at
            if at > -touch / 2:
                break
        before = at
        if low >= 0.0 and high <= 1.0:
            share = (low * at_high - high * at_low) / (at_high - at_low)
        elif low >= 1.0 or high <= 0.0:
            return False
        elif slope > 0.0:
            share = min(max(share + at / slope, 0.0), 1.0)
        else:
            share = 1.0 if at > 0.0 else 0.0
    if high > 1.0:
        return False
    if 0.0 <= low < high:  # to rounding they may be one, where the gap is a step
        guess[1] = (at_low - at_high) / (high - low)
    shares[k] = guess[0] = high
    return True


@subkernel
def _stands(sides, hand):
    """The side of `sides` (2, fingers) of whose fingers none moves; −1 if there is none, or none moves."""
    still = -1
    for side in range(2):
        moves = False
        for n in range(sides.shape[1]):
            if sides[side, n]:
                on = hand[4][0][hand[0][hand[1] + n]]
                for joint in hand[2]:
                    moves = moves or joint == on
        if not moves:
            still = side if still < 0 else 2
    return still if still < 2 else -1


@kernel
def closed(tool, shares, sides, hand, closing, handle, shapes, touch, rounds, room, guess, near):
    """Whether a hand at a tool pose can be centred across a handle and closed on it.

    Where the fingers of one side stand still, the tool brings these to the bar, and the others close on it.
    `tool` (rotation, translation) is then where that is; `shares` (F,) are how far its finger joints are
    closed. `sides` (F, 2, fingers) are those that each closes; `handle` is in the world. What closing
    each joint found before is in `guess` (F, 2) and `near` (F, 2): it saves looks, at first all are 0.
    """
    seen = np.empty_like(handle[1]), np.empty_like(handle[2])
    count, found = shares.shape[0], np.empty_like(shares)
    still = _stands(sides[0], hand) if count == 1 else -1
    closes = np.empty_like(sides[0])
    for side in range(2):
        for n in range(closes.shape[1]):
            closes[side, n] = sides[0, 1 - still if still >= 0 else side, n]
    for _ in range(CENTRED):
        for m in range(handle[0].shape[0]):
            seen_from(tool[0], tool[1], handle[1][m], handle[2][m], seen[0][m], seen[1][m])
        there = handle[0], seen[0], seen[1]
        if still >= 0:  # the tool brings this finger to the bar, the joint the other
            _gaps(shares, sides[0], hand, closing, there, shapes, room, near[0], math.inf)
            away = room[1][still] - touch / 2
            if not math.isfinite(away):
                return False
            if abs(away) > touch / 2:
                for i in range(3):
                    tool[1][i] += (away if still == 1 else -away) * tool[0][i, 1]
                continue
            rest = hand, closing, there, shapes, touch, rounds, room, guess[0], near[0]
            return _closing(0, shares, closes, *rest)
        for k in range(count):
            rest = hand, closing, there, shapes, touch, rounds, room, guess[k], near[k]
            if not _closing(k, shares, sides[k], *rest):
                return False
            found[k] = shares[k]
        for k in range(count):
            shares[k] = found[k]
        if count > 1:
            return True
        _gaps(shares, sides[0], hand, closing, there, shapes, room, near[0], math.inf)
        left, right = room[1][0], room[1][1]
        if not math.isfinite(left + right) or abs(left - right) < touch:
            return True
        for i in range(3):  # the side that is farther tells where the bar lies
            tool[1][i] += (right - left) / 2 * tool[0][i, 1]
    return False


@kernel
def engaged(tool, shares, pads, hand, closing, handle, shapes, reach, inward, room):
    """Whether on both sides a body of a closed hand still meets a handle that is moved by `reach`.

    The handle is moved each way along x and along z of the tool, and the body by its distance and `inward`
    more: there they overlap. `pads` are (finger shapes of each body (B, fingers), its side of the tool along
    y (B,), 1 or −1). The rest is as in `closed`, which left the hand so.
    """
    seen, place = (np.empty_like(handle[1]), np.empty_like(handle[2])), np.empty(3)
    near, above, below = np.empty(2, np.int64), False, False
    there, own = (handle[0], seen[0], seen[1]), np.empty((2, pads[0].shape[1]), np.bool_)
    for b in range(pads[0].shape[0]):
        near[0] = near[1] = 0
        for f in range(own.shape[1] - 1, -1, -1):
            own[0, f] = own[1, f] = pads[0][b, f]
            if pads[0][b, f]:
                near[0] = near[1] = f
        over, more = True, 0.0
        for look in range(5):
            for i in range(3):
                place[i] = tool[1][i] - pads[1][b] * more * tool[0][i, 1]
                if look > 0:
                    way = reach if look % 2 else -reach
                    place[i] -= way * tool[0][i, 0 if look < 3 else 2]
            for m in range(handle[0].shape[0]):
                seen_from(tool[0], place, handle[1][m], handle[2][m], seen[0][m], seen[1][m])
            _gaps(shares, own, hand, closing, there, shapes, room, near, math.inf if look == 0 else 0.0)
            if look == 0:
                more = max(room[1][0], 0.0) + inward
            elif room[1][0] > 0.0:
                over = False
                break
        above = above or (over and pads[1][b] > 0.0)
        below = below or (over and pads[1][b] <= 0.0)
    return above and below
