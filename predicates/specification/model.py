"""Specification (Π = goal, avoid, J) and its parts."""

from dataclasses import dataclass, field
from enum import Enum

from sdt_kg.iri import Iri
from sdt_kg.task import Verb
from sdt_kg.twin import Container


class Quality(Enum):
    """J: what is compared among certified motions; the value is the local name in `law.ttl`."""

    TIME = "Time"
    ENERGY = "Energy"
    WORK = "MechanicalWork"
    PATH_LENGTH = "PathLength"
    BASE_TRAVEL = "BaseTravel"
    CLEARANCE = "SmallestClearance"


class Scope(Enum):
    """What a query of a rule is asked over; the value is the local name in `law.ttl`."""

    STATES = "States"
    EVENTS = "Events"


class Demand(Enum):
    """What a query must answer, and when."""

    NEVER = "avoids"
    ALWAYS = "keeps"
    AT_THE_END = "reaches"


@dataclass(frozen=True, slots=True)
class Step:
    """One request of a sequence.

    Attributes:
        container: None stands for every container that does not meet the request yet.
        position: Where the container's own joint is to end [rad or m]; None: where the verb says.
    """

    verb: Verb
    container: Container | None
    position: float | None = None


@dataclass(frozen=True, slots=True)
class StaysClosed:
    """The container is closed, as Eq. (8) says, all along."""

    container: Container


@dataclass(frozen=True, slots=True)
class NeverBeyond:
    """The container's own joint never goes beyond a position [rad or m]."""

    container: Container
    position: float


@dataclass(frozen=True, slots=True)
class KeepsDistance:
    """No part of the robot comes nearer to a body (IRI) of the kitchen than a distance [m]."""

    body: Iri
    distance: float


@dataclass(frozen=True, slots=True)
class OpensBefore:
    """The second container is never open before the first one has been."""

    first: Container
    then: Container


@dataclass(frozen=True, slots=True)
class QueryRule:
    """A query over each state on the way, or over the events so far.

    Attributes:
        label: What the rule says, for people.
        sparql: ASK, or SELECT: a row is a yes.
    """

    label: str
    sparql: str
    over: Scope
    demand: Demand


Rule = StaysClosed | NeverBeyond | KeepsDistance | OpensBefore | QueryRule


@dataclass(frozen=True, slots=True)
class Specification:
    """Π = ⟨goal, avoid, J⟩ about one kitchen.

    Attributes:
        iri: As the file names it.
        steps: In order; the goal is that each is achieved.
        rules: What must hold along the way or at the end.
        quality: J; None: the first certified motion will do.
        written: The Turtle that it was read from; empty where it was made otherwise.
    """

    iri: Iri
    label: str
    steps: tuple[Step, ...]
    rules: tuple[Rule, ...] = ()
    quality: Quality | None = None
    written: str = field(default="", repr=False, compare=False)
