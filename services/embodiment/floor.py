"""Robots stand on the plane z = 0 of the kitchen's root frame, so that is where its floor has to be."""

from collections.abc import Iterator
from functools import lru_cache

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.annotation import Drive
from sdt_kg.errors import AnnotationError, InputError
from sdt_kg.iri import Iri, local_name
from services.physics.geometry.floor import SIDE
from services.physics.model import Scene
from services.physics.solids import Solid
from services.physics.tree import UNIVERSE, Array

SUNK = 0.02
"""[m] What stands on the floor reaches at most so far into it: wheels and feet are drawn no more exactly."""

ALOFT = 0.2
"""[m] A chassis whose wheels have no shapes is nearer to the floor."""

BESIDE = 0.1
"""[m] How far beside what the robot stands on the frame of its base may lie: half a wheel's width, say."""

THROUGH = 0.05
"""[m] The same of what a kitchen's joints move, which a larger shape may stand for."""


def check_floor(scene: Scene) -> None:
    """Nothing of the kitchen that moves is in the floor, nor is the robot, parked.

    Judged all the same, a handle at table height would lie on the floor, and one that a robot on its pedestal
    reaches would be out of the reach of one that is sunk in the floor to its arms.

    Raises:
        InputError: A moved body is: the kitchen's root frame is not on its floor, but at its worktop, say.
        AnnotationError: What of the robot stands on the floor is.
    """
    moved = (one for one in scene.solids[: scene.floor] if one.joint != UNIVERSE)
    body, height = _lowest(scene, moved)
    if height < -THROUGH:
        kitchen = scene.kitchen.mechanism.name
        raise InputError(
            f"{local_name(body)} of kitchen '{kitchen}' reaches {-height:.3g} m below z = 0 of the kitchen's "
            "root frame, on which robots stand",
            allowed="a root frame on the floor",
            remedy="give the model a link on the floor as its root, with a fixed joint up to the present one",
        )
    body, height = _standing(scene)
    if height < -SUNK:
        robot, given = scene.robot.mechanism.name, scene.annotation.base_height
        raise AnnotationError(
            f"{local_name(body)} of robot '{robot}' reaches {-height:.3g} m into the floor: "
            f"its sdt:baseHeight is {given:g}",
            allowed=f"{round(given - height, 4):g}, with which its lowest point is on the floor",
        )


def check_base(scene: Scene, drive: Drive) -> None:
    """A robot that drives has the frame of its base amid what it stands on.

    The limits of its speed hold for that frame: a slow turn about one metres away sweeps the robot along.

    Raises:
        AnnotationError: It lies beside that.
    """
    low, high = _footprint(scene)
    away = float(np.linalg.norm(np.maximum(np.maximum(low, -high), 0.0)))
    if drive is Drive.FIXED or away <= BESIDE or np.isinf(away):  # infinite where none of that has a shape
        return
    robot, body = scene.robot.mechanism.name, scene.annotation.base_body
    raise AnnotationError(
        f"'{body}', the sdt:baseBody of robot '{robot}', lies {away:.3g} m beside what the robot stands on",
        allowed="a body amid that, for which the limits of the base's speed hold",
        remedy="name one there, or give the model a link there with a fixed joint",
    )


def check_start(start: tuple[float, float, float]) -> None:
    """A robot that starts at this pose, x, y [m] and yaw [rad], has a floor below it.

    Every motion from there would be refused, and no search find another.

    Raises:
        InputError: It starts beyond the end of the floor.
    """
    x, y, _ = start
    most = SIDE / 2
    if max(abs(x), abs(y)) > most:
        raise InputError(
            f"the robot's base would start at x {x:g} m, y {y:g} m, where there is no floor",
            allowed=f"a base pose with x and y from {-most:g} to {most:g} m in the kitchen's root frame",
            remedy="start it nearer to the kitchen",
        )


@lru_cache(maxsize=8)
def _footprint(scene: Scene) -> tuple[Array, Array]:
    """Corners of the box about what the robot stands on, along x and y of its base [m], shape (2,)."""
    world_T_joint = scene.placements.move(scene.q((0.0, 0.0, 0.0), {}))
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for one in scene.solids:
        if one.body in scene.standing:
            at = world_T_joint[one.joint]
            middle = at.act(one.centre)[:2]
            half = (np.abs(at.rotation @ one.joint_T_shape.rotation) @ one.half)[:2]
            low, high = np.minimum(low, middle - half), np.maximum(high, middle + half)
    return low, high


@lru_cache(maxsize=8)
def aloft(scene: Scene) -> tuple[str, ...]:
    """That nothing is known of what carries the robot, in words, where it is in the air."""
    _, height = _standing(scene)
    if height < ALOFT:
        return ()
    where = f"below {height:.3g} m" if np.isfinite(height) else "at all"
    return (f"what the robot stands on has no shape {where}, which nothing can collide with",)


def _standing(scene: Scene) -> tuple[Iri, float]:
    """The lowest body of those on which the robot stands, and how high it reaches down [m]."""
    return _lowest(scene, (one for one in scene.solids if one.body in scene.standing))


def _lowest(scene: Scene, some: Iterator[Solid]) -> tuple[Iri, float]:
    """The body that reaches farthest down, the robot parked, and to which height [m].

    Infinite where nothing has a shape.
    """
    world_T_joint = scene.placements.move(scene.q((0.0, 0.0, 0.0), {}))
    heights = ((one.body, _height(one, world_T_joint[one.joint] * one.joint_T_shape)) for one in some)
    return min(heights, key=lambda each: each[1], default=("", np.inf))


def _height(one: Solid, world_T_shape: pin.SE3) -> float:
    """Of the lowest point [m]: a wheel's rim is round, a box about it is not."""
    shape, up = one.shape, world_T_shape.rotation[2]
    if isinstance(shape, coal.ConvexBase):
        return float((np.array(shape.points()) @ up).min() + world_T_shape.translation[2])
    if isinstance(shape, coal.Cylinder):
        down = shape.radius * np.hypot(up[0], up[1]) + shape.halfLength * abs(up[2])
        return float(world_T_shape.translation[2] - down)
    middle = world_T_shape.act((shape.aabb_local.min_ + shape.aabb_local.max_) / 2)
    return float(middle[2] - np.abs(up) @ one.half)
