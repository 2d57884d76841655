"""One question over the bus: silence is never taken for an answer."""

import time
import uuid
from dataclasses import dataclass

import zenoh

from services.bus import keys
from services.bus.replies import problem_in
from services.judging.codec import CBOR, encode, encode_cbor
from services.judging.messages import Header, Message, Verb
from services.judging.problems import BusUnavailableError, Problem, ProblemType, error_of, problem

RETRIES = 3
"""How often a question is asked again that got no reply although a server is there."""
RETRY_AFTER = 0.1
"""[s] Before the first repeat; doubled each time."""
LIVE_TIMEOUT = 1.0
"""[s] For the question whether a server is there."""
MARGIN = 0.05
"""[s] The client waits so much longer than the deadline that it tells the server, which knows more."""


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked, and in which encoding."""

    verb: Verb
    request: Message
    encoding: str


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
        BusError, InputError: What the server says.
    """
    until = time.monotonic() + deadline
    pause, said = RETRY_AFTER, "nobody is there"
    for _ in range(RETRIES + 1):
        left = until - time.monotonic()
        if left <= 0:
            break
        reply = _once(session, twin, question, left)
        if isinstance(reply, tuple):
            return reply
        if reply is not None and not (reply.kind is ProblemType.UNAVAILABLE and reply.retry_after):
            raise error_of(reply)
        left = until - time.monotonic()
        if left <= 0:
            raise error_of(reply or problem(ProblemType.DEADLINE, "no reply came in time"))
        if reply is None and not servers(session, twin, min(left, LIVE_TIMEOUT)):
            said = f"no server of '{twin}' is on the bus"
        else:
            said = "no reply" if reply is None else reply.detail
        wait = pause if reply is None else reply.retry_after or pause
        time.sleep(max(0.0, min(wait, until - time.monotonic())))
        pause *= 2
    raise BusUnavailableError(problem(ProblemType.UNAVAILABLE, said))


def servers(session: zenoh.Session, twin: str, seconds: float = LIVE_TIMEOUT) -> list[str]:
    """Instances that are there now."""
    tokens = session.liveliness().get(keys.any_live(twin), timeout=seconds)
    return sorted(keys.instance_of(str(each.ok.key_expr)) for each in tokens if each.ok)


def _once(
    session: zenoh.Session, twin: str, question: Question, left: float
) -> tuple[bytes, str] | Problem | None:
    """One try: reply and responder, what went wrong, or None for silence."""
    header = Header(id=uuid.uuid4().hex, deadline_ms=max(1, int(left * 1000)))
    written = encode_cbor if question.encoding == CBOR else encode
    replies = session.get(
        keys.rpc(twin, question.verb),
        payload=written(question.request),
        encoding=question.encoding,
        attachment=encode(header),
        timeout=left + MARGIN,
        consolidation=zenoh.ConsolidationMode.NONE,
        accept_replies=zenoh.ReplyKeyExpr.ANY,
    )
    for reply in replies:
        if reply.ok is not None:
            return reply.ok.payload.to_bytes(), keys.instance_of(str(reply.ok.key_expr))
        if reply.err is not None:
            return problem_in(reply.err)
    return None
