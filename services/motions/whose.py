"""Joints that are the robot's or the kitchen's, as bags have them: whose they are, the models tell.

Who reads a bag needs no models then; who judges its motion has them.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from sdt_kg.errors import MotionError
from sdt_kg.iri import Iri
from sdt_kg.motion import Array
from sdt_kg.twin import Twin
from services.motions.base import check_names
from services.motions.given import Given

NAMES, POSITIONS = "joint_names", "joint_positions"
MOVING, VELOCITIES = "moving_joint_names", "joint_velocities"
BASE_JOINT: Final = "base_joint"
"""Of what the poses of the base are said to be."""
OF_BAGS: Final = (NAMES, POSITIONS, MOVING, VELOCITIES, BASE_JOINT)


def whole(columns: Mapping[str, Array], speeds: Mapping[str, Array]) -> dict[str, np.ndarray]:
    """Positions and velocities, shape (T,) each, as arrays of all joints."""
    arrays: dict[str, np.ndarray] = {NAMES: _texts(columns), POSITIONS: _side_by_side(columns)}
    return arrays | ({MOVING: _texts(speeds), VELOCITIES: _side_by_side(speeds)} if speeds else {})


def parted(given: Given, twin: Twin, robot: Iri | None) -> Given:
    """The same with the robot's joints and the kitchen's, each by itself.

    Args:
        given: Arrays of a motion; one whose joints are the robot's or the kitchen's already stays as it is.
        twin: Joints are the robot's or, where the robot has none of that name, the kitchen's.
        robot: Whose motion it is; None: of the twin's only one.

    Raises:
        MotionError: Velocities of a part of a group, poses that are not of the base, joints of two kinds.
    """
    if not any(name in given for name in OF_BAGS):
        return given
    twice = next((name for name in given.arrays if name.startswith(("robot_j", "robot_p", "kitchen_"))), None)
    if twice:
        raise MotionError(f"the file has '{NAMES}' and '{twice}'", allowed="one of them")
    robot = twin.robots[0] if robot is None and len(twin.robots) == 1 else robot
    if BASE_JOINT in given:
        check_names(given.names(BASE_JOINT), twin, robot)
    columns, speeds = _columns(given, NAMES, POSITIONS), dict[str, Array]()
    if MOVING in given or VELOCITIES in given:
        speeds = _columns(given, MOVING, VELOCITIES)
    others = {name: array for name, array in given.arrays.items() if name not in OF_BAGS}
    return Given(others | _of_each(columns, speeds, twin, robot), given.at)


def rates_of(speeds: Mapping[str, Array], names: Sequence[str]) -> Array | None:
    """Velocities of these joints, shape (T, n); None where there are none."""
    known = [name for name in names if name in speeds]
    for name in names if known else ():
        if name not in known:
            raise MotionError(
                f"there are velocities of '{known[0]}', and none of '{name}'",
                allowed="velocities of all of base, robot or kitchen, or of none of it",
            )
    return np.array([speeds[name] for name in names]).T if known else None


def _of_each(
    columns: Mapping[str, Array], speeds: Mapping[str, Array], twin: Twin, robot: Iri | None
) -> dict[str, np.ndarray]:
    own = set() if robot is None else {joint.name for joint in twin.mechanism(robot).joints}
    kitchen = {joint.name for joint in twin.mechanism(twin.environment).joints} - own
    groups = {
        "robot": [name for name in columns if name not in kitchen],
        "kitchen": [name for name in columns if name in kitchen],
    }
    arrays: dict[str, np.ndarray] = {}
    for group, names in groups.items():
        if group == "robot" or names:
            samples = len(next(iter(columns.values()), ()))
            arrays[f"{group}_joint_names"] = _texts(names)
            arrays[f"{group}_positions"] = np.array([columns[name] for name in names]).T.reshape(samples, -1)
            rates = rates_of(speeds, names)
            if rates is not None:
                arrays[f"{group}_velocities"] = rates
    return arrays


def _columns(given: Given, names: str, values: str) -> dict[str, Array]:
    """Joint → its column, shape (T,)."""
    if names not in given:
        raise MotionError(f"there is no '{names}', and '{values}' are theirs", allowed="both, or none")
    joints = given.names(names)
    array = given.numbers(values, (None, len(joints)), joints)
    return {name: array[:, k] for k, name in enumerate(joints)}


def _texts(names: Mapping[str, Array] | Sequence[str]) -> np.ndarray:
    return np.array(list(names), dtype=np.str_)


def _side_by_side(columns: Mapping[str, Array]) -> np.ndarray:
    return np.array(list(columns.values())).T
