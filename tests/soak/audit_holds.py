"""How a handle is held along a motion, by one hand or by several in turn: a part of `audit`."""

from collections.abc import Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tests.services.embodiment.dense import Judgement
from tests.soak.machine import Machine, Solid, gap

Array = NDArray[np.float64]
May = dict[str, NDArray[np.bool_]]

MOVES = 1e-6  # [rad or m] the container has begun to move
SOME = 4  # looks at how deep fingers are in a handle, while they hold it


class Staged(Protocol):
    """Who moves what."""

    @property
    def robot(self) -> Machine: ...
    @property
    def handle(self) -> str: ...


class Placed(Protocol):
    """Everything at many times.

    Attributes:
        hands: Of those that may hold: the tool's link, link_T_tool, and the links of the fingers.
        frames, rooms: world_T_link of robot and kitchen, shape (T, 4, 4) each.
    """

    hands: dict[str, tuple[str, Array, set[str]]]
    times: Array
    frames: dict[str, Array]
    rooms: dict[str, Array]
    robot: list[Solid]
    kitchen: list[Solid]

    @property
    def stage(self) -> Staged: ...
    def container(self) -> Array:
        """Position of the container's joint at all times."""
        ...


def held(found: Judgement, way: Placed) -> May:
    """The tool keeps its place on the handle while the container moves; at which looks hands may touch it.

    Where the container rests on the way, the tool may go, and take another place before it moves on, or the
    tool of another hand may, once it has gone.
    """
    value = way.container()
    may = {name: np.zeros(len(way.times), dtype=bool) for name in way.hands}
    moving = np.flatnonzero(np.abs(value - value[0]) > MOVES)
    if not len(moving):
        found.keeps("moves", -1.0, 0.1)
        return may
    begin, last, before = max(int(moving[0]) - 1, 0), _stops(value), 0
    while True:
        name = min(way.hands, key=lambda one: sorted(_touch(way, one, begin))[1])
        slip, turn = _off(way, name, begin)
        away = (slip > 0.002) | (turn > np.radians(1.0))
        rest = next((one for one in _rests(value, begin, last) if away[one].any()), None)
        end = last if rest is None else rest.start
        found.keeps("slip", 0.002 - float(slip[begin : end + 1].max()), 3e-4)
        found.keeps("turn", np.radians(1.0) - float(turn[begin : end + 1].max()), 5e-4)
        touches = [_touch(way, name, look) for look in np.linspace(begin, end, SOME).astype(int)]
        found.keeps("contact", 0.002 - sorted(touches[0])[1], 2e-4)
        found.keeps("depth", 0.002 + min(map(min, touches)), 1e-3)
        come = np.flatnonzero(away[before:begin])
        gone = np.flatnonzero(away[end:])
        until = end + int(gone[0]) if len(gone) else len(value)
        may[name][before + int(come[-1]) + 1 if len(come) else before : until] = True
        if rest is None:
            return may
        begin, before = rest.stop - 1, until


def _off(way: Placed, name: str, begin: int) -> tuple[Array, Array]:
    """How far a hand's tool is [m] and is turned [rad] from where it was on the handle, at all times."""
    link, link_T_tool, _ = way.hands[name]
    tool = np.linalg.inv(way.rooms[way.stage.handle]) @ way.frames[link] @ link_T_tool
    slip = np.linalg.norm(tool[:, :3, 3] - tool[begin, :3, 3], axis=1)
    return slip, Rotation.from_matrix(tool[begin, :3, :3].T @ tool[:, :3, :3]).magnitude()


def _stops(value: Array) -> int:
    """The last look before which the container moves."""
    away = np.flatnonzero(np.abs(value - value[-1]) > MOVES)
    return min(int(away[-1]) + 1, len(value) - 1) if len(away) else len(value) - 1


def _rests(value: Array, begin: int, last: int) -> Iterator[slice]:
    """Looks in a row at which the container is at one value, before the last."""
    at = begin + 1
    while at < last:
        stop = at + 1
        while stop < last and abs(value[stop] - value[at]) < 1e-9:
            stop += 1
        if stop - at > 2:
            yield slice(at, stop)
        at = stop


def _touch(way: Placed, name: str, look: int) -> list[float]:
    """How far fingers, one for each link with which they begin, are from the handle; negative is deep."""
    touch: dict[str, float] = {}
    _, _, fingers = way.hands[name]
    for finger in (one for one in way.robot if one.link in fingers):
        first = _first(way, fingers, finger.link)
        for bar in (one for one in way.kitchen if one.link == way.stage.handle):
            distance = gap(finger, way.frames[finger.link][look], bar, way.rooms[bar.link][look])
            touch[first] = min(touch.get(first, np.inf), distance)
    return [*touch.values()]


def _first(way: Placed, fingers: set[str], finger: str) -> str:
    """The first of the fingers' links on the way to this one from the palm."""
    machine, first = way.stage.robot, finger
    while finger in machine.parent:
        finger = machine.urdf.ends(machine.parent[finger])[0]
        first = finger if finger in fingers else first
    return first
