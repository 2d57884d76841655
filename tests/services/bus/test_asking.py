"""How urgent a question is."""

from typing import Any, cast

import pytest
import zenoh

from services.bus.asking import SMALL
from services.bus.client import Connection

pytestmark = pytest.mark.oracle


class Watched:
    """A session that notes how urgent its questions are."""

    def __init__(self, session: zenoh.Session) -> None:
        self.session, self.priorities = session, list[zenoh.Priority]()

    def get(self, key: str, **given: Any) -> Any:
        self.priorities.append(given["priority"])
        return self.session.get(key, **given)


def test_a_small_question_overtakes_a_large_one(session: zenoh.Session) -> None:
    watched = Watched(session)
    asking = Connection(cast("zenoh.Session", watched), "b")
    assert asking.ask("ASK { ?d a sdt:Door }")
    assert asking.ask("ASK { ?d a sdt:Door } #" + " " * SMALL)
    assert watched.priorities == [zenoh.Priority.INTERACTIVE_HIGH, zenoh.Priority.DATA]
