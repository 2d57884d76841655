"""What people type, turned into edits of a twin; and the twin that a name, file or store stands for."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from sdt_kg.entities import Replacement
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.history import (
    Edit,
    Followed,
    Rewritten,
    TakenAway,
    Trajectory,
    brought,
    changed,
    moved,
    obstacle,
    posed,
    without_obstacle,
)
from sdt_kg.iri import Iri, body_iri, joint_iri, local_name
from sdt_kg.load import load_twin, model_name
from sdt_kg.mechanism import Geometry, Joint, JointType, Mechanism, Pose, ShapeType
from sdt_kg.numbers import number_in
from sdt_kg.scenes.build import pose_of
from sdt_kg.twin import Twin
from sdt_kg.urdf.document import LARGEST
from sdt_kg.urdf.meshes import mesh_hash
from services.kinds_of_edit import EDITS, no_edit
from services.motions import read_motion
from services.requests import parse_state
from services.store.files import folder_of_place, is_saved_graph, readable
from services.store.histories import kept_history

POSE_NUMBERS: Final = (3, 6)
MESHES: Final = (".stl", ".obj", ".dae")


def twin_of(source: str, robots: tuple[str, ...] = (), annotation: str | None = None) -> Twin:
    """The twin of a bundled kitchen, a model file, or a saved graph; `KITCHEN@JOINT=VALUE,…` in a state.

    Raises:
        InputError: None of these, or no such state.
        GraphError: The saved graphs are not whole.
    """
    name, at, states = source.rpartition("@") if "=" in source.rpartition("@")[2] else (source, "", "")
    twin = _saved_twin(name) if is_saved_graph(name) else load_twin(name, robots, annotation=annotation)
    return twin.at(parse_state(twin, states.split(","))) if at else twin


def _saved_twin(place: str) -> Twin:
    """The twin of saved graphs; of a kept history, the twin of its latest branch."""
    history = kept_history(place)
    if history is not None:
        return history.latest.twin
    store = readable(place)
    try:
        return Twin.from_quads(store.dump(), beside=folder_of_place(place))
    finally:
        store.close()


def parse_edit(twin: Twin, text: str) -> Edit:
    """The edit that a text such as `set:door_joint.upperLimit=1.2` means for this twin.

    Raises:
        InputError: It is none, or names what the twin does not have.
    """
    verb, colon, rest = text.partition(":")
    if not colon or verb not in EDITS or not rest:
        raise no_edit(text, EDITS, "sdt branch --help")
    if verb == "without":
        return _without(twin, rest)
    if verb == "clear":
        return _clear(twin, rest)
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
    return _MAKERS[verb](twin, name, value, text)


def _without(twin: Twin, name: str) -> Edit:
    robots = {twin.name(robot): robot for robot in twin.robots}
    return TakenAway(robots[name]) if name in robots else without_obstacle(twin, name)


def _clear(twin: Twin, name: str) -> Edit:
    """A body and all that hangs on it have no shape any more."""
    kitchen = twin.mechanism(twin.environment)
    names = [each.name for each in kitchen.bodies]
    if name not in names:
        raise UnknownEntityError("body", name, names)
    gone = {name}
    for joint in kitchen.joints:  # parents before children
        if joint.parent in gone:
            gone.add(joint.child)
    shapes = tuple(f"{body_iri(kitchen.name, each)}/collision/" for each in gone)
    removed = frozenset(
        triple
        for triple in twin.entities.store.triples(twin.entities.asserted[twin.environment])
        if triple[0].startswith(shapes) or triple[2].value.startswith(shapes)
    )
    if not removed:
        raise InputError(f"'{name}' has no shape", allowed="a body that something can run into")
    return Rewritten(Replacement(twin.environment, removed, frozenset(), f"{name} cleared away"))


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
    (number,) = numbers_of(value, (1,), text, math.inf)
    return changed(twin, joint_called(twin, whole), **{what: number})


def _posed(twin: Twin, name: str, value: str, text: str) -> Edit:
    return posed(twin, joint_called(twin, name), _pose(numbers_of(value, POSE_NUMBERS, text)))


def _furniture(twin: Twin, name: str, value: str, text: str) -> Edit:
    """A body and all that hangs on it are elsewhere, turned about the vertical through the body's frame."""
    x, y, *more = numbers_of(value, (2, 3, 4), text)
    height, yaw = ([*more, 0.0, 0.0])[:2]
    kitchen = twin.mechanism(twin.environment)
    joint = _piece(twin, name)
    root_T_parent = np.eye(4)
    for each in _above(kitchen, joint.parent):
        if each.type is not JointType.FIXED:
            raise InputError(f"'{name}' hangs on {each.child}, which moves", allowed="what stands still")
        root_T_parent = each.origin.matrix() @ root_T_parent
    root_T_child = root_T_parent @ joint.origin.matrix()
    turn = _pose([0.0, 0.0, 0.0, 0.0, 0.0, yaw]).matrix()[:3, :3]
    root_T_child[:3, :3] = turn @ root_T_child[:3, :3]
    root_T_child[:3, 3] += (x, y, height)
    pose = pose_of(np.linalg.inv(root_T_parent) @ root_T_child)
    return posed(twin, joint_iri(kitchen.name, joint.name), pose)


def _piece(twin: Twin, name: str) -> Joint:
    """The joint of a body; of a container that of the piece of furniture on which it hangs."""
    kitchen = twin.mechanism(twin.environment)
    above = {each.child: each for each in kitchen.joints}
    containers = {each.name: each for each in twin.containers()}
    if name in containers:
        name = kitchen.joint(local_name(containers[name].joint)).parent
        while name in above and above[name].type is not JointType.FIXED:
            name = above[name].parent
    if name not in above:
        raise UnknownEntityError("piece of furniture", name, above)
    return above[name]


def _above(kitchen: Mechanism, body: str) -> Iterator[Joint]:
    """The joints between a body and the root, from the body up."""
    above = {each.child: each for each in kitchen.joints}
    while body in above:
        yield above[body]
        body = above[body].parent


def _box(twin: Twin, name: str, value: str, text: str) -> Edit:
    size, _, place = value.partition("@")
    sides = numbers_of(size, (3,), text)
    if min(sides) <= 0:
        raise InputError(f"'{text}' has a side that is not above 0", allowed=EDITS["box"])
    box = Geometry(ShapeType.BOX, Pose(), tuple(sides))
    return obstacle(twin, name, [box], _upright(place, text))


def _mesh(twin: Twin, name: str, value: str, text: str) -> Edit:
    """A mesh is read where it lies: what the one who types may read."""
    reference, _, place = value.rpartition("@")
    file, _, factor = reference.partition("*")
    path = Path(file).expanduser().resolve()
    if not path.is_file() or path.suffix.lower() not in MESHES:
        raise InputError(f"no mesh '{file}'", allowed=EDITS["mesh"])
    (scale,) = numbers_of(factor or "1", (1,), text)
    if scale <= 0:
        raise InputError(f"'{text}' has a scale that is not above 0", allowed=EDITS["mesh"])
    shape = Geometry(ShapeType.MESH, Pose(), (scale, scale, scale), str(path), mesh_hash(path))
    return obstacle(twin, name, [shape], _upright(place, text))


def _upright(place: str, text: str) -> Pose:
    """Pose of x, y, z [m] and, where given, yaw [rad]."""
    x, y, z, *yaw = numbers_of(place, (3, 4), text)
    return _pose([x, y, z, 0.0, 0.0, *(yaw or [0.0])])


_MAKERS: Final[dict[str, Callable[[Twin, str, str, str], Edit]]] = {
    "set": _set,
    "pose": _posed,
    "furniture": _furniture,
    "box": _box,
    "mesh": _mesh,
}


def joint_called(twin: Twin, name: str) -> Iri:
    """A joint of the kitchen or, as ROBOT/JOINT, of a robot; a joint's name may have a / in it itself.

    Raises:
        UnknownEntityError: There is no such kitchen, robot or joint.
        InputError: A joint of the kitchen is called as one of a robot is named here.
    """
    models = {twin.name(each): each for each in (twin.environment, *twin.robots)}
    names = {owner: [each.name for each in twin.mechanism(iri).joints] for owner, iri in models.items()}
    kitchen = twin.name(twin.environment)
    readings = [(owner, name.removeprefix(f"{owner}/")) for owner in models if name.startswith(f"{owner}/")]
    found = [(owner, joint) for owner, joint in [(kitchen, name), *readings] if joint in names[owner]]
    if len(found) > 1:
        raise InputError(
            f"'{name}' is a joint of {' and of '.join(owner for owner, _ in found)}",
            allowed="a name that is one joint's",
            remedy=f"'{kitchen}/{name}' is the kitchen's; give the other another name in its file",
        )
    if not found:
        raise _no_joint(name, readings[-1] if readings else (kitchen, name), names)
    return joint_iri(*found[0])


def _no_joint(name: str, reading: tuple[str, str], names: Mapping[str, Sequence[str]]) -> UnknownEntityError:
    """What is not there: the joint, or the model before the /, if no joint is called with one."""
    owner, joint = reading
    model, slash, _ = name.partition("/")
    if slash and model not in names and not any("/" in each for each in names[owner]):
        return UnknownEntityError("kitchen or robot", model, names)
    return UnknownEntityError("joint", joint, names[owner])


def numbers_of(text: str, counts: tuple[int, ...], whole: str, largest: float = LARGEST) -> list[float]:
    """The finite numbers of a text with commas between.

    Args:
        text: The numbers.
        counts: How many they may be.
        whole: What they are part of, for the error.
        largest: How large each may be, as in a model's file unless it is said.

    Raises:
        InputError: They are not so many, not numbers, or too large.
    """
    try:
        numbers = [number_in(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in counts or not all(map(math.isfinite, numbers)):
        wanted = " or ".join(map(str, counts))
        allowed = f"{wanted} finite numbers with commas between" if counts != (1,) else "one finite number"
        form = EDITS.get(whole.partition(":")[0], "")
        raise InputError(
            f"'{whole}': '{text}' has not the numbers that it takes",
            allowed=allowed,
            remedy=f"as in {form}" if form else "",
        )
    if max(map(abs, numbers)) > largest:
        raise InputError(f"'{whole}': {max(numbers, key=abs):g} is too large", allowed=f"up to {largest:g}")
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
