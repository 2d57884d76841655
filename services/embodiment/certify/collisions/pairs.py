"""Which pairs of bodies must keep which distance, and what the sweep over them says."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from predicates.case import Evidence, Quantity
from predicates.margins import COUNTED, LOOKED_UP_TO, SMALLEST, NearestPair
from sdt_kg.iri import local_name
from sdt_kg.numbers import told_apart
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.held.hold import Hold
from services.embodiment.certify.held.through import most_depth
from services.embodiment.certify.sweep.clearance import PRECISION, Clearance, Distance, Pairs, Sweep
from services.embodiment.certify.sweep.pieces import Timeline, positions
from services.embodiment.certify.sweep.subject import Subject
from services.physics.geometry.floor import SIDE
from services.physics.model import Scene

Indices = NDArray[np.intp]

BLOCK = 8  # pieces joined in the first look at pairs of robot and kitchen


def collisions(checked: Subject, holds: Sequence[Hold]) -> Findings:
    """Robot against itself and against the kitchen as it moves.

    The only contact allowed is that of the holding gripper's fingers with the container's handle,
    from the time on at which the tool is in its grasp until it leaves it, the container at rest; and so of
    each hold. Fingers of another gripper keep clear of it meanwhile.
    """
    findings, pairs = Findings(), checked.scene.environment_pairs
    own = _touching(checked, holds)
    self_pairs = _keep(checked, checked.scene.self_pairs, 0)
    others = _keep(checked, pairs[~own], _blocks(checked.timeline))
    looks = {checked.timeline: [("self", "self", self_pairs), ("environment", "environment", others)]}
    for along, hold, name in _parts(checked, holds):
        touch = _touch(checked, hold, pairs[own], _blocks(along))
        looks.setdefault(along, []).append(("environment", name, touch))
    for along, sets in looks.items():
        some = [each for each in sets if len(each[2].shapes)]
        if some:
            sweep = Sweep(along, checked.kinematics, checked.shapes, [pairs for _, _, pairs in some])
            found = sweep.run(checked.tolerances.resolution)
            for (scope, name, pairs), one in zip(some, found, strict=True):
                smallest = _smallest(checked, along, pairs, one)
                findings.add(_findings(checked, one, smallest, scope, name))
    return findings


def _smallest(checked: Subject, along: Timeline, pairs: Pairs, found: Clearance) -> Distance | None:
    """The smallest distance, where all keep theirs; what was seen has the least beyond what it had to keep.

    Of fingers that may be in what they hold, but not in it before, these may be two: not where that had to
    keep the least of all.
    """
    worst = found.worst
    if found.first is not None or found.gave_up is not None or worst is None:
        return worst
    if worst.least <= pairs.least_held.min():
        return worst
    least = np.full(len(pairs.shapes), -checked.tolerances.depth)
    even = Pairs(pairs.shapes, least, least, np.inf, pairs.level)
    (seen,) = Sweep(along, checked.kinematics, checked.shapes, [even]).run(checked.tolerances.resolution)
    return seen.worst or worst


def _parts(checked: Subject, holds: Sequence[Hold]) -> Iterator[tuple[Timeline, Hold | None, str]]:
    """When the hand may come to the handle: for each hold, from where the one before has left."""
    pieces, first = checked.timeline.pieces, 0
    for number, hold in enumerate(holds, 1):
        name = "handle" if number == 1 else f"handle, hold {number}"
        yield _part(checked, first, hold.left), hold, name
        first = hold.left
    if first < len(pieces.start):
        yield _part(checked, first, len(pieces.start)), None, "handle, let go" if holds else "handle"


def _part(checked: Subject, first: int, end: int) -> Timeline:
    """The timeline itself where that is all of it."""
    pieces = checked.timeline.pieces
    return checked.timeline if end - first == len(pieces.start) else Timeline(pieces.part(first, end))


def above_floor(checked: Subject, reach: float) -> Findings:
    """The robot stays where there is a floor: its box ends, and beyond it nothing would be below the arm.

    No point of the robot is farther from its base than `reach` [m].
    """
    plane, pieces = checked.scene.base[:2], checked.pieces
    far, most = float(pieces.farthest[plane].max()) + reach, SIDE / 2
    if far <= most:
        return Findings()
    values, s = positions(pieces.columns(plane))
    away = np.abs(values).max(axis=2)
    i, n = np.unravel_index(np.argmax(away), away.shape)
    name, time = checked.scene.names[plane[0]], float(pieces.start[n] + s[i, n, 0])
    reason = (
        f"the robot comes up to {far:.4g} m from the kitchen's origin, and its floor ends after {most:g} m"
    )
    evidence = Evidence(Quantity.POSITION, far, most, "m", name, time=time)
    return Findings([Violation("beyond the floor", reason, evidence, far)])


def _blocks(timeline: Timeline) -> int:
    """Level of a timeline that joins `BLOCK` pieces."""
    return max(0, timeline.depth - int(np.log2(BLOCK)))


def _keep(checked: Subject, shapes: Indices, level: int) -> Pairs:
    least = np.full(len(shapes), checked.tolerances.margin + checked.scene.annotation.overhang)
    return Pairs(shapes, least, least, np.inf, level)


def _touching(checked: Subject, holds: Sequence[Hold]) -> NDArray[np.bool_]:
    """Which pairs of robot and kitchen are a finger of a gripper that ever holds and the handle."""
    one, other = checked.scene.environment_pairs.T
    finger, bar = np.zeros((2, len(checked.scene.solids)), dtype=bool)
    for hold in holds:
        finger[hold.fingers], bar[hold.bar] = True, True
    return finger[one] & bar[other]


def _touch(checked: Subject, hold: Hold | None, shapes: Indices, level: int) -> Pairs:
    kept = _keep(checked, shapes, level)
    if hold is None:
        return kept
    pairs = ((checked.scene.solids[i].shape for i in pair) for pair in shapes)
    deep = np.array([-most_depth(finger, bar, checked.tolerances.depth) for finger, bar in pairs])
    held = np.where(np.isin(shapes, hold.fingers).any(axis=1), deep, kept.least)
    return Pairs(kept.shapes, kept.least, held, hold.arrived, level)


def _findings(
    checked: Subject, found: Clearance, smallest: Distance | None, scope: str, name: str
) -> Findings:
    findings, scene = Findings(), checked.scene
    if found.gave_up is not None:
        reason = f"the motion is too fast between samples to be checked for contact ({scope})"
        evidence = Evidence(Quantity.TIME, found.gave_up, found.gave_up, "s", time=found.gave_up, scope=scope)
        findings.violations.append(Violation(f"too fast to be checked: {name}", reason, evidence, 0.0))
    if found.first is not None:
        broken = [found.first, found.worst or found.first]
        broken = [one for one in broken if one.value < one.least or not one.resolved]
        findings.violations.extend(_violation(checked, one, scope) for one in broken)
    elif found.gave_up is None:
        findings.figures[SMALLEST + name] = (LOOKED_UP_TO if smallest is None else smallest.value, "m")
        if scope == "environment":
            findings.slack[name] = found.slack - PRECISION
        if smallest is not None:
            findings.nearest.append(_nearest(scene, smallest, name))
            one, other = sorted(scene.solids[i].body for i in smallest.pair)
            findings.nearest_pairs[SMALLEST + name] = NearestPair((one, other), smallest.time)
    findings.figures[COUNTED + name] = (float(found.queries), "1")
    return findings


def _nearest(scene: Scene, distance: Distance, name: str) -> str:
    one, other = (local_name(scene.solids[i].body) for i in distance.pair)
    return f"nearest ({name}): {one} and {other}, {distance.value * 1000:.1f} mm at {distance.time:.2f} s"


def _violation(checked: Subject, distance: Distance, scope: str) -> Violation:
    """What is nearer than it may be; or so near that it cannot be shown to be not, by what would do."""
    one, other = (checked.scene.solids[i].body for i in distance.pair)
    names = f"{local_name(one)} and {local_name(other)}"
    millimetres = abs(distance.value) * 1000
    told, _ = told_apart(millimetres, 0.0, 1, "f")
    if distance.value < 0:
        reason = f"{names} are {told} mm in each other"
    elif distance.resolved:
        reason = f"{names} come as near as {told} mm"
    else:
        reason = f"{names} are {millimetres:.2f} mm apart, closer than the check can resolve"
    shown = max(distance.least + checked.tolerances.resolution, distance.value)
    evidence = Evidence(
        Quantity.DISTANCE,
        distance.value,
        distance.least if distance.resolved else shown,
        "m",
        links=(one, other),
        time=distance.time,
        scope=scope,
    )
    return Violation(f"collision: {scope}", reason, evidence, distance.least - distance.value)
