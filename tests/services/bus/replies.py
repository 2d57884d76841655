"""Cases about kitchen B, what oracles rightly answer, and an oracle that answers as it is told."""

import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import zenoh

from predicates.case import Answer, Case
from predicates.satisfies_request import demanded
from sdt_kg.annotation import Drive
from sdt_kg.task import Task, Verb
from services.app import Policy, Service
from services.bus import keys
from services.bus.keys import Oracle
from services.bus.oracles.codec import Plain, answer_plain
from services.judging.codec import CBOR, from_cbor, to_cbor

DRAWER, OTHER = "sink_area_left_middle_drawer_main", "sink_area_left_upper_drawer_main"
NAN = float("nan")
FREE, FIXED = Policy(budget=60.0), Policy(Drive.FIXED, budget=60.0)
Change = Callable[[Plain], object]


def case_of(here: Service, container: str) -> Case:
    """The motion that opens it, and the robot that is asked."""
    of = here.twin.container(container)
    motion = next(here.physics.generate(here.twin, demanded(of, Verb.OPEN)))
    return Case(here.twin, here.twin.robots[0], Task(Verb.OPEN, of.iri), motion=motion)


def sent(answer: Answer) -> Plain:
    """What the bus carries of an answer."""
    return from_cbor(to_cbor(answer_plain(answer)))


@contextmanager
def replying(session: zenoh.Session, kind: Oracle, said: Callable[[str], bytes]) -> Iterator[str]:
    """An oracle that answers each verb so, whatever it is asked about."""
    instance = "0" + uuid.uuid4().hex[:11]  # the first of those that were asked as often

    def answered(query: zenoh.Query) -> None:
        with query:
            query.reply(query.key_expr, said(str(query.parameters)), encoding=CBOR)

    asked = session.declare_queryable(keys.oracle(kind, instance), answered, complete=True)
    token = session.liveliness().declare_token(keys.oracle_live(kind, instance))
    yield instance
    token.undeclare()
    asked.undeclare()
