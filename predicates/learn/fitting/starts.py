"""Where fits begin: lines and arcs through a few points of the track which most others agree with."""

import numpy as np

from predicates.learn.fitting.cells import Cells
from predicates.learn.fitting.curve import Frame
from predicates.learn.fitting.priors import RADIUS, RADIUS_SPREAD
from predicates.learn.fitting.vectors import cross
from predicates.learn.track import Array

TRIPLES = 300
"""[1] Triples of points tried; even with half of the points outliers, about 37 are clean."""

JUDGES = 80
"""[1] Points that judge a triple."""

NEAR = 0.006
"""[m] Beyond this a point does not agree: three times the usual deviation."""

SEED = 20100524
"""[1] Fixed: the same track always gives the same answer."""

Start = tuple[Frame, Array]


def starts(cells: Cells) -> tuple[Start, Start]:
    """Where the best line and the best arc begin: frame and parameters (6,)."""
    generator = np.random.default_rng(SEED)
    count = len(cells.points)
    triples = np.sort(generator.integers(0, count, (TRIPLES, 3)), axis=1)
    judges = cells.points[np.unique(np.linspace(0, count - 1, min(count, JUDGES)).astype(int))]
    points = cells.points[triples]
    return _line(points, judges, cells), _arc(points, judges, cells)


def _agreement(squares: Array) -> Array:
    """MSAC's cost of each candidate: squared distances, none counting more than NEAR."""
    return np.minimum(squares / NEAR**2, 1).sum(axis=1)


def _line(points: Array, judges: Array, cells: Cells) -> Start:
    first, _, last = np.moveaxis(points, 1, 0)
    along = last - first
    lengths = np.linalg.norm(along, axis=1)
    tangent = along / np.maximum(lengths, 1e-9)[:, None]
    offset = judges[None] - first[:, None]
    squares = (offset**2).sum(axis=2) - np.einsum("mnk,mk->mn", offset, tangent) ** 2
    cost = np.where(lengths > 1e-6, _agreement(squares), np.inf)
    best = int(np.argmin(cost))
    if not np.isfinite(cost[best]):
        return Frame.about(cells.points[0], np.array([1.0, 0.0, 0.0])), np.zeros(6)
    centre = cells.points.mean(axis=0)
    o = first[best] + tangent[best] * ((centre - first[best]) @ tangent[best])
    return Frame.about(o, tangent[best]), np.zeros(6)


def _arc(points: Array, judges: Array, cells: Cells) -> Start:
    first, second, last = np.moveaxis(points, 1, 0)
    one, other = second - first, last - first
    normal = cross(one, other)
    squared = (normal**2).sum(axis=1)
    valid = squared > 1e-14
    safe = np.where(valid, squared, 1.0)[:, None]
    towards = (other**2).sum(axis=1)[:, None] * cross(normal, one)
    towards = (towards + (one**2).sum(axis=1)[:, None] * cross(other, normal)) / (2 * safe)
    radius = np.where(valid, np.linalg.norm(towards, axis=1), RADIUS)
    centre, axis = first + towards, normal / np.sqrt(safe)
    offset = judges[None] - centre[:, None]
    z = np.einsum("mnk,mk->mn", offset, axis)
    rho = np.sqrt(np.maximum((offset**2).sum(axis=2) - z * z, 0))
    cost = _agreement(z * z + (rho - radius[:, None]) ** 2)
    cost = cost + (np.log(np.maximum(radius, 1e-9) / RADIUS) / RADIUS_SPREAD) ** 2 / 2
    best = int(np.argmin(np.where(valid, cost, np.inf)))
    if not valid[best]:
        frame, parameters = _line(points, judges, cells)
        parameters[4] = 1 / RADIUS
        return frame, parameters
    inward = (centre[best] - second[best]) / radius[best]
    parameters = np.zeros(6)
    parameters[4] = 1 / radius[best]
    return Frame.about(second[best], cross(inward, axis[best]), inward), parameters
