"""Compiled: the deepest point of triangles in a convex body."""

import math

from services.kernel import kernel, subkernel

WAITING = 128
"""[1] Parts of a triangle that wait in the room: three of each size, and there are few sizes above `fine`."""


@kernel(makes=False)
def deepest_point(triangles, normals, offsets, fine, room):
    """Depth of the deepest point of triangles in a body whose points x have normals·x ≤ offsets; 0 outside.

    It may be too little by `fine`: what may be deeper by more is cut in four.
    """
    found = 0.0
    for n in range(triangles.shape[0]):
        waiting = 1
        for k in range(3):
            for i in range(3):
                room[0, k, i] = triangles[n, k, i]
        while waiting > 0:
            waiting -= 1
            most, amid, face = _depths(room[waiting], normals, offsets, found + fine)
            found = max(found, amid)
            if most > found + fine:
                most = min(most, _of_two(room[waiting], normals, offsets, face))
            if most <= found + fine:
                continue
            if waiting + 4 > room.shape[0]:
                found = most
                continue
            _cut(room, waiting)
            waiting += 4
    return found


@subkernel
def _from(f, k, corners, normals, offsets):
    """How far corner k of a triangle is from the plane of face f, positive within [m]."""
    x, y, z = corners[k, 0], corners[k, 1], corners[k, 2]
    return offsets[f] - (normals[f, 0] * x + normals[f, 1] * y + normals[f, 2] * z)


@subkernel
def _depths(corners, normals, offsets, enough):
    """(what no point of a triangle is deeper than, how deep its middle is, the face that is nearest to it).

    How far a face's plane is away is linear on the triangle. So the middle is as deep as the least of the
    corners' means, and no point is deeper than the least of their largest. Once that is enough, it is all.
    """
    most, amid, nearest = math.inf, math.inf, 0
    for f in range(normals.shape[0]):
        a, b, c = (
            _from(f, 0, corners, normals, offsets),
            _from(f, 1, corners, normals, offsets),
            _from(f, 2, corners, normals, offsets),
        )
        most = min(most, max(a, b, c))
        if most <= enough:
            return most, -math.inf, f
        if (a + b + c) / 3.0 < amid:
            amid, nearest = (a + b + c) / 3.0, f
    return most, amid, nearest


@subkernel
def _of_two(corners, normals, offsets, one):
    """What no point of a triangle is deeper than, by two faces: one, and that nearest where this is farthest.

    Any mean of both distances is linear too; its largest is the least where two corners have it.
    """
    far, other = 0, 0
    for k in range(1, 3):
        if _from(one, k, corners, normals, offsets) > _from(one, far, corners, normals, offsets):
            far = k
    for f in range(1, normals.shape[0]):
        if _from(f, far, corners, normals, offsets) < _from(other, far, corners, normals, offsets):
            other = f
    least = math.inf
    for k in range(3):
        m = (k + 1) % 3
        slope = _from(one, k, corners, normals, offsets) - _from(one, m, corners, normals, offsets)
        fall = _from(other, k, corners, normals, offsets) - _from(other, m, corners, normals, offsets)
        share = slope / (slope - fall) if slope != fall else 0.0
        share, largest = min(max(share, 0.0), 1.0), -math.inf
        for n in range(3):
            a, b = _from(one, n, corners, normals, offsets), _from(other, n, corners, normals, offsets)
            largest = max(largest, (1.0 - share) * a + share * b)
        least = min(least, largest)
    return least


@subkernel
def _cut(room, n):
    """The triangle in room[n] is cut in four, in room[n] to room[n + 3]: that amid its sides first."""
    for i in range(3):
        a, b, c = room[n, 0, i], room[n, 1, i], room[n, 2, i]
        ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
        room[n + 1, 0, i], room[n + 1, 1, i], room[n + 1, 2, i] = a, ab, ca
        room[n + 2, 0, i], room[n + 2, 1, i], room[n + 2, 2, i] = ab, b, bc
        room[n + 3, 0, i], room[n + 3, 1, i], room[n + 3, 2, i] = ca, bc, c
        room[n, 0, i], room[n, 1, i], room[n, 2, i] = ab, bc, ca
