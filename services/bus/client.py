"""The client: a twin on the bus, its verbs with typed replies and typed errors."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Never, TypeVar

import pyoxigraph as ox
import zenoh

from predicates.record import StoredVerdict, read_verdicts
from sdt_kg.errors import NoTruthError
from sdt_kg.store import Row, rows_of
from services.bus import keys
from services.bus.asking import LIVE_TIMEOUT, Question, asked, present
from services.bus.keys import Meta, Part
from services.bus.sessions import open_session
from services.judging.codec import CBOR, JSON, arrays_of, decode, encode, encode_cbor, message_of
from services.judging.messages import (
    AchieveRequest,
    CausesRequest,
    HistoryRequest,
    Message,
    PlaceRequest,
    QueryRequest,
    SatisfiesRequest,
    SweepRequest,
    TaskRequest,
    Verb,
    WhatIfRequest,
    WhyRequest,
)
from services.judging.replies import (
    CausesReply,
    HistoryReply,
    JobReply,
    MetRequest,
    PlaceReply,
    Reply,
    SatisfiesReply,
    TaskReply,
    TextReply,
    VerdictsReply,
    WhatIfReply,
)

R = TypeVar("R", bound=Reply)


@dataclass(frozen=True, slots=True)
class Verdicts:
    """What canachieve said.

    Attributes:
        objects: As `sdt achieve --json` prints them.
        stored: The same as values, read from the triples.
        instance: The server that answered.
        motions: Γ of each, where `motions=True` asked for it and it was certified: arrays as in a file.
    """

    objects: tuple[dict[str, Any], ...]
    stored: tuple[StoredVerdict, ...]
    instance: str
    motions: tuple[Mapping[str, Any] | None, ...] = ()

    def __bool__(self) -> Never:
        """They may have several outcomes."""
        raise NoTruthError("verdicts", "look at each one's outcome: each['outcome'] == 'certified', say")


@dataclass(frozen=True, slots=True)
class Connection:
    """A twin on the bus, asked with names as people type them.

    Attributes:
        session: Closed by whoever opened it.
        twin: Name of the kitchen.
        deadline: [s] For each question.
    """

    session: zenoh.Session
    twin: str
    deadline: float = 60.0

    def select(self, query: str) -> tuple[list[str], list[Row]]:
        """Columns and rows of a SELECT."""
        payload, _ = self._asked(Verb.SELECT, QueryRequest(query=query))
        solutions = ox.parse_query_results(payload, format=ox.QueryResultsFormat.JSON)
        return rows_of(solutions)

    def ask(self, query: str) -> bool:
        """Whether the pattern of an ASK is there."""
        payload, _ = self._asked(Verb.ASK, QueryRequest(query=query))
        return bool(ox.parse_query_results(payload, format=ox.QueryResultsFormat.JSON))

    def construct(self, query: str) -> list[ox.Triple]:
        """Triples of a CONSTRUCT or DESCRIBE."""
        payload, _ = self._asked(Verb.CONSTRUCT, QueryRequest(query=query))
        quads = ox.parse(payload, format=ox.RdfFormat.N_TRIPLES)
        return [ox.Triple(quad.subject, quad.predicate, quad.object) for quad in quads]

    def satisfies(self, *state: str) -> tuple[MetRequest, ...]:
        """Every request that the state meets."""
        request = SatisfiesRequest(state=list(state))
        return tuple(self._typed(Verb.SATISFIES, request, SatisfiesReply)[0].requests)

    def causes(
        self,
        task: str,
        *state: str,
        motion: Mapping[str, object] | None = None,
        **relative: Any,  # noqa: ANN401 - fields of CausesRequest, checked there
    ) -> CausesReply:
        """Motions that would cause the task, or whether the given one does; no robot (tee, handle_force)."""
        asked = {"task": task, "state": list(state), "motion": arrays_of(motion), **relative}
        request = message_of(CausesRequest, asked)
        return self._typed(Verb.CAUSES, request, CausesReply, CBOR)[0]

    def achieve(
        self,
        task: str,
        robot: str | None = None,
        *state: str,
        motion: Mapping[str, object] | None = None,
        **policy: Any,  # noqa: ANN401 - fields of AchieveRequest, checked there
    ) -> Verdicts:
        """CanAchieve: one verdict for each container that the task is about.

        Args:
            task: `open:CONTAINER` and so on.
            robot: Name; may be left out where the server has one.
            state: `JOINT=VALUE` texts.
            motion: Arrays as in a motion file (`services.motions.read_arrays` reads them), to be verified;
                made where it is None.
            policy: drive, base, friction, any_start, contact, budget, seed, tee, handle_force, motions,
                single.

        Raises:
            InputError: A field that is none, or wrong.
        """
        about = {"task": task, "robot": robot, "state": list(state), "motion": arrays_of(motion)}
        request = message_of(AchieveRequest, about | {"quads": True} | policy)
        reply, instance = self._typed(Verb.CANACHIEVE, request, VerdictsReply, CBOR)
        store = ox.Store()
        store.load((reply.quads or "").encode(), format=ox.RdfFormat.N_QUADS)
        motions = tuple(reply.motions or ())
        return Verdicts(tuple(reply.verdicts), tuple(read_verdicts(store)), instance, motions)

    def why(self, iri: str) -> str:
        """A kept verdict in plain words; the beginning of its hash will do for its IRI."""
        return self.story(iri).text

    def story(self, iri: str) -> TextReply:
        """The same, and part by part."""
        return self._typed(Verb.WHY, WhyRequest(iri=iri), TextReply)[0]

    def place(self, task: str, robot: str | None = None, *state: str, **search: Any) -> dict[str, Any]:  # noqa: ANN401 - fields of PlaceRequest
        """Where the base may stand for a task: the object of `sdt place --json` (budget, seed, friction)."""
        asked = {"task": task, "robot": robot, "state": list(state), **search}
        request = message_of(PlaceRequest, asked)
        return self._typed(Verb.PLACE, request, PlaceReply)[0].placement

    def whatif(
        self,
        task: str,
        edits: Sequence[str] = (),
        robot: str | None = None,
        *state: str,
        **policy: Any,  # noqa: ANN401 - fields of WhatIfRequest, checked there
    ) -> dict[str, Any]:
        """The same question in another world, and what turns: the object of `sdt whatif --json`.

        Args:
            task: `open:CONTAINER` or `close:CONTAINER`.
            edits: As `sdt whatif --edit` takes them; none may name a file. Without: turn is of any change.
            robot: Name; may be left out where the server has one; a grid is then about all.
            state: `JOINT=VALUE` texts.
            policy: turn, grid, within, drive, base, friction, budget, seed, tee, handle_force.
        """
        asked = {"task": task, "edits": list(edits), "robot": robot, "state": list(state), **policy}
        request = message_of(WhatIfRequest, asked)
        return self._typed(Verb.WHATIF, request, WhatIfReply)[0].answer

    def task(self, task: str, robot: str | None = None, *state: str, **policy: Any) -> dict[str, Any]:  # noqa: ANN401 - fields of TaskRequest
        """What becomes of a task with steps and rules: the object of `sdt task --json`.

        Args:
            task: Name of a ready task, or one in Turtle.
            robot: Name; may be left out where the server has one.
            state: `JOINT=VALUE` texts.
            policy: drive, base, friction, budget, seed, tee, handle_force.
        """
        asked = {"task": task, "robot": robot, "state": list(state), **policy}
        request = message_of(TaskRequest, asked)
        return self._typed(Verb.TASK, request, TaskReply)[0].result

    def history(
        self, kind: str = "verdict", after: int = 0, epoch: str = "", limit: int = 100, instance: str = ""
    ) -> HistoryReply:
        """Events of `verdict` or `state` after a sequence number; a gap is told.

        Args:
            kind: verdict or state.
            after: Number of the last event that is known.
            epoch: Of that number, as the publication or an earlier reply said.
            limit: Events in the reply.
            instance: The server whose numbers are meant; empty: any.
        """
        fields = {"kind": kind, "after": after, "epoch": epoch, "limit": limit}
        request = message_of(HistoryRequest, fields)
        return self._typed(Verb.HISTORY, request, HistoryReply, instance=instance)[0]

    def sweep(self, verb: str = "open", *state: str, **policy: Any) -> JobReply:  # noqa: ANN401 - fields of SweepRequest
        """A job that judges every container for every robot (or `robots=[...]`)."""
        request = message_of(SweepRequest, {"verb": verb, "state": list(state), **policy})
        return self._typed(Verb.SWEEP, request, JobReply)[0]

    def progress(self, job: str) -> JobReply:
        """How far a job is."""
        return decode(JobReply, self._told(job, Part.PROGRESS))

    def result(self, job: str) -> dict[str, Any]:
        """`{job, state, verdicts, problems}` of a job, so far."""
        return decode(_Anything, self._told(job, Part.RESULT)).model_extra or {}

    def cancel(self, job: str) -> JobReply:
        """The job stops; what it has found stays."""
        return decode(JobReply, self._told(job, Part.CANCEL))

    def _told(self, job: str, part: Part) -> bytes:
        question = Question(keys.job(self.twin, job, part), only=keys.server_of(job))
        return asked(self.session, self.twin, self.deadline, question)[0]

    def health(self) -> list[dict[str, Any]]:
        """What each server of the twin says of itself."""
        return self._each(Meta.HEALTH)

    def metrics(self) -> list[dict[str, Any]]:
        """Counters of each server, by Prometheus' names and labels; `/metrics` has the latencies too."""
        return self._each(Meta.METRICS)

    def _each(self, part: Meta) -> list[dict[str, Any]]:
        replies = self.session.get(
            keys.meta(self.twin, part),
            timeout=LIVE_TIMEOUT,
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
        )
        return [
            decode(_Anything, reply.ok.payload.to_bytes()).model_extra or {} for reply in replies if reply.ok
        ]

    def servers(self) -> list[str]:
        """Instances that are there now."""
        return present(self.session, keys.any_live(self.twin))

    def _typed(
        self, verb: Verb, request: Message, kind: type[R], encoding: str = JSON, instance: str = ""
    ) -> tuple[R, str]:
        payload, who = self._asked(verb, request, encoding, instance)
        return decode(kind, payload, encoding), who

    def _asked(
        self, verb: Verb, request: Message, encoding: str = JSON, instance: str = ""
    ) -> tuple[bytes, str]:
        payload = encode_cbor(request) if encoding == CBOR else encode(request)
        question = Question(keys.rpc(self.twin, verb, instance), payload, encoding, instance)
        return asked(self.session, self.twin, self.deadline, question)


class _Anything(Message, extra="allow"):
    """Whatever a server says of itself."""


@contextmanager
def connect(
    twin: str, endpoint: str = "tcp/127.0.0.1:7447", *, deadline: float = 60.0, config: Path | None = None
) -> Iterator[Connection]:
    """A twin on the bus at an endpoint.

    Raises:
        BusUnavailableError: Nobody listens there.
    """
    session = open_session(connect=endpoint, mode="client", config=config)
    try:
        yield Connection(session, twin, deadline)
    finally:
        session.close()
