"""Which joint moves an observed point: fixed, prismatic or revolute, by evidence."""

import math
from dataclasses import replace

import numpy as np

from predicates.learn.articulation import Articulation, Learned
from predicates.learn.candidates import moving, still
from predicates.learn.fitting.cells import Cells, cells_of
from predicates.learn.fitting.curve import Frame
from predicates.learn.fitting.fit import ARC, LINE, Fit, Problem, fit
from predicates.learn.fitting.priors import LARGE_RADIUS, SCALE, Gravity, Plumb
from predicates.learn.fitting.starts import Start, starts
from predicates.learn.fitting.turning import LEAST_TURN, Turning, turning_of, turns_of
from predicates.learn.fitting.vectors import cross
from predicates.learn.track import Array, Track, checked

UP: Array = np.array([0.0, 0.0, 1.0])
"""Up in a ROS frame (REP 103)."""

BENT = 3.0
"""[1] Standard deviations by which a bend differs from noise."""

LEAST_SLANT = 0.1
"""[1] Sine of the angle between a path and gravity below which gravity says nothing of the path's plane."""

SINE_LIMIT, COSINE_LIMIT = 0.5, math.sqrt(0.75)
"""[1] Of 30 degrees: classes that would turn a path farther from where it was seen are not tried."""


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
    candidates = [still(track, cells, turning)]
    if cells.extent > 0:
        line, arc = starts(cells)
        candidates += [
            moving(track, _family(cells, gravity, LINE, line, None), turning, cells),
            moving(track, _family(cells, gravity, ARC, arc, turning), turning, cells),
        ]
        if not _tells_turn(turning, candidates[1]) and _hides_arc(candidates[1], cells):
            candidates[1:] = _either(*candidates[1:])
    if cells.may_shift:
        candidates = [_unsure(candidates[0], candidates[1:]), *candidates[1:]]
    return Learned(track, tuple(sorted(candidates, key=lambda each: -each.evidence)))


def _either(line: Articulation, arc: Articulation) -> list[Articulation]:
    """Both, a line no likelier than an arc: typical radii alone would make it sure of a drawer."""
    if line.evidence <= arc.evidence:
        return [line, arc]
    half = float(np.logaddexp(line.evidence, arc.evidence)) - math.log(2)
    return [replace(each, evidence=half) for each in (line, arc)]


def _tells_turn(turning: Turning | None, line: Articulation) -> bool:
    """Whether orientations turn, or would if an arc of a large radius led as far as a line."""
    if turning is None:
        return False
    return turning.seen is not None or line.limits[1] - line.limits[0] > LEAST_TURN * LARGE_RADIUS


def _hides_arc(line: Articulation, cells: Cells) -> bool:
    """Whether noise of single samples would hide that a line is an arc of a large radius."""
    along = line.positions[cells.members >= 0]
    rows = np.stack([np.ones_like(along), along], axis=1)
    bend = along**2 / (2 * LARGE_RADIUS)
    bend = bend - rows @ np.linalg.lstsq(rows, bend, rcond=None)[0]
    return float(np.linalg.norm(bend)) < BENT * cells.noise


def _unsure(still: Articulation, moving: list[Articulation]) -> Articulation:
    """A point that shifts, or may, stands still on a tracker that wanders, or was moved a little.

    Mechanisms that hardly move are rare, so that the evidence alone would be sure of standstill: that is
    taken to be no likelier than not.
    """
    either = float(np.logaddexp.reduce([each.evidence for each in moving]))
    return replace(still, evidence=min(still.evidence, either))


def _family(
    cells: Cells, gravity: Gravity, free: int, start: Start, turning: Turning | None
) -> list[tuple[Plumb, Fit, float]]:
    """Fits of all classes of axes, each with its evidence, the share of its class included."""
    name = "prismatic" if free == LINE else "revolute"
    found: list[tuple[Plumb, Fit, float]] = []
    for plumb, share in gravity.classes(name).items():
        if found and not _possible(gravity, plumb, found[0][1]):
            continue
        problem = Problem(cells, gravity, plumb, free, None if turning is None else turning.seen)
        frame, parameters = _start_of(problem, gravity, start)
        one = fit(problem, frame, parameters)
        found.append((plumb, one, one.evidence + math.log(share)))
    return found


def _possible(gravity: Gravity, plumb: Plumb, free: Fit) -> bool:
    """Whether the best path of any direction allows an axis of a class: it may be turned by 30 degrees."""
    assert gravity.up is not None, "without it there is one class only"
    climb = abs(float(free.curve.tangent[0] @ gravity.up))
    if free.free == ARC:
        return plumb is Plumb.HORIZONTAL or climb < SINE_LIMIT
    return climb < SINE_LIMIT if plumb is Plumb.HORIZONTAL else climb > COSINE_LIMIT


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
