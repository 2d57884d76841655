"""τ of a container under a body motion: as that says, or as a gripper drags the handle along."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain as chained

import numpy as np
from numpy.typing import NDArray

from predicates.meant import by_other_handles
from sdt_kg.annotation import Gripper
from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import Iri, body_iri, local_name
from sdt_kg.mechanism import JointType
from sdt_kg.motion import BodyMotion, Motion, check_body_motion
from sdt_kg.twin import Container, Twin
from services.physics.chain import Chain, chain, of_own_joint
from services.physics.model import Scene
from services.physics.replay import (
    ANGLE_TOLERANCE,
    POSE_TOLERANCE,
    Bounds,
    apart,
    effective_bounds,
    fitted_positions,
)
from services.physics.tree import Model

Array = NDArray[np.float64]

LIMIT_PLAY = 0.002
"""[rad or m] How far beyond a stop a dragged joint may seem to be: the tool's tolerance on the handle."""

FINGER_PLAY = 0.01
"""[m] A finger whose tip moves farther lets go. Ours: more than a grip gives, less than it opens."""

STOP_STEP = 1e-5
"""[rad or m] Differences beyond a stop which count when the moment of the grasp is looked for."""

BEGINS = 200
"""[1] Of more samples at which the hold may begin some are looked at first, then those about the best."""

RESTS = 1e-12
"""[1, m] By which a tool's pose and fingertips that rest differ from one sample to the next: rounding."""

BLOCK = 64
"""[1] Samples in which a hold is followed at first."""

INSTANT = 1e-4
"""[s] Half of the interval over which the velocity of a dragged joint is taken."""


@dataclass(frozen=True, slots=True)
class _Hold:
    """A gripper holds the handle from sample `begin` to `end`, the joint's positions being `values`."""

    begin: int
    end: int
    values: Array


def carried(
    model: Model,
    scene: Callable[[], Scene],
    twin: Twin,
    body_motion: BodyMotion,
    container: Container,
) -> Motion:
    """Motion of the container's own joint under the body motion.

    If the body motion says how the kitchen moves, as it says; what it does not name stands still, as does
    everything under the motion of a robot that is not there. If it says nothing, the handle moves
    rigidly with a gripper that is at it, for as long as the joint can follow and the fingers stay as
    they are; before and after, the container stands still. Once they have opened they may close as far
    again, and hold it anew. Where its own handle is not moved so, others are looked at by which it moves.

    Args:
        model: Built from the twin's environment.
        scene: Kitchen and robot together; asked for only where a gripper has to be followed.
        twin: The kitchen in the state in which the motion begins.
        body_motion: Of the robot.
        container: Whose motion is wanted.

    Raises:
        MotionError: The arrays are no motion: shapes, times, values which are not numbers.
        UnknownEntityError: The robot has no gripper of the motion's name.
    """
    check_body_motion(body_motion)
    times, still = body_motion.times, twin.state[container.joint]
    columns = {joint: i for i, joint in enumerate(body_motion.kitchen_joints)}
    if {container.joint, *twin.entities.coupling.together(container.joint)} & {*columns}:
        told = _telling(model, body_motion, container)
        both = body_motion.kitchen_q, body_motion.kitchen_v
        values, velocities = (each[:, [columns[told]]] for each in both)
        return of_own_joint(model, container, Motion(told, times, values, velocities=velocities))
    if not columns and body_motion.robot in twin.robots:
        every = (container, *by_other_handles(twin, container))
        dragged = (_dragged(model, scene(), twin, body_motion, each) for each in every)
        own = next(dragged)
        moved = (each for each in chained((own,), dragged) if np.ptp(each.values) > LIMIT_PLAY)
        return of_own_joint(model, container, next(moved, own))
    nowhere = np.zeros((len(times), 1))
    return Motion(container.joint, times, nowhere + still, velocities=nowhere)


def _telling(model: Model, body_motion: BodyMotion, container: Container) -> Iri:
    """The listed joint that says where the container is, as certification takes it: others may be off.

    That is the one which they mimic, else the last of them.
    """
    coupling, active = model.coupling, model.coordinate[container.active_joint]
    listed = [each for each in body_motion.kitchen_joints if each in model.coordinate]
    together = [
        each
        for each in listed
        if coupling.source[model.coordinate[each]] == active
        and coupling.multiplier[model.coordinate[each]] != 0
    ]
    return container.active_joint if container.active_joint in together else [container.joint, *together][-1]


def _dragged(model: Model, scene: Scene, twin: Twin, body_motion: BodyMotion, container: Container) -> Motion:
    """Motion of the own joint, as the gripper that moves it most drags its handle along."""
    found = [
        _held(model, scene, twin, body_motion, container, each) for each in _grippers(scene, body_motion)
    ]
    values, velocities = max(found, key=lambda one: float(np.ptp(one[0])))
    return Motion(container.joint, body_motion.times, values[:, None], velocities=velocities[:, None])


def _held(  # noqa: PLR0913, PLR0917 - a world, a motion in it, and who moves what
    model: Model,
    scene: Scene,
    twin: Twin,
    body_motion: BodyMotion,
    container: Container,
    gripper: Gripper,
) -> tuple[Array, Array]:
    """Positions and velocities of the own joint, shape (T,), as one gripper moves it, hold after hold."""
    samples = len(body_motion.times)
    values, velocities = np.full(samples, twin.state[container.joint]), np.zeros(samples)
    about = body_motion, gripper
    tools = _tool_poses(scene, *about, 0.0)
    fingers, may = _fingertips(scene, *about), np.ones(samples, dtype=bool)
    while True:
        handle = chain(model, container.handle, twin.state)
        bounds = effective_bounds(model, twin, handle.follower)
        begins = np.flatnonzero(_near(scene, tools, gripper, container.handle) & may).tolist()
        hold = _longest_hold(handle, bounds, twin, tools, fingers, begins)
        if hold is None or (not may[0] and np.ptp(hold.values) <= LIMIT_PLAY):
            return values, velocities
        held = slice(hold.begin, hold.end + 1)
        values[held], values[hold.end :] = hold.values, hold.values[-1]
        ends = [
            _positions(handle, bounds, twin, _tool_poses(scene, *about, dt), tools[hold.begin])
            for dt in (-INSTANT, INSTANT)
        ]
        velocities[held] = ((ends[1] - ends[0]) / (2 * INSTANT))[held]
        may &= (np.abs(fingers - fingers[hold.begin]) <= FINGER_PLAY).all(axis=1)  # as closed as they were
        may[: hold.end + 1] = False
        if not may.any():
            return values, velocities
        twin = twin.at({container.joint: float(np.clip(values[-1], container.lower, container.upper))})
        scene = Scene(twin, body_motion.robot)


def _grippers(scene: Scene, body_motion: BodyMotion) -> tuple[Gripper, ...]:
    grippers = {each.name: each for each in scene.annotation.grippers}
    if not body_motion.gripper:
        return tuple(grippers.values())
    if body_motion.gripper not in grippers:
        raise UnknownEntityError("gripper", body_motion.gripper, grippers)
    return (grippers[body_motion.gripper],)


def _tool_poses(scene: Scene, motion: BodyMotion, gripper: Gripper, dt: float) -> Array:
    """world_T_tool at each sample, a moment dt before or after it, shape (T, 4, 4)."""
    base, q = motion.base + dt * motion.base_v, motion.q + dt * motion.v
    frame = scene.tool_frame(gripper.name)
    poses = [
        scene.placement(scene.q(base[k], dict(zip(motion.joints, q[k], strict=True))), frame).homogeneous
        for k in range(len(q))
    ]
    return np.array(poses)


def _fingertips(scene: Scene, motion: BodyMotion, gripper: Gripper) -> Array:
    """Ways of fingertips by joints that open a gripper, those that the motion names, shape (T, n) [m]."""
    names = {each.joint for each in gripper.finger_joints}
    chosen = [k for k, name in enumerate(motion.joints) if name in names]
    levers = [_lever(scene, motion.joints[k], gripper) for k in chosen]
    return motion.q[:, chosen] * np.array(levers)


def _lever(scene: Scene, joint: str, gripper: Gripper) -> float:
    """How far a fingertip moves for a unit of a joint at most: its distance from a hinge, 1 by a slide."""
    k = next(k for k, each in enumerate(scene.robot.joints, scene.robot.first) if each.name == joint)
    own = scene.robot.joints[k - scene.robot.first]
    if own.type is JointType.PRISMATIC:
        return 1.0
    bodies = {body_iri(scene.robot.mechanism.name, each) for each in gripper.fingers}
    scene.placement(scene.q(np.zeros(3), {}), scene.tool_frame(gripper.name))
    hinge, far = scene.placements.world_T_joint[k + 1], 0.0
    for one in scene.solids:
        if one.body in bodies and k + 1 in scene.model.supports[one.joint]:
            away = hinge.actInv(scene.placements.world_T_joint[one.joint].act(one.centre))
            far = max(far, float(np.linalg.norm(np.cross(away, own.axis))) + one.radius)
    return far or 1.0


def _longest_hold(  # noqa: PLR0913, PLR0917 - two paths, what joins them, and where the search may begin
    handle: Chain, bounds: Bounds, twin: Twin, tools: Array, fingers: Array, near: list[int]
) -> _Hold | None:
    """The hold that explains the motion best; None if no tool comes near, or the joint is beyond a stop.

    A gripper that comes along the joint's own direction is held to the right moment by the joint's
    limits: taken too early, it would push a closed drawer through the cabinet.
    """

    def hold_from(begin: int) -> _Hold:
        held = list[Array]()
        tool_T_handle = _tool_T_handle(handle, twin, tools[begin])
        for block in _blocks(begin, len(tools), bounds):
            values = _positions(handle, bounds, twin, tools[block], tools[begin])
            fitted = handle.poses((values - handle.follower.offset) / handle.follower.multiplier)[0]
            gaps, angles = apart(fitted, tools[block] @ tool_T_handle)
            inside = (values >= bounds.lower - LIMIT_PLAY) & (values <= bounds.upper + LIMIT_PLAY)
            closed = (np.abs(fingers[block] - fingers[begin]) <= FINGER_PLAY).all(axis=1)
            fits = (gaps <= POSE_TOLERANCE) & (angles <= ANGLE_TOLERANCE) & inside & closed
            held.append(values if fits.all() else values[: int(np.argmin(fits))])
            if not fits.all():
                break
        values = np.concatenate(held)
        return _Hold(begin, begin + len(values) - 1, values)

    def best(begins: list[int]) -> _Hold | None:
        holds = (hold for hold in map(hold_from, begins) if len(hold.values))  # none from beyond a stop
        return max(holds, key=lambda hold: _rank(hold, bounds), default=None)

    near = _moving(tools, fingers, near)
    step = len(near) // BEGINS + 1
    found = best(near[::step])
    if found is None or step == 1:
        return found
    at = near.index(found.begin)
    return best(near[max(at - step + 1, 0) : at + step])


def _moving(tools: Array, fingers: Array, near: list[int]) -> list[int]:
    """The samples without those at which hand and fingers are as at the one before: one tells of all."""
    if len(near) <= 1:
        return near
    at = np.array(near)
    poses = np.hstack((tools[at].reshape(len(at), -1), fingers[at]))
    rests = (np.abs(np.diff(poses, axis=0)) <= RESTS).all(axis=1) & (np.diff(at) == 1)
    return at[np.concatenate(([True], ~rests))].tolist()


def _blocks(begin: int, end: int, bounds: Bounds) -> Iterator[slice]:
    """Samples from one on, in blocks that grow: most holds end soon. Turns without end are counted in one."""
    size = BLOCK if math.isfinite(bounds.upper) else end - begin
    while begin < end:
        yield slice(begin, min(begin + size, end))
        begin, size = begin + size, 2 * size


def _rank(hold: _Hold, bounds: Bounds) -> tuple[int, int, float]:
    """How well a hold explains the motion: until when, how far inside the stops, how far it moves."""
    beyond = max(bounds.lower - float(hold.values.min()), float(hold.values.max()) - bounds.upper, 0.0)
    return hold.end, -round(beyond / STOP_STEP), float(np.ptp(hold.values))


def _tool_T_handle(handle: Chain, twin: Twin, world_T_tool: Array) -> Array:
    """Where the handle is in the tool's frame at the grasp, the container being where the state has it."""
    active = np.array([twin.state[handle.follower.active]])
    return np.linalg.inv(world_T_tool) @ handle.poses(active)[0][0]


def _positions(handle: Chain, bounds: Bounds, twin: Twin, tools: Array, grasp: Array) -> Array:
    """Positions of the own joint at which the handle is where the tools hold it."""
    observed = tools @ _tool_T_handle(handle, twin, grasp)
    return fitted_positions(handle, bounds, twin.state[handle.follower.active], observed)


def _near(scene: Scene, tools: Array, gripper: Gripper, handle: Iri) -> NDArray[np.bool_]:
    """At which samples the tool's origin is no farther from the handle than half the gripper's opening."""
    _, joint_T_handle = scene.kitchen.attached[local_name(handle)]
    world_T_joint = scene.placement(scene.q(np.zeros(3), {}), handle) * joint_T_handle.inverse()
    origins = (world_T_joint.inverse().homogeneous @ tools[:, :, 3].T).T[:, :3]
    near = np.zeros(len(tools), dtype=bool)
    for solid in scene.solids:
        if solid.body == handle:
            local = (origins - solid.centre) @ solid.joint_T_shape.rotation
            beyond = np.maximum(np.abs(local) - solid.half, 0.0)
            near |= np.linalg.norm(beyond, axis=1) <= gripper.opening / 2
    return near
