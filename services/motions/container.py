"""Arrays → τ of a container, and back."""

from collections.abc import Mapping

import numpy as np

from sdt_kg.errors import ALIKE, MotionError, UnknownEntityError
from sdt_kg.iri import body_iri, joint_iri, local_name
from sdt_kg.mechanism import JointType, Mechanism
from sdt_kg.motion import Motion
from sdt_kg.twin import Twin
from services.motions.given import Given
from services.motions.units import check_base, check_joints, check_leaps, check_times

UNIT_NORM = 1e-3
"""[1] How far the norm of a quaternion may be from 1."""


def joint_motion(given: Given, twin: Twin) -> Motion:
    """τ as positions of the container's joint."""
    times, name = given.times(), given.text("joint") or ""
    kitchen = twin.mechanism(twin.environment)
    check_known("joint", name, movable(kitchen))
    values = given.column("values", len(times))
    velocities = given.column("velocities", len(times)) if "velocities" in given else None
    check_joints((name,), values, kitchen, "values", given)
    check_times(times, (name,), values, velocities, kitchen)
    check_leaps((name,), times, values, kitchen, given)
    return Motion(joint_iri(kitchen.name, name), times, values, given.flag("timed", default=True), velocities)


def frame_motion(given: Given, twin: Twin) -> Motion:
    """τ as poses of a frame of the kitchen."""
    times, name = given.times(), given.text("frame") or ""
    kitchen = twin.mechanism(twin.environment)
    check_known("frame", name, {body.name for body in kitchen.bodies})
    poses = given.numbers("poses", (len(times), 7))
    norms = np.linalg.norm(poses[:, 3:], axis=1)
    wrong = np.flatnonzero(np.abs(norms - 1) > UNIT_NORM)
    if wrong.size:
        k = int(wrong[0])
        raise MotionError(
            f"the quaternion at {given.at(k)} has the norm {norms[k]:.4g}",
            allowed="x, y, z [m], then a unit quaternion x, y, z, w",
        )
    check_base(poses[:, :2], "poses", given)
    return Motion(body_iri(kitchen.name, name), times, poses, given.flag("timed", default=True))


def container_arrays(motion: Motion) -> dict[str, np.ndarray]:
    """What `joint_motion` or `frame_motion` reads back exactly."""
    arrays = {"times": motion.times, "timed": np.array(motion.timed)}
    if motion.is_poses:
        return arrays | {"frame": np.array(local_name(motion.of)), "poses": motion.values}
    arrays |= {"joint": np.array(local_name(motion.of)), "values": motion.values[:, 0]}
    return arrays if motion.velocities is None else arrays | {"velocities": motion.velocities[:, 0]}


def movable(mechanism: Mechanism) -> set[str]:
    """Names of the joints that can move."""
    return {joint.name for joint in mechanism.joints if joint.type is not JointType.FIXED}


def check_known(kind: str, name: str, names: Mapping[str, object] | set[str], remedy: str = "") -> None:
    """The name is one of these.

    Raises:
        UnknownEntityError: It is not; those of which it is a misspelling are told.
    """
    if name not in names:
        raise UnknownEntityError(kind, name, names, remedy, alike=ALIKE)
