"""A container's motion that was asked for: whether it can be certified at all, and is what a robot does."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from predicates.case import Evidence, Quantity
from sdt_kg.errors import MotionError, UnknownEntityError
from sdt_kg.iri import local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Container
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.limits import joint_limits, kitchen_keeps, position_limits
from services.embodiment.certify.motion import rests, start, whole_motion
from services.embodiment.certify.sweep.kinematics import farther, unit_of
from services.embodiment.certify.sweep.pieces import Pieces, hermite, positions
from services.embodiment.certify.tolerances import Tolerances
from services.physics.chain import of_joint
from services.physics.model import Scene
from services.physics.replay import START_TOLERANCE, check_samples, spline_of, velocities_of

Array = NDArray[np.float64]

SHARES = np.linspace(0.3, 0.7, 9)  # [1] of the way to the farthest value: one of them is passed at some speed
OFF = "off the motion asked for"
"""Name of the figure that says how far a certified motion is from it."""

AS_PHYSICS = {
    "start_position": START_TOLERANCE["m"],
    "start_angle": START_TOLERANCE["rad"],
}
HALVINGS = 60  # until a time is known to the last bit
ROUNDING = 1e-12  # [1, and rad or m] more than a product and a sum of these are rounded


def refused_at_once(scene: Scene, container: Container, motion: Motion, tolerances: Tolerances) -> Findings:
    """Why the certifier refuses whatever moves the container so, if it does: limits, its start, its ends.

    Args:
        scene: Kitchen and robot; the robot stands, wherever.
        container: What the motion is of.
        motion: Values of the container's joint. If it need not keep its times, a robot begins where the
            kitchen is, and slower is no less: what counts is the way, as Φ takes it.
        tolerances: Of the certifier.
    """
    if not motion.timed and _is_way(scene, container, motion):
        return Findings()
    times, values, velocities = motion.times, motion.values, velocities_of(motion)
    none, still = np.zeros((len(times), 0)), np.zeros((len(times), 3))
    moved = (motion.of,), values, velocities
    stands = BodyMotion(scene.robot_iri, "", (), times, still, none, none, still, *moved)
    kept = tolerances if motion.timed else replace(tolerances, **AS_PHYSICS)
    pieces, findings = whole_motion(scene, stands, kept)
    findings.add(start(scene, pieces, None, kept))
    if motion.timed:
        findings.add(rests(scene, pieces, kept))
        findings.add(joint_limits(scene, pieces, container, kept))
    else:
        findings.add(position_limits(scene, pieces, container, kept))
    findings.add(kitchen_keeps(scene, pieces, container, kept))
    return findings


def _is_way(scene: Scene, container: Container, motion: Motion) -> bool:
    """Whether the motion goes from where the kitchen is to somewhere, between the container's stops."""
    k, (_, values) = scene.coordinate[motion.of], spline_of(motion).position()
    begins = abs(values[0] - scene.q((0.0, 0.0, 0.0), {})[k]) <= min(START_TOLERANCE.values())
    inside = container.lower <= values.min() and values.max() <= container.upper
    return begins and inside and float(np.ptp(values)) > START_TOLERANCE["rad"]


def to_keep(scene: Scene, motion: Motion | None, body: BodyMotion) -> Motion | None:
    """The motion that the body motion has to keep; none if that carries it itself, by whichever joint."""
    if motion is None or motion.is_poses or motion.velocities is None or motion.of not in scene.coordinate:
        return motion
    joints = [*body.kitchen_joints]
    for joint in [motion.of] if motion.of in joints else joints:
        column = [joints.index(joint)]
        values, velocities = body.kitchen_q[:, column], body.kitchen_v[:, column]
        told = of_joint(scene, motion.of, Motion(joint, body.times, values, velocities=velocities))
        if told is not None and all(
            _same(getattr(motion, name), getattr(told, name)) for name in ("times", "values", "velocities")
        ):
            return None
    return motion


def _same(one: Array, other: Array) -> bool:
    """Whether two arrays differ by no more than converting a joint's values to another's rounds."""
    return one.shape == other.shape and np.allclose(one, other, rtol=ROUNDING, atol=ROUNDING)


def keeps(scene: Scene, pieces: Pieces, motion: Motion, tolerances: Tolerances) -> Findings:
    """From some time on the container is where the motion has it, all the time; before and after, it rests.

    Of a motion that need not keep its times the way is kept: where it begins, turns back and ends.

    Args:
        scene: Of the body motion.
        pieces: Of the body motion, all coordinates.
        motion: Values of a joint of the kitchen, to be kept, with their times where these are required.
        tolerances: `coupling` is how far off the joint may be, and each container that moves with it.

    Raises:
        MotionError: What is to be kept is no motion, or is one of poses.
        UnknownEntityError: There is no such joint that moves.
    """
    check_samples(motion)
    if motion.is_poses:
        raise MotionError("a motion to be kept is given as poses", allowed="values of a joint")
    if motion.of not in scene.coordinate:
        raise UnknownEntityError("joint", local_name(motion.of), map(local_name, scene.coordinate))
    k = scene.coordinate[motion.of]
    unit, most = unit_of(scene, k), tolerances.coupling / farther(scene, k)
    wanted, found = hermite(motion.times, motion.values, velocities_of(motion)), pieces.columns(np.array([k]))
    if motion.timed:
        off, time = _apart(Pieces(wanted.start + _lag(wanted, found), wanted.duration, wanted.c), found)
    else:
        off, time = _astray(_way(wanted, most), _way(found, most)), None
    if off <= most:
        return Findings(figures={OFF: (off, unit)})
    reason = f"{local_name(motion.of)} is up to {off:.4g} {unit} off the motion that was asked for"
    evidence = Evidence(Quantity.POSITION, off, most, unit, motion.of, time=time)
    return Findings([Violation("motion asked for", reason, evidence, off)])


def _way(pieces: Pieces, least: float) -> list[float]:
    """Where one coordinate begins, turns back by more than `least`, and ends, or nearly so."""
    values, s = (each[:, :, 0] for each in positions(pieces))
    turns = [float(values[0, 0])]
    for value in np.take_along_axis(values, np.argsort(s, axis=0, kind="stable"), axis=0).T.ravel().tolist():
        if len(turns) > 1 and (value - turns[-1]) * (turns[-1] - turns[-2]) >= 0:
            turns[-1] = value
        elif abs(value - turns[-1]) > least:
            turns.append(value)
    return turns


def _astray(one: list[float], other: list[float]) -> float:
    """How far two ways are apart at most where they turn; what has ended stays there."""
    count = max(len(one), len(other))
    ways = [np.array(way + way[-1:] * (count - len(way))) for way in (one, other)]
    return float(np.abs(ways[0] - ways[1]).max())


def _lag(wanted: Pieces, found: Pieces) -> float:
    """By how much later one motion is at a value than the other [s], none if that never moves.

    The value is one that the first passes quickly, so that the time is sharp; infinite if the other does not
    come there.
    """
    values = positions(wanted)[0]
    begin = float(wanted.c[0, 0, 0])
    way = float(values.ravel()[np.argmax(np.abs(values - begin))]) - begin
    if way == 0:
        return 0.0
    passed = [(share, *_first(wanted, begin + share * way, way)) for share in SHARES]
    share, there, _ = max(passed, key=lambda each: each[2])
    return _first(found, begin + float(share) * way, way)[0] - there


def _first(pieces: Pieces, value: float, way: float) -> tuple[float, float]:
    """When one coordinate comes to a value, from where `way` leads to it, and its speed there."""
    values, s = (each[:, :, 0] for each in positions(pieces))
    beyond = (values - value) * way >= 0
    if not beyond.any():
        return np.inf, 0.0
    n = int(np.argmax(beyond.any(axis=0)))
    order = np.argsort(s[:, n], kind="stable")
    turns, reached = s[order, n], beyond[order, n]
    k = int(np.argmax(reached))
    low, high = turns[max(k - 1, 0)], turns[k]
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        x = pieces.at(np.array([n]), np.array([middle]))[0][0, 0]
        low, high = (low, middle) if (x - value) * way >= 0 else (middle, high)
    return float(pieces.start[n] + high), abs(float(pieces.at(np.array([n]), np.array([high]))[1][0, 0]))


def _apart(one: Pieces, other: Pieces) -> tuple[float, float]:
    """How far a coordinate of two motions, at rest before and after, is apart at most, and about when [s].

    Between two knots of either the difference is a cubic, and within the hull of its Bézier points.
    """
    knots = np.unique(np.concatenate([_knots(one), _knots(other)]))
    if not np.isfinite(knots).all():
        (one_x, _), (x, _) = positions(one), positions(other)  # what one comes to, and the other does not
        return float(max(x.min() - one_x.min(), one_x.max() - x.max())), float(other.start[0])
    h = np.diff(knots)
    (x0, v0, x1, v1), (y0, y_v0, y1, y_v1) = (_at(each, knots) for each in (one, other))
    points = np.abs([x0 - y0, x0 - y0 + h / 3 * (v0 - y_v0), x1 - y1 - h / 3 * (v1 - y_v1), x1 - y1])
    n = int(np.argmax(points.max(axis=0)))
    return float(points.max()), float(knots[n])


def _knots(pieces: Pieces) -> Array:
    return np.append(pieces.start, pieces.start[-1] + pieces.duration[-1])


def _at(pieces: Pieces, knots: Array) -> tuple[Array, Array, Array, Array]:
    """Position and velocity at both ends of the intervals between knots, as their cubics have them."""
    end, middle = pieces.start[-1] + pieces.duration[-1], (knots[1:] + knots[:-1]) / 2
    n = np.clip(np.searchsorted(pieces.start, middle, side="right") - 1, 0, len(pieces.start) - 1)
    moves = (middle > pieces.start[0]) & (middle < end)
    found: list[Array] = []
    for at in (knots[:-1], knots[1:]):
        x, v, _ = pieces.at(n, np.clip(at - pieces.start[n], 0.0, pieces.duration[n]))
        found += [x[:, 0], np.where(moves, v[:, 0], 0.0)]
    return found[0], found[1], found[2], found[3]
