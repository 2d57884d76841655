"""Mixed requests with faults: every one ends in a right answer or a typed error, and soon."""

import random
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field

import zenoh

from sdt_kg.errors import InputError, OracleUnavailableError
from services.bus.asking import priority_of
from services.bus.client import Connection
from services.bus.sessions import open_session
from services.judging.codec import MAX_REQUEST
from services.judging.problems import BusError
from tests.services.bus.routed import BARE

DRAWER = "sink_area_left_middle_drawer_main"
CLIENTS = 8
PATIENT, HURRIED = 60.0, 0.001
"""[s] Deadlines."""
TOO_LARGE = zenoh.ZBytes(b" " * (MAX_REQUEST + 1))
"""Made once: making it keeps the clients from seeing when answers come."""
COUNT = "SELECT (COUNT(*) AS ?n) WHERE { ?d a sdt:Drawer }"
PAUSE = 0.01
"""[s] Between bare questions."""

Cases = Mapping[tuple[str, int], tuple[str, str]]
"""Task and seed → IRI and outcome of its verdict in process."""


Excused = Callable[[tuple[float, float]], bool]


@dataclass
class Outcomes:
    """What became of the requests.

    Attributes:
        counts: Kind of request and of its end → how often.
        wrong: Answers that were not the right ones.
        late: Seconds past its deadline at which each late answer or error came.
        bare: Seconds that a bare question over the same bus took, to a process that has nothing to do.
        verdicts: IRIs that were acknowledged.
    """

    counts: Counter[tuple[str, str]] = field(default_factory=Counter[tuple[str, str]])
    wrong: list[str] = field(default_factory=list[str])
    late: list[float] = field(default_factory=list[float])
    bare: list[float] = field(default_factory=list[float])
    verdicts: set[str] = field(default_factory=set[str])
    lock: threading.Lock = field(default_factory=threading.Lock)

    def add(self, kind: str, end: str, late: float = 0.0, *, right: bool = True) -> None:
        """One request ended."""
        with self.lock:
            self.counts[kind, end] += 1
            if late > 0:
                self.late.append(late)
            if not right:
                self.wrong.append(f"{kind}: {end}")


@dataclass(frozen=True)
class Asking:
    """One request: by whom, of which kind, about what.

    Attributes:
        case: Task and seed of an achieve.
        expected: IRI and outcome of its verdict.
        is_excused: Whether nobody could be reached at some time between two: then there may be silence.
    """

    session: zenoh.Session
    endpoint: str
    outcomes: Outcomes
    case: tuple[str, int]
    expected: tuple[str, str]
    is_excused: Excused

    def raw(
        self, kind: str, verb: str, payload: bytes | zenoh.ZBytes, attachment: bytes | None = None
    ) -> None:
        """Ask without our library; silence is told apart."""
        began = time.monotonic()
        key = f"sdt/v1/b/rpc/{verb}"
        replies = list(
            self.session.get(
                key,
                payload=payload,
                attachment=attachment,
                timeout=PATIENT,
                priority=priority_of(payload),
            )
        )
        spent = time.monotonic() - began
        if not replies or (
            replies[0].err and not str(replies[0].err.encoding).startswith("application/json")
        ):
            excused = self.is_excused((began, began + spent))
            self.outcomes.add(kind, "silence", right=excused)
            return
        hurried = attachment is not None
        end, right = "answer" if replies[0].ok else "problem", len(replies) == 1
        late = spent - HURRIED if hurried and not self.is_excused((began, began + spent)) else 0.0
        self.outcomes.add(kind, end, late, right=right and (hurried or end == "problem"))


def run(  # noqa: PLR0917 - what a run is made of
    endpoint: str,
    requests: int,
    harm: Mapping[int, Callable[[], None]],
    cases: Cases,
    seed: int = 0,
    is_excused: Excused = lambda _: False,
) -> Outcomes:
    """Ask from several clients at once, and do harm before some of the requests."""
    outcomes, draw = Outcomes(), random.Random(seed)  # noqa: S311 - no secret
    kinds = draw.choices([*_ASKED, *_FAULTS], weights=[4, 4, 4, 2, 1, 1, 2, 1, 1, 1], k=requests)
    about = draw.choices(list(cases), k=requests)
    sessions = [open_session(connect=endpoint, mode="client") for _ in range(CLIENTS)]

    def ask(number: int) -> None:
        harm.get(number, _none)()
        case = about[number]
        asking = Asking(sessions[number % CLIENTS], endpoint, outcomes, case, cases[case], is_excused)
        kind = kinds[number]
        if kind in _FAULTS:
            _FAULTS[kind](asking)
        else:
            _asked(kind, asking)

    with ThreadPoolExecutor(CLIENTS) as pool, _bare_questions(endpoint, outcomes):
        list(pool.map(ask, range(requests)))
    for session in sessions:
        session.close()
    return outcomes


def scattered(
    requests: int, harms: Mapping[Callable[[], None], int], seed: int = 0
) -> dict[int, Callable[[], None]]:
    """Before which request which harm is done, each so often."""
    draw = random.Random(seed)  # noqa: S311 - no secret
    each = [harm for harm, often in harms.items() for _ in range(often)]
    return dict(zip(draw.sample(range(requests // 20, requests), len(each)), each, strict=True))


@contextmanager
def _bare_questions(endpoint: str, outcomes: Outcomes) -> Iterator[None]:
    """A thread that asks whoever answers at once: what that takes, the machine takes."""
    over = threading.Event()

    def ask() -> None:
        with open_session(connect=endpoint, mode="client") as session:
            while not over.wait(PAUSE):
                began = time.monotonic()
                if list(session.get(BARE, timeout=PATIENT)):
                    outcomes.bare.append(time.monotonic() - began)

    thread = threading.Thread(target=ask, name="bare questions")
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def _none() -> None:
    """No harm."""


def _achieved(to: Connection, asking: Asking) -> bool:
    (task, seed), expected = asking.case, asking.expected
    (said,) = to.achieve(task, "pr2", seed=seed).objects
    asking.outcomes.verdicts.add(said["iri"])
    return (said["iri"], said["outcome"]) == expected


_ASKED: dict[str, Callable[[Connection, Asking], bool]] = {
    "satisfies": lambda to, _: len(to.satisfies()) == 17,
    "select": lambda to, _: to.select(COUNT)[1] == [{"n": 14}],
    "ask": lambda to, _: to.ask("ASK { ?d a sdt:Door }"),
    "causes": lambda to, _: to.causes(f"open:{DRAWER}").holds == [True],
    "achieve": _achieved,
    "hurried": lambda to, _: len(to.satisfies()) == 17,
}


def _asked(kind: str, asking: Asking) -> None:
    to = Connection(asking.session, "b", HURRIED if kind == "hurried" else PATIENT)
    began = time.monotonic()
    try:
        right, end = _ASKED[kind](to, asking), "answer"
    except (BusError, OracleUnavailableError) as error:
        right, end = True, type(error).__name__
    asking.outcomes.add(kind, end, time.monotonic() - began - to.deadline, right=right)


def _told(asking: Asking) -> None:
    """A deadline of a millisecond, told to the server, with the client waiting on."""
    asking.raw("told", "satisfies", b"{}", b'{"deadline_ms": 1}')


def _malformed(asking: Asking) -> None:
    asking.raw("malformed", "canachieve", b'{"task": [')


def _oversized(asking: Asking) -> None:
    asking.raw("oversized", "causes", TOO_LARGE)


def _vanishing(asking: Asking) -> None:
    """A client that asks and is gone before the reply."""
    try:
        gone = open_session(connect=asking.endpoint, mode="client")
    except (OracleUnavailableError, InputError) as error:
        asking.outcomes.add("vanishing", type(error).__name__)
        return
    gone.get("sdt/v1/b/rpc/satisfies", payload=b"{}", timeout=1.0)
    gone.close()
    asking.outcomes.add("vanishing", "gone")


_FAULTS: dict[str, Callable[[Asking], None]] = {
    "malformed": _malformed,
    "oversized": _oversized,
    "vanishing": _vanishing,
    "told": _told,
}


def is_typed(end: str) -> bool:
    """Whether a request ended as one may; silence only where nobody was there, which the caller checks."""
    ends = {"answer", "problem", "gone", "silence", "DeadlineError", "BusUnavailableError", "InternalError"}
    return end in ends
