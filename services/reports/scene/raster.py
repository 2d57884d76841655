"""Compiled loops that fill triangles and draw edges into pixels with a depth."""

import math

import numpy as np

from services.kernel import kernel


@kernel(error_model="numpy")
def fill(color, depth, corners, colors, near, scale):
    """Triangles; the nearest wins.

    Args:
        color: Shape (height, width, 3), written.
        depth: Shape (height, width) [m], written.
        corners: Right, up and depth of each corner before the perspective, shape (F, 3, 3) [m].
        colors: Shape (F, 3).
        near: What is nearer is cut away [m].
        scale: Pixels for one metre at a depth of one metre.
    """
    height, width = depth.shape
    kept = np.empty((4, 3))
    for f in range(len(corners)):
        count = 0
        for i in range(3):
            j = (i + 1) % 3
            a, b = corners[f, i, 2], corners[f, j, 2]
            if a >= near:
                for c in range(3):
                    kept[count, c] = corners[f, i, c]
                count += 1
            if (a >= near) != (b >= near):
                u = (near - a) / (b - a)
                for c in range(3):
                    kept[count, c] = (1 - u) * corners[f, i, c] + u * corners[f, j, c]
                count += 1
        for k in range(1, count - 1):
            x0, y0 = width / 2 + scale * kept[0, 0] / kept[0, 2], height / 2 - scale * kept[0, 1] / kept[0, 2]
            x1, y1 = width / 2 + scale * kept[k, 0] / kept[k, 2], height / 2 - scale * kept[k, 1] / kept[k, 2]
            x2 = width / 2 + scale * kept[k + 1, 0] / kept[k + 1, 2]
            y2 = height / 2 - scale * kept[k + 1, 1] / kept[k + 1, 2]
            area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0)
            if abs(area) < 1e-9:
                continue
            z0, z1, z2 = 1 / kept[0, 2], 1 / kept[k, 2], 1 / kept[k + 1, 2]
            first, last = max(min(y0, y1, y2) - 0.5, 0.0), min(max(y0, y1, y2) + 0.5, height - 1.0)
            left, right = max(min(x0, x1, x2) - 0.5, 0.0), min(max(x0, x1, x2) + 0.5, width - 1.0)
            for row in range(int(first), int(last) + 1):
                for column in range(int(left), int(right) + 1):
                    x, y = column + 0.5, row + 0.5
                    v = ((x - x0) * (y2 - y0) - (y - y0) * (x2 - x0)) / area
                    w = ((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) / area
                    if v < 0 or w < 0 or v + w > 1:
                        continue
                    here = 1 / ((1 - v - w) * z0 + v * z1 + w * z2)
                    if here < depth[row, column]:
                        depth[row, column] = here
                        for c in range(3):
                            color[row, column, c] = colors[f, c]


@kernel(error_model="numpy")
def stroke(color, depth, ends, ink, near, scale, slack):
    """Edges, where nothing that was filled hides them.

    Args:
        color: Shape (height, width, 3), written.
        depth: Shape (height, width) [m].
        ends: As the corners of `fill`, shape (E, 2, 3) [m].
        ink: Their colour, mixed half and half with what is there, shape (3,).
        near: As in `fill`.
        scale: As in `fill`.
        slack: By how much of its depth an edge may lie behind the surface that it bounds.
    """
    height, width = depth.shape
    for e in range(len(ends)):
        a, b = ends[e, 0, 2], ends[e, 1, 2]
        if a < near and b < near:
            continue
        first = max(0.0, (near - a) / (b - a)) if a < near else 0.0
        last = min(1.0, (near - a) / (b - a)) if b < near else 1.0
        za, zb = (1 - first) * a + first * b, (1 - last) * a + last * b
        x0 = width / 2 + scale * ((1 - first) * ends[e, 0, 0] + first * ends[e, 1, 0]) / za
        y0 = height / 2 - scale * ((1 - first) * ends[e, 0, 1] + first * ends[e, 1, 1]) / za
        x1 = width / 2 + scale * ((1 - last) * ends[e, 0, 0] + last * ends[e, 1, 0]) / zb
        y1 = height / 2 - scale * ((1 - last) * ends[e, 0, 1] + last * ends[e, 1, 1]) / zb
        steps = int(min(max(abs(x1 - x0), abs(y1 - y0), 1.0), 8.0 * width))
        for i in range(steps + 1):
            u = i / steps
            column, row = math.floor(x0 + u * (x1 - x0)), math.floor(y0 + u * (y1 - y0))
            if column < 0 or row < 0 or column >= width or row >= height:
                continue
            if 1 / ((1 - u) / za + u / zb) < depth[row, column] * (1 + slack):
                for c in range(3):
                    color[row, column, c] = 0.5 * color[row, column, c] + 0.5 * ink[c]
