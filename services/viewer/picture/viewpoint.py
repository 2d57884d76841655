"""From where a kitchen is looked at first: where most of its containers are seen from their fronts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import local_name
from sdt_kg.twin import Container
from services.viewer.picture.looks import Looks, handle_path

Array = NDArray[np.float64]
Claims = NDArray[np.bool_]

HEIGHTS = (1.6, 2.4)
"""[m] At which the camera may stand."""
AWAY = (2.0, 3.0, 4.5)
"""[m] From some front it may stand so far."""
TURNED = (-0.7, 0.0, 0.7)
"""[rad] And so much aside of its normal."""
FARTHEST = 8.0
"""[m] Fronts beyond are too small in the picture."""
NEAREST = 1.2
"""[m] From a front: nearer, it fills the picture."""
CLEAR = 0.6
"""[m] From the camera to any front, also one behind it: else what opens opens into its face."""
CONE = np.cos(np.radians(32.0))
"""[1] Cosine of the angle between the middle of the picture and what is seen between the panels."""
FACING = np.cos(np.radians(70.0))
"""[1] Cosine of the angle between a front's normal and the way to the camera: beyond, one sees a line."""
ABOVE = 0.1
"""[m] The camera stands where nothing is below it down to here: else that fills half the picture."""
BEFORE = 0.08
"""[m] The point of a front that has to be seen lies so far before its handle."""
STANDS = 0.8
"""[m] So far beyond the end of a handle's way stands about the robot that pulled it there."""
ROOM = 2.5
"""[m] From the camera to that robot: nearer, it fills the picture."""
FIRST = 0.02
"""[1] Part of the way to open in which a handle moves along the normal of its front."""
FRONTS = 40
"""[1] Of more fronts some are looked at, evenly chosen."""
TRIANGLES = 1500
"""[1] The largest hide what is behind them; smaller ones hide little."""
LINES = 64
"""[1] Of sight, looked along at once: what is found of them fits into a cache."""


@dataclass(frozen=True, slots=True)
class Fronts:
    """Where containers are opened.

    Attributes:
        points: Before each handle, shape (F, 3) [m].
        normals: Which way each handle goes first, shape (F, 3), of length 1.
        robot: About where stands who has opened the first, shape (3,) [m]; None: nobody has to be seen.
    """

    points: Array
    normals: Array
    robot: Array | None = None


def fronts_of(
    looks: Looks, joints: Mapping[str, float], asked: Container, containers: Sequence[Container]
) -> Fronts:
    """Of the container that is asked about, first, and of others, as far as their handles move.

    Args:
        looks: The kitchen's.
        joints: Joint name → position [rad or m].
        asked: What is asked about.
        containers: All of the kitchen.
    """
    others = [each for each in containers if each.iri != asked.iri]
    points: list[Array] = []
    normals: list[Array] = []
    for each in (asked, *others[:: 1 + len(others) // FRONTS]):
        ways = each.lower + np.array([0.0, FIRST]) * (each.open_from - each.lower)
        path = handle_path(looks, joints, local_name(each.handle), local_name(each.joint), ways, len(ways))
        moved = path[-1] - path[0]
        if away := float(np.linalg.norm(moved)):
            normals.append(moved / away)
            points.append(path[0] + BEFORE * normals[-1])
    return Fronts(
        np.array(points).reshape(-1, 3), np.array(normals).reshape(-1, 3), _robot(looks, joints, asked)
    )


def _robot(looks: Looks, joints: Mapping[str, float], asked: Container) -> Array | None:
    """About where the robot stands once it has opened that: beyond the end of the handle's way, along it."""
    ways = asked.lower + np.array([1.0 - FIRST, 1.0]) * (asked.open_from - asked.lower)
    before, end = handle_path(looks, joints, local_name(asked.handle), local_name(asked.joint), ways, 2)
    moved = float(np.linalg.norm(end - before))
    return end + STANDS * (end - before) / moved if moved else None


def largest(looks: Looks, joints: Mapping[str, float], world_T_root: Array) -> Array:
    """The largest triangles of a mechanism's collision shapes, which hide most: (T, 3 corners, 3) [m]."""
    placed = looks.skeleton.placed(joints, world_T_root)
    found = [np.zeros((0, 3, 3))]
    for name, surface in looks.collision.items():
        frame, frame_T_body = looks.skeleton.carried[name]
        at = placed[frame] @ frame_T_body
        found.append((surface.vertices @ at[:3, :3].T + at[:3, 3])[surface.faces])
    every = np.concatenate(found)
    areas = np.linalg.norm(_normals(every), axis=1)
    return every[np.argsort(areas)[-TRIANGLES:]]


def viewpoint(fronts: Fronts, hiding: Array) -> tuple[Array, Array] | None:
    """Where the camera stands and at what it looks, points (3,) [m]; None if no front can be seen.

    The first front is seen if it can be, then the robot that has opened it, then as many others as can be,
    then all of them as near and as straight as can be.

    Args:
        fronts: Of the kitchen.
        hiding: What may stand between, triangles (T, 3, 3) [m].
    """
    if not len(fronts.points):
        return None
    places = _places(fronts)
    ways = fronts.points[None] - places[:, None]
    away = np.linalg.norm(ways, axis=2)
    ways = ways / np.maximum(away, NEAREST)[..., None]
    facing = -np.einsum("cfk,fk->cf", ways, fronts.normals)
    seen = (facing > FACING) & (away > NEAREST) & (away < FARTHEST)
    over_floor = ~_hidden(places, np.column_stack((places[:, :2], np.full(len(places), ABOVE))), hiding)
    seen &= (over_floor & (away.min(axis=1) > CLEAR))[:, None]
    begins, ends = _ends(places, fronts.points)
    seen[seen] = ~_hidden(begins[seen], ends[seen], hiding)
    for _ in range(2):  # the middle of what is seen, then of what of that is in the picture
        middles = _middles(ways, seen)
        seen &= np.einsum("cfk,ck->cf", ways, middles) > CONE
    if not seen.any():
        return None
    whole = seen[:, 0] & _in_picture(fronts.robot, places, _middles(ways, seen))
    worth = np.where(seen, facing / np.maximum(away, NEAREST), 0.0).sum(axis=1)
    best = int(np.lexsort((worth, seen.sum(axis=1), whole, seen[:, 0]))[-1])
    far = float(away[best][seen[best]].mean())
    return places[best], places[best] + far * _middles(ways, seen)[best]


def _places(fronts: Fronts) -> Array:
    """Where the camera may stand, around every front, shape (C, 3) [m]."""
    towards = np.arctan2(fronts.normals[:, 1], fronts.normals[:, 0])
    found = []
    for turned, away, height in product(TURNED, AWAY, HEIGHTS):
        ground = np.stack((np.cos(towards + turned), np.sin(towards + turned)), axis=1)
        places = fronts.points[:, :2] + away * ground
        found.append(np.column_stack((places, np.full(len(places), height))))
    return np.concatenate(found)


def _ends(places: Array, points: Array) -> tuple[Array, Array]:
    """Both ends of every line of sight, each of shape (C, F, 3) [m]."""
    shape = (len(places), len(points), 3)
    return np.broadcast_to(places[:, None], shape), np.broadcast_to(points[None], shape)


def _middles(ways: Array, seen: Claims) -> Array:
    """Direction of the middle of what is seen from each place, shape (C, 3)."""
    summed = np.einsum("cfk,cf->ck", ways, seen.astype(float))
    return summed / np.maximum(np.linalg.norm(summed, axis=1, keepdims=True), 1e-9)


def _in_picture(point: Array | None, places: Array, middles: Array) -> Claims:
    """From which places (C, 3), not too near, the point, if any, is seen when that way (C, 3) is looked."""
    if point is None:
        return np.ones(len(places), bool)
    ways = point - places
    away = np.linalg.norm(ways, axis=1)
    return (away > ROOM) & (np.einsum("ck,ck->c", ways, middles) > CONE * away)


def _normals(triangles: Array) -> Array:
    """Of length twice the area, shape (T, 3)."""
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def _hidden(begins: Array, ends: Array, triangles: Array) -> Claims:
    """Whether a triangle is between the ends of each line (L, 3) [m]."""
    some = [slice(k, k + LINES) for k in range(0, len(begins), LINES)]
    return np.concatenate([np.zeros(0, bool), *(_crossed(begins[k], ends[k], triangles) for k in some)])


def _crossed(begins: Array, ends: Array, triangles: Array) -> Claims:
    """The same of few lines: Möller and Trumbore, by matrices."""
    corner, one, two = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    along = ends - begins
    moments = np.cross(begins, along)
    normals = _normals(triangles)
    against = -(along @ normals.T)
    against[np.abs(against) < 1e-12] = np.inf  # along the triangle: it hides nothing
    u = (moments @ two.T - along @ np.cross(two, corner).T) / against
    v = -(moments @ one.T - along @ np.cross(one, corner).T) / against
    t = (begins @ normals.T - (corner * normals).sum(axis=1)) / against
    return ((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0) & (t < 1)).any(axis=1)
