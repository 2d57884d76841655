"""One question over the bus: silence is never taken for an answer."""

import time
import uuid
from dataclasses import dataclass

import zenoh
from pydantic import ConfigDict, Field, ValidationError

from services.bus import keys
from services.bus.keys import Meta
from services.judging.codec import JSON, decode, encode
from services.judging.messages import Message
from services.judging.problems import Problem, ProblemType, error_of, problem
from services.judging.replies import VersionReply

RETRIES = 3
"""How often a question is asked again that got no reply, or that a server could not take just then."""
RETRY_AFTER = 0.1
"""[s] Before the first repeat; doubled each time."""
LIVE_TIMEOUT = 1.0
"""[s] For the question whether a server is there."""
MARGIN = 0.05
"""[s] The client waits so much longer than the deadline that it tells the server, which knows more."""
SMALL = 2**16
"""[bytes] A question of at most so many, one fragment of Zenoh's, does not wait behind larger ones."""


class Header(Message):
    """The attachment of a question.

    Attributes:
        id: Of the request, repeated in logs and replies.
        deadline_ms: After which nobody waits any more, counted from when the server receives it.
        traceparent: W3C trace context, passed on as it is.
    """

    model_config = ConfigDict(strict=True)

    id: str = Field(default="", max_length=128)
    deadline_ms: int = Field(default=60_000, ge=1, le=86_400_000)
    traceparent: str = Field(default="", max_length=256)


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked.

    Attributes:
        key: Of a verb, or of a part of a job.
        payload: In the encoding.
        only: The one server that can answer; empty: any.
    """

    key: str
    payload: bytes = b""
    encoding: str = JSON
    only: str = ""


def asked(session: zenoh.Session, twin: str, deadline: float, question: Question) -> tuple[bytes, str]:
    """Payload of the reply, and who answered.

    Args:
        session: Connected.
        twin: Name of the kitchen.
        deadline: [s] For the question and its repeats.
        question: Repeated only where nobody has answered, or a server says when to come back.

    Raises:
        BusUnavailableError: No server is there, or it stays silent.
        DeadlineError: There was no reply in time, whoever is to blame.
        ForbiddenError: A server tells of itself all the while, and this question never gets to it.
        BusError, InputError: What the server says.
    """
    until = time.monotonic() + deadline
    pause, deaf = RETRY_AFTER, list[set[str]]()
    for tries_left in reversed(range(RETRIES + 1)):
        reply = _once(session, question, until - time.monotonic())
        if isinstance(reply, tuple):
            return reply
        if reply is None and time.monotonic() >= until:
            reply = problem(ProblemType.DEADLINE, "no reply came in time")
        elif reply is None:
            reply, there = _silence(session, twin, question.only, until, pause)
            deaf.append(there)
        if not tries_left or not reply.retry_after or reply.retry_after >= until - time.monotonic():
            break
        time.sleep(reply.retry_after)
        pause *= 2
    if len(deaf) > RETRIES and (steady := set.intersection(*deaf)):
        reply = problem(
            ProblemType.FORBIDDEN,
            f"{', '.join(sorted(steady))} is there and never hears {question.key}: "
            "the access list of the router or server does not let this user ask it",
        )
    raise error_of(reply)


def present(session: zenoh.Session, tokens_at: str, seconds: float = LIVE_TIMEOUT) -> list[str]:
    """Instances of servers or oracles that are there now, by the key expression of their tokens."""
    tokens = session.liveliness().get(tokens_at, timeout=seconds)
    return sorted({keys.instance_of(str(each.ok.key_expr)) for each in tokens if each.ok})


def priority_of(payload: bytes | zenoh.ZBytes) -> zenoh.Priority:
    """Of a question and its reply: small ones overtake the fragments of large ones on a shared link."""
    return zenoh.Priority.INTERACTIVE_HIGH if len(payload) <= SMALL else zenoh.Priority.DATA


def problem_in(error: zenoh.ReplyError) -> Problem | None:
    """What the responder says; None where Zenoh itself says that time is up: that is no JSON."""
    if not str(error.encoding).startswith(JSON):
        return None
    try:
        return Problem.model_validate_json(error.payload.to_bytes())
    except ValidationError:
        return problem(ProblemType.INTERNAL, "the responder's error is not readable")


def _silence(
    session: zenoh.Session, twin: str, only: str, until: float, pause: float
) -> tuple[Problem, set[str]]:
    """What silence means as far as one can see, and who could have answered and tells of itself."""
    there = {each for each in present(session, keys.any_live(twin), _left(until)) if only in {"", each}}
    if not there:
        nobody = f"no server of '{twin}' is on the bus"
        said = f"{nobody} under the name '{only}'; its jobs have ended with it" if only else nobody
        return problem(ProblemType.UNAVAILABLE, said, retry_after=pause), set()
    said = f"{', '.join(sorted(there))} gave no reply"
    telling = _telling(session, twin, _left(until))
    return problem(ProblemType.UNAVAILABLE, said, retry_after=pause), there & telling


def _left(until: float) -> float:
    """[s] That may be spent on whether somebody is there, before the deadline."""
    return min(max(until - time.monotonic(), 0.001), LIVE_TIMEOUT)


def _telling(session: zenoh.Session, twin: str, seconds: float) -> set[str]:
    """Instances that say who they are when they are asked."""
    replies = session.get(
        keys.meta(twin, Meta.VERSION),
        timeout=seconds,
        target=zenoh.QueryTarget.ALL,
        consolidation=zenoh.ConsolidationMode.NONE,
    )
    return {decode(VersionReply, each.ok.payload.to_bytes()).instance for each in replies if each.ok}


def _once(session: zenoh.Session, question: Question, left: float) -> tuple[bytes, str] | Problem | None:
    """One try: reply and responder, what went wrong, or None for silence."""
    header = Header(id=uuid.uuid4().hex, deadline_ms=max(1, int(left * 1000)))
    replies = session.get(
        question.key,
        payload=question.payload,
        encoding=question.encoding,
        attachment=encode(header),
        timeout=max(left, 0.0) + MARGIN,
        priority=priority_of(question.payload),
        consolidation=zenoh.ConsolidationMode.NONE,
        accept_replies=zenoh.ReplyKeyExpr.ANY,
    )
    for reply in replies:
        if reply.ok is not None:
            return reply.ok.payload.to_bytes(), keys.instance_of(str(reply.ok.key_expr))
        if reply.err is not None:
            return problem_in(reply.err)
    return None
