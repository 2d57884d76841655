"""What people type as a counterfactual edit, turned into another world: twin, robot or policy."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from sdt_kg.annotation import Drive
from sdt_kg.entities import Replacement
from sdt_kg.errors import InputError
from sdt_kg.history import Rewritten, posed
from sdt_kg.iri import SDT, Iri, joint_iri, local_name
from sdt_kg.load import load_twin, model_name
from sdt_kg.mechanism import Joint, Pose
from sdt_kg.twin import Container, Twin
from services.app import Service
from services.edits import EDITS, parse_edit
from services.requests import parse_base, parse_state

TWIN_EDITS: Final = ("move", "set", "pose", "box", "without")

KINDS: Final = {
    "robot": "robot:NAME (another robot does it: bundled, or a path)",
    "kitchen": "kitchen:NAME (the same task in another kitchen)",
    "drive": "drive:omni|differential|fixed (the base moves otherwise)",
    "base": "base:X,Y,YAW (the robot starts elsewhere) [m, m, rad]",
    "handle": "handle:CONTAINER=DX,DY,DZ (its handle is moved, in the frame of its body) [m]",
    "jam": "jam:CONTAINER (its joint is stuck)",
    "broken": "broken:GRIPPER (the robot cannot use it)",
    **{name: EDITS[name] for name in TWIN_EDITS},
}
"""Kind → how it is written, and what it means."""


@dataclass(frozen=True, slots=True)
class World:
    """Where a question is asked, and of whom.

    Attributes:
        service: Kitchen, robots and policy.
        robot: Bundled name or path, as loaded.
    """

    service: Service
    robot: str

    @property
    def robot_iri(self) -> Iri:
        """IRI of the robot that is asked about."""
        return self.service.robot(model_name(self.robot))


@dataclass(frozen=True, slots=True)
class Change:
    """One edit.

    Attributes:
        text: As it is written.
        at: World, share in [0, 1] → the world after that share of the change.
        amount: Share → in words; None: there is no half of such a change.
    """

    text: str
    at: Callable[[World, float], World]
    amount: Callable[[World, float], str] | None = None

    @property
    def is_gradual(self) -> bool:
        """Whether there is something between nothing and all of it."""
        return self.amount is not None


def parse_change(text: str) -> Change:
    """The change that a text means; the names in it are looked up in the world to which it is applied.

    Raises:
        InputError: No such kind of edit.
    """
    kind, colon, rest = text.partition(":")
    if kind not in KINDS or not colon or not rest:
        raise InputError(f"'{text}' is no edit", allowed="; ".join(KINDS.values()))
    if kind in _WHOLE:
        whole = _WHOLE[kind]
        return Change(text, lambda world, share: whole(world, rest) if share > 0 else world)
    if kind in {"move", "set", "base", "handle"}:
        return _gradual(text, kind, rest)
    return Change(text, lambda world, share: _twin_edited(world, text) if share > 0 else world)


def changed(world: World, changes: tuple[Change, ...], share: float = 1.0) -> World:
    """The world after a share of all changes, in their order."""
    for change in changes:
        world = change.at(world, share)
    return world


def _gradual(text: str, kind: str, rest: str) -> Change:
    """A change whose numbers go from what they are to what is asked."""
    name, _, value = rest.partition("=") if kind != "base" else ("", "", rest)
    ends = _ENDS[kind]

    def numbers(world: World, share: float) -> np.ndarray:
        start, end = ends(world, name, value)
        return start + share * (end - start)

    def at(world: World, share: float) -> World:
        values = ",".join(repr(float(each)) for each in numbers(world, share))
        if kind == "base":
            base = parse_base(values)
            return _under(world, base=base)
        if kind == "handle":
            return _handle_moved(world, name, numbers(world, share))
        return _twin_edited(world, f"{kind}:{name}={values}")

    def amount(world: World, share: float) -> str:
        values = ",".join(f"{each:.4g}" for each in numbers(world, share))
        return f"{kind}:{name}={values}" if name else f"{kind}:{values}"

    return Change(text, at, amount)


def _move_ends(world: World, name: str, value: str) -> tuple[np.ndarray, np.ndarray]:
    """Position of the joint as it is, and as asked; of what moves with it, the one that is set."""
    twin = world.service.twin
    after = parse_state(twin, [f"{name}={value}"])
    followers = twin.entities.coupling.followers
    moving = [joint for joint in after if after[joint] != twin.state[joint] and joint not in followers]
    if not moving:
        raise InputError(f"move:{name}={value} changes nothing", allowed="another position")
    return np.array([twin.state[moving[0]]]), np.array([after[moving[0]]])


def _set_ends(world: World, name: str, value: str) -> tuple[np.ndarray, np.ndarray]:
    joint_name, _, what = name.rpartition(".")
    twin = world.service.twin
    (end,) = _numbers(value, 1)
    joint = _joint_named(twin, joint_name)
    now = {
        "lowerLimit": joint.limits.lower,
        "upperLimit": joint.limits.upper,
        "velocityLimit": joint.limits.velocity,
        "accelerationLimit": joint.limits.acceleration,
        "effortLimit": joint.limits.effort,
    }.get(what)
    if now is None or not np.isfinite(now):
        raise InputError(f"'{name}' has no finite value to start from", allowed="a limit that the joint has")
    return np.array([now]), np.array([end])


def _base_ends(world: World, name: str, value: str) -> tuple[np.ndarray, np.ndarray]:
    del name
    base = parse_base(value)
    assert base is not None, "a text was given"
    start = world.service.policy.base or world.service.twin.kitchen().start
    return np.array(start, dtype=float), np.array(base)


def _handle_ends(world: World, name: str, value: str) -> tuple[np.ndarray, np.ndarray]:
    world.service.twin.container(name)
    return np.zeros(3), np.array(_numbers(value, 3))


_ENDS: Final = {"move": _move_ends, "set": _set_ends, "base": _base_ends, "handle": _handle_ends}


def _twin_edited(world: World, text: str) -> World:
    twin = world.service.twin
    return _in(world, parse_edit(twin, text).applied(twin))


def _in(world: World, twin: Twin) -> World:
    return replace(world, service=replace(world.service, twin=twin))


def _under(world: World, **policy: object) -> World:
    service = world.service
    return replace(world, service=replace(service, policy=replace(service.policy, **policy)))


def _handle_moved(world: World, name: str, by: np.ndarray) -> World:
    """The frame of the handle's fixed joint is elsewhere."""
    twin = world.service.twin
    container = twin.container(name)
    joint = _carrying(twin, container)
    origin = joint.origin
    x, y, z = np.add(origin.position, by)
    pose = Pose((float(x), float(y), float(z)), origin.orientation)
    iri = joint_iri(twin.name(twin.environment), joint.name)
    return _in(world, posed(twin, iri, pose).applied(twin))


def _carrying(twin: Twin, container: Container) -> Joint:
    """The joint by which a container's handle hangs on it."""
    handle = local_name(container.handle)
    joints = [each for each in twin.mechanism(twin.environment).joints if each.child == handle]
    if not joints or container.handle == container.iri:
        raise InputError(
            f"the handle of {container.name} is no body of its own", allowed="a handle on a joint"
        )
    return joints[0]


def _jammed(world: World, name: str) -> World:
    twin = world.service.twin
    joint = local_name(twin.container(name).active_joint)
    return _twin_edited(world, f"set:{joint}.velocityLimit=0")


def _broken(world: World, name: str) -> World:
    """The robot has the gripper no longer."""
    twin, robot = world.service.twin, world.robot_iri
    names = [each.name for each in twin.robot(robot).grippers]
    if name not in names:
        raise InputError(f"no gripper '{name}'", allowed=", ".join(names))
    if len(names) == 1:
        raise InputError(f"'{name}' is the robot's only gripper", allowed="a robot with another one left")
    triples = twin.entities.store.triples(twin.entities.asserted[robot])
    lost = frozenset(
        each for each in triples if each[1] == SDT + "hasGripper" and local_name(each[2].value) == name
    )
    by = Replacement(robot, lost, frozenset(), f"gripper {name} is broken")
    return _in(world, Rewritten(by).applied(twin))


def _other_robot(world: World, name: str) -> World:
    twin = world.service.twin
    if model_name(name) not in [twin.name(each) for each in twin.robots]:
        twin = parse_edit(twin, f"robot:{name}").applied(twin)
    return replace(_in(world, twin), robot=name)


def _other_kitchen(world: World, name: str) -> World:
    return _in(world, load_twin(name, [world.robot]))


def _other_drive(world: World, name: str) -> World:
    try:
        return _under(world, drive=Drive(name))
    except ValueError:
        raise InputError(f"no drive '{name}'", allowed=", ".join(each.value for each in Drive)) from None


_WHOLE: Final = {
    "robot": _other_robot,
    "kitchen": _other_kitchen,
    "drive": _other_drive,
    "jam": _jammed,
    "broken": _broken,
}


def _joint_named(twin: Twin, name: str) -> Joint:
    joints = {each.name: each for each in twin.mechanism(twin.environment).joints}
    if name not in joints:
        raise InputError(f"no joint '{name}' in the kitchen", allowed="a joint of sdt containers --all")
    return joints[name]


def _numbers(text: str, count: int) -> list[float]:
    try:
        numbers = [float(each) for each in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(np.isfinite(numbers)):
        raise InputError(f"'{text}' is not {count} finite number(s)", allowed="as X,Y,Z")
    return numbers
