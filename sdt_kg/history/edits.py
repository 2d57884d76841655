"""Edits: what makes a branch from another one. Each can be applied, undone and said in words."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import pyoxigraph as ox

from sdt_kg.entities import Replacement
from sdt_kg.errors import GraphError, InputError, UnknownEntityError
from sdt_kg.history.trajectory import Trajectory
from sdt_kg.iri import SDT, Iri, body_iri, joint_iri, local_name
from sdt_kg.mechanism import Body, Geometry, Joint, JointType, Mechanism, Pose
from sdt_kg.store import Triple, Value
from sdt_kg.triples import mechanism_triples
from sdt_kg.triples.facts import TYPE
from sdt_kg.twin import Twin

INDEX: Final = SDT + "index"
FIRST_OBSTACLE_INDEX: Final = 1_000_000
"""Obstacles come after all else, in an order that does not depend on when each was put there."""
OBSTACLE_INDICES: Final = 2**40
OBSTACLE: Final = SDT + "Obstacle"
DRAWN_AT: Final = SDT + "drawnAt"
POSE: Final = "x", "y", "z", "qx", "qy", "qz", "qw"


@dataclass(frozen=True, slots=True)
class Moved:
    """Joints are elsewhere: joint IRI → position [rad or m]."""

    positions: tuple[tuple[Iri, float], ...]

    @property
    def sentence(self) -> str:
        """The edit in words."""
        return "moved " + ", ".join(f"{local_name(joint)} to {at:g}" for joint, at in self.positions)

    def applied(self, twin: Twin) -> Twin:
        """The twin after it; StateError outside limits."""
        return twin.at(dict(self.positions))

    def inverse(self, before: Twin) -> "Moved":
        """What undoes it."""
        return _back(before, [joint for joint, _ in self.positions])


@dataclass(frozen=True, slots=True)
class Followed:
    """The kitchen went through a trajectory."""

    trajectory: Trajectory

    @property
    def sentence(self) -> str:
        """The edit in words."""
        names = ", ".join(map(local_name, self.trajectory.joints))
        return f"followed a trajectory of {names} for {self.trajectory.duration:g} s"

    def applied(self, twin: Twin) -> Twin:
        """The twin at the last sample; StateError if the trajectory does not begin in its state."""
        self.trajectory.check_start(twin)
        return self.trajectory.at(twin, -1)

    def inverse(self, before: Twin) -> Moved:
        """What undoes it: the joints are where they were."""
        return _back(before, self.trajectory.joints)


@dataclass(frozen=True, slots=True)
class Rewritten:
    """Asserted triples of one model are others: a limit, a pose, an obstacle."""

    by: Replacement

    @property
    def sentence(self) -> str:
        """The edit in words."""
        return f"{local_name(self.by.model)}: {self.by.note}"

    def applied(self, twin: Twin) -> Twin:
        """The twin after it; GraphError if what it replaces is not there."""
        return twin.rewritten(self.by)

    def inverse(self, before: Twin) -> "Rewritten":
        """What undoes it."""
        del before
        by = self.by
        note = by.note.removeprefix("undone: ") if by.note.startswith("undone: ") else f"undone: {by.note}"
        return Rewritten(Replacement(by.model, by.added, by.removed, note))


@dataclass(frozen=True, slots=True)
class Brought:
    """A robot is there, of which these triples are asserted."""

    robot: Iri
    triples: frozenset[Triple]

    @property
    def sentence(self) -> str:
        """The edit in words."""
        return f"robot {local_name(self.robot)} added"

    def applied(self, twin: Twin) -> Twin:
        """The twin with the robot; InputError if there is one of that name."""
        return twin.with_robot(self.robot, sorted(self.triples, key=str))

    def inverse(self, before: Twin) -> "TakenAway":
        """What undoes it."""
        del before
        return TakenAway(self.robot)


@dataclass(frozen=True, slots=True)
class TakenAway:
    """A robot is no longer there."""

    robot: Iri

    @property
    def sentence(self) -> str:
        """The edit in words."""
        return f"robot {local_name(self.robot)} removed"

    def applied(self, twin: Twin) -> Twin:
        """The twin without the robot; UnknownEntityError if it was not there."""
        return twin.without_robot(self.robot)

    def inverse(self, before: Twin) -> Brought:
        """What undoes it."""
        return brought(before, self.robot)


Edit = Moved | Followed | Rewritten | Brought | TakenAway


def key_of(edit: Edit) -> str:
    """SHA-256 over all that the edit says."""
    match edit:
        case Moved(positions):
            texts = [f"{joint} {at.hex()}" for joint, at in positions]
        case Followed(trajectory):
            texts = [trajectory.iri]
        case Rewritten(by):
            texts = [by.model, *(f"{sign}{triple}" for sign, triple in _signed(by))]
        case Brought(robot, triples):
            texts = [robot, *sorted(map(str, triples))]
        case TakenAway(robot):
            texts = [robot]
    text = "\n".join([type(edit).__name__, *texts])
    return hashlib.sha256(text.encode()).hexdigest()


def _signed(by: Replacement) -> list[tuple[str, str]]:
    return sorted([("-", str(each)) for each in by.removed] + [("+", str(each)) for each in by.added])


def moved(positions: Mapping[Iri, float]) -> Moved:
    """These joints go to these positions [rad or m]."""
    return Moved(tuple(sorted((joint, float(at)) for joint, at in positions.items())))


def _back(before: Twin, joints: Sequence[Iri]) -> Moved:
    """The joints are where they were; of those that mimic, the ones that they mimic, exactly."""
    followers = before.entities.coupling.followers
    free = {followers[joint].active if joint in followers else joint for joint in joints}
    return moved({joint: before.state[joint] for joint in free})


def changed(twin: Twin, subject: Iri, **changes: Value) -> Rewritten:
    """Properties of one individual become others: a limit (`upperLimit`), a pose (`x`), say; None removes."""
    return Rewritten(_elsewhere(twin, subject, twin.entities.replacement(subject, changes)))


def _elsewhere(twin: Twin, subject: Iri, by: Replacement) -> Replacement:
    """The replacement; where it puts a joint's frame elsewhere, the joint keeps where it was drawn."""
    joint, _, part = subject.rpartition("/")
    if part != "origin":
        return by
    facts = twin.entities.facts
    values = {name: facts.number(subject, name) for name in POSE}
    here, kept = " ".join(map(repr, values.values())), facts.one(joint, "drawnAt")
    added = {local_name(name): value for _, name, value in by.added}
    values |= {name: float(value.value) for name, value in added.items() if isinstance(value, ox.Literal)}
    before, now = frozenset[Triple](), frozenset[Triple]()
    if kept is not None:
        before = frozenset({(joint, DRAWN_AT, ox.Literal(str(kept)))})
    if " ".join(map(repr, values.values())) != (kept or here):
        now = frozenset({(joint, DRAWN_AT, ox.Literal(str(kept or here)))})
    return replace(by, removed=by.removed | (before - now), added=by.added | (now - before))


def posed(twin: Twin, joint: Iri, pose: Pose) -> Rewritten:
    """The frame of a joint is elsewhere in its parent's frame, and with it the bodies that it carries."""
    values: dict[str, Value] = dict(zip(POSE, (*pose.position, *pose.orientation), strict=True))
    by = changed(twin, f"{joint}/origin", **values).by
    shown = ", ".join(f"{value:g}" for value in (*pose.position, *pose.orientation))
    return Rewritten(replace(by, note=f"edited: {local_name(joint)}: pose = {shown}"))


def brought(twin: Twin, robot: Iri) -> Brought:
    """A robot is added as another twin has it."""
    if robot not in twin.robots:
        raise UnknownEntityError("robot", local_name(robot), map(local_name, twin.robots))
    entities = twin.entities
    return Brought(robot, frozenset(entities.store.triples(entities.asserted[robot])))


def obstacle(twin: Twin, name: str, shapes: Sequence[Geometry], pose: Pose) -> Rewritten:
    """A body that nothing moves stands in the scene.

    Args:
        twin: Where it is put.
        name: Its name; its joint is named `NAME_obstacle`.
        shapes: Its collision shapes, in its own frame.
        pose: Of its frame in the root frame of the kitchen.

    Raises:
        InputError: There is a body or joint of that name, or it has no shape.
    """
    mechanism = twin.mechanism(twin.environment)
    joint = f"{name}_obstacle"
    taken = {body.name for body in mechanism.bodies} | {each.name for each in mechanism.joints}
    if {name, joint} & taken or not name:
        raise InputError(f"'{name}' cannot name an obstacle", allowed="a name that no body or joint has")
    if not shapes:
        raise InputError(f"obstacle '{name}' has no shape", allowed="at least one")
    added = frozenset(_obstacle_triples(mechanism, name, tuple(shapes), pose))
    return Rewritten(Replacement(twin.environment, frozenset(), added, f"obstacle {name} added"))


def _obstacle_triples(
    mechanism: Mechanism, name: str, shapes: tuple[Geometry, ...], pose: Pose
) -> list[Triple]:
    mount = Joint(f"{name}_obstacle", JointType.FIXED, mechanism.root, name, pose)
    alone = Mechanism(mechanism.name, mechanism.root, (Body(name, None, shapes),), (mount,))
    body, joint = body_iri(mechanism.name, name), joint_iri(mechanism.name, mount.name)
    digest = int(hashlib.sha256(name.encode()).hexdigest(), 16)
    index = ox.Literal(FIRST_OBSTACLE_INDEX + digest % OBSTACLE_INDICES)
    triples = [
        (subject, predicate, index if predicate == INDEX and subject in (body, joint) else value)
        for subject, predicate, value in mechanism_triples(alone, "Environment")
        if subject.startswith((body, joint))
    ]
    return [*triples, (body, TYPE, ox.NamedNode(OBSTACLE))]


def without_obstacle(twin: Twin, name: str) -> Rewritten:
    """An obstacle that was put there is gone.

    Raises:
        UnknownEntityError: No obstacle has that name.
    """
    kitchen = twin.environment
    body = body_iri(local_name(kitchen), name)
    obstacles = twin.entities.facts.having(TYPE, OBSTACLE)
    if body not in obstacles:
        raise UnknownEntityError("obstacle", name, map(local_name, obstacles))
    own = (body, joint_iri(local_name(kitchen), f"{name}_obstacle"))
    asserted = twin.entities.store.triples(twin.entities.asserted[kitchen])
    removed = frozenset(triple for triple in asserted if _is_part(triple[0], own))
    if not removed:
        raise GraphError(f"obstacle '{name}' is not asserted of '{local_name(kitchen)}'")
    return Rewritten(Replacement(kitchen, removed, frozenset(), f"obstacle {name} removed"))


def _is_part(iri: Iri, wholes: Sequence[Iri]) -> bool:
    return any(iri == whole or iri.startswith(whole + "/") for whole in wholes)
