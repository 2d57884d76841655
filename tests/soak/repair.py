"""A peer's motion, repaired by hand: slower, the drawer still until the hand has closed, the base led along.

What stays is the peer's: the drive, the arm's way, where it grasps and how far it opens. What changes:
wrists begin inside their limits; samples are thinned and slowed until accelerations hold; the drawer
rests while the hand comes and closes; then the base (and the torso) make up for what the tool slips
on the handle.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Container
from services.physics.model import Scene

Array = NDArray[np.float64]

CLOSING = 3.0  # [s]
THIN = 10  # samples from one waypoint to the next
INSIDE = 0.005  # [rad or m] inside its limits keeps a joint that begins beyond them: the peer's wrists
LED = 0.35  # share of the way to the handle on which the correction of the base grows


def repaired(
    scene: Scene, motion: BodyMotion, container: Container, slower: float, closed: float
) -> BodyMotion:
    """The motion for the gripper that ends at the handle.

    Args:
        scene: Kitchen and robot.
        motion: The peer's.
        container: What it opens, a drawer.
        slower: Factor of all times but the closing's.
        closed: Position of the finger joint that holds the handle [rad or m].
    """
    column = motion.kitchen_joints.index(container.active_joint)
    drawer = motion.kitchen_q[:, column]
    world_T_tools = {g.name: _tools(scene, motion, g.name) for g in scene.annotation.grippers}
    handles = np.array([_handle(scene, container, q) for q in drawer])
    name = min(world_T_tools, key=lambda g: float(np.linalg.norm((world_T_tools[g] - handles)[-1, :3, 3])))
    tools = world_T_tools[name]
    relative = np.linalg.inv(handles) @ tools
    away = np.linalg.norm(relative[:, :3, 3] - relative[-1, :3, 3], axis=1)
    grasp = int(np.argmax(away < 0.004))  # the tool is as near to its last place on the handle as this [m]
    opened = np.where(np.arange(len(drawer)) < grasp, 0.0, drawer - drawer[grasp])
    opened = np.maximum.accumulate(np.clip(opened, 0, container.upper))
    wanted = np.array([_handle(scene, container, q) for q in opened]) @ relative[grasp]
    base, lift = motion.base.copy(), np.zeros(len(motion.times))
    for k in range(len(motion.times)):
        part = float(np.clip(1 - (grasp - k) / max(LED * grasp, 1), 0, 1))
        aim = wanted[k] if k >= grasp else wanted[grasp] @ np.linalg.inv(tools[grasp]) @ tools[k]
        moved = aim @ np.linalg.inv(tools[k])
        turn = np.arctan2(moved[1, 0], moved[0, 0])
        cos, sin = np.cos(turn), np.sin(turn)
        arm = np.array(((cos, -sin), (sin, cos))) @ (tools[k, :2, 3] - motion.base[k, :2])
        led = np.array((*(aim[:2, 3] - arm), motion.base[k, 2] + turn))
        base[k] = (1 - part) * motion.base[k] + part * led
        lift[k] = part * (aim - tools[k])[2, 3]
    finger = next(each for each in scene.annotation.grippers if each.name == name)
    joints = [each.joint for each in finger.finger_joints]
    limits = [scene.robot.mechanism.joint(joint).limits for joint in motion.joints]
    lower, upper = (np.array([getattr(each, end) for each in limits]) for end in ("lower", "upper"))
    beyond = (motion.q[0] < lower) | (motion.q[0] > upper)
    q = np.where(beyond, np.clip(motion.q, lower + INSIDE, upper - INSIDE), motion.q)
    q[:, motion.joints.index("torso_lift_joint")] += lift
    fingers = [motion.joints.index(joint) for joint in joints]
    q[: grasp + 1, fingers] = [each.open for each in finger.finger_joints]
    held = q[grasp:].copy()
    held[:, fingers] = closed
    way = (np.hstack((base, q, opened[:, None])), np.hstack((base[grasp:], held, opened[grasp:, None])))
    come = _leg(motion.times[: grasp + 1] * slower, way[0][: grasp + 1])
    close = _leg(np.array((0.0, CLOSING)), np.stack((way[0][grasp], way[1][0])))
    pull = _leg(motion.times[grasp:] * slower, way[1])
    times, rows, speeds = _joined(come, close, pull)
    count = 3 + len(motion.joints)
    return replace(
        motion,
        gripper=name,
        times=times,
        base=rows[:, :3],
        base_v=speeds[:, :3],
        q=rows[:, 3:count],
        v=speeds[:, 3:count],
        kitchen_joints=(container.active_joint,),
        kitchen_q=rows[:, count:],
        kitchen_v=speeds[:, count:],
    )


def _tools(scene: Scene, motion: BodyMotion, gripper: str) -> Array:
    frame = scene.tool_frame(gripper)
    rows = zip(motion.base, motion.q, strict=True)
    return np.array(
        [
            scene.placement(scene.q(b, dict(zip(motion.joints, q, strict=True))), frame).homogeneous
            for b, q in rows
        ]
    )


def _handle(scene: Scene, container: Container, position: float) -> Array:
    at = {container.active_joint: float(np.clip(position, container.lower, container.upper))}
    return scene.placement(scene.q(np.zeros(3), {}, at), container.handle).homogeneous


def _leg(times: Array, rows: Array) -> tuple[Array, Array, Array]:
    """Every so many samples, from rest to rest, with nothing beyond them between two."""
    kept = np.unique(np.append(np.arange(0, len(times), THIN), len(times) - 1))
    times = times[kept] - times[kept[0]]
    speeds = PchipInterpolator(times, rows[kept]).derivative()(times)
    speeds[[0, -1]] = 0
    return times, rows[kept], speeds


def _joined(*legs: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
    times, rows, speeds = legs[0]
    for later, more, rates in legs[1:]:
        times = np.concatenate((times, times[-1] + later[1:]))
        rows, speeds = np.vstack((rows, more[1:])), np.vstack((speeds, rates[1:]))
    return times, rows, speeds
