"""The bus server: Zenoh queries in, replies out. Callbacks only enqueue."""

import json
import logging
import time
from asyncio import Future
from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from typing import Self

import zenoh

from sdt_kg.errors import InputError, SdtError
from services.bus import keys
from services.bus.history import Herald
from services.bus.keys import Meta, Part
from services.bus.question import OTHER, Question, reply, understood
from services.bus.schema import MEDIA, VOID, asyncapi
from services.bus.sweeps import Sweeps
from services.http.memory import Memory
from services.judging.codec import JSON, asked_in, encode
from services.judging.messages import SCHEMA, HistoryRequest, QueryRequest, SweepRequest, Verb
from services.judging.problems import Problem, ProblemType, problem, problem_of
from services.judging.queried import problem_of_query
from services.judging.workers.jobs import Done, Task, Waiter
from services.judging.workers.lane import GRACE
from services.judging.workers.pool import Pool
from services.store.workers import Answered, Asked

log = logging.getLogger(__name__)
_VERSION = version("sdt-kg")  # read once: it takes half a millisecond

COUNTING = 10.0
"""[s] What a server holds is counted in."""
ACCEPTED = {
    Verb.SELECT: ("application/sparql-results+json",),
    Verb.ASK: ("application/sparql-results+json",),
    Verb.CONSTRUCT: ("application/n-triples",),
    Verb.DESCRIBE: ("application/n-triples",),
}
"""Media types of the replies to queries."""


class Server:
    """One instance that answers for some twins until it is closed.

    Attributes:
        instance: Its name in keys of replies and liveliness tokens.
    """

    def __init__(
        self,
        session: zenoh.Session,
        pool: Pool,
        memory: Memory,
        sweeps: Sweeps,
    ) -> None:
        self._session, self._sweeps = session, sweeps
        self.instance, self._twins = sweeps.instance, tuple(sweeps.catalogue)
        self._pool, self._memory = pool, memory
        self._declared: list[zenoh.Queryable[None] | zenoh.LivelinessToken] = []
        self._herald: Herald | None = None
        self._began = time.monotonic()

    def start(self) -> Self:
        """Questions are answered from now on; the liveliness tokens come last."""
        self._herald = Herald(self._session, self.instance, self._memory, self._twins)
        for twin in self._twins:
            for tail in ("*", f"*/{self.instance}"):
                key = f"{keys.of_twin(twin)}/rpc/{tail}"
                # Called by Zenoh's own thread: handing over to one of Python's takes as long as the callback.
                asked = zenoh.handlers.Callback(partial(self._asked, twin), indirect=False)
                self._declared.append(self._session.declare_queryable(key, asked, complete=True))
            jobs = f"{keys.of_twin(twin)}/jobs/*/*"
            self._declared.append(self._session.declare_queryable(jobs, partial(self._asked_job, twin)))
            for part in Meta:
                key = keys.meta(twin, part)
                told = partial(self._told, key, part)
                self._declared.append(self._session.declare_queryable(key, told))
        for twin in self._twins:
            token = self._session.liveliness().declare_token(keys.live(twin, self.instance))
            self._declared.append(token)
        return self

    def pids(self) -> list[int]:
        """Process ids of the workers."""
        return self._pool.pids()

    def close(self) -> None:
        """Nothing is answered any more."""
        for each in reversed(self._declared):
            each.undeclare()
        self._declared.clear()
        if self._herald is not None:
            self._herald.close()

    def _asked(self, twin: str, query: zenoh.Query) -> None:
        """A question: enqueued, or refused at once."""
        verb = keys.asked(str(query.key_expr))
        question = understood(query, twin, verb.value if verb else OTHER, self._pool.telemetry, self.instance)
        if question is not None:
            _acted(question, lambda: self._enqueue(verb, question))

    def _enqueue(self, verb: Verb | None, question: Question) -> None:
        if verb is None:
            raise InputError("the key asks for no known verb", allowed=", ".join(each.value for each in Verb))
        waiter = question.waiter()
        if verb in ACCEPTED:
            self._query(verb, question, waiter)
            return
        payload, encoding = question.payload, question.encoding
        states = self._memory.world.kitchens[question.twin].moved
        if verb is Verb.SWEEP:
            started = self._sweeps.start(question.twin, asked_in(SweepRequest, payload, encoding), states)
            waiter.answer(Done(encode(started), JSON))
            return
        if verb is Verb.HISTORY:
            assert self._herald is not None, "started"
            self._herald.tell(question, asked_in(HistoryRequest, payload, encoding))
            return
        task = Task(question.twin, verb.value, payload, encoding, question.seconds, states, question.origin)
        self._pool.submit(task, waiter, share=True)

    def _query(self, verb: Verb, question: Question, waiter: Waiter) -> None:
        request = asked_in(QueryRequest, question.payload, question.encoding)

        def done(future: Future[Answered]) -> None:
            waiter.answer(_answered(future))

        self._pool.deadlines.watch(waiter)
        self._memory.ask(Asked("query", request.query, ACCEPTED[verb]), question.seconds + GRACE, done)

    def _asked_job(self, twin: str, query: zenoh.Query) -> None:
        """Progress, result or cancellation of a sweep; answered at once, it costs nothing."""
        key = str(query.key_expr)
        named = keys.job_of(key)
        if named is not None and keys.server_of(named[0]) not in {"", self.instance}:
            query.drop()  # the server that has it answers
            return
        question = understood(query, twin, "job", self._pool.telemetry, self.instance)
        if question is not None:
            _acted(question, lambda: question.answer(self._of_job(key)))

    def _of_job(self, key: str) -> Done:
        named = keys.job_of(key)
        if named is None:
            raise InputError("the key names no part of a job", allowed=", ".join(each.value for each in Part))
        job, part = named
        if part is Part.RESULT:
            return Done(self._sweeps.result(job), JSON)
        act = self._sweeps.cancel if part is Part.CANCEL else self._sweeps.progress
        return Done(encode(act(job)), JSON)

    def _told(self, key: str, part: Meta, query: zenoh.Query) -> None:
        """What the server says of itself; answered at once but for what it holds, which is counted."""
        if part is Meta.VOID:
            asked = Asked("query", VOID, (MEDIA,))
            self._memory.ask(asked, COUNTING, lambda future: reply(query, key, _answered(future)))
            return
        reply(query, key, Done(json.dumps(self._meta(part)).encode(), JSON))

    def _meta(self, part: Meta) -> dict[str, object]:
        if part is Meta.VERSION:
            return {"instance": self.instance, "schema": SCHEMA, "version": _VERSION}
        if part is Meta.HEALTH:
            counts = self._pool.counts
            return {
                "instance": self.instance,
                "seconds": round(time.monotonic() - self._began, 3),
                "queued": self._pool.queued,
                "answered": counts.answered,
                "late": self._pool.deadlines.missed,
                "crashed": counts.crashed,
                "replaced": counts.replaced,
                "refused": counts.refused,
                "workers": len(self._pool.pids()),
            }
        if part is Meta.METRICS:
            return dict(self._pool.telemetry.metrics.to_json())
        return asyncapi()


def _acted(question: Question, act: Callable[[], None]) -> None:
    """What is to be done for a question; whatever happens, the asker is answered."""
    try:
        act()
    except SdtError as error:
        question.answer(problem_of(error))
    except Exception:  # the edge of a service: logged, and answered as a failure
        log.exception("%s could not be taken", question.what)
        question.answer(problem(ProblemType.INTERNAL, f"{question.what} failed; the server's log says why"))


def _answered(future: Future[Answered]) -> Done | Problem:
    """A query's answer in SPARQL's own formats, or what is wrong."""
    try:
        answered = future.result()
    except SdtError as error:
        return problem_of_query(error)
    return Done(answered.body, answered.media)
