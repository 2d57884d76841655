"""What can be asked: the same over Zenoh and over HTTP.

Unknown fields are tolerated unless they look like a known one misspelled; an unknown major version of the
schema is refused. A truth or a text is no number, and nothing else is a truth.
"""

from enum import Enum
from typing import Annotated, Any, Final, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from sdt_kg.errors import meant
from services.policy import LEAST_FRICTION, MOST_CONTACT, MOST_FRICTION
from services.relative import Relative, TeeName

SCHEMA = "1.0"
DriveName = Literal["omni", "differential", "fixed"]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Seed = Annotated[int, Field(ge=0, lt=2**63)]
Contact = Annotated[float, Field(ge=0, le=MOST_CONTACT, allow_inf_nan=False)]
Friction = Annotated[float, Field(ge=LEAST_FRICTION, le=MOST_FRICTION, allow_inf_nan=False)]
Edit = Annotated[str, Field(max_length=500)]
BasePose = Annotated[tuple[Finite, Finite, Finite], Field(strict=False)]
"""x, y [m], yaw [rad]; an array of JSON is no tuple yet, but the numbers in it are read strictly."""


class Verb(Enum):
    """What can be asked."""

    SELECT = "select"
    ASK = "ask"
    CONSTRUCT = "construct"
    DESCRIBE = "describe"
    SATISFIES = "satisfies"
    CAUSES = "causes"
    CANPERFORM = "canperform"
    CANACHIEVE = "canachieve"
    WHY = "why"
    PLACE = "place"
    WHATIF = "whatif"
    TASK = "task"
    COMPUTE = "compute"
    SWEEP = "sweep"
    HISTORY = "history"


class Message(BaseModel):
    """What all messages share."""

    model_config = ConfigDict(extra="ignore", populate_by_name=True)

    version: str = Field(default=SCHEMA, alias="schema")


def _plain(value: object) -> object:
    """A number of numpy as Python's own, by itself or in a list: clients of ours count with such."""
    if isinstance(value, list):
        return [_plain(each) for each in value]
    return value.item() if isinstance(value, np.generic) else value


class Request(Message):
    """A question: without a field that was meant it would be another one."""

    model_config = ConfigDict(strict=True)

    @model_validator(mode="before")
    @classmethod
    def _spells_what_it_means(cls, said: object) -> object:
        """No field is left out because its name is misspelled."""
        fields = said if isinstance(said, dict) else {}
        missing = [name for name in cls.model_fields if name not in fields]
        for name in (str(each) for each in fields if each not in cls.model_fields):
            if near := meant(name.lower(), missing):
                raise ValueError(f"no field '{name[:80]}'; did you mean '{near}'?")
        return {name: _plain(value) for name, value in said.items()} if isinstance(said, dict) else said


class Stated(Request):
    """A question about the kitchen in a state.

    Attributes:
        state: `JOINT=VALUE` texts as for `sdt --state`, on top of the present state of the server's kitchen.
    """

    state: list[str] = Field(default_factory=list, max_length=1000)


class Classed(Stated):
    """A question relative to a class D.

    Attributes:
        tee: Kinematics alone, or with forces that push back.
        handle_force: [N] Allowed at the handle, for d_artic_dyn; None: what the kitchen's force data say.
    """

    tee: TeeName = "d_artic"
    handle_force: float | None = Field(default=None, gt=0, le=10_000, allow_inf_nan=False)

    @property
    def relative(self) -> Relative:
        """The class that is named.

        Raises:
            InputError: Forces for a class that knows none.
        """
        return Relative(self.tee, handle_force=self.handle_force)


class QueryRequest(Request):
    """SPARQL over everything that the server holds: twins, states, verdicts.

    The reply is what SPARQL 1.1 says: results as JSON for SELECT and ASK, N-Triples for a graph.
    """

    query: str = Field(max_length=200_000)


class SatisfiesRequest(Stated):
    """Which requests does the state meet?"""


MOTION: Final = "motion"
"""The field of a request; what is wrong with what it has is said to be from there."""


class CausesRequest(Classed):
    """Does the motion cause the task, or which motion would? No robot.

    Attributes:
        motion: Arrays as in a motion file, by name; None: make one.
    """

    task: str = Field(max_length=500)
    motion: dict[str, Any] | None = None


class Searched(Stated):
    """A question about a robot, for whose answer is searched.

    Attributes:
        robot: Name; may be left out where the server has one. Of an achieve or a grid: without it, every
            robot.
        friction: Coefficient with which fingers rub on handles [1]: holds that need more are refused; None:
            the verdict says what its holds need.
        budget: [s] Of search for each container, or world.
    """

    robot: str | None = Field(default=None, max_length=500)
    friction: Friction | None = None
    budget: float = Field(default=20.0, gt=0, le=3600)
    seed: Seed = 0


class Performed(Classed, Searched):
    """A question about a robot, under a policy.

    Attributes:
        drive: None is the robot's own.
        base: Start pose x, y [m], yaw [rad].
        quads: Whether the reply carries what is kept as N-Quads.
    """

    drive: DriveName | None = None
    base: BasePose | None = None
    quads: bool = False


class AchieveRequest(Performed):
    """CanAchieve, or CanPerform alone.

    Attributes:
        motions: Whether the reply carries the certified body motions.
        any_start: Whether a robot's motion that is given may begin anywhere, in any posture.
        contact: How far a finger may be from the handle that it holds [m]; None: 0.002, and no more.
        single: Whether what several verdicts would answer is refused, before any is judged.
    """

    task: str = Field(max_length=500)
    motion: dict[str, Any] | None = None
    motions: bool = False
    any_start: bool = False
    contact: Contact | None = None
    single: bool = False


class TaskRequest(Performed):
    """Steps, rules that hold along the way, the best motion by J.

    Attributes:
        task: Name of a ready task, or one written in Turtle.
    """

    task: str = Field(max_length=200_000)


class PlaceRequest(Searched):
    """Where may the base stand, so that the task is certified without moving it?"""

    task: str = Field(max_length=500)


class WhatIfRequest(Performed):
    """Would the robot achieve the task if things were otherwise?

    Attributes:
        task: Of one container; of a grid also `open` (every container) or `open:CONTAINER,CONTAINER`.
        edits: As `sdt whatif --edit` takes them; none may name a file.
        turn: Whether the smallest share of them is searched at which the outcome turns; without edits, the
            smallest change of every kind that is looked at.
        grid: Whether each edit is an axis of alternatives (`A | B`), and every combination is judged.
        within: [s] Of CPU for a turn without edits; None: 30.
    """

    task: str = Field(max_length=500)
    edits: list[Edit] = Field(default_factory=list, max_length=20)
    turn: bool = False
    grid: bool = False
    within: float | None = Field(default=None, ge=1, le=3600)


class ComputeRequest(Request):
    """What a query can touch and nobody has judged is judged, within bounds; then it can be asked.

    Attributes:
        drive, friction: As of an achieve, for what is judged.
        budget: [s] In all.
        limit: Cases.
    """

    query: str = Field(max_length=200_000)
    drive: DriveName | None = None
    friction: Friction | None = None
    budget: float = Field(default=60.0, gt=0, le=600)
    limit: int = Field(default=20, ge=1, le=1000)


class WhyRequest(Request):
    """A stored verdict in plain words."""

    iri: str = Field(max_length=500)


class SweepRequest(Classed):
    """A job: CanAchieve for every combination of robots, tasks, start states, drives and seeds.

    Attributes:
        verb: open or close, of every container.
        tasks: `open`, `close` or `open:CONTAINER`; empty: the verb.
        robots: Names; empty: all of the server.
        starts: Start states, each after `state`; empty: `state` alone.
        drives: Empty: `drive`, or each robot's own.
        seeds: Of the search.
        friction: As of an achieve.
    """

    verb: Literal["open", "close"] = "open"
    tasks: list[str] = Field(default_factory=list, max_length=1000)
    robots: list[str] = Field(default_factory=list, max_length=100)
    starts: list[list[str]] = Field(default_factory=list, max_length=1000)
    drives: list[DriveName] = Field(default_factory=list, max_length=3)
    seeds: list[Seed] = Field(default_factory=lambda: [0], min_length=1, max_length=1000)
    drive: DriveName | None = None
    friction: Friction | None = None
    budget: float = Field(default=20.0, gt=0, le=3600)


class HistoryRequest(Request):
    """Events that were published after one that the asker has seen.

    Attributes:
        after: Its sequence number; 0: from the oldest that is kept.
        epoch: Of the reply from which that number is; empty: not known.
        limit: Events in one reply.
    """

    kind: Literal["verdict", "state"] = "verdict"
    after: int = Field(default=0, ge=0)
    epoch: str = Field(default="", max_length=64)
    limit: int = Field(default=100, ge=1, le=1000)


REQUESTS: dict[Verb, type[Message]] = {
    Verb.SELECT: QueryRequest,
    Verb.ASK: QueryRequest,
    Verb.CONSTRUCT: QueryRequest,
    Verb.DESCRIBE: QueryRequest,
    Verb.SATISFIES: SatisfiesRequest,
    Verb.CAUSES: CausesRequest,
    Verb.CANPERFORM: AchieveRequest,
    Verb.CANACHIEVE: AchieveRequest,
    Verb.WHY: WhyRequest,
    Verb.PLACE: PlaceRequest,
    Verb.WHATIF: WhatIfRequest,
    Verb.TASK: TaskRequest,
    Verb.COMPUTE: ComputeRequest,
    Verb.SWEEP: SweepRequest,
    Verb.HISTORY: HistoryRequest,
}
