"""Body motions judged by code that shares nothing with what made and certified them.

The files are read again (`machine`), splines are scipy's, distances coal's: of primitives as they are, of
meshes by their triangles, not by hulls. How deep a mesh is, `depths` tells. Looked at wherever something has
moved by `step`, from look to look as far as the last distance allows.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

from tests.services.embodiment.dense import Judgement
from tests.soak.annotated import Note
from tests.soak.audit_holds import held
from tests.soak.machine import Machine, Solid, gap

Array = NDArray[np.float64]
Looks = NDArray[np.intp]

CLOSED, OPEN = 0.01, 0.9  # [rad or m] beyond the lower limit, and share of the upper one
NEAR = 0.02  # [m] pairs whose boxes stay farther apart are not looked at
SAMPLED = 32  # looks at rates between two samples


@dataclass(frozen=True)
class Stage:
    """What a motion is judged against.

    Attributes:
        accelerations: Of the kitchen's joints; 1 where none is given.
        state: Kitchen joint → position at the start, where it is not at rest.
        joint, handle: Of the container.
        goal: `open` or `close`.
        start: Base pose that was demanded; None: any.
    """

    kitchen: Machine
    robot: Machine
    note: Note
    accelerations: Mapping[str, float]
    state: Mapping[str, float]
    joint: str
    handle: str
    goal: str
    drive: str
    start: tuple[float, float, float] | None = None


class Way:
    """A motion with placements of everything at many times."""

    def __init__(self, stage: Stage, motion: Mapping[str, Array], step: float) -> None:
        self.stage, self.knots = stage, motion["times"]
        self.joints = [str(name) for name in motion["robot_joint_names"]]
        self.kitchen_joints = [str(name) for name in motion["kitchen_joint_names"]]
        self.names = ["x", "y", "yaw", *self.joints, *self.kitchen_joints]
        parts = ("base", "robot", "kitchen")
        self.q = np.hstack([motion[f"{each}_positions" if each != "base" else each] for each in parts])
        self.v = np.hstack([motion[f"{each}_velocities"] for each in parts])
        self.spline = CubicHermiteSpline(self.knots, self.q, self.v)
        named = str(motion["gripper"])
        self.hands = {name: one for name, one in stage.note.grippers.items() if named in {"", name}}
        self.robot, self.kitchen = [*stage.robot.solids], [*stage.kitchen.solids]
        self.times = self._fine(step)
        self.frames, self.rooms = self.placed(self.times)

    @property
    def hand(self) -> tuple[str, Array, set[str]]:
        """Of the one hand that may hold: the tool's link, link_T_tool, and the links of the fingers."""
        (one,) = self.hands.values()
        return one

    def placed(self, times: Array) -> tuple[dict[str, Array], dict[str, Array]]:
        """world_T_link of the robot's links, and of the kitchen's."""
        stage, at = self.stage, self.spline(times)
        robot: dict[str, Array | float] = {**stage.robot.rests(), **stage.note.parked}
        kitchen: dict[str, Array | float] = {**stage.kitchen.rests(), **stage.state}
        robot |= {name: at[:, 3 + k] for k, name in enumerate(self.joints)}
        kitchen |= {name: at[:, 3 + len(self.joints) + k] for k, name in enumerate(self.kitchen_joints)}
        base = np.tile(np.eye(4), (len(times), 1, 1))
        base[:, :3, :3] = Rotation.from_rotvec(at[:, 2, None] * (0, 0, 1)).as_matrix()
        base[:, :2, 3], base[:, 2, 3] = at[:, :2], stage.note.height
        tools = {tool for tool, _, _ in self.hands.values()}
        links = {solid.link for solid in self.robot} | tools | {stage.note.base_body}
        frames = stage.robot.place(robot, links)
        world_T_root = base @ np.linalg.inv(frames[stage.note.base_body])
        rooms = stage.kitchen.place(kitchen, {solid.link for solid in self.kitchen} | {stage.handle})
        shape = (len(times), 4, 4)
        return (
            {link: world_T_root @ frame for link, frame in frames.items()},
            {link: np.broadcast_to(frame, shape) for link, frame in rooms.items()},
        )

    def container(self) -> Array:
        """Position of the container's joint at all times."""
        at, joint = self.spline(self.times), self.stage.joint
        if joint in self.names:
            return at[:, self.names.index(joint)]
        source, ratio, offset = self.stage.kitchen.mimicked()[joint]
        return ratio * at[:, self.names.index(source)] + offset

    def _fine(self, step: float) -> Array:
        frames, _ = self.placed(self.knots)
        ends = [corners(solid, frames[solid.link]) for solid in self.robot]
        travel = np.max([np.linalg.norm(np.diff(end, axis=0), axis=2).max(axis=1) for end in ends], axis=0)
        parts = np.maximum(1, np.ceil(1.3 * travel / step)).astype(int)  # curves are longer than chords
        between = zip(self.knots[:-1], self.knots[1:], parts, strict=True)
        return np.concatenate(
            [*(np.linspace(a, b, n, endpoint=False) for a, b, n in between), self.knots[-1:]]
        )


def corners(solid: Solid, frames: Array) -> Array:
    """Of the box about a solid, in the world, shape (T, 8, 3)."""
    return np.einsum("tij,kj->tki", frames[:, :3, :3], solid.corners) + frames[:, None, :3, 3]


def audited(stage: Stage, motion: Mapping[str, Array], step: float) -> Judgement:
    """Every rule of a certificate, and whether the request is met at the end."""
    found, way = Judgement(), Way(stage, motion, step)
    _limits(found, way)
    _ends(found, way)
    _drives(found, way)
    may = held(found, way)
    for rule, distance in _distances(way, may):
        found.keeps(rule, distance - stage.note.overhang, step / 2 + 2e-4)
    return found


def _limits(found: Judgement, way: Way) -> None:
    stage, spline, knots = way.stage, way.spline, way.knots
    share = np.linspace(0, 1, SAMPLED + 1)
    times = np.unique(knots[:-1, None] + np.diff(knots)[:, None] * share)
    at, speed = spline(times), np.abs(spline(times, 1))
    inside = 1e-9 * np.diff(knots)
    bend = np.abs(np.vstack((spline(knots[:-1] + inside, 2), spline(knots[1:] - inside, 2))))
    plane, turn = stage.note.base[::2], stage.note.base[1::2]
    for k, name in enumerate(way.names):
        if k < 3:
            lower, upper, (velocity, most) = -np.inf, np.inf, plane if k < 2 else turn
        else:
            of_robot = k < 3 + len(way.joints)
            lower, upper, velocity = (stage.robot if of_robot else stage.kitchen).limits(name)
            known = stage.note.accelerations if of_robot else stage.accelerations
            most = known.get(name, np.inf if of_robot else 1.0)
        found.keeps("limits", float(min(at[:, k].min() - lower, upper - at[:, k].max())) + 1e-5, 3e-6)
        found.keeps("velocity", 1.001 - float(speed[:, k].max()) / velocity, 2e-3)
        found.keeps("acceleration", 1.001 - float(bend[:, k].max()) / most, 2e-3)
    for rates, most in zip((speed, bend), plane, strict=True):
        found.keeps("base", 1.001 - float(np.linalg.norm(rates[:, :2], axis=1).max()) / most, 2e-3)


def _ends(found: Judgement, way: Way) -> None:
    """At rest at both ends, parked at first, the goal met at last, and nothing else of the kitchen moved."""
    stage, container = way.stage, way.container()
    found.keeps("rest", 1e-3 - float(np.abs(way.v[[0, -1]]).max()), 1e-4)
    parked = {**stage.robot.rests(), **stage.note.parked}
    first = np.array([way.q[0, 3 + k] - parked[name] for k, name in enumerate(way.joints)])
    found.keeps("start", 1e-3 - float(np.abs(first).max()), 1e-4)
    if stage.start is not None:
        found.keeps("start", 1e-3 - float(np.abs(way.q[0, :3] - stage.start).max()), 1e-4)
    lower, upper, _ = stage.kitchen.limits(stage.joint)
    if stage.joint in (mimicked := stage.kitchen.mimicked()):
        source, ratio, offset = mimicked[stage.joint]
        upper = min(upper, ratio * stage.kitchen.limits(source)[1] + offset)
    last = float(container[-1])
    found.keeps("goal", last - OPEN * upper if stage.goal == "open" else lower + CLOSED - last, 1e-9)
    moved = np.ptp(way.spline(way.times), axis=0)
    own = {stage.joint, mimicked.get(stage.joint, (stage.joint,))[0]}
    for k, name in enumerate(way.names[3 + len(way.joints) :], 3 + len(way.joints)):
        rest = stage.state.get(name, stage.kitchen.rests()[name])
        found.keeps("start", 1e-3 - abs(float(way.q[0, k]) - rest), 1e-4)
        if name not in own and mimicked.get(name, (name,))[0] not in own:
            found.keeps("others", 1e-5 - float(moved[k]), 3e-6)


def _drives(found: Judgement, way: Way) -> None:
    at, speed = way.spline(way.times), way.spline(way.times, 1)
    if way.stage.drive == "fixed":
        found.keeps("fixed", 1e-6 - float(np.abs(at[:, :3] - at[0, :3]).max()), 9e-7)
    if way.stage.drive == "differential":
        sideways = np.abs(-np.sin(at[:, 2]) * speed[:, 0] + np.cos(at[:, 2]) * speed[:, 1])
        found.keeps("sideways", 0.002 - float(sideways.max()), 3e-4)
        found.keeps("drift", 0.01 - float(np.trapezoid(sideways, way.times)), 2e-3)


def _distances(way: Way, may: Mapping[str, NDArray[np.bool_]]) -> Iterator[tuple[str, float]]:
    """Least distance of each pair that has to keep one, where it is less than `NEAR`."""
    holder = {finger: name for name, (_, _, fingers) in way.hands.items() for finger in fingers}
    stage, every = way.stage, np.ones(len(way.times), dtype=bool)
    boxes = [_box(corners(one, way.frames[one.link])) for one in way.robot]
    rooms = [_box(corners(one, way.rooms[one.link])) for one in way.kitchen]
    for one, box in zip(way.robot, boxes, strict=True):
        for other, room in zip(way.kitchen, rooms, strict=True):
            holds = one.link in holder and other.link == stage.handle
            looks = _near(box, room, ~may[holder[one.link]] if holds else every)
            yield "environment", _least(one, way.frames[one.link], other, way.rooms[other.link], looks)
    for i, (one, box) in enumerate(zip(way.robot, boxes, strict=True)):
        for other, room in zip(way.robot[i + 1 :], boxes[i + 1 :], strict=True):
            pair = frozenset((one.link, other.link))
            if len(pair) == 2 and pair not in stage.note.touching and not stage.robot.joined(*pair):
                looks = _near(box, room, every)
                yield "self", _least(one, way.frames[one.link], other, way.frames[other.link], looks)


def _box(ends: Array) -> tuple[Array, Array, Array, Array]:
    """Lower and upper ends at all times, and over all times."""
    low, high = ends.min(axis=1), ends.max(axis=1)
    return low, high, low.min(axis=0), high.max(axis=0)


def _near(one: tuple[Array, ...], other: tuple[Array, ...], asked: NDArray[np.bool_]) -> Looks:
    """Looks that are asked for at which two boxes are nearer than `NEAR` along each axis."""
    if (one[2] > other[3] + NEAR).any() or (other[2] > one[3] + NEAR).any():
        return np.zeros(0, dtype=np.intp)
    apart = np.maximum(one[0] - other[1], other[0] - one[1])
    return np.flatnonzero((apart < NEAR).all(axis=1) & asked)


def _least(one: Solid, frames: Array, other: Solid, rooms: Array, looks: Looks) -> float:
    """Least distance over these looks; those are left out that nothing can have come nearer in."""
    if not len(looks):
        return NEAR
    seen = np.linalg.inv(rooms) @ frames
    step = np.linalg.norm(np.diff(corners(one, seen), axis=0), axis=2).max(axis=1)
    travelled = np.concatenate(([0.0], np.cumsum(step))) * 1.01
    least, k = NEAR, 0
    while k < len(looks):
        at = int(looks[k])
        distance = gap(one, frames[at], other, rooms[at])
        least = min(least, distance)
        ahead = np.searchsorted(travelled, travelled[at] + max(distance, 0.0), side="right")
        k = max(k + 1, int(np.searchsorted(looks, ahead)))
    return least
