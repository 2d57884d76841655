"""All that a refused motion does wrong: how deep it collides, what it drags along, what it lets go.

To refuse takes one reason; people who made a motion want every kind, with figures. This looks at many
times, not between them, so it adds to a refusal and decides none.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from predicates.case import Evidence, Quantity
from sdt_kg.annotation import Gripper
from sdt_kg.iri import Iri, body_iri, local_name
from sdt_kg.mechanism import Mechanism
from sdt_kg.numbers import told_apart
from sdt_kg.twin import Container
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.held.hold import Hold
from services.embodiment.certify.held.holds import first_of, one_after_the_other
from services.embodiment.certify.held.stints import begin, last, rests
from services.embodiment.certify.sweep.kinematics import Placed, unit_of
from services.embodiment.certify.sweep.subject import Subject

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]

TOGETHER = 32  # configurations that are looked at together, for memory
MOST_PAIRS = 40  # pairs of shapes whose deepest point is looked for, those that are hardest to part first
MOST_TIMES = 4_000  # that are looked at: in some 4 s with a usual robot and kitchen
PLACES = 8  # times of a collision at which that is done at first
FINER = 9  # times around the deepest of these


@dataclass(frozen=True, slots=True)
class Touch:
    """Two shapes that overlap at a time.

    Attributes:
        way: The shift that would part them [m].
    """

    pair: tuple[int, int]
    time: float
    way: float


def survey(checked: Subject, container: Container, grippers: Sequence[Gripper]) -> Findings:
    """Collisions by kind, each with the first and the deepest; how the handle is held and let go."""
    findings = Findings()
    times = _times(checked)
    acting, away = list[Hold](), np.zeros(len(times), dtype=bool)
    first = begin(checked.pieces, checked.scene.coordinate[container.joint])
    if first is not None:
        holds = [Hold(checked, container, gripper, first) for gripper in grippers]
        gaps = [_gaps(checked, hold, times) for hold in holds]
        best = min(range(len(holds)), key=lambda k: float(gaps[k].min()))
        every = first_of(grippers[best], grippers)
        acting = [*one_after_the_other(checked, container, every, first)]
        away = _away(acting, times)
        own = _in_turn(acting, grippers, times, gaps)
        findings.violations.extend(_contact(checked, acting[0], times, own))
    for rule, scope, pairs in _kinds(checked, acting):
        touches = [touch for part in _parts(times) for touch in _touches(checked, pairs, part)]
        if acting and rule == "collision: fingers and handle":
            depth, clear = checked.tolerances.depth, set(times[away].tolist())
            touches = [each for each in touches if each.way > depth or each.time in clear]
        findings.violations.extend(_collisions(checked, rule, scope, touches, times))
    return findings


def _times(checked: Subject) -> Array:
    """Every sample, and halfway to the next; of a log with very many, some."""
    pieces = checked.pieces
    middle = pieces.start + pieces.duration / 2
    times = np.sort(np.concatenate((pieces.start, middle, [checked.timeline.end])))
    return times[np.linspace(0, len(times) - 1, min(len(times), MOST_TIMES)).astype(np.intp)]


def _in_turn(acting: Sequence[Hold], grippers: Sequence[Gripper], times: Array, gaps: list[Array]) -> Array:
    """Distance of the nearest finger of who holds the handle then, or did last, shape (T,) [m]."""
    of = {gripper.name: gap for gripper, gap in zip(grippers, gaps, strict=True)}
    found = of[acting[0].gripper.name].copy()
    for before, hold in pairwise(acting):
        later = times > before.until
        found[later] = of[hold.gripper.name][later]
    return found


def _away(acting: Sequence[Hold], times: Array) -> Mask:
    """When the fingers that hold have left the handle, and none are in the next grasp."""
    away = np.zeros(len(times), dtype=bool)
    for k, hold in enumerate(acting):
        if k:
            away &= times < hold.arrived
        away |= times > hold.clear_from()
    return away


def _placed(checked: Subject, times: Array) -> Placed:
    pieces = checked.timeline.pieces
    piece = np.clip(np.searchsorted(pieces.start, times, side="right") - 1, 0, len(pieces.start) - 1)
    q, v, _ = pieces.at(piece, times - pieces.start[piece])
    return checked.kinematics.place(q, v)


def _kinds(checked: Subject, acting: Sequence[Hold]) -> Iterator[tuple[str, str, Indices]]:
    """Rule, scope and pairs of shapes of each kind of collision."""
    pairs = checked.scene.environment_pairs
    own, bar = np.zeros((2, len(pairs)), dtype=bool)
    for hold in acting:
        bodies = hand(checked.scene.robot.mechanism, hold.gripper)
        robot = [i for i, one in enumerate(checked.scene.solids) if one.body in bodies]
        moved = np.flatnonzero(checked.shapes.carrier == hold.handle.carrier)
        own |= np.isin(pairs[:, 0], robot) & np.isin(pairs[:, 1], moved)
        bar |= np.isin(pairs[:, 0], hold.fingers) & np.isin(pairs[:, 1], hold.bar)
    if acting:
        yield "collision: fingers and handle", "environment", pairs[own & bar]
        yield "collision: own container", "environment", pairs[own & ~bar]
    yield "collision: environment", "environment", pairs[~own]
    yield "collision: self", "self", checked.scene.self_pairs


def hand(mechanism: Mechanism, gripper: Gripper) -> set[Iri]:
    """Bodies (IRIs) of a gripper: all from the nearest common ancestor of its fingers and tool on."""
    parent = {joint.child: joint.parent for joint in mechanism.joints}

    def ancestors(body: str) -> list[str]:
        way = [body]
        while way[-1] in parent:
            way.append(parent[way[-1]])
        return way

    ways = [ancestors(body) for body in (*gripper.fingers, gripper.tool_body)]
    root = next(body for body in ways[0] if all(body in way for way in ways))
    names = {body.name for body in mechanism.bodies if root in ancestors(body.name)}
    return {body_iri(mechanism.name, name) for name in names}


def _collisions(
    checked: Subject, rule: str, scope: str, touches: list[Touch], times: Array
) -> Iterator[Violation]:
    """The first of these overlaps, and the deepest."""
    if not touches:
        return
    first = min(touches, key=lambda each: (each.time, -each.way))
    yield _violation(checked, rule, scope, first, _depth(checked, first.pair, [first.time])[0][0])
    worst, (depth, time) = _deepest(checked, touches, float(np.diff(times).max()))
    if time > first.time:
        yield _violation(checked, rule, scope, Touch(worst.pair, time, worst.way), depth)


def _parts(times: Array) -> Iterator[Array]:
    for start in range(0, len(times), TOGETHER):
        yield times[start : start + TOGETHER]


def _touches(checked: Subject, pairs: Indices, times: Array) -> Iterator[Touch]:
    """Pairs that overlap at these times; their boxes are looked at first."""
    if not len(pairs):
        return
    placed, shapes = _placed(checked, times), checked.shapes
    count, every = len(times), np.arange(len(checked.scene.solids))
    span, shape = np.repeat(np.arange(count), len(every)), np.tile(every, count)
    size = (count, len(every), 3)
    centre = shapes.centres(placed, span, shape).reshape(size)
    half = shapes.extents(placed, span, shape).reshape(size)
    one, other = pairs.T
    near = np.ones((count, len(pairs)), dtype=bool)
    for axis in range(3):
        apart = np.abs(centre[:, one, axis] - centre[:, other, axis])
        near &= apart < half[:, one, axis] + half[:, other, axis]
    at, which = np.nonzero(near)
    for k, pair, distance in zip(at, pairs[which], shapes.distances(placed, at, pairs[which]), strict=True):
        if distance < 0:
            yield Touch((int(pair[0]), int(pair[1])), float(times[k]), -float(distance))


def _deepest(checked: Subject, touches: list[Touch], step: float) -> tuple[Touch, tuple[float, float]]:
    """The pair with the deepest point, with depth [m] and time [s].

    No point is deeper than the way that would part the shapes, so pairs with a short way need no look.
    """
    by_pair: dict[tuple[int, int], list[Touch]] = {}
    for touch in touches:
        by_pair.setdefault(touch.pair, []).append(touch)
    groups = sorted(by_pair.values(), key=lambda group: -max(each.way for each in group))
    best, found = groups[0][0], (0.0, groups[0][0].time)
    for group in groups[:MOST_PAIRS]:
        if max(each.way for each in group) <= found[0]:
            break
        group.sort(key=lambda each: -each.way)
        chosen = [*group[: PLACES // 2], *group[PLACES // 2 :: 1 + len(group) // PLACES]]
        here = max(_depth(checked, group[0].pair, [each.time for each in chosen]))
        if here > found:
            best, found = group[0], here
    end = checked.timeline.end
    around = np.clip(found[1] + np.linspace(-step, step, FINER), checked.pieces.start[0], end)
    return best, max(found, *_depth(checked, best.pair, around.tolist()))


def _depth(checked: Subject, pair: tuple[int, int], times: list[float]) -> list[tuple[float, float]]:
    """Depth of the deepest point of either shape in the other [m], and time [s], for each time."""
    placed = _placed(checked, np.array(times))
    pairs, span = np.tile(pair, (len(times), 1)), np.arange(len(times))
    ways = -checked.shapes.distances(placed, span, pairs)
    found: list[tuple[float, float]] = []
    for k, time in enumerate(times):
        depth = checked.shapes.depth(placed, k, pair) if ways[k] > 0 else 0.0
        found.append((min(depth, float(ways[k])), time))
    return found


def _violation(checked: Subject, rule: str, scope: str, touch: Touch, depth: float) -> Violation:
    one, other = (checked.scene.solids[i].body for i in touch.pair)
    deep, _ = told_apart(depth * 1000, 0.0, 1, "f")
    reason = f"{local_name(one)} and {local_name(other)} are {deep} mm in each other"
    evidence = Evidence(Quantity.DISTANCE, -depth, 0.0, "m", links=(one, other), time=touch.time, scope=scope)
    return Violation(rule, reason, evidence, depth)


def _gaps(checked: Subject, hold: Hold, times: Array) -> Array:
    """Distance of the nearest finger to the handle, shape (T,) [m]; infinite without shapes."""
    pairs = np.array([(finger, bar) for finger in hold.fingers for bar in hold.bar], dtype=np.intp)
    if not len(pairs):
        return np.full(len(times), np.inf)
    placed, count = _placed(checked, times), len(times)
    span = np.repeat(np.arange(count), len(pairs))
    return checked.shapes.distances(placed, span, np.tile(pairs, (count, 1))).reshape(count, -1).min(axis=1)


def _contact(checked: Subject, hold: Hold, times: Array, gaps: Array) -> Iterator[Violation]:
    """How far the container moves before a finger is at its handle, and where the finger leaves it.

    It need not be there while the container rests, nor be back before it begins to move.
    """
    container, k = hold.container, checked.scene.coordinate[hold.container.joint]
    unit = unit_of(checked.scene, k)
    pieces = checked.pieces
    piece = np.clip(np.searchsorted(pieces.start, times, side="right") - 1, 0, len(pieces.start) - 1)
    moved = np.abs(pieces.at(piece, times - pieces.start[piece])[0][:, k] - pieces.c[0, 0, k])
    near = gaps <= checked.tolerances.contact
    reached = int(np.argmax(near)) if near.any() else len(times) - 1
    far = float(moved[: reached + 1].max())
    if far > checked.tolerances.position:
        until = f"a finger of {hold.gripper.name} is at its handle" if near.any() else "the end, never held"
        reason = f"{container.name} has moved by {far:.4g} {unit} until {until}"
        evidence = Evidence(Quantity.POSITION, far, 0.0, unit, container.joint, time=float(times[reached]))
        yield Violation("moves before it is held", reason, evidence, far)
    held = (np.arange(len(times)) > reached) & (piece >= hold.begin) & (piece <= last(pieces, k))
    for rest in rests(pieces, k, hold.begin):
        held &= (piece < rest.start) | (piece >= rest.stop)
    lost = np.flatnonzero(~near & held)
    chosen = [lost[0], lost[np.argmax(gaps[lost])]] if near.any() and len(lost) else []
    if not near.any():
        chosen = [int(np.argmin(gaps))]
    for n in chosen:
        verb = "leaves it by" if near.any() else "comes no nearer to it than"
        reason = f"contact with {local_name(container.handle)} is lost: "
        reason += f"{hold.gripper.name} {verb} {gaps[n] * 1000:.1f} mm"
        evidence = Evidence(
            Quantity.DISTANCE,
            float(gaps[n]),
            checked.tolerances.contact,
            "m",
            container.handle,
            time=float(times[n]),
        )
        yield Violation("contact lost", reason, evidence, float(gaps[n]))
