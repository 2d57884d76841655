"""What of a surface of triangles lies in no shape, exactly: triangles are cut by the faces of shapes."""

import numpy as np

from tests.robots.shapes import Array, Shape

SIDES = 96  # of the prism inside a cylinder that stands for it
SLACK = 2e-7  # [m] faces stand out by this: what lies on a face is not cut off by rounding
THIN = 1e-12  # [m²] less area than this is rounding


def faces(shape: Shape) -> tuple[Array, Array]:
    """Outer normals (N, 3) and offsets (N,) of a box, or of a prism within a cylinder."""
    if shape.kind == "box":
        normals, offsets = np.concatenate((np.eye(3), -np.eye(3))), np.tile(shape.size / 2, 2)
    else:
        assert shape.kind == "cylinder"
        angles = 2 * np.pi * np.arange(SIDES) / SIDES
        around = np.stack((np.cos(angles), np.sin(angles), np.zeros(SIDES)), axis=1)
        normals = np.concatenate((around, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]))
        radius, length = shape.size
        offsets = np.concatenate((np.full(SIDES, radius * np.cos(np.pi / SIDES)), [length / 2] * 2))
    normals = normals @ shape.pose[:3, :3].T
    return normals, offsets + normals @ shape.pose[:3, 3] + SLACK


def divided(polygon: Array, normal: Array, offset: float) -> tuple[Array, Array]:
    """The parts of a convex polygon (N, 3) within a plane and beyond it, maybe empty."""
    height = polygon @ normal - offset
    parts: tuple[list[Array], list[Array]] = ([], [])
    for i, corner in enumerate(polygon):
        j = (i + 1) % len(polygon)
        parts[int(height[i] > 0)].append(corner)
        if (height[i] > 0) != (height[j] > 0):
            between = corner + height[i] / (height[i] - height[j]) * (polygon[j] - corner)
            parts[0].append(between)
            parts[1].append(between)
    return np.array(parts[0]).reshape(-1, 3), np.array(parts[1]).reshape(-1, 3)


def area(polygon: Array) -> float:
    spokes = polygon[1:] - polygon[0]
    return float(np.linalg.norm(np.cross(spokes[:-1], spokes[1:]).sum(axis=0)) / 2)


def uncovered(triangles: Array, shapes: list[Shape]) -> list[Array]:
    """Convex polygons that together are the part of triangles (N, 3, 3) outside all shapes."""
    whole = np.zeros(len(triangles), dtype=bool)
    for shape in shapes:
        normals, offsets = faces(shape)
        whole |= (triangles @ normals.T <= offsets).all(axis=(1, 2))
    left = list(triangles[~whole])
    for shape in shapes:
        normals, offsets = faces(shape)
        beyond: list[Array] = []
        for polygon in left:
            if ((polygon @ normals.T - offsets).min(axis=0) >= 0).any():
                beyond.append(polygon)
                continue
            rest = polygon
            for normal, offset in zip(normals, offsets, strict=True):
                rest, cut = divided(rest, normal, offset)
                if len(cut) > 2 and area(cut) > THIN:
                    beyond.append(cut)
                if len(rest) < 3:
                    break
        left = beyond
    return left
