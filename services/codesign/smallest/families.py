"""Which edits are looked at where none is named: families, each with its range and its resolution."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from predicates.case import Outcome, Verdict
from sdt_kg.iri import Iri, body_iri, local_name
from sdt_kg.twin import Container, Twin
from services.codesign.again import FREEDOM
from services.whatif import Change, World, parse_change

ROBOTS = ("pr2", "tiago_dual", "stretch")
HANDLE_RANGE = 0.3
"""[m] By which a handle is moved at most: about the height of a cabinet door's free half."""
HEIGHT_RANGE = 0.5
"""[m] By which a piece of furniture is raised or lowered at most."""
MOST_CLEARED = 3
"""[1] Bodies that are cleared one by one: those which the reasons of the refusal name."""
GRADUAL_SCAN = 2
"""[1] Steps of the first scan in each direction; the rest of the time halves."""
AND = " & "
"""Between two edits that are made at once."""
LENGTH_TOLERANCE = 0.02
"""[m] To which a length is told."""
START_TOLERANCE = 0.1
"""[m] To which the start of the base is told."""
LEAST_LENGTH = 1e-6
"""[m] A shorter way is none."""


@dataclass(frozen=True, slots=True)
class Family:
    """Edits of one kind, the ones that are less first.

    Attributes:
        name: What it asks, in words.
        edits: Whole edits, each tried; or gradual ones, directions of one change.
        scan: Steps of the first scan of gradual edits; 0: edits are whole.
        finest: To which the size of a gradual edit is told [m].
        range: What was looked at, in words.
        resolution: How finely, in words.
        lengths: Of gradual edits: how far each direction goes [m].
        start: Of edits of where the base starts: where it does as it is.
    """

    name: str
    edits: tuple[str, ...]
    scan: int = 0
    finest: float = 0.0
    range: str = ""
    resolution: str = ""
    lengths: tuple[float, ...] = ()
    start: tuple[float, float, float] | None = None

    @property
    def longest(self) -> float:
        """[m] Which share 1 of a gradual edit goes, in every direction that is as long."""
        return max(self.lengths, default=0.0)

    @property
    def tolerance(self) -> float:
        """[1] Of the share of gradual edits."""
        return min(1.0, self.finest / max(self.longest, self.finest))

    @property
    def directions(self) -> list[Change]:
        """Its edits as changes of which equal shares go equally far."""
        changes = [parse_change(each) for each in self.edits]
        factors = [self.longest / max(each, LEAST_LENGTH) for each in self.lengths]
        return [each.sooner(factor) for each, factor in zip(changes, factors, strict=True)]


def made_at_once(text: str) -> tuple[Change, ...]:
    """The edits of `A & B`, or the one of `A`."""
    return tuple(map(parse_change, text.split(AND)))


def families(world: World, verdict: Verdict, container: Container) -> list[Family]:
    """What is looked at for a verdict; what gives way where it is refused, what breaks it where it holds."""
    found = [_robots(world), _drives(world), _states(world, verdict, container)]
    if verdict.outcome is not Outcome.CERTIFIED:
        found.append(_clearing(world, verdict, container))
    found += [_handle(container), _height(container)]
    return [each for each in found if each.edits]


def _robots(world: World) -> Family:
    own = world.service.twin.name(world.robot_iri)
    others = tuple(each for each in ROBOTS if each != own)
    names = tuple(f"robot:{each}" for each in others)
    return Family("which robot", names, range="the bundled robots: " + ", ".join(others), resolution="each")


def _drives(world: World) -> Family:
    """Every other drive, the one with more freedom first."""
    now = world.service.policy.drive_of(world.service.twin, world.robot_iri)
    others = tuple(each.value for each in reversed(FREEDOM) if each is not now)
    names = tuple(f"drive:{each}" for each in others)
    return Family("which drive", names, range=", ".join(others), resolution="each")


def _states(world: World, verdict: Verdict, container: Container) -> Family:
    """Other containers that stand open, closed; and those which a reason names, opened."""
    twin = world.service.twin
    edits: list[str] = []
    for each in twin.containers():
        if each.active_joint == container.active_joint:
            continue
        if not each.is_closed(twin.state[each.joint]):
            edits.append(f"move:{each.name}=closed")
        elif _moved_by(twin, each) & named(verdict):
            edits.append(f"move:{each.name}=open")
    listed = ", ".join(each.partition(":")[2] for each in edits)
    return Family(
        "which other door or drawer is moved",
        tuple(edits),
        range=f"those that stand open, closed; those that a reason names, opened: {listed}",
        resolution="all the way, one at a time",
    )


def _clearing(world: World, verdict: Verdict, container: Container) -> Family:
    """Obstacles that were put there, and bodies which a reason names."""
    twin = world.service.twin
    kitchen = twin.mechanism(twin.environment)
    own = _moved_by(twin, container)
    obstacles = {each.child for each in kitchen.joints if each.name == f"{each.child}_obstacle"}
    blamed = [local_name(each) for each in sorted(named(verdict) - own) if _is_shaped(twin, each)]
    bodies = list(dict.fromkeys([*sorted(obstacles & set(blamed)), *blamed, *sorted(obstacles)]))
    edits = tuple(f"clear:{each}" for each in bodies[:MOST_CLEARED])
    listed = ", ".join(bodies[:MOST_CLEARED])
    return Family(
        "which obstacle is cleared",
        edits,
        range=f"obstacles that were put there, and what the reasons name: {listed}",
        resolution="one at a time, with all that hangs on it",
    )


def _handle(container: Container) -> Family:
    steps = ("0,0,{}", "0,0,-{}", "0,{},0", "0,-{},0")
    edits = tuple(f"handle:{container.name}={each.format(HANDLE_RANGE)}" for each in steps)
    along = f"along ±z and ±y of its body, to {HANDLE_RANGE} m"
    return _gradual("where its handle is", edits, HANDLE_RANGE, along)


def _height(container: Container) -> Family:
    edits = tuple(f"furniture:{container.name}=0,0,{sign}{HEIGHT_RANGE}" for sign in ("", "-"))
    along = f"up and down to {HEIGHT_RANGE} m, with the piece of furniture that it is part of"
    return _gradual("at which height it is", edits, HEIGHT_RANGE, along)


def _gradual(name: str, edits: tuple[str, ...], longest: float, along: str) -> Family:
    """Edits that all go as far [m]."""
    resolution = _halves(longest / GRADUAL_SCAN, LENGTH_TOLERANCE)
    return Family(name, edits, GRADUAL_SCAN, LENGTH_TOLERANCE, along, resolution, (longest,) * len(edits))


def _halves(first: float, finest: float) -> str:
    """How finely sizes are looked at, in words."""
    return f"steps of {first:.2f} m until one turns, then halves of them as the time allows, to {finest} m"


def pairs(found: Sequence[Family]) -> Family:
    """Two edits of different families at once, gradual ones all the way; what each tries first is first."""
    ranked = [
        (i + j, f"{one}{AND}{other}")
        for a, b in combinations(found, 2)
        for i, one in enumerate(a.edits)
        for j, other in enumerate(b.edits)
    ]
    edits = tuple(edit for _, edit in sorted(ranked, key=lambda each: each[0]))
    kinds = "; ".join(each.name for each in found)
    return Family(
        "which two together",
        edits,
        range=f"{len(edits)} pairs of two of these: {kinds}",
        resolution="each edit of a pair all the way",
    )


def base_family(start: tuple[float, float, float], spots: list[tuple[float, float, float]]) -> Family:
    """From where the robot starts towards poses at which a base that stands still is certified."""
    edits = tuple("base:{:.4f},{:.4f},{:.4f}".format(*each) for each in spots)
    lengths = [((x - start[0]) ** 2 + (y - start[1]) ** 2) ** 0.5 for x, y, _ in spots]
    return Family(
        "where the base starts",
        edits,
        2 * GRADUAL_SCAN,
        START_TOLERANCE,
        "straight towards base poses that are certified with a fixed base",
        _halves(max(lengths, default=0.0) / (2 * GRADUAL_SCAN), START_TOLERANCE),
        tuple(lengths),
        start,
    )


def named(verdict: Verdict) -> set[Iri]:
    """Bodies that the reasons of a refusal name, or that a joint which they name carries."""
    found: set[Iri] = set()
    for each in verdict.diagnoses:
        if each.evidence is not None and each.evidence.scope != "self":
            found.update(each.evidence.links or ())
    return {each for each in found if each.startswith(verdict.case.twin.environment + "/")}


def _moved_by(twin: Twin, container: Container) -> set[Iri]:
    """The container's body and what hangs on it."""
    kitchen = twin.mechanism(twin.environment)
    moved = {local_name(container.iri)}
    for joint in kitchen.joints:  # parents before children
        if joint.parent in moved:
            moved.add(joint.child)
    return {body_iri(kitchen.name, each) for each in moved}


def _is_shaped(twin: Twin, body: Iri) -> bool:
    kitchen = twin.mechanism(twin.environment)
    return any(body_iri(kitchen.name, each.name) == body and each.collision for each in kitchen.bodies)
