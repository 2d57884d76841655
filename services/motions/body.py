"""Arrays → Γ of a robot, and back."""

from collections.abc import Iterator

import numpy as np

from sdt_kg.errors import MotionError
from sdt_kg.iri import Iri, joint_iri, local_name, model_iri
from sdt_kg.likely import told_likely
from sdt_kg.mechanism import Mechanism
from sdt_kg.motion import ANOTHER, Array, BodyMotion
from sdt_kg.twin import Twin
from services.motions.container import check_known, movable
from services.motions.given import Given
from services.motions.units import (
    check_base,
    check_base_leaps,
    check_joints,
    check_leaps,
    check_times,
    drives,
)
from services.physics.spline import at_rest_velocities

KEYS = ("times", "base", "robot_joint_names", "robot_positions")
BASE = ("x", "y", "yaw")
WORLD = ("world", "map")
"""Names of the frame in which the base is, besides the kitchen's and its root's."""

STILL = 1e-3
"""[rad or m] A fixed joint whose position differs from 0 by less stands still."""

STANDS = 1e-9
"""[rad or m] What differs by no more from one sample to the next stands still."""

MOST = 0.5
"""[1] Share of joints that a robot must have for a motion to be one of it, misspelled perhaps."""


def body_motion(given: Given, twin: Twin, asked: Iri | None) -> BodyMotion:
    """Γ, of the robot that is asked about.

    A motion of another robot is no wrong input: it comes back as one of that robot, with its joints
    as they are, and is refused where it is judged.
    """
    for key in KEYS:
        if key not in given:
            raise MotionError(f"there is no '{key}'", allowed=", ".join(KEYS))
    times, names = given.times(), given.names("robot_joint_names")
    kitchen = twin.mechanism(twin.environment)
    _check_base_frame(given, kitchen)
    base = given.numbers("base", (len(times), 3), BASE)
    q = given.numbers("robot_positions", (len(times), len(names)), names)
    check_base(base, "base", given)
    v = _velocities(given, "robot_velocities", times, q, names)
    robot = _robot(given, twin, asked, names)
    if asked in {None, robot}:
        names, q, v = _of_robot(given, twin, robot, times, names, q, v)
        limits = twin.robot(robot).base_limits
        check_base_leaps(times, base, limits, given)
        if not drives(times, base, limits):
            told = v if "robot_velocities" in given else None
            check_times(times, names, q, told, twin.mechanism(robot))
    joints, kitchen_q, kitchen_v = _kitchen(given, kitchen, times)
    return BodyMotion(
        robot=robot,
        gripper=given.text("gripper") or "",
        joints=names,
        times=times,
        base=base,
        q=q,
        v=v,
        base_v=_velocities(given, "base_velocities", times, base, BASE),
        kitchen_joints=tuple(joint_iri(kitchen.name, name) for name in joints),
        kitchen_q=kitchen_q,
        kitchen_v=kitchen_v,
        phases=_phases(given, len(times)),
    )


def body_arrays(motion: BodyMotion) -> dict[str, np.ndarray]:
    """What `body_motion` reads back exactly."""
    arrays = {
        "times": motion.times,
        "robot": np.array(local_name(motion.robot)),
        "gripper": np.array(motion.gripper),
        "base": motion.base,
        "base_velocities": motion.base_v,
        "robot_joint_names": np.array(motion.joints, dtype=np.str_),
        "robot_positions": motion.q,
        "robot_velocities": motion.v,
        "phase_names": np.array([name for name, _ in motion.phases], dtype=np.str_),
        "phase_starts": np.array([start for _, start in motion.phases], dtype=np.int64),
    }
    if motion.kitchen_joints:
        arrays["kitchen_joint_names"] = np.array([local_name(each) for each in motion.kitchen_joints])
        arrays |= {"kitchen_positions": motion.kitchen_q, "kitchen_velocities": motion.kitchen_v}
    return arrays


def _check_base_frame(given: Given, kitchen: Mechanism) -> None:
    frame, allowed = given.text("base_frame"), (*WORLD, kitchen.name, kitchen.root)
    if frame is not None and frame.removeprefix("/") not in allowed:
        raise MotionError(
            f"the base is given in the frame '{frame}'",
            allowed=f"the kitchen's root frame: {', '.join(dict.fromkeys(allowed))}",
            remedy="transform the base poses into it",
        )


def _robot(given: Given, twin: Twin, asked: Iri | None, names: tuple[str, ...]) -> Iri:
    """The robot that the file names, else the one that is asked about, if the joints are its own."""
    if not twin.robots:
        raise MotionError(
            "the file is a robot's motion, and no robot is asked about",
            allowed="a container's motion: 'joint' and 'values', or 'frame' and 'poses'",
            remedy="ask sdt achieve --robot NAME --motion FILE",
        )
    named = given.text("robot")
    if asked is None and named is None and len(twin.robots) == 1:
        asked = twin.robots[0]
    loaded = {local_name(each): each for each in twin.robots}
    if asked is None:
        if named is None:
            raise MotionError("the file names no robot", allowed=", ".join(loaded) or "load a robot")
        check_known("robot", named, loaded)
        return loaded[named]
    if named is not None and named != local_name(asked):
        return model_iri(named)
    known = {joint.name for joint in twin.mechanism(asked).joints}
    foreign = sum(name not in known for name in names)
    return model_iri(ANOTHER) if len(names) > 1 and foreign > MOST * len(names) else asked


def _of_robot(  # noqa: PLR0913, PLR0917  # a motion's parts
    given: Given, twin: Twin, robot: Iri, times: Array, names: tuple[str, ...], q: Array, v: Array
) -> tuple[tuple[str, ...], Array, Array]:
    """Names, positions and velocities of the robot's movable joints."""
    body = twin.mechanism(robot)
    _check_whose(names, body, twin.mechanism(twin.environment))
    moving = _moving(names, q, body, "robot_positions", given)
    names, q, v = tuple(names[k] for k in moving), q[:, moving], v[:, moving]
    for group in twin.robot(robot).coupled:
        missing = [name for name in group if name not in names]
        if missing and len(missing) < len(group):
            raise MotionError(
                f"the motion has no '{missing[0]}', which shares a motor with joints that it has",
                allowed=f"all of {', '.join(group)}, or none",
            )
    check_leaps(names, times, q, body, given)
    return names, q, v


def _check_whose(names: tuple[str, ...], robot: Mechanism, kitchen: Mechanism) -> None:
    """None of the joints that are said to be the robot's is the kitchen's alone.

    Raises:
        MotionError: One is.
    """
    own = {joint.name for joint in robot.joints}
    theirs = {joint.name for joint in kitchen.joints} - own
    name = next((each for each in names if each in theirs), None)
    if name is not None:
        raise MotionError(
            f"'robot_joint_names' has '{name}', which is a joint of kitchen {kitchen.name}",
            allowed=f"joints of {robot.name}",
            remedy=f"list it in 'kitchen_joint_names'; in CSV, name the column kitchen/{name}",
        )


def _kitchen(given: Given, kitchen: Mechanism, times: Array) -> tuple[tuple[str, ...], Array, Array]:
    """Names, positions and velocities of the kitchen's joints, if the file has any.

    A joint that is fixed in our model is left out if it stands still; one that does not is for the
    verdict to refuse.
    """
    if "kitchen_joint_names" not in given:
        for array in ("kitchen_positions", "kitchen_velocities"):
            if array in given:
                raise MotionError(
                    f"there is '{array}', and no 'kitchen_joint_names'", allowed="both, or neither"
                )
        return (), np.zeros((len(times), 0)), np.zeros((len(times), 0))
    names = given.names("kitchen_joint_names")
    q = given.numbers("kitchen_positions", (len(times), len(names)), names)
    v = _velocities(given, "kitchen_velocities", times, q, names)
    _check_kitchen(names, kitchen)
    able, fixed = movable(kitchen), {each.name: each.fixed_at for each in kitchen.joints}
    moving = [
        k for k, name in enumerate(names) if name in able or np.abs(q[:, k] - fixed[name]).max() > STILL
    ]
    names, q, v = tuple(names[k] for k in moving), q[:, moving], v[:, moving]
    check_joints(names, q, kitchen, "kitchen_positions", given)
    check_leaps(names, times, q, kitchen, given)
    return names, q, v


def _check_kitchen(names: tuple[str, ...], kitchen: Mechanism) -> None:
    """The joints are this kitchen's.

    Raises:
        MotionError: Of several, this kitchen has none: the motion was made in another.
        UnknownEntityError: No such joint.
    """
    if len(names) > 1 and not {joint.name for joint in kitchen.joints} & set(names):
        raise MotionError(
            f"the motion is of another kitchen: kitchen {kitchen.name} has none of its"
            f" {len(names)} 'kitchen_joint_names'",
            allowed="the kitchen's own joints, or no arrays of the kitchen's",
            remedy="name the kitchen in which the motion was made",
        )
    _check_names(names, kitchen)


def _check_names(names: tuple[str, ...], mechanism: Mechanism) -> None:
    known = {joint.name for joint in mechanism.joints}
    unknown = next((name for name in names if name not in known), None)
    if unknown is not None:
        check_known("joint", unknown, known, told_likely(names, (mechanism.name,)))


def _moving(
    names: tuple[str, ...], values: Array, mechanism: Mechanism, array: str, given: Given
) -> list[int]:
    """Columns of joints that can move; one that is fixed in our model may be listed, where it stands.

    Raises:
        UnknownEntityError: No such joint.
        MotionError: A fixed joint that moves, or a value in another unit.
    """
    _check_names(names, mechanism)
    able, fixed = movable(mechanism), {each.name: each.fixed_at for each in mechanism.joints}
    for k in (k for k, name in enumerate(names) if name not in able):
        away = np.flatnonzero(np.abs(values[:, k] - fixed[names[k]]) > STILL)
        if away.size:
            at = int(away[0])
            raise MotionError(
                f"'{array}' of {names[k]} at {given.at(at)} is {values[at, k]:.4g}, but the joint is fixed",
                allowed=f"{fixed[names[k]]:.6g}, or leave the joint out",
            )
    moving = [k for k, name in enumerate(names) if name in able]
    check_joints(tuple(names[k] for k in moving), values[:, moving], mechanism, array, given)
    return moving


def _velocities(given: Given, name: str, times: Array, positions: Array, columns: tuple[str, ...]) -> Array:
    if name in given:
        return given.numbers(name, positions.shape, columns)
    velocities = np.zeros_like(positions)
    for k, column in enumerate(positions.T):
        for run in _moving_runs(column):
            velocities[run, k] = at_rest_velocities(times[run], column[run, None])[:, 0]
    return velocities


def _moving_runs(column: Array) -> Iterator[slice]:
    """Samples from rest to rest: what stands from one sample to the next does not swing between them."""
    moves = np.abs(np.diff(column)) > STANDS
    edges = np.flatnonzero(np.diff(np.concatenate([[False], moves, [False]])))
    for first, last in edges.reshape(-1, 2):
        yield slice(first, last + 1)


def _phases(given: Given, samples: int) -> tuple[tuple[str, int], ...]:
    if "phase_names" not in given:
        return ()
    names = given.names("phase_names")
    starts = given.numbers("phase_starts", (len(names),)).tolist()
    if starts != sorted(starts) or any(each not in range(samples) for each in starts):
        said = ", ".join(f"{each:g}" for each in starts)
        raise MotionError(f"phases start at [{said}]", allowed=f"increasing samples from 0 to {samples - 1}")
    return tuple(zip(names, map(int, starts), strict=True))
