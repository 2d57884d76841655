"""The gantry's motions checked by other code: closed-form kinematics, boxes by separating axes, many times.

Nothing of the certifier is used: splines are scipy's, placements are written out by hand, and overlap
is decided for boxes by the 15 axes that can separate them. Finite steps, so a motion is called right
only by a wide enough margin.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion

Array = NDArray[np.float64]

# link → boxes: centre and half extents in the link's frame [m], as cell.urdf and gantry.urdf have them.
ROBOT = {
    "base": [((0, 0, 0.1), (0.2, 0.2, 0.1))],
    "lift": [((-0.1, 0, 0), (0.05, 0.05, 0.05))],
    "arm": [((0, 0, 0), (0.05, 0.02, 0.02))],
    "palm": [((0, 0, 0), (0.01, 0.04, 0.06))],
    "up": [((0.04, 0, 0.005), (0.03, 0.01, 0.005))],
    "down": [((0.04, 0, -0.005), (0.03, 0.01, 0.005))],
}
JOINED = {("base", "lift"), ("lift", "arm"), ("arm", "palm"), ("palm", "up"), ("palm", "down")}
CABINET = [((1.5, 0, 0.35), (0.25, 0.3, 0.01)), ((1.5, 0, 0.65), (0.25, 0.3, 0.01))]
FRONT = ((1.26, 0, 0.5), (0.01, 0.2, 0.1))
BAR = [
    ((0, 0, 0), (0.005, 0.1, 0.005)),
    ((0.025, 0.095, 0), (0.02, 0.005, 0.005)),
    ((0.025, -0.095, 0), (0.02, 0.005, 0.005)),
]
HANDLE = np.array((1.205, 0.0, 0.5))
JOINTS = ("lift_joint", "arm_joint", "wrist_joint", "up_joint")
SLOW = 6e-4  # [m] that fingers move between two looks once they are at the handle
FAR = 0.05  # [m] between balls about two boxes: their gap is no smaller
MOVES = 1e-6  # [m] the drawer has begun to move


@dataclass(frozen=True)
class World:
    """What a mutation may change.

    Attributes:
        lower, upper, velocity, acceleration: Of lift, arm, wrist, finger and drawer, shape (5,).
        handle: Shift of the handle [m], shape (3,).
        walls: Boxes that stand still: centre and half extents [m].
        gripper: Which gripper acts.
    """

    drive: Drive = Drive.OMNI
    lower: tuple[float, ...] = (0.0, 0.0, -np.inf, 0.0, 0.0)
    upper: tuple[float, ...] = (0.6, 0.8, np.inf, 0.04, 0.5)
    velocity: tuple[float, ...] = (0.5, 0.5, 2.0, 0.2, 1.0)
    acceleration: tuple[float, ...] = (1.0, 1.0, 4.0, 1.0, 1.0)
    handle: tuple[float, float, float] = (0.0, 0.0, 0.0)
    walls: tuple[tuple[tuple[float, float, float], tuple[float, float, float]], ...] = ()
    gripper: str = "hand"


@dataclass
class Judgement:
    """How far each rule is kept, in parts of what may be uncertain: below -1 wrong, above 1 right."""

    slack: dict[str, float] = field(default_factory=dict)

    def keeps(self, rule: str, slack: float, uncertain: float) -> None:
        self.slack[rule] = min(self.slack.get(rule, np.inf), slack / uncertain)

    @property
    def wrong(self) -> bool:
        return min(self.slack.values()) < -1

    @property
    def right(self) -> bool:
        return min(self.slack.values()) > 1


def judged(world: World, motion: BodyMotion, step: float) -> Judgement:
    """The motion looked at every `step` metres of its fastest point's travel, at most 20 ms apart."""
    found = Judgement()
    order = [motion.joints.index(name) for name in JOINTS]
    q = np.hstack((motion.base, motion.q[:, order], motion.kitchen_q))
    v = np.hstack((motion.base_v, motion.v[:, order], motion.kitchen_v))
    way = CubicHermiteSpline(motion.times, q, v)
    times = _times(motion.times, way, step)
    at, speed, bend = way(times), way(times, 1), _bends(way, motion.times)
    _limits(found, world, at, speed, bend)
    found.keeps("rest", 1e-3 - float(np.abs(v[[0, -1]]).max()), 1e-4)
    found.keeps("start", 1e-3 - float(np.abs(q[0, :6]).max()), 1e-4)
    found.keeps("start", 1e-3 - abs(float(q[0, 7])), 1e-4)
    _drive(found, world, times, at, speed)
    moves = np.flatnonzero(np.abs(CubicHermiteSpline(motion.times, q[:, 7], v[:, 7])(times)) > MOVES)
    if not len(moves):
        found.keeps("moves", -1.0, 0.1)
        return found
    # The grasp is the last sample before the drawer moves.
    grasp = int(np.searchsorted(motion.times, times[moves[0]], side="right") - 1)
    stop = int(np.searchsorted(motion.times, _stops(motion.times, times, at[:, 7])))
    held, before = np.zeros(len(times), dtype=bool), 0
    while True:
        end, onward = _lets_go(way, motion.times, grasp, stop)
        _held(found, world, q[grasp])
        _follows(found, q[grasp], at[(times >= motion.times[grasp]) & (times <= motion.times[end])])
        arrived = _arrived(way, motion.times[before : grasp + 1], first=not before)
        left = _left(way, motion.times[grasp], motion.times[end : onward and onward + 1])
        held |= (times >= arrived) & (times < left)
        if onward is None:
            break
        grasp, before = onward, int(np.searchsorted(motion.times, left)) + 1
    fastest = float(np.abs(np.diff(at, axis=0)).sum(axis=1).max(initial=0))
    _collisions(found, world, at, held, 2e-4 + fastest)
    return found


def _lets_go(way: CubicHermiteSpline, knots: Array, grasp: int, stop: int) -> tuple[int, int | None]:
    """The sample from which on the drawer rests while the tool leaves its grasp, and the last one of that."""
    at, rate = way(knots)[:, 7], way(knots, 1)[:, 7]
    k = grasp + 1
    while k < stop:
        end = k
        while end + 1 < stop and abs(at[end + 1] - at[k]) < 1e-9 and rate[end] == rate[end + 1] == 0:
            end += 1
        slip, turned = _off(way(knots[k : end + 1]), way(knots[grasp]))
        if end > k and ((slip > 0.002) | (turned > np.radians(1.0))).any():
            return k, end
        k = end + 1
    return stop, None


def _stops(knots: Array, times: Array, drawer: Array) -> float:
    """The sample from which on the drawer stays where it is."""
    moving = np.flatnonzero(np.abs(drawer - drawer[-1]) > MOVES)
    return float(knots[np.searchsorted(knots, times[moving[-1]], side="right")] if len(moving) else knots[-1])


def _left(way: CubicHermiteSpline, grasp: float, samples: Array) -> float:
    """The last sample, the drawer at rest, up to which the tool is at its grasp: then fingers keep clear."""
    slip, turned = _off(way(samples), way(grasp))
    away = np.flatnonzero((slip > 0.002) | (turned > np.radians(1.0)))
    return float(samples[max(away[0] - 1, 0)]) if len(away) else np.inf


def _times(knots: Array, way: CubicHermiteSpline, step: float) -> Array:
    """No coordinate's metres (radians times a metre) add up to more than a step in between."""
    coarse = np.union1d(np.arange(knots[0], knots[-1], 0.02), knots)
    travel = np.abs(np.diff(way(coarse), axis=0)).sum(axis=1)
    parts = np.maximum(1, np.ceil(2 * travel / step)).astype(int)
    return np.union1d(
        np.concatenate(
            [np.linspace(a, b, n + 1) for a, b, n in zip(coarse[:-1], coarse[1:], parts, strict=True)]
        ),
        knots,
    )


def _bends(way: CubicHermiteSpline, knots: Array) -> Array:
    """Largest accelerations: at both ends of every piece, from inside."""
    inside = 1e-9 * np.diff(knots)
    return np.abs(np.vstack((way(knots[:-1] + inside, 2), way(knots[1:] - inside, 2))))


def _limits(found: Judgement, world: World, at: Array, speed: Array, bend: Array) -> None:
    lower, upper = np.array(world.lower), np.array(world.upper)
    found.keeps("lower", float((at[:, 3:] - lower).min()) + 1e-5, 3e-6)
    found.keeps("upper", float((upper - at[:, 3:]).min()) + 1e-5, 3e-6)
    rates = ((speed, (0.2, 0.2, 0.2), world.velocity), (bend, (0.4, 0.4, 0.4), world.acceleration))
    for name, (values, base, own) in zip(("velocity", "acceleration"), rates, strict=True):
        most = np.array((*base, *own))
        found.keeps(name, 1.001 - float((np.abs(values) / most).max()), 2e-3)
        combined = np.linalg.norm(values[:, :2], axis=1)
        found.keeps(name, 1.001 - float(combined.max()) / base[0], 2e-3)


def _drive(found: Judgement, world: World, times: Array, at: Array, speed: Array) -> None:
    if world.drive is Drive.FIXED:
        found.keeps("fixed", 1e-6 - float(np.abs(at[:, :3] - at[0, :3]).max()), 1e-6)
    if world.drive is Drive.DIFFERENTIAL:
        sideways = np.abs(-np.sin(at[:, 2]) * speed[:, 0] + np.cos(at[:, 2]) * speed[:, 1])
        found.keeps("sideways", 0.002 - float(sideways.max()), 3e-4)
        found.keeps("drift", 0.01 - float(np.trapezoid(sideways, times)), 2e-3)


def _frames(at: Array) -> dict[str, tuple[Array, Array]]:
    """World rotation and origin of each robot link, shapes (T, 3, 3) and (T, 3)."""
    x, y, yaw, lift, arm, wrist, up, _ = at.T
    zero, one = np.zeros(len(at)), np.ones(len(at))
    turn = np.array(((np.cos(yaw), -np.sin(yaw), zero), (np.sin(yaw), np.cos(yaw), zero), (zero, zero, one)))
    roll = np.array(
        ((one, zero, zero), (zero, np.cos(wrist), -np.sin(wrist)), (zero, np.sin(wrist), np.cos(wrist)))
    )
    base_R, roll_R = np.moveaxis(turn, 2, 0), np.moveaxis(roll, 2, 0)

    def along(origin: Array, rotation: Array, *offset: Array) -> Array:
        return origin + (rotation @ np.stack(offset, axis=1)[:, :, None])[:, :, 0]

    base = np.stack((x, y, zero), axis=1)
    lifted = along(base, base_R, zero, zero, 0.3 + lift)
    reached = along(lifted, base_R, arm, zero, zero)
    palm = along(reached, base_R, 0.1 * one, zero, zero)
    palm_R = base_R @ roll_R
    return {
        "base": (base_R, base),
        "lift": (base_R, lifted),
        "arm": (base_R, reached),
        "palm": (palm_R, palm),
        "up": (palm_R, along(palm, palm_R, 0.01 * one, zero, up)),
        "down": (palm_R, along(palm, palm_R, 0.01 * one, zero, -up)),
    }


def _held(found: Judgement, world: World, grasp: Array) -> None:
    """The bar is between the pads, and they reach over it; for a hand that is nearly straight."""
    if world.gripper != "hand":
        found.keeps("held", -1.0, 0.1)
        return
    frames = _frames(grasp[None])
    palm_R, palm = frames["palm"][0][0], frames["palm"][1][0]
    corners = np.array(
        [(sx * 0.005, sy * 0.1, sz * 0.005) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    )
    pulled = HANDLE + np.array(world.handle) - np.array((grasp[7], 0.0, 0.0))
    bar = (corners + pulled - palm) @ palm_R  # in the palm's frame
    # Only what is between the pads counts: |y| of the palm below 10 mm.
    middle = bar.mean(axis=0)
    tilt = 0.01 * abs(palm_R[2, 1]) + 0.1 * abs(palm_R[1, 0]) + 0.1 * abs(palm_R[2, 0])
    up, half = float(grasp[6]), 0.005
    for gap in (up - (middle[2] + half), up + (middle[2] - half)):
        found.keeps("contact", 0.002 - gap, 2e-4 + tilt)
        found.keeps("depth", 0.002 + gap, 2e-4 + tilt)
    # Pads reach from 20 to 80 mm before the palm's origin, ±10 mm to its sides; the bar is ±100 mm long.
    for reach in (0.08 - middle[0] + half, middle[0] + half - 0.02, 0.11 - abs(middle[1])):
        found.keeps("over", reach - 0.003, 5e-4 + tilt)


def _off(rows: Array, grasp: Array) -> tuple[Array, Array]:
    """How far the tool is from its place on the handle at the grasp, and how much it has turned."""
    both = np.vstack((grasp, rows))
    palm_R, palm = _frames(both)["palm"]
    tool = palm + palm_R @ np.array((0.07, 0.0, 0.0))
    relative = tool + np.column_stack((both[:, 7], np.zeros((len(both), 2))))
    turned = np.linalg.norm(palm_R - palm_R[0], axis=(1, 2)) / np.sqrt(2)
    return np.linalg.norm(relative - relative[0], axis=1)[1:], turned[1:]


def _arrived(way: CubicHermiteSpline, samples: Array, *, first: bool) -> float:
    """The sample from which on the tool is at its grasp: the fingers may touch."""
    slip, turned = _off(way(samples), way(samples[-1]))
    away = np.flatnonzero((slip > 0.002) | (turned > np.radians(1.0)))
    return float(samples[away[-1] + 1 if len(away) else 0 if first else -1])


def _follows(found: Judgement, grasp: Array, later: Array) -> None:
    """The tool keeps its place on the handle, and the fingers theirs on the tool."""
    slip, turned = _off(later, grasp)
    found.keeps("slip", 0.002 - float(slip.max()), 3e-4)
    found.keeps("turn", 2 * np.sin(np.radians(1.0) / 2) - float(turned.max()), 5e-4)
    found.keeps("fingers", 0.002 - float(np.abs(later[:, 6] - grasp[6]).max()), 2e-4)


def _collisions(found: Judgement, world: World, at: Array, held: NDArray[np.bool_], uncertain: float) -> None:
    frames = _frames(at)
    shift = np.column_stack((-at[:, 7], np.zeros((len(at), 2))))
    handle = shift + HANDLE + np.array(world.handle)
    still = np.zeros_like(shift)
    kitchen = [(centre, half, still, False) for centre, half in (*CABINET, *world.walls)]
    kitchen.append((*FRONT, shift, False))
    kitchen += [(centre, half, handle, True) for centre, half in BAR]
    parts = [(name, np.array(c), np.array(h)) for name, boxes in ROBOT.items() for c, h in boxes]
    eye = np.tile(np.eye(3), (len(at), 1, 1))
    for name, centre, half in parts:
        rotation, origin = frames[name]
        place = origin + rotation @ centre
        for other_centre, other_half, moved, is_bar in kitchen:
            gap = separation(rotation, place, half, eye, moved + np.array(other_centre), np.array(other_half))
            if is_bar and name in {"up", "down"}:
                found.keeps("finger", float(gap[~held].min(initial=np.inf)), uncertain)
                found.keeps("finger", float(gap[held].min(initial=np.inf)) + 0.002, SLOW)
            else:
                found.keeps("environment", float(gap.min()), uncertain)
        if name not in {"base"}:
            low = place[:, 2] - (np.abs(rotation[:, 2]) @ half)
            found.keeps("floor", float(low.min()), uncertain)
    for i, (one, centre, half) in enumerate(parts):
        for other, other_centre, other_half in parts[i + 1 :]:
            if (one, other) not in JOINED:
                (one_R, one_p), (other_R, other_p) = frames[one], frames[other]
                gap = separation(
                    one_R, one_p + one_R @ centre, half, other_R, other_p + other_R @ other_centre, other_half
                )
                found.keeps("self", float(gap.min()), uncertain)


def separation(  # noqa: PLR0917
    one_R: Array, one_p: Array, one: Array, other_R: Array, other_p: Array, other: Array
) -> Array:
    """Largest gap of two boxes along an axis that can separate them, shape (T,): negative is depth."""
    balls = np.linalg.norm(other_p - one_p, axis=1) - np.linalg.norm(one) - np.linalg.norm(other)
    if balls.min() > FAR:
        return balls
    between = (other_p - one_p)[:, None]
    crossed = np.cross(one_R.swapaxes(1, 2)[:, :, None], other_R.swapaxes(1, 2)[:, None]).reshape(-1, 9, 3)
    axes = np.concatenate((one_R.swapaxes(1, 2), other_R.swapaxes(1, 2), crossed), axis=1)
    length = np.linalg.norm(axes, axis=2)
    axes = axes / np.where(length > 1e-6, length, 1.0)[:, :, None]
    reach = np.abs(axes @ one_R) @ one + np.abs(axes @ other_R) @ other
    gaps = np.abs((axes * between).sum(axis=2)) - reach
    return np.where(length > 1e-6, gaps, -np.inf).max(axis=1)
