"""Bytes ↔ values of the bus; no I/O.

A payload is JSON, or CBOR where the encoding says so; in CBOR, arrays may be RFC 8746 typed arrays
(tag 86, little-endian float64; tag 40 around it for more than one dimension). Unknown fields are
tolerated, an unknown major version of the schema is refused. The attachment is optional.
"""

import json
from typing import Any, Literal, TypeVar

import cbor2
import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sdt_kg.errors import InputError
from services.bus.keys import Verb

SCHEMA = "1.0"
M = TypeVar("M", bound="Message")

JSON, CBOR = "application/json", "application/cbor"
MAX_REQUEST = 16 * 2**20
"""[bytes] A body motion of 10,000 samples and 50 joints is 4 MB."""
MAX_REPLY = 64 * 2**20
"""[bytes] Rows of a query, verdicts with their quads."""
MAX_CELLS = 4_000_000
"""Numbers in one array."""

_MULTI_DIMENSIONAL, _FLOAT64_LE = 40, 86


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
        state: `JOINT=VALUE` texts as for `sdt --state`; empty is everything closed.
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
        robot: Name; may be left out where the server has one.
        drive: None is the robot's own.
        base: Start pose x, y [m], yaw [rad].
        budget: [s] Of search for each container.
        quads: Whether the reply carries the verdicts as N-Quads.
        motions: Whether it carries the certified body motions.
    """

    task: str = Field(max_length=500)
    robot: str | None = Field(default=None, max_length=500)
    motion: dict[str, Any] | None = None
    drive: Literal["omni", "differential", "fixed"] | None = None
    base: tuple[float, float, float] | None = None
    budget: float = Field(default=20.0, gt=0, le=3600)
    seed: int = 0
    quads: bool = False
    motions: bool = False


class WhyRequest(Message):
    """A stored verdict in plain words."""

    iri: str = Field(max_length=500)


class SweepRequest(Stated):
    """A job: CanAchieve for every container and robot.

    Attributes:
        verb: open or close.
        robots: Names; empty: all of the server.
    """

    verb: Literal["open", "close"] = "open"
    robots: list[str] = Field(default_factory=list, max_length=100)
    drive: Literal["omni", "differential", "fixed"] | None = None
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
        motions: τ where it holds: joint, times [s], values [rad or m].
    """

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
    Verb.SWEEP: SweepRequest,
}
REPLIES: dict[Verb, type[Reply]] = {  # the queries' replies are SPARQL's own
    Verb.SATISFIES: SatisfiesReply,
    Verb.CAUSES: CausesReply,
    Verb.CANPERFORM: VerdictsReply,
    Verb.CANACHIEVE: VerdictsReply,
    Verb.WHY: TextReply,
    Verb.SWEEP: JobReply,
}


def encode(message: BaseModel) -> bytes:
    """The message as JSON."""
    return message.model_dump_json(by_alias=True).encode()


def encode_cbor(message: BaseModel) -> bytes:
    """The message as CBOR; arrays as typed arrays."""
    return to_cbor(message.model_dump(by_alias=True))


def to_cbor(value: object) -> bytes:
    """Plain values and float64 arrays as CBOR."""
    return cbor2.dumps(value, default=_array_to_cbor)


def decode(kind: type[M], payload: bytes, encoding: str = JSON) -> M:
    """The message in a payload.

    Raises:
        InputError: No JSON or CBOR, a field is missing or wrong, or another major version.
    """
    if len(payload) > MAX_REPLY:
        raise InputError(f"a message of {len(payload)} bytes", allowed=f"at most {MAX_REPLY}")
    raw = from_cbor(payload) if encoding == CBOR else _from_json(payload)
    if not isinstance(raw, dict):
        raise InputError(f"the message is a {type(raw).__name__}", allowed="an object with named fields")
    version = str(raw.get("schema", SCHEMA))
    if version.partition(".")[0] != SCHEMA.partition(".")[0]:
        raise InputError(f"the message has the schema {version}", allowed=SCHEMA)
    try:
        return kind.model_validate(raw)
    except ValidationError as error:
        wrong = error.errors(include_url=False, include_input=False, include_context=False)
        first = wrong[0]
        where = ".".join(str(each) for each in first["loc"])
        more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
        raise InputError(f"'{where}' of {kind.__name__}: {first['msg']}{more}") from None


def _from_json(payload: bytes) -> object:
    try:
        return json.loads(payload or b"{}", parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise InputError(f"the payload is no JSON: {error}", allowed=f"{JSON} or {CBOR}") from None


def _no_constant(name: str) -> None:
    raise ValueError(f"{name} is not JSON")


def from_cbor(payload: bytes) -> Any:  # noqa: ANN401 - what CBOR carries
    """Plain values and float64 arrays.

    Raises:
        InputError: The bytes are no CBOR, or have a tag that is not ours.
    """
    try:
        return cbor2.loads(payload, tag_hook=_array_from_cbor)
    except (cbor2.CBORError, ValueError, RecursionError) as error:
        raise InputError(f"the payload is no CBOR: {error}", allowed=f"{JSON} or {CBOR}") from None


def _array_to_cbor(encoder: Any, value: object) -> None:  # noqa: ANN401 - cbor2's encoder has no public protocol
    if not isinstance(value, np.ndarray):
        raise TypeError(f"a {type(value).__name__} in a message")
    flat = cbor2.CBORTag(_FLOAT64_LE, np.ascontiguousarray(value, dtype="<f8").tobytes())
    encoder.encode(flat if value.ndim == 1 else cbor2.CBORTag(_MULTI_DIMENSIONAL, [list(value.shape), flat]))


def _array_from_cbor(tag: cbor2.CBORTag, immutable: bool = False) -> object:
    del immutable
    if tag.tag == _FLOAT64_LE and isinstance(tag.value, bytes):
        return np.frombuffer(tag.value, dtype="<f8") if tag.value else np.zeros(0)
    if tag.tag == _MULTI_DIMENSIONAL:
        shape, flat = tag.value
        if isinstance(flat, np.ndarray) and int(np.prod(shape)) == flat.size <= MAX_CELLS:
            return flat.reshape(tuple(int(each) for each in shape))
    raise ValueError(f"tag {tag.tag} is not a float64 array")
