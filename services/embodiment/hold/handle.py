"""What a hand needs to know of a handle: its bar, and where it goes as the container moves."""

from dataclasses import dataclass
from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from sdt_kg.twin import Container
from services.embodiment.body.world import World

Array = NDArray[np.float64]

SAMPLES = 4000  # surface points of a handle; 1 per 4 mm² of a usual bar
MIDDLE = 0.25  # [1] share of the bar's half length about its middle that tells its cross-section
BAR_DEPTH = 0.03  # [m] of a handle without a gap behind it: what counts as bar, from its outer face
SNAP = 0.9  # [1] cosine from which the handle's own axis stands for the opening direction
PROBE = 1e-4  # [rad or m] change of the container's joint that tells the opening direction


@dataclass(frozen=True, slots=True, eq=False)
class Bar:
    """Part of a handle that is gripped, in the frame of the model joint that carries it.

    Attributes:
        joint: Pinocchio's index of that joint.
        centre: Middle of the bar [m], shape (3,).
        along: Unit vector along the bar.
        outward: Unit vector away from the front.
        length, depth, width: Extents along, outward and across [m].
    """

    joint: int
    centre: Array
    along: Array
    outward: Array
    length: float
    depth: float
    width: float


class Mechanics:
    """Configurations of the kitchen as one container moves; everything else stays.

    Attributes:
        moving: Coordinates that move with the container, shape (m,).
        parts: IRIs of the joints of `moving`.
    """

    def __init__(self, world: World, container: Container) -> None:
        scene = world.scene
        self.world, self.container = world, container
        active = scene.coordinate[container.active_joint]
        self._source = int(scene.coupling.source[active])
        unit = np.zeros(scene.model.nq)
        unit[self._source] = 1.0
        self._rates = scene.coupling.rates(unit)
        own = scene.coordinate[container.joint]
        zero = scene.coupling.positions(np.zeros(scene.model.nq))
        self._multiplier, self._offset = float(self._rates[own]), float(zero[own])
        self._zero = zero
        self.moving = np.flatnonzero(self._rates)
        self.parts = tuple(scene.names[k] for k in self.moving)
        self.start = float(scene.q((0.0, 0.0, 0.0), {})[own])

    def positions(self, values: Array) -> Array:
        """Positions of the moving coordinates for values (T,) of the container's own joint, shape (T, m)."""
        active = (np.asarray(values) - self._offset) / self._multiplier
        return self._zero[self.moving] + active[:, None] * self._rates[self.moving]

    def rates(self, values: Array) -> Array:
        """Velocities of the moving coordinates for velocities (T,) of the container's own joint."""
        return (np.asarray(values) / self._multiplier)[:, None] * self._rates[self.moving]

    def put(self, q: Array, values: Array) -> Array:
        """Copies of scene configurations q (…, nq) with the container at `values` (T,), shape (T, nq)."""
        placed = np.empty((len(values), q.shape[-1]))
        placed[:] = q
        placed[:, self.moving] = self.positions(values)
        return placed

    def put_each(self, q: Array, values: Array) -> Array:
        """Copies of scene configurations q (T, nq), each with the container at its value (T,)."""
        placed = q.copy()
        placed[:, self.moving] = self.positions(values)
        return placed

    def handle_poses(self, q: Array, joint: int, values: Array) -> tuple[Array, Array]:
        """World poses of a joint frame at each value: rotations (T, 3, 3), translations (T, 3)."""
        return self.world.poses(self.put(q, values), joint)


def find_bar(world: World, mechanics: Mechanics, q: Array) -> Bar | None:
    """The bar of the container's handle at scene configuration q; None if the handle has no geometry."""
    shapes = world.shapes_of((mechanics.container.handle,))
    if not len(shapes):
        return None
    solids, placed = world.scene.solids, tuple(world.joint_T_shape[k] for k in shapes)
    places = np.array([np.column_stack((one.rotation, one.translation)) for one in placed])
    covariance, points = _surface(tuple(solids[k].shape for k in shapes), places.tobytes())
    joint = int(world.boxes[0][shapes[0]])
    outward = _opening_direction(mechanics, q, joint, points.mean(axis=1))
    along, outward = _axes(covariance, outward)
    across = np.cross(outward, along)
    local = np.stack([along, outward, across]) @ points
    low, high = local.min(axis=1), local.max(axis=1)
    middle, length = (low[0] + high[0]) / 2, high[0] - low[0]
    core = local[:, np.abs(local[0] - middle) < MIDDLE * length / 2]
    core = core if core.size else local
    core = core[:, core[1] > core[1].max() - BAR_DEPTH]
    c_low, c_high = core.min(axis=1), core.max(axis=1)
    centre = middle * along + (c_low[1] + c_high[1]) / 2 * outward + (c_low[2] + c_high[2]) / 2 * across
    return Bar(joint, centre, along, outward, length, c_high[1] - c_low[1], c_high[2] - c_low[2])


def _opening_direction(mechanics: Mechanics, q: Array, joint: int, point: Array) -> Array:
    start = mechanics.start
    r, p = mechanics.handle_poses(q, joint, np.array([start, start + PROBE]))
    away = (r[1] @ point + p[1]) - (r[0] @ point + p[0])
    return r[0].T @ (away / np.linalg.norm(away))


def _covariance(corners: Array) -> Array:
    """Covariance of the surface of triangles (N, 3, 3), exact, shape (3, 3)."""
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    total = corners.sum(axis=1)
    mean = area @ total / 3 / area.sum()
    squares = np.einsum("n,nki,nkj->ij", area, corners, corners) + np.einsum(
        "n,ni,nj->ij", area, total, total
    )
    return squares / 12 / area.sum() - np.outer(mean, mean)


def _axes(covariance: Array, outward: Array) -> tuple[Array, Array]:
    """(along, outward): the longest axis across the opening direction, and that direction, snapped."""
    _, axes = np.linalg.eigh(covariance)
    along = next((axis for axis in axes.T[::-1] if abs(axis @ outward) < SNAP), axes[:, -1])
    along = along * np.sign(along[np.argmax(np.abs(along))])
    outward = outward - (outward @ along) * along
    outward = outward / np.linalg.norm(outward)
    for axis in axes.T:
        if abs(axis @ outward) > SNAP and abs(axis @ along) < 0.5:
            outward = np.sign(axis @ outward) * axis
    return along, outward


@lru_cache(maxsize=64)
def _surface(shapes: tuple[coal.CollisionGeometry, ...], places: bytes) -> tuple[Array, Array]:
    """Covariance of the surface of shapes, and points on it, shape (3, SAMPLES), in the frame of their joint.

    Kept, so not to be changed: it is the same for all robots.

    Args:
        shapes: They must not be changed afterwards.
        places: The pose of each in that frame, shape (N, 3, 4), as bytes.
    """
    at = np.frombuffer(places).reshape(-1, 3, 4)
    triangles = (
        _triangles(one) @ place[:, :3].T + place[:, 3] for one, place in zip(shapes, at, strict=True)
    )
    corners = np.concatenate([*triangles])
    edge_1, edge_2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    part = np.cumsum(np.linalg.norm(np.cross(edge_1, edge_2), axis=1))
    share, u, v = _shares()
    chosen = np.searchsorted(part / part[-1], share, side="right")
    points = corners[chosen, 0] + u[:, None] * edge_1[chosen] + (v - u)[:, None] * edge_2[chosen]
    return _covariance(corners), np.ascontiguousarray(points.T)


@lru_cache(maxsize=1)
def _shares() -> tuple[Array, Array, Array]:
    """Random shares that choose triangles, and places on them; kept, so not to be changed."""
    rng = np.random.default_rng(0)
    share = rng.random(SAMPLES)
    u, v = np.sort(rng.random((2, SAMPLES)), axis=0)
    return share, u, v


def _triangles(shape: coal.CollisionGeometry) -> Array:
    """Triangles of a shape, or of its own box for round ones, shape (N, 3, 3)."""
    if isinstance(shape, coal.BVHModelBase):
        vertices = np.array(shape.vertices())
        indices = np.array(
            [[t[0], t[1], t[2]] for t in (shape.tri_indices(i) for i in range(shape.num_tris))]
        )
        return vertices[indices]
    low, high = np.array(shape.aabb_local.min_), np.array(shape.aabb_local.max_)
    corners = np.array(
        [
            [(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]]
            for i in (0, 1)
            for j in (0, 1)
            for k in (0, 1)
        ]
    )
    faces = [
        (0, 1, 3),
        (0, 3, 2),
        (4, 6, 7),
        (4, 7, 5),
        (0, 4, 5),
        (0, 5, 1),
        (2, 3, 7),
        (2, 7, 6),
        (0, 2, 6),
        (0, 6, 4),
        (1, 5, 7),
        (1, 7, 3),
    ]
    return corners[np.array(faces)]
