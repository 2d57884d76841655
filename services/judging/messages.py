"""What can be asked, and what is answered: the same over Zenoh and over HTTP.

Unknown fields are tolerated, an unknown major version of the schema is refused.
"""

from enum import Enum
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

SCHEMA = "1.0"
DriveName = Literal["omni", "differential", "fixed"]


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
    COMPUTE = "compute"
    SWEEP = "sweep"


class Message(BaseModel):
    """What all messages share."""

    model_config = ConfigDict(extra="ignore", populate_by_name=True)

    version: str = Field(default=SCHEMA, alias="schema")


class Header(Message):
    """The attachment of a question.

    Attributes:
        id: Of the request, repeated in logs and replies.
        deadline_ms: After which nobody waits any more, counted from when the server receives it.
        traceparent: W3C trace context, passed on as it is.
    """

    id: str = Field(default="", max_length=128)
    deadline_ms: int = Field(default=60_000, ge=1, le=86_400_000)
    traceparent: str = Field(default="", max_length=256)


class Stated(Message):
    """A question about the kitchen in a state.

    Attributes:
        state: `JOINT=VALUE` texts as for `sdt --state`, on top of the present state of the server's kitchen.
    """

    state: list[str] = Field(default_factory=list, max_length=1000)


class QueryRequest(Message):
    """SPARQL over everything that the server holds: twins, states, verdicts.

    The reply is what SPARQL 1.1 says: results as JSON for SELECT and ASK, N-Triples for a graph.
    """

    query: str = Field(max_length=200_000)


class SatisfiesRequest(Stated):
    """Which requests does the state meet?"""


class CausesRequest(Stated):
    """Does the motion cause the task, or which motion would? No robot.

    Attributes:
        motion: Arrays as in a motion file, by name; None: make one.
    """

    task: str = Field(max_length=500)
    motion: dict[str, Any] | None = None


class AchieveRequest(Stated):
    """CanAchieve, or CanPerform alone.

    Attributes:
        robot: Name; without it, every robot of the server.
        drive: None is the robot's own.
        base: Start pose x, y [m], yaw [rad].
        budget: [s] Of search for each container.
        quads: Whether the reply carries the verdicts as N-Quads.
        motions: Whether it carries the certified body motions.
    """

    task: str = Field(max_length=500)
    robot: str | None = Field(default=None, max_length=500)
    motion: dict[str, Any] | None = None
    drive: DriveName | None = None
    base: tuple[float, float, float] | None = None
    budget: float = Field(default=20.0, gt=0, le=3600)
    seed: int = 0
    quads: bool = False
    motions: bool = False


class PlaceRequest(Stated):
    """Where may the base stand, so that the task is certified without moving it?

    Attributes:
        robot: Name; may be left out where the server has one.
        budget: [s] Of search.
    """

    task: str = Field(max_length=500)
    robot: str | None = Field(default=None, max_length=500)
    budget: float = Field(default=20.0, gt=0, le=3600)
    seed: int = 0


class ComputeRequest(Message):
    """What a query can touch and nobody has judged is judged, within bounds; then it can be asked.

    Attributes:
        budget: [s] In all.
        limit: Cases.
    """

    query: str = Field(max_length=200_000)
    budget: float = Field(default=60.0, gt=0, le=600)
    limit: int = Field(default=20, ge=1, le=1000)


class WhyRequest(Message):
    """A stored verdict in plain words."""

    iri: str = Field(max_length=500)


class SweepRequest(Stated):
    """A job: CanAchieve for every combination of robots, tasks, start states, drives and seeds.

    Attributes:
        verb: open or close, of every container.
        tasks: `open`, `close` or `open:CONTAINER`; empty: the verb.
        robots: Names; empty: all of the server.
        starts: Start states, each after `state`; empty: `state` alone.
        drives: Empty: `drive`, or each robot's own.
        seeds: Of the search.
    """

    verb: Literal["open", "close"] = "open"
    tasks: list[str] = Field(default_factory=list, max_length=1000)
    robots: list[str] = Field(default_factory=list, max_length=100)
    starts: list[list[str]] = Field(default_factory=list, max_length=1000)
    drives: list[DriveName] = Field(default_factory=list, max_length=3)
    seeds: list[int] = Field(default_factory=lambda: [0], min_length=1, max_length=1000)
    drive: DriveName | None = None
    budget: float = Field(default=20.0, gt=0, le=3600)


class Reply(Message):
    """What all replies share: which server answered."""

    instance: str = ""


class MetRequest(BaseModel):
    """A request that a state meets."""

    verb: str
    container: str


class SatisfiesReply(Reply):
    """Of satisfies."""

    requests: list[MetRequest]


class CausesReply(Reply):
    """Of causes: one answer for each motion.

    Attributes:
        tasks: What each answer is about; the container as an IRI.
        motions: τ where it holds: joint, times [s], values [rad or m].
    """

    tasks: list[MetRequest | None] = Field(default_factory=list)
    holds: list[bool]
    diagnoses: list[list[dict[str, Any]]]
    motions: list[dict[str, Any] | None]


class VerdictsReply(Reply):
    """Of canachieve and canperform: the objects of `sdt achieve --json`.

    Attributes:
        quads: The verdicts as N-Quads, where asked for.
        motions: Γ of each verdict, where asked for and certified: arrays as in a motion file.
    """

    verdicts: list[dict[str, Any]]
    quads: str | None = None
    motions: list[dict[str, Any] | None] | None = None


class PlaceReply(Reply):
    """Of place: the object of `sdt place --json`."""

    placement: dict[str, Any]


class ComputeReply(Reply):
    """Of compute.

    Attributes:
        computed: What was judged, and what was left out and why.
    """

    computed: dict[str, Any]


class TextReply(Reply):
    """Of why."""

    text: str


class JobReply(Reply):
    """Of sweep, and of progress.

    Attributes:
        state: queued, running, done, cancelled or failed.
    """

    job: str
    state: Literal["queued", "running", "done", "cancelled", "failed"]
    done: int = 0
    total: int = 0


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
    Verb.COMPUTE: ComputeRequest,
    Verb.SWEEP: SweepRequest,
}
REPLIES: dict[Verb, type[Reply]] = {  # the queries' replies are SPARQL's own
    Verb.SATISFIES: SatisfiesReply,
    Verb.CAUSES: CausesReply,
    Verb.CANPERFORM: VerdictsReply,
    Verb.CANACHIEVE: VerdictsReply,
    Verb.WHY: TextReply,
    Verb.PLACE: PlaceReply,
    Verb.COMPUTE: ComputeReply,
    Verb.SWEEP: JobReply,
}
