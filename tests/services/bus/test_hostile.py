"""Whatever is sent, under whatever key: one typed problem, soon, and the next question is answered."""

import json
import re

import cbor2
import pytest
import zenoh

from services.bus import sweeps
from services.bus.client import Connection
from services.judging.codec import CBOR, JSON
from services.judging.messages import SweepRequest
from services.judging.problems import MOST_TOLD, BusUnavailableError, ProblemType, problem
from services.judging.workers.jobs import Done, Waiter

pytestmark = pytest.mark.oracle

DRAWER = "sink_area_left_middle_drawer_main"
QUERY = b'{"query": "ASK { ?d a sdt:Door }"}'
ACHIEVE = {"task": f"open:{DRAWER}", "robot": "pr2", "budget": 1}
NAN, INF = float("nan"), float("inf")
BIG = cbor2.CBORTag(2, b"\xff" * 100_000)
SELF = bytes.fromhex("d81c81d81d00")
"""CBOR of a list that is its own element."""


def kinds(
    session: zenoh.Session, key: str, payload: bytes = QUERY, encoding: str = JSON, **more: object
) -> set[str]:
    """Of the problems that are the answer; `answer` where there is one."""
    replies = list(session.get(key, payload=payload, encoding=encoding, timeout=60, **more))  # pyright: ignore[reportArgumentType, reportCallIssue]
    assert replies, "silence"
    return {
        "answer" if each.err is None else json.loads(each.err.payload.to_bytes())["type"].rsplit("/", 1)[-1]
        for each in replies
    }


@pytest.mark.parametrize(
    "key",
    [
        *("sdt/v1/*/rpc/ask", "sdt/*/b/rpc/ask", "sdt/v1/b/rpc/*", "sdt/v1/b/rpc/as$*", "sdt/v1/**", "**"),
        *("sdt/v1/*/rpc/satisfies", "sdt/v1/*/rpc/sweep", "sdt/v1/*/rpc/history"),
        *("sdt/v1/b/jobs/*/*", "sdt/v1/b/jobs/*/cancel", "sdt/v1/b/jobs/x/dance"),
        f"sdt/v1/b/rpc/{'x' * 50_000}",
    ],
)
def test_a_key_that_asks_several_or_nothing_is_refused(session: zenoh.Session, key: str) -> None:
    assert kinds(session, key) == {"invalid-request"}


def test_every_server_of_every_twin_can_be_asked_how_it_is(session: zenoh.Session) -> None:
    (health,) = list(session.get("sdt/v1/*/@meta/health", timeout=30))
    assert health.ok is not None
    assert str(health.ok.key_expr) == "sdt/v1/b/@meta/health"
    every = {str(each.ok.key_expr) for each in session.get("sdt/v1/b/@meta/*", timeout=30) if each.ok}
    assert every == {f"sdt/v1/b/@meta/{part}" for part in ("schema", "void", "version", "health", "metrics")}


@pytest.mark.parametrize("verb", ["select", "sweep", "satisfies", "history"])
@pytest.mark.parametrize(
    ("payload", "encoding"),
    [
        (b'{"state": ["\\ud800=1"], "verb": "\\ud800", "kind": "\\ud800", "query": "\\ud800"}', JSON),
        (b"[" * 100_000, JSON),
        (b'{"a":' * 100_000, JSON),
        (b'{"after": ' + b"9" * 6000 + b"}", JSON),
        (b'{"schema": "' + b"9" * 1_000_000 + b'"}', JSON),
        (cbor2.dumps({"schema": BIG}), CBOR),
        (cbor2.dumps({"query": cbor2.CBORTag(40, 5)}), CBOR),
        (b"\x81" * 100_000, CBOR),
        (b"\x9b\x7f" + b"\xff" * 7, CBOR),
        (SELF, CBOR),
    ],
    ids=["surrogate", "deep", "deep map", "digits", "long", "bignum", "shape", "deep cbor", "2^63", "cyclic"],
)
def test_what_cannot_be_read_is_refused_at_once(
    session: zenoh.Session, verb: str, payload: bytes, encoding: str
) -> None:
    assert kinds(session, f"sdt/v1/b/rpc/{verb}", payload, encoding) == {"invalid-request"}
    assert kinds(session, "sdt/v1/b/rpc/ask") == {"answer"}


@pytest.mark.parametrize(
    "more",
    [
        *({"base": [1e308] * 3}, {"base": [1e6, 0.0, 0.0]}, {"base": [0.0, 0.0, 1e6]}),
        *({"base": [NAN, 0.0, 0.0]}, {"base": [INF, 0.0, 0.0]}, {"budget": NAN}, {"budget": INF}),
        *({"seed": 2**80}, {"seed": -1}, {"tee": "d"}, {"tee": "d_artic_dyn", "handle_force": NAN}),
        *({"state": [f"{DRAWER}={value}"]} for value in ("nan", "inf", "1e308", "")),
        {"state": ["all=open"] * 1001},
        {"motion": {"times": [0.0] * 10, "values": [0.0] * 1_000_000}},
        {"motion": {"joint": f"{DRAWER}_joint", "times": [0.0, NAN], "values": [[0.0], [NAN]]}},
        {"motion": {"times": None, "values": {"a": 1}}},
        {"motion": {"times": cbor2.CBORTag(258, [1, 2])}},
        {"robot": ["pr2"]},
    ],
    ids=lambda more: str(more)[:60],
)
def test_what_means_nothing_is_refused(session: zenoh.Session, more: dict[str, object]) -> None:
    payload = cbor2.dumps(ACHIEVE | more)
    assert kinds(session, "sdt/v1/b/rpc/canachieve", payload, CBOR) == {"invalid-request"}


@pytest.mark.parametrize(
    ("attachment", "kind"),
    [
        *((b'{"deadline_ms": %s}' % value, "invalid-request") for value in (b"0", b"-5", b"1e300", b"1e999")),
        (b'{"schema": "2.0"}', "invalid-request"),
        (b'{"id": "\\ud800"}', "invalid-request"),
        (b"[" * 10_000, "invalid-request"),
        (b" " * 1_000_000, "too-large"),
    ],
)
def test_a_wrong_attachment_is_refused(session: zenoh.Session, attachment: bytes, kind: str) -> None:
    assert kinds(session, "sdt/v1/b/rpc/ask", attachment=attachment) == {kind}


@pytest.mark.parametrize(("attachment", "report"), [(b'{"id": "mine"}', "mine"), (None, r"[0-9a-f]{32}")])
def test_a_problem_names_the_request_as_the_log_does(
    session: zenoh.Session, attachment: bytes | None, report: str
) -> None:
    (reply,) = session.get("sdt/v1/b/rpc/ask", payload=b"{", attachment=attachment, timeout=60)
    assert reply.err is not None
    assert re.fullmatch(report, json.loads(reply.err.payload.to_bytes())["report"])


def test_a_request_that_is_replayed_is_answered_again(session: zenoh.Session) -> None:
    for _ in range(3):
        assert kinds(session, "sdt/v1/b/rpc/ask", attachment=b'{"id": "one and the same"}') == {"answer"}


def test_no_more_sweeps_go_on_than_may(connection: Connection, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeps, "AT_ONCE_JOBS", 0)
    hurried = Connection(connection.session, "b", 1.0)
    with pytest.raises(BusUnavailableError):
        hurried.sweep("open", "all=open")


def test_finished_sweeps_give_way_and_those_that_go_on_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeps, "JOBS_KEPT", 2)
    monkeypatch.setattr(sweeps.Sweeps, "_run", lambda *_: None)
    models = sweeps.Models("b", ("pr2",), (DRAWER,))
    kept = sweeps.Sweeps(None, {"b": models}, "one")  # pyright: ignore[reportArgumentType]  # nothing is judged
    jobs = [kept.start("b", SweepRequest()).job for _ in range(3)]
    kept.cancel(jobs[1])
    jobs.append(kept.start("b", SweepRequest()).job)
    assert [job for job in jobs if job in kept._jobs] == [jobs[0], jobs[2], jobs[3]]


def test_an_answer_that_cannot_be_given_leaves_the_thread_to_others() -> None:
    def failing(outcome: object) -> None:
        raise UnicodeError(outcome)

    assert Waiter(0.0, failing).answer(Done(b"", JSON))


def test_what_was_sent_is_not_told_back_at_any_length() -> None:
    assert len(problem(ProblemType.INVALID_REQUEST, "x" * 10**6).detail) < MOST_TOLD + 10
