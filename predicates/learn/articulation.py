"""Which joint moves an observed point: fixed, prismatic or revolute, by evidence."""

import math
from dataclasses import dataclass

import numpy as np

from predicates.learn.fitting.cells import Cells, cells_of
from predicates.learn.fitting.curve import Curves, Frame
from predicates.learn.fitting.fit import ARC, LINE, Fit, Problem, fit
from predicates.learn.fitting.priors import (
    SCALE,
    SCALE_WEIGHT,
    TURN_SCALE,
    Gravity,
    Plumb,
    log_scale_density,
    log_travel_density,
)
from predicates.learn.fitting.starts import Start, starts
from predicates.learn.fitting.student import FREEDOM, log_student
from predicates.learn.fitting.turning import Turning, turning_of, turns_of
from predicates.learn.fitting.vectors import cross
from predicates.learn.track import Array, Track, checked
from sdt_kg.mechanism import JointType

UP: Array = np.array([0.0, 0.0, 1.0])
"""Up in a ROS frame (REP 103)."""

OUTLIER = 5.0
"""[1] Scales from the path beyond which a sample counts as an outlier and bounds no limit."""

LEAST_SLANT = 0.1
"""[1] Sine of the angle between a path and gravity below which gravity says nothing of the path's plane."""

SMOOTHING = 7
"""[1] Samples whose median bounds a limit, so that noise does not widen it."""

ROUNDS = 30
"""[1] Rounds of reweighting of a point that stands still."""


@dataclass(frozen=True, slots=True, eq=False)
class Articulation:
    """One joint that would explain a track. Vectors are in the track's frame.

    Attributes:
        joint_type: FIXED, PRISMATIC or REVOLUTE.
        axis: Unit vector, shape (3,): positive motion leads away from the first samples; zeros if fixed.
        origin: Revolute: centre of the point's circle; prismatic and fixed: where the point is at 0 [m].
        radius: Of the circle [m]; 0 unless revolute.
        positions: Shape (T,): joint position of each sample [rad or m], 0 at the first samples.
        limits: Smallest and largest position observed, outliers left out [rad or m].
        distances: Shape (T,): distance of each sample from the path [m].
        scale: Sigma of the deviations, robust [m].
        outliers: How many samples are farther than five scales from the path.
        deviations: Name → standard deviation: axis [rad], origin [m], radius [m], limits [rad or m].
        evidence: Log evidence, comparable among the candidates of one track.
        plumb: How the axis was taken to lie.
        curve: The path; None if fixed.
    """

    joint_type: JointType
    axis: Array
    origin: Array
    radius: float
    positions: Array
    limits: tuple[float, float]
    distances: Array
    scale: float
    outliers: int
    deviations: dict[str, float]
    evidence: float
    plumb: Plumb
    curve: Curves | None

    @property
    def residual_rms(self) -> float:
        """Root mean square distance of all samples from the path [m], outliers included."""
        return float(np.sqrt(np.mean(self.distances**2)))

    def distance(self, points: Array) -> Array:
        """Distance of points (N, 3) from the path, shape (N,) [m]."""
        if self.curve is None:
            return np.linalg.norm(points - self.origin, axis=1)
        return np.linalg.norm(self.curve.residuals(points)[0], axis=1)

    def point(self, positions: Array) -> Array:
        """Where the observed point is at joint positions (N,), shape (N, 3) [m]."""
        if self.joint_type is not JointType.REVOLUTE:
            return self.origin + positions[:, None] * self.axis
        assert self.curve is not None
        begin = self._start() - self.origin
        across = cross(self.axis, begin)
        return self.origin + np.cos(positions)[:, None] * begin + np.sin(positions)[:, None] * across

    def _start(self) -> Array:
        """The point of the circle at position 0."""
        assert self.curve is not None
        zero = float(self.deviations["zero"])
        inward, tangent = self.curve.inward[0], self.curve.tangent[0]
        return self.origin + self.radius * (math.sin(zero) * tangent - math.cos(zero) * inward)


@dataclass(frozen=True, slots=True, eq=False)
class Learned:
    """Candidates for one track, best first.

    Attributes:
        track: What was observed.
        candidates: One of each joint type.
    """

    track: Track
    candidates: tuple[Articulation, ...]

    @property
    def best(self) -> Articulation:
        """The candidate with the most evidence."""
        return self.candidates[0]

    @property
    def probabilities(self) -> tuple[float, ...]:
        """Posterior probability of each candidate, all three being equally likely before."""
        evidence = np.array([each.evidence for each in self.candidates])
        weights = np.exp(evidence - evidence.max())
        return tuple(float(each) for each in weights / weights.sum())


def learn(track: Track, up: Array | None = UP) -> Learned:
    """Candidates for the joint that moves the observed point, by evidence.

    Args:
        track: Positions, and orientations where there are any.
        up: Unit vector, shape (3,): up in the track's frame; None where that is not known. Axes are
            then as likely to lie in any direction.

    Raises:
        MotionError: Too few samples.
    """
    track = checked(track)
    turns = None if track.orientations is None else turns_of(track.orientations)
    cells = cells_of(track.positions, turns)
    gravity = Gravity.towards(up)
    turning = None if turns is None else turning_of(track, turns, cells)
    candidates = [_still(track, cells, turning)]
    if cells.extent > 0:
        line, arc = starts(cells)
        candidates += [
            _moving(track, _family(cells, gravity, LINE, line, None), turning, cells),
            _moving(track, _family(cells, gravity, ARC, arc, turning), turning, cells),
        ]
    return Learned(track, tuple(sorted(candidates, key=lambda each: -each.evidence)))


def _family(
    cells: Cells, gravity: Gravity, free: int, start: Start, turning: Turning | None
) -> list[tuple[Plumb, Fit, float]]:
    """Fits of all classes of axes, each with its evidence, the share of its class included."""
    name = "prismatic" if free == LINE else "revolute"
    found: list[tuple[Plumb, Fit, float]] = []
    for plumb, share in gravity.classes(name).items():
        problem = Problem(cells, gravity, plumb, free, None if turning is None else turning.seen)
        frame, parameters = _start_of(problem, gravity, start)
        one = fit(problem, frame, parameters)
        found.append((plumb, one, one.evidence + math.log(share)))
    return found


def _start_of(problem: Problem, gravity: Gravity, start: Start) -> Start:
    """The start, or one whose plane lies as gravity or orientations want it, if that fits better."""
    frame, parameters = start
    if problem.free == LINE:
        return start
    tried = [start]
    tangent, inward = frame.axes[0], np.zeros(3)
    if gravity.up is not None and problem.plumb is not Plumb.FREE:
        inward = cross(gravity.up, tangent)
    if problem.plumb is Plumb.HORIZONTAL:
        inward = cross(inward, tangent)
    if float(np.linalg.norm(inward)) > LEAST_SLANT:
        tried += [(Frame.about(frame.o, tangent, sign * inward), parameters) for sign in (1, -1)]
    if problem.seen is not None:
        arm, radius = problem.seen.arm, max(float(np.linalg.norm(problem.seen.arm)), problem.seen.arm_spread)
        across = cross(problem.seen.axis, arm if radius > 0 else frame.axes[1])
        middle = np.median(problem.cells.points, axis=0)
        tried.append((Frame.about(middle, across, -arm), np.array([0, 0, 0, 0, 1 / radius, 0])))
    costs = [float(problem.cost(each, at[None], 2 * SCALE)[0]) for each, at in tried]
    return tried[int(np.argmin(costs))]


def _still(track: Track, cells: Cells, turning: Turning | None) -> Articulation:
    """The candidate that nothing moves."""
    origin, scale = np.median(track.positions, axis=0), SCALE
    squares, pull = np.zeros(0), cells.weights
    for _ in range(ROUNDS):
        squares = ((cells.points - origin) ** 2).sum(axis=1)
        pull = cells.weights * (FREEDOM + 3) / (FREEDOM + squares / scale**2)
        scale = math.sqrt((float(pull @ squares) / 3 + SCALE_WEIGHT * SCALE**2) / (pull.sum() + SCALE_WEIGHT))
        origin = pull @ cells.points / pull.sum()
    evidence = float(log_student(squares, scale, 3) @ cells.weights) + log_scale_density(scale, SCALE)
    spread = scale / math.sqrt(float(pull.sum()))
    evidence += 1.5 * math.log(2 * math.pi) + 3 * math.log(spread)
    if turning is not None:
        evidence += turning.evidence_still()
    distances = np.linalg.norm(track.positions - origin, axis=1)
    return Articulation(
        JointType.FIXED, np.zeros(3), origin, 0.0, np.zeros(len(distances)), (0.0, 0.0), distances,
        scale, int((distances > OUTLIER * scale).sum()), {"origin": spread}, evidence, Plumb.FREE, None,
    )  # fmt: skip


def _moving(
    track: Track, family: list[tuple[Plumb, Fit, float]], turning: Turning | None, cells: Cells
) -> Articulation:
    """The best fit of a family as a joint, with the evidence of the whole family."""
    plumb, best, _ = max(family, key=lambda each: each[2])
    evidence = float(np.logaddexp.reduce([each for _, _, each in family])) + log_travel_density(cells.travel)
    curve, revolute = best.curve, best.free == ARC
    distances = np.linalg.norm(curve.residuals(track.positions)[0], axis=1)
    along = curve.progress(track.positions)[0]
    radius = 1 / float(curve.curvature[0]) if revolute else 0.0
    axis = curve.normal[0] if revolute else curve.tangent[0]
    unsure = best.scale / radius if revolute else 0.0
    if turning is not None:
        evidence += (
            turning.evidence_turning(axis, along / radius, unsure) if revolute else turning.evidence_still()
        )
    steady = distances <= OUTLIER * best.scale
    steady = steady if steady.any() else np.ones_like(steady)
    raw = _raw_positions(along, axis, radius, unsure, turning)
    zero = _zero(raw, steady, cells)
    positions = raw - zero
    if -positions[steady].min() > positions[steady].max():
        axis, positions, curve, zero = -axis, -positions, _reversed(curve), -zero
    deviations = _deviations(best, radius, len(track.positions), cells) | {"zero": zero}
    anchor = curve.anchor[0]
    origin = anchor + radius * curve.inward[0] if revolute else anchor + zero * axis
    smooth = _smooth(positions[steady])
    limits = (float(smooth.min()), float(smooth.max()))
    kind = JointType.REVOLUTE if revolute else JointType.PRISMATIC
    return Articulation(
        kind, axis, origin, radius, positions, limits, distances, best.scale, int((~steady).sum()),
        deviations, evidence, plumb, curve,
    )  # fmt: skip


def _raw_positions(along: Array, axis: Array, radius: float, unsure: float, turning: Turning | None) -> Array:
    """Joint positions from any zero: of orientations where they say more than places."""
    if radius == 0:
        return along
    if turning is not None and turning.seen is not None and unsure > TURN_SCALE:
        return np.unwrap(turning.vectors @ axis)
    return np.unwrap(along / radius)


def _smooth(positions: Array) -> Array:
    """Running median, shape (T - SMOOTHING + 1,), or the positions where there are too few."""
    if len(positions) < 2 * SMOOTHING:
        return positions
    return np.median(np.lib.stride_tricks.sliding_window_view(positions, SMOOTHING), axis=1)


def _zero(raw: Array, steady: np.ndarray, cells: Cells) -> float:
    """Position at which the track begins: the median of its first cell's samples."""
    steady = steady & (cells.members >= 0) if (steady & (cells.members >= 0)).any() else steady
    first = cells.members == cells.members[int(np.argmax(steady))]
    return float(np.median(raw[first & steady]))


def _reversed(curve: Curves) -> Curves:
    """The same curve, run through the other way."""
    return Curves(curve.anchor, -curve.tangent, curve.inward, curve.curvature)


def _deviations(best: Fit, radius: float, samples: int, cells: Cells) -> dict[str, float]:
    """Standard deviations of what people read, from the covariance of the parameters."""
    variance = np.diag(best.covariance)
    per_cell = samples / max(len(cells.points), 1)
    end = best.scale / math.sqrt(max(per_cell, 1.0))
    if best.free == LINE:
        lateral = float(np.sqrt(variance[0:2].max()))
        return {"axis": float(np.sqrt(variance[2:4].max())), "origin": lateral, "limits": end}
    direction = best.parameters[4:6] * radius
    spread = radius**2 * math.sqrt(float(direction @ best.covariance[4:6, 4:6] @ direction))
    across = np.array([-direction[1], direction[0]])
    # the plane turns with the tangent (along it) and with the curvature vector (across it)
    swing = radius * math.sqrt(float(across @ best.covariance[4:6, 4:6] @ across))
    tilt = math.sqrt(float(across @ best.covariance[2:4, 2:4] @ across))
    inwards = math.sqrt(float(direction @ best.covariance[0:2, 0:2] @ direction))
    return {
        "axis": max(swing, tilt),
        "origin": math.hypot(spread, inwards),
        "radius": spread,
        "limits": end / radius,
    }
