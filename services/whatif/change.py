"""Changes of a world: all at once, or by a share where there is something between nothing and all of it."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.history import posed
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.mechanism import Joint, Pose
from sdt_kg.twin import Container, Twin
from services.edits import joint_called, numbers_of
from services.kinds_of_edit import EDITS, no_edit
from services.requests import named_joints, parse_base, parse_state
from services.whatif.payload import FORM
from services.whatif.whole import WHOLE
from services.whatif.world import World

TWIN_EDITS: Final = ("move", "set", "pose", "furniture", "box", "mesh", "without", "clear")

KINDS: Final = {
    "robot": "robot:NAME (another robot does it: bundled, or a path)",
    "kitchen": "kitchen:NAME (the same task in another kitchen)",
    "drive": "drive:omni|differential|fixed (the base moves otherwise)",
    "base": "base:X,Y,YAW (the robot starts elsewhere) [m, m, rad]",
    "handle": "handle:CONTAINER=DX,DY,DZ (its handle is moved, in the frame of its body) [m]",
    "jam": "jam:CONTAINER (its joint is stuck)",
    "broken": "broken:GRIPPER (the robot cannot use it)",
    "payload": f"{FORM} (a box is in it: it cannot be used, and the box must touch nothing) [m, kg]",
    **{name: EDITS[name] for name in TWIN_EDITS},
}
"""Kind → how it is written, and what it means."""

OF_ROBOT: Final = frozenset({"robot", "kitchen", "broken", "payload"})
"""Kinds that make another world for each robot."""


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

    def sooner(self, factor: float) -> "Change":
        """A gradual change that is complete after a share of 1 / factor."""
        amount = self.amount
        assert amount is not None, "a whole change is made or not"

        def share_of(share: float) -> float:
            return min(1.0, factor * share)

        return Change(
            self.text,
            lambda world, share: self.at(world, share_of(share)),
            lambda world, share: amount(world, share_of(share)),
        )


def parse_change(text: str) -> Change:
    """The change that a text means; the names in it are looked up in the world to which it is applied.

    Raises:
        InputError: No such kind of edit.
    """
    kind, colon, rest = text.partition(":")
    if kind not in KINDS or not colon or not rest:
        raise no_edit(text, KINDS)
    if kind in WHOLE:
        whole = WHOLE[kind]
        return Change(text, lambda world, share: whole(world, rest) if share > 0 else world)
    if kind in _ENDS:
        return _gradual(text, kind, rest)
    return Change(text, lambda world, share: world.edited(text) if share > 0 else world)


def changed(world: World, changes: tuple[Change, ...], share: float = 1.0) -> World:
    """The world after a share of all changes, in their order."""
    for change in changes:
        world = change.at(world, share)
    return world


def depends_on_robot(text: str) -> bool:
    """Whether the edit's world is another one for each robot that is asked about."""
    return text.partition(":")[0] in OF_ROBOT


def _gradual(text: str, kind: str, rest: str) -> Change:
    """A change whose numbers go from what they are to what is asked."""
    name, _, value = rest.partition("=") if kind != "base" else ("", "", rest)
    ends = _ENDS[kind]

    def numbers(world: World, share: float) -> np.ndarray:
        start, end = ends(world, name, value)
        return (1 - share) * start + share * end  # with all of it, to the last bit what was asked

    def at(world: World, share: float) -> World:
        values = ",".join(repr(float(each)) for each in numbers(world, share))
        if kind == "base":
            base = parse_base(values)
            return world.under(base=base)
        if kind == "handle":
            return _handle_moved(world, name, numbers(world, share))
        return world.edited(f"{kind}:{name}={values}")

    def amount(world: World, share: float) -> str:
        values = ",".join(f"{each:.4g}" for each in numbers(world, share))
        return f"{kind}:{name}={values}" if name else f"{kind}:{values}"

    return Change(text, at, amount)


def _move_ends(world: World, name: str, value: str) -> tuple[np.ndarray, np.ndarray]:
    """Position of the named joint as it is, and as asked; of a container that of the joint that is set."""
    twin = world.service.twin
    after = parse_state(twin, [f"{name}={value}"])
    joint = named_joints(twin).get(name.strip())
    if joint is None:
        raise InputError(f"move:{name}={value} moves several", allowed="a joint or container")
    if after[joint] == twin.state[joint]:
        raise InputError(f"move:{name}={value} changes nothing", allowed="another position")
    return np.array([twin.state[joint]]), np.array([after[joint]])


def _set_ends(world: World, name: str, value: str) -> tuple[np.ndarray, np.ndarray]:
    joint_name, _, what = name.rpartition(".")
    twin = world.service.twin
    (end,) = numbers_of(value, (1,), f"set:{name}={value}", math.inf)
    joint = _joint_at(twin, joint_called(twin, joint_name))
    limits = {
        "lowerLimit": joint.limits.lower,
        "upperLimit": joint.limits.upper,
        "velocityLimit": joint.limits.velocity,
        "accelerationLimit": joint.limits.acceleration,
        "effortLimit": joint.limits.effort,
        "softLimitGain": joint.limits.gain,
    }
    if what not in limits:
        raise UnknownEntityError("limit of a joint", what, limits)
    now = limits[what]
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
    return np.zeros(3), np.array(numbers_of(value, (3,), f"handle:{name}={value}"))


def _furniture_ends(world: World, name: str, value: str) -> tuple[np.ndarray, np.ndarray]:
    del world, name
    end = np.array(numbers_of(value, (2, 3, 4), f"furniture: {value}"))
    return np.zeros(len(end)), end


_ENDS: Final = {
    "move": _move_ends,
    "set": _set_ends,
    "base": _base_ends,
    "handle": _handle_ends,
    "furniture": _furniture_ends,
}

GRADUAL: Final = tuple(_ENDS)
"""Kinds of which there is something between nothing and all of it."""


def _handle_moved(world: World, name: str, by: np.ndarray) -> World:
    """The frame of the handle's fixed joint is elsewhere."""
    twin = world.service.twin
    container = twin.container(name)
    joint = _carrying(twin, container)
    origin = joint.origin
    x, y, z = np.add(origin.position, by)
    pose = Pose((float(x), float(y), float(z)), origin.orientation)
    iri = joint_iri(twin.name(twin.environment), joint.name)
    return world.with_twin(posed(twin, iri, pose).applied(twin))


def _carrying(twin: Twin, container: Container) -> Joint:
    """The joint by which a container's handle hangs on it."""
    handle = local_name(container.handle)
    joints = [each for each in twin.mechanism(twin.environment).joints if each.child == handle]
    if not joints or container.handle == container.iri:
        raise InputError(
            f"the handle of {container.name} is no body of its own", allowed="a handle on a joint"
        )
    return joints[0]


def _joint_at(twin: Twin, iri: Iri) -> Joint:
    """A joint of the kitchen or of a robot."""
    (joint,) = (
        each
        for model in (twin.environment, *twin.robots)
        for each in twin.mechanism(model).joints
        if joint_iri(twin.name(model), each.name) == iri
    )
    return joint
