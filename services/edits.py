"""What people type, turned into edits of a twin; and the twin that a name, file or store stands for."""

import math
from pathlib import Path
from typing import Final

from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.history import (
    Edit,
    Followed,
    TakenAway,
    Trajectory,
    brought,
    changed,
    moved,
    obstacle,
    posed,
    without_obstacle,
)
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.load import load_twin, model_name
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.twin import Twin
from services.motions import read_motion
from services.requests import parse_state
from services.store.files import is_saved_graph, readable

EDITS: Final = {
    "move": "move:JOINT=VALUE (a position, open or closed)",
    "set": "set:JOINT.PROPERTY=NUMBER (upperLimit, velocityLimit …)",
    "pose": "pose:JOINT=X,Y,Z[,ROLL,PITCH,YAW]",
    "box": "box:NAME=SX,SY,SZ@X,Y,Z[,YAW]",
    "without": "without:NAME (of an obstacle or robot)",
    "robot": "robot:NAME (bundled, or a path)",
    "follow": "follow:MOTION.npz (joint values, or a body motion)",
}
POSE_NUMBERS: Final = (3, 6)


def twin_of(source: str, robots: tuple[str, ...] = (), annotation: str | None = None) -> Twin:
    """The twin of a bundled kitchen, a model file, or a saved graph; `KITCHEN@JOINT=VALUE,…` in a state.

    Raises:
        InputError: None of these, or no such state.
        GraphError: The saved graphs are not whole.
    """
    name, at, states = source.rpartition("@") if "=" in source.rpartition("@")[2] else (source, "", "")
    if is_saved_graph(name):
        store = readable(name)
        try:
            twin = Twin.from_quads(store.dump())
        finally:
            store.close()
    else:
        twin = load_twin(name, robots, annotation=annotation)
    return twin.at(parse_state(twin, states.split(","))) if at else twin


def parse_edit(twin: Twin, text: str) -> Edit:
    """The edit that a text such as `set:door_joint.upperLimit=1.2` means for this twin.

    Raises:
        InputError: It is none, or names what the twin does not have.
    """
    verb, colon, rest = text.partition(":")
    if not colon or verb not in EDITS or not rest:
        raise InputError(f"'{text}' is no edit", allowed="; ".join(EDITS.values()))
    if verb == "without":
        return _without(twin, rest)
    if verb == "robot":
        return _robot(twin, rest)
    if verb == "follow":
        return Followed(Trajectory.of(read_motion(Path(rest), twin)))
    name, equals, value = rest.partition("=")
    if not equals or not name or not value:
        raise InputError(f"'{text}' is no edit", allowed=EDITS[verb])
    if verb == "move":
        after = parse_state(twin, [rest])
        followers = twin.entities.coupling.followers
        return moved(
            {joint: at for joint, at in after.items() if at != twin.state[joint] and joint not in followers}
        )
    if verb == "set":
        return _set(twin, name, value, text)
    return _placed(twin, verb, name, value, text)


def _without(twin: Twin, name: str) -> Edit:
    robots = {twin.name(robot): robot for robot in twin.robots}
    return TakenAway(robots[name]) if name in robots else without_obstacle(twin, name)


def _robot(twin: Twin, name: str) -> Edit:
    """A robot from its file; it is the same beside any kitchen, so that this one need not be loaded again."""
    if model_name(name) in map(local_name, twin.robots):
        raise InputError(f"robot '{model_name(name)}' is there already", allowed="another robot")
    other = load_twin("b", [name])
    return brought(other, other.robots[0])


def _set(twin: Twin, name: str, value: str, text: str) -> Edit:
    whole, dot, what = name.rpartition(".")
    if not dot:
        raise InputError(f"'{text}' names no property", allowed=EDITS["set"])
    (number,) = _numbers(value, (1,), text)
    return changed(twin, _joint(twin, whole), **{what: number})


def _placed(twin: Twin, verb: str, name: str, value: str, text: str) -> Edit:
    if verb == "pose":
        numbers = _numbers(value, POSE_NUMBERS, text)
        return posed(twin, _joint(twin, name), _pose(numbers))
    size, _, place = value.partition("@")
    sides = _numbers(size, (3,), text)
    if min(sides) <= 0:
        raise InputError(f"'{text}' has a side that is not above 0", allowed=EDITS["box"])
    numbers = _numbers(place or "0,0,0", (3, 4), text)
    box = Geometry(ShapeType.BOX, Pose(), tuple(sides))
    yaw = numbers[3:] or [0.0]
    return obstacle(twin, name, [box], _pose([*numbers[:3], 0.0, 0.0, *yaw]))


def _joint(twin: Twin, name: str) -> Iri:
    """A joint of the kitchen or, as ROBOT/JOINT, of a robot."""
    model, slash, joint = name.rpartition("/")
    models = {twin.name(each): each for each in (twin.environment, *twin.robots)}
    owner = model if slash else twin.name(twin.environment)
    if owner not in models:
        raise UnknownEntityError("kitchen or robot", owner, models)
    names = [each.name for each in twin.mechanism(models[owner]).joints]
    if joint not in names:
        raise UnknownEntityError("joint", joint, names)
    return joint_iri(owner, joint)


def _numbers(text: str, counts: tuple[int, ...], whole: str) -> list[float]:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in counts or not all(map(math.isfinite, numbers)):
        wanted = " or ".join(map(str, counts))
        raise InputError(f"'{whole}': '{text}' is not {wanted} finite number(s)", allowed="as X,Y,Z")
    return numbers


def _pose(numbers: list[float]) -> Pose:
    """Pose of x, y, z [m] and, where given, roll, pitch, yaw [rad] about fixed axes."""
    x, y, z, *angles = numbers
    roll, pitch, yaw = angles or (0.0, 0.0, 0.0)
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a / 2), math.sin(a / 2)) for a in (roll, pitch, yaw))
    orientation = (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
    return Pose((x, y, z), orientation)
