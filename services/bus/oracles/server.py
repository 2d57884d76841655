"""An oracle on its own: answers the bus until it is closed."""

import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import zenoh

from sdt_kg.errors import SdtError
from services.bus import keys
from services.bus.asking import Header
from services.bus.keys import Oracle
from services.bus.oracles.handler import OracleSetup
from services.bus.question import MOST_ATTACHED, bounded, reply
from services.judging.codec import CBOR, decode
from services.judging.problems import Problem, problem_of
from services.judging.workers.jobs import Done, NoMemory, Task, Waiter
from services.judging.workers.pool import Pool

WAITING = 32
"""Questions that may wait for the oracle's worker."""


@contextmanager
def oracle(session: zenoh.Session, kind: Oracle, workers: int = 1) -> Iterator[str]:
    """The name of an oracle that answers over the session until the context ends."""
    instance = uuid.uuid4().hex[:12]
    pool = Pool(OracleSetup(kind), workers, NoMemory(), WAITING)
    pool.warm()

    def asked(query: zenoh.Query) -> None:
        answer = _answerer(query)
        try:
            pool.submit(*_understood(query, answer))
        except SdtError as error:
            answer(problem_of(error))

    queryable = session.declare_queryable(keys.oracle(kind, instance), asked, complete=True)
    token = session.liveliness().declare_token(keys.oracle_live(kind, instance))
    try:
        yield instance
    finally:
        token.undeclare()
        queryable.undeclare()
        pool.close()


def _understood(query: zenoh.Query, answer: Callable[[Done | Problem], None]) -> tuple[Task, Waiter]:
    header = (
        Header() if query.attachment is None else decode(Header, bounded(query.attachment, MOST_ATTACHED))
    )
    payload = b"" if query.payload is None else bounded(query.payload)
    verb = str(query.parameters)
    seconds = header.deadline_ms / 1000
    return Task("", verb, payload, CBOR, seconds), Waiter(time.monotonic() + seconds, answer)


def _answerer(query: zenoh.Query) -> Callable[[Done | Problem], None]:
    return lambda outcome: reply(query, str(query.key_expr), outcome)
