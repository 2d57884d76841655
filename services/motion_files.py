"""Motions in .npz files: a robot's body motion, or a container's motion.

A body motion has `times` (T,) [s], `base` (T, 3) x, y [m], yaw [rad] in the world, `robot_joint_names` (n,),
`robot_positions` (T, n) and, if it says how the kitchen moves, `kitchen_joint_names` (m,),
`kitchen_positions` (T, m). A container's motion has `joint`, `times`, `values` (T,), or `frame`, `times`,
`poses` (T, 7): x, y, z [m], quaternion xyzw in the kitchen's root frame.

Between samples a motion is the cubic Hermite spline of positions and velocities. Files that we write have
velocities; where a file has none, they are those of the C² cubic spline through the samples which begins
and ends at rest. We also write `robot`, `gripper`, `phase_names`, `phase_starts`, `timed`.
"""

import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sdt_kg.errors import InputError, MotionError, UnknownEntityError
from sdt_kg.iri import Iri, body_iri, joint_iri, local_name
from sdt_kg.mechanism import JointType, Mechanism
from sdt_kg.motion import Array, BodyMotion, Motion
from sdt_kg.twin import Twin
from services.motion_units import check_base, check_joints, check_times
from services.physics.spline import at_rest_velocities

BODY_KEYS = ("times", "base", "robot_joint_names", "robot_positions")
ALLOWED = (
    "times, base, robot_joint_names, robot_positions (a robot's motion); "
    "joint, times, values or frame, times, poses (a container's)"
)

STILL = 1e-3
"""[rad or m] A fixed joint whose position differs from 0 by less stands still."""

Arrays = Mapping[str, np.ndarray]


def read_motion(path: Path, twin: Twin, robot: Iri | None = None) -> Motion | BodyMotion:
    """The motion in a file, checked against the twin.

    Args:
        path: An .npz file.
        twin: The kitchen and its robots, whose joints the file names.
        robot: Whose body motion it is; a file that names its robot may leave it out.

    Raises:
        MotionError: No .npz, wrong or missing arrays, times that do not increase, values that are
            not numbers or are probably in another unit; with the index and the joint.
        UnknownEntityError: A joint or frame which the models lack; the nearest names are told.
    """
    return motion_of(_load(path), twin, robot)


def motion_of(arrays: Arrays, twin: Twin, robot: Iri | None = None) -> Motion | BodyMotion:
    """The motion that these arrays are, as in a file; the same errors."""
    if "robot_positions" in arrays or "base" in arrays:
        return _body_motion(arrays, twin, robot)
    if "joint" in arrays:
        return _joint_motion(arrays, twin)
    if "frame" in arrays:
        return _frame_motion(arrays, twin)
    raise MotionError(f"the motion has {', '.join(arrays) or 'nothing'}", allowed=ALLOWED)


def write_motion(path: Path, motion: Motion | BodyMotion) -> None:
    """The motion is in the file, and `read_motion` gives it back exactly."""
    with path.open("wb") as out:
        np.savez_compressed(out, **arrays_of(motion))  # pyright: ignore[reportArgumentType]  # numpy's stub takes **kwds for allow_pickle


def arrays_of(motion: Motion | BodyMotion) -> dict[str, np.ndarray]:
    """The motion as the arrays of a file: `motion_of` gives it back exactly."""
    return _body_arrays(motion) if isinstance(motion, BodyMotion) else _arrays(motion)


def _load(path: Path) -> dict[str, np.ndarray]:
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except FileNotFoundError:
        raise InputError(f"no file at {path}") from None
    except (ValueError, OSError, EOFError, zipfile.BadZipFile, AttributeError) as error:
        raise MotionError(f"{path.name} is no .npz of plain arrays: {error}", allowed=ALLOWED) from None


def _numbers(arrays: Arrays, name: str, shape: tuple[int | None, ...]) -> Array:
    """An array of finite numbers of that shape; None stands for any length."""
    if name not in arrays:
        raise MotionError(f"the file has no '{name}'", allowed=ALLOWED)
    try:
        array = np.asarray(arrays[name], dtype=np.float64)
    except (TypeError, ValueError):
        raise MotionError(f"'{name}' holds {arrays[name].dtype}", allowed="numbers") from None
    fits = array.ndim == len(shape) and all(b in (None, a) for a, b in zip(array.shape, shape, strict=True))
    if not fits:
        wanted = ", ".join("T" if each is None else str(each) for each in shape)
        raise MotionError(f"'{name}' has the shape {array.shape}", allowed=f"({wanted})")
    wrong = np.argwhere(~np.isfinite(array))
    if wrong.size:
        raise MotionError(f"'{name}' is not a number at index {wrong[0].tolist()}", allowed="finite numbers")
    return array


def _names(arrays: Arrays, name: str) -> tuple[str, ...]:
    array = arrays[name]
    if array.ndim > 1 or array.dtype.kind not in "US":
        raise MotionError(f"'{name}' holds {array.dtype} of shape {array.shape}", allowed="a list of names")
    names = tuple(str(each) for each in array.astype(str).ravel())
    repeated = sorted({each for each in names if names.count(each) > 1})
    if repeated:
        raise MotionError(f"'{name}' names {repeated[0]} twice", allowed="every name once")
    return names


def _times(arrays: Arrays) -> Array:
    """Increasing times of two samples or more [s]."""
    times = _numbers(arrays, "times", (None,))
    if len(times) < 2:
        raise MotionError(f"the motion has {len(times)} samples", allowed="two or more")
    falling = np.flatnonzero(np.diff(times) <= 0)
    if falling.size:
        k = int(falling[0])
        raise MotionError(
            f"times do not increase: index {k} is {times[k]:.6g} s, index {k + 1} is {times[k + 1]:.6g} s",
            allowed="strictly increasing times",
        )
    return times


def _joint_motion(arrays: Arrays, twin: Twin) -> Motion:
    times, (name,) = _times(arrays), _names(arrays, "joint")
    kitchen = twin.mechanism(twin.environment)
    _known("joint", name, _movable(kitchen))
    values = _column(arrays, "values", len(times))
    velocities = _column(arrays, "velocities", len(times)) if "velocities" in arrays else None
    check_joints((name,), values, kitchen, "values")
    speeds = at_rest_velocities(times, values) if velocities is None else velocities
    check_times(times, (name,), speeds, kitchen)
    return Motion(joint_iri(kitchen.name, name), times, values, _timed(arrays), velocities)


def _frame_motion(arrays: Arrays, twin: Twin) -> Motion:
    times, (name,) = _times(arrays), _names(arrays, "frame")
    kitchen = twin.mechanism(twin.environment)
    _known("frame", name, {body.name for body in kitchen.bodies})
    poses = _numbers(arrays, "poses", (len(times), 7))
    norms = np.linalg.norm(poses[:, 3:], axis=1)
    wrong = np.flatnonzero(np.abs(norms - 1) > 1e-3)
    if wrong.size:
        k = int(wrong[0])
        raise MotionError(
            f"the quaternion at index {k} has the norm {norms[k]:.4g}",
            allowed="x, y, z [m], then a unit quaternion x, y, z, w",
        )
    check_base(poses[:, :2], "poses")
    return Motion(body_iri(kitchen.name, name), times, poses, _timed(arrays))


def _column(arrays: Arrays, name: str, samples: int) -> Array:
    """Shape (T, 1), from (T,) or (T, 1)."""
    if name in arrays and arrays[name].ndim == 2:
        return _numbers(arrays, name, (samples, 1))
    return _numbers(arrays, name, (samples,))[:, None]


def _timed(arrays: Arrays) -> bool:
    return bool(arrays["timed"]) if "timed" in arrays else True


def _body_motion(arrays: Arrays, twin: Twin, robot: Iri | None) -> BodyMotion:
    robot = _robot(arrays, twin, robot)
    for key in BODY_KEYS:
        if key not in arrays:
            raise MotionError(f"the file has no '{key}'", allowed=", ".join(BODY_KEYS))
    times, names = _times(arrays), _names(arrays, "robot_joint_names")
    body, kitchen = twin.mechanism(robot), twin.mechanism(twin.environment)
    base = _numbers(arrays, "base", (len(times), 3))
    q = _numbers(arrays, "robot_positions", (len(times), len(names)))
    check_base(base, "base")
    v = _velocities(arrays, "robot_velocities", times, q)
    moving = _moving(names, q, body, "robot_positions")
    names, q, v = tuple(names[k] for k in moving), q[:, moving], v[:, moving]
    check_times(times, names, v, body)
    joints, kitchen_q, kitchen_v = _kitchen(arrays, kitchen, times)
    return BodyMotion(
        robot=robot,
        gripper=str(arrays["gripper"]) if "gripper" in arrays else "",
        joints=names,
        times=times,
        base=base,
        q=q,
        v=v,
        base_v=_velocities(arrays, "base_velocities", times, base),
        kitchen_joints=tuple(joint_iri(kitchen.name, name) for name in joints),
        kitchen_q=kitchen_q,
        kitchen_v=kitchen_v,
        phases=_phases(arrays, len(times)),
    )


def _robot(arrays: Arrays, twin: Twin, robot: Iri | None) -> Iri:
    """The robot given, or the one that the file names."""
    named = str(arrays["robot"]) if "robot" in arrays else None
    if robot is None and named is None and len(twin.robots) == 1:
        return twin.robots[0]
    names = {local_name(each): each for each in twin.robots}
    if robot is None and named is not None:
        _known("robot", named, names)
        return names[named]
    if robot is None:
        raise MotionError("the file names no robot", allowed=", ".join(names) or "load a robot")
    if named is not None and named != local_name(robot):
        raise MotionError(f"the motion is of the robot '{named}'", allowed=local_name(robot))
    return robot


def _kitchen(arrays: Arrays, kitchen: Mechanism, times: Array) -> tuple[tuple[str, ...], Array, Array]:
    """Names, positions and velocities of the kitchen's movable joints, if the file has any."""
    if "kitchen_joint_names" not in arrays:
        return (), np.zeros((len(times), 0)), np.zeros((len(times), 0))
    names = _names(arrays, "kitchen_joint_names")
    q = _numbers(arrays, "kitchen_positions", (len(times), len(names)))
    v = _velocities(arrays, "kitchen_velocities", times, q)
    moving = _moving(names, q, kitchen, "kitchen_positions")
    return tuple(names[k] for k in moving), q[:, moving], v[:, moving]


def _moving(names: tuple[str, ...], values: Array, mechanism: Mechanism, array: str) -> list[int]:
    """Columns of joints that can move; a joint that is fixed in our model may be listed, standing still.

    Raises:
        UnknownEntityError: No such joint.
        MotionError: A fixed joint that moves, or a value in another unit.
    """
    for name in names:
        _known("joint", name, {joint.name for joint in mechanism.joints})
    movable = _movable(mechanism)
    for k in (k for k, name in enumerate(names) if name not in movable):
        away = np.flatnonzero(np.abs(values[:, k]) > STILL)
        if away.size:
            at = int(away[0])
            raise MotionError(
                f"'{array}' of {names[k]} at index {at} is {values[at, k]:.4g}, but the joint is fixed",
                allowed="0, or leave the joint out",
            )
    moving = [k for k, name in enumerate(names) if name in movable]
    check_joints(tuple(names[k] for k in moving), values[:, moving], mechanism, array)
    return moving


def _velocities(arrays: Arrays, name: str, times: Array, positions: Array) -> Array:
    if name in arrays:
        return _numbers(arrays, name, positions.shape)
    return at_rest_velocities(times, positions) if positions.size else np.zeros_like(positions)


def _phases(arrays: Arrays, samples: int) -> tuple[tuple[str, int], ...]:
    if "phase_names" not in arrays:
        return ()
    names = _names(arrays, "phase_names")
    starts = [int(each) for each in _numbers(arrays, "phase_starts", (len(names),))]
    if starts != sorted(starts) or any(not 0 <= each < samples for each in starts):
        raise MotionError(f"phases start at {starts}", allowed=f"increasing samples from 0 to {samples - 1}")
    return tuple(zip(names, starts, strict=True))


def _movable(mechanism: Mechanism) -> set[str]:
    return {joint.name for joint in mechanism.joints if joint.type is not JointType.FIXED}


def _known(kind: str, name: str, names: Mapping[str, object] | set[str]) -> None:
    if name not in names:
        raise UnknownEntityError(kind, name, names)


def _arrays(motion: Motion) -> dict[str, np.ndarray]:
    arrays = {"times": motion.times, "timed": np.array(motion.timed)}
    if motion.is_poses:
        return arrays | {"frame": np.array(local_name(motion.of)), "poses": motion.values}
    arrays |= {"joint": np.array(local_name(motion.of)), "values": motion.values[:, 0]}
    return arrays if motion.velocities is None else arrays | {"velocities": motion.velocities[:, 0]}


def _body_arrays(motion: BodyMotion) -> dict[str, np.ndarray]:
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
