"""Mixed requests with faults: every one ends in a right answer or a typed error, and soon."""

import contextlib
import os
import random
import signal
import threading
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Protocol

import zenoh

from sdt_kg.errors import InputError, OracleUnavailableError
from services.bus.client import Connection
from services.bus.sessions import open_session
from services.judging.codec import MAX_REQUEST
from services.judging.problems import BusError

DRAWER = "sink_area_left_middle_drawer_main"
CLIENTS = 8
PATIENT, HURRIED = 60.0, 0.001
"""[s] Deadlines."""
TOO_LARGE = zenoh.ZBytes(b" " * (MAX_REQUEST + 1))
"""Made once: making it keeps the clients from seeing when answers come."""
COUNT = "SELECT (COUNT(*) AS ?n) WHERE { ?d a sdt:Drawer }"


class Judged(Protocol):
    """A server whose processes can be killed."""

    def pids(self) -> list[int]:
        """Processes that judge."""
        ...


@dataclass
class Outcomes:
    """What became of the requests.

    Attributes:
        counts: Kind of request and of its end → how often.
        wrong: Answers that were not the right ones.
        late: Seconds past its deadline at which each late answer came.
    """

    counts: Counter[tuple[str, str]] = field(default_factory=Counter[tuple[str, str]])
    wrong: list[str] = field(default_factory=list[str])
    late: list[float] = field(default_factory=list[float])
    lock: threading.Lock = field(default_factory=threading.Lock)

    def add(self, kind: str, end: str, late: float, *, right: bool = True) -> None:
        """One request ended."""
        with self.lock:
            self.counts[kind, end] += 1
            if late > 0:
                self.late.append(late)
            if not right:
                self.wrong.append(f"{kind}: {end}")


def run(endpoint: str, server: Judged, requests: int, kills: int, seed: int = 0) -> Outcomes:
    """Ask from several clients at once, and kill workers now and then."""
    outcomes, draw = Outcomes(), random.Random(seed)  # noqa: S311 - no secret
    kinds = draw.choices([*_ASKED, *_FAULTS], weights=[4, 4, 4, 2, 2, 1, 1, 2], k=requests)
    killed_after = set(draw.sample(range(requests), kills))
    sessions = [open_session(connect=endpoint, mode="client") for _ in range(CLIENTS)]

    def ask(number: int) -> None:
        if number in killed_after:
            for pid in server.pids():
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
        session = sessions[number % CLIENTS]
        kind = kinds[number]
        if kind in _FAULTS:
            _FAULTS[kind](session, endpoint, outcomes)
        else:
            _asked(kind, Connection(session, "b", PATIENT), outcomes)

    with ThreadPoolExecutor(CLIENTS) as pool:
        list(pool.map(ask, range(requests)))
    for session in sessions:
        session.close()
    return outcomes


_ASKED: dict[str, Callable[[Connection], bool]] = {
    "satisfies": lambda to: len(to.satisfies()) == 17,
    "select": lambda to: to.select(COUNT)[1] == [{"n": 14}],
    "ask": lambda to: to.ask("ASK { ?d a sdt:Door }"),
    "causes": lambda to: to.causes(f"open:{DRAWER}").holds == [True],
}


def _asked(kind: str, to: Connection, outcomes: Outcomes) -> None:
    began = time.monotonic()
    try:
        right, end = _ASKED[kind](to), "answer"
    except (BusError, OracleUnavailableError) as error:
        right, end = True, type(error).__name__
    outcomes.add(kind, end, time.monotonic() - began - to.deadline, right=right)


def _hurried(session: zenoh.Session, endpoint: str, outcomes: Outcomes) -> None:
    """A deadline of a millisecond, told to the server, with the client waiting on."""
    del endpoint
    began = time.monotonic()
    replies = list(
        session.get("sdt/v1/b/rpc/satisfies", payload=b"{}", attachment=b'{"deadline_ms": 1}', timeout=30)
    )
    end = ("answer" if replies[0].ok else "problem") if replies else "silence"
    outcomes.add("hurried", end, time.monotonic() - began - HURRIED, right=end != "silence")


def _malformed(session: zenoh.Session, endpoint: str, outcomes: Outcomes) -> None:
    del endpoint
    replies = list(session.get("sdt/v1/b/rpc/canachieve", payload=b'{"task": [', timeout=PATIENT))
    outcomes.add("malformed", "problem", 0.0, right=len(replies) == 1 and replies[0].err is not None)


def _oversized(session: zenoh.Session, endpoint: str, outcomes: Outcomes) -> None:
    del endpoint
    replies = list(session.get("sdt/v1/b/rpc/causes", payload=TOO_LARGE, timeout=PATIENT))
    outcomes.add("oversized", "problem", 0.0, right=len(replies) == 1 and replies[0].err is not None)


def _vanishing(session: zenoh.Session, endpoint: str, outcomes: Outcomes) -> None:
    """A client that asks and is gone before the reply."""
    del session
    try:
        gone = open_session(connect=endpoint, mode="client")
    except (OracleUnavailableError, InputError) as error:
        outcomes.add("vanishing", type(error).__name__, 0.0)
        return
    gone.get("sdt/v1/b/rpc/satisfies", payload=b"{}", timeout=1.0)
    gone.close()
    outcomes.add("vanishing", "gone", 0.0)


_FAULTS: dict[str, Callable[[zenoh.Session, str, Outcomes], None]] = {
    "malformed": _malformed,
    "oversized": _oversized,
    "vanishing": _vanishing,
    "hurried": _hurried,
}


def is_typed(end: str) -> bool:
    """Whether a request ended as one may."""
    return end in {"answer", "problem", "gone", "DeadlineError", "BusUnavailableError", "InternalError"}
