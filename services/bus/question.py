"""A Zenoh query that is to be answered once: understood, counted, logged and traced."""

import logging
import time
import uuid
from dataclasses import dataclass, field, replace

import zenoh

from sdt_kg.errors import SdtError
from services.bus import keys
from services.bus.asking import Header
from services.judging.codec import CBOR, JSON, MAX_REPLY, MAX_REQUEST, decode
from services.judging.problems import Problem, ProblemType, TooLargeError, problem, problem_of
from services.judging.workers.jobs import Done, Waiter
from services.telemetry.origin import Origin, within
from services.telemetry.spans import Span
from services.telemetry.told import Telemetry

log = logging.getLogger(__name__)

MOST_ATTACHED = 2**16
"""[bytes] Of an attachment."""
OTHER = "other"
"""What is counted of a key that names no verb."""


@dataclass(frozen=True, slots=True)
class Question:
    """Who asks what, and since when.

    Attributes:
        what: The verb, or another part of the key space, as it is counted.
        header: With an id, the asker's or one of ours: the log and a problem name it.
        reply_key: Of the answer.
    """

    query: zenoh.Query
    twin: str
    what: str
    header: Header
    reply_key: str
    telemetry: Telemetry
    span: Span
    began: float = field(default_factory=time.monotonic)

    @property
    def payload(self) -> bytes:
        """What was sent.

        Raises:
            TooLargeError: More than may be.
        """
        return b"" if self.query.payload is None else bounded(self.query.payload)

    @property
    def encoding(self) -> str:
        """Of what was sent, and of the answer."""
        return CBOR if str(self.query.encoding or JSON).startswith(CBOR) else JSON

    @property
    def seconds(self) -> float:
        """After which nobody waits [s]."""
        return self.header.deadline_ms / 1000

    @property
    def origin(self) -> Origin:
        """For what is done because of it."""
        return Origin(self.header.id, self.span.traceparent)

    def waiter(self) -> Waiter:
        """Who waits for the answer."""
        return Waiter(self.began + self.seconds, self.answer)

    def answer(self, outcome: Done | Problem) -> None:
        """Reply, and let the asker know that this was all."""
        if isinstance(outcome, Done) and len(outcome.payload) > MAX_REPLY:
            outcome = problem(ProblemType.TOO_LARGE, f"the answer has {len(outcome.payload)} bytes")
        if isinstance(outcome, Problem):
            outcome = outcome.model_copy(update={"report": self.header.id})
        seconds = time.monotonic() - self.began
        end = outcome.kind.value if isinstance(outcome, Problem) else "answer"
        self.telemetry.metrics.asked("bus", self.what, end, seconds)  # who has the answer finds it counted
        reply(self.query, self.reply_key, outcome)
        self.span.end(end=end)
        if log.isEnabledFor(logging.INFO):
            fields = {"twin": self.twin, "verb": self.what, "end": end, "seconds": round(seconds, 6)}
            detail = f": {outcome.detail}" if isinstance(outcome, Problem) else ""
            with within(self.origin):
                log.info("%s %s %s%s", self.twin, self.what, end, detail, extra={"fields": fields})


def reply(query: zenoh.Query, key: str, outcome: Done | Problem) -> None:
    """The reply or the error is sent under the key, and the query is over."""
    with query:
        try:
            if isinstance(outcome, Done):
                query.reply(key, outcome.payload, encoding=outcome.encoding)
            else:
                query.reply_err(outcome.model_dump_json().encode(), encoding=JSON)
        except zenoh.ZError as error:  # the asker has gone
            log.info("nobody took the reply under %s: %s", key, error)


def bounded(payload: zenoh.ZBytes, most: int = MAX_REQUEST) -> bytes:
    """What was sent.

    Raises:
        TooLargeError: More than may be.
    """
    if len(payload) > most:  # before it is copied
        said = f"the request has {len(payload)} bytes; at most {most}"
        raise TooLargeError(problem(ProblemType.TOO_LARGE, said))
    return payload.to_bytes()


def understood(
    query: zenoh.Query, twin: str, what: str, telemetry: Telemetry, instance: str
) -> Question | None:
    """The question; None: its key or attachment was none, and that was answered."""
    key = str(query.key_expr)
    named = query.accepts_replies() == zenoh.ReplyKeyExpr.ANY and not key.endswith(instance)
    reply_key = f"{key}/{instance}" if named else key
    error, header = None, Header()
    try:
        keys.check_one(key)
        if query.attachment is not None:
            header = decode(Header, bounded(query.attachment, MOST_ATTACHED))
    except SdtError as wrong:
        error = wrong
    if not header.id:
        header = header.model_copy(update={"id": uuid.uuid4().hex})
    span = telemetry.spans.begin(f"bus {what}", header.traceparent, twin=twin, request=header.id)
    question = Question(query, twin, what, header, reply_key, telemetry, span)
    if error is None:
        return question
    replace(question, reply_key=key).answer(problem_of(error))
    return None
