"""The Law over Zenoh says what it says in process; silence, faults and nonsense are typed errors."""

import json
import os
import signal
import time
from dataclasses import replace
from typing import Any

import pyoxigraph as ox
import pytest
import zenoh

from predicates.record import to_json
from sdt_kg.errors import InputError, OracleUnavailableError
from services.app import Policy, load
from services.bus import keys
from services.bus.client import Connection, connect
from services.bus.server import Server
from services.bus.sessions import open_session
from services.judging.codec import MAX_REQUEST
from services.judging.problems import DeadlineError, ForbiddenError, RequestError, TooLargeError
from services.specifications import achieve_task, specification_from
from tests.ports import free_endpoint

pytestmark = pytest.mark.oracle

DRAWER = "sink_area_left_middle_drawer_main"
UNTIMED = ("seconds", "times", "stored")


def test_a_verdict_over_the_bus_is_the_one_in_process(connection: Connection) -> None:
    here = load("b", ["pr2"], policy=Policy(budget=20.0))
    (made,) = here.achieve(f"open:{DRAWER}")
    over = connection.achieve(f"open:{DRAWER}", "pr2")
    (said,) = over.objects
    expected = to_json(made)
    assert {k: v for k, v in said.items() if k not in UNTIMED} == {
        k: v for k, v in expected.items() if k not in UNTIMED
    }
    assert [each.iri for each in over.stored] == [made.iri]

    again = connection.achieve(f"open:{DRAWER}", "pr2")
    assert again.objects[0]["stored"], "a repeat returns the stored verdict"
    assert "CERTIFIED" in connection.why(made.iri)
    _, rows = connection.select("SELECT ?v WHERE { ?v law:outcome law:Certified }")
    assert made.iri in {row["v"] for row in rows}


def test_a_refusal_and_an_abstention_are_replies(connection: Connection) -> None:
    over = connection.achieve(f"open:{DRAWER}", "pr2", f"{DRAWER}=open")
    assert over.objects[0]["outcome"] == "not_certified"
    assert over.objects[0]["diagnoses"][0]["kind"] == "causal"


def test_requests_and_motions_are_those_in_process(connection: Connection) -> None:
    here = load("b")
    met = {(each.verb, each.container) for each in connection.satisfies(f"{DRAWER}=open")}
    assert ("open", DRAWER) in met
    assert len(met) == len(list(here.at(f"{DRAWER}=open").satisfies()))
    reply = connection.causes(f"open:{DRAWER}")
    assert reply.holds == [True]
    assert reply.motions[0] is not None
    checked = connection.causes(f"open:{DRAWER}", motion=reply.motions[0])
    assert checked.holds == [True]


def test_a_class_with_forces_is_asked_over_the_bus(connection: Connection) -> None:
    assert connection.causes(f"open:{DRAWER}", tee="d_artic_dyn").holds == [True]
    (refused,) = connection.causes(f"open:{DRAWER}", tee="d_artic_dyn", handle_force=2.0).diagnoses
    assert "where 2 N is allowed" in refused[0]["reason"]
    with pytest.raises(RequestError, match="handle_force"):
        connection.achieve(f"open:{DRAWER}", "pr2", handle_force=2.0)


def test_queries_of_every_form(connection: Connection) -> None:
    assert connection.select("SELECT (COUNT(*) AS ?n) WHERE { ?d a sdt:Drawer }") == (["n"], [{"n": 14}])
    assert connection.ask("ASK { ?d a sdt:Drawer }")
    assert connection.construct("CONSTRUCT { ?d a sdt:Drawer } WHERE { ?d a sdt:Drawer }")


@pytest.mark.parametrize("query", ["SELECT", "DROP ALL"])
def test_what_does_not_read_is_refused(connection: Connection, query: str) -> None:
    with pytest.raises(RequestError):
        connection.select(query)


@pytest.mark.parametrize("pattern", ["SERVICE <http://127.0.0.1:1/> { ?s ?p ?o }", "?s ?p ?o"])
def test_what_would_fetch_is_forbidden(connection: Connection, pattern: str) -> None:
    elsewhere = "" if "SERVICE" in pattern else "FROM <http://127.0.0.1:1/>"
    with pytest.raises(ForbiddenError):
        connection.select(f"SELECT * {elsewhere} {{ {pattern} }}")


def test_a_verdict_that_is_not_kept_is_named(connection: Connection) -> None:
    with pytest.raises(RequestError, match="no verdict <"):
        connection.why("https://example.org/id/verdict/x")


@pytest.mark.parametrize("task", ["open:nothing_like_it", "dance", ""])
def test_a_wrong_task_is_the_askers_error(connection: Connection, task: str) -> None:
    with pytest.raises(InputError):
        connection.achieve(task, "pr2")


def test_a_client_without_our_library_asks_in_json(session: zenoh.Session) -> None:
    asked = session.get("sdt/v1/b/rpc/select", payload=json.dumps({"query": "SELECT * { ?d a sdt:Door }"}))
    (reply,) = list(asked)
    assert reply.ok is not None
    assert len(json.loads(reply.ok.payload.to_bytes())["results"]["bindings"]) == 3


@pytest.mark.parametrize("payload", [b"", b"{", b"\xff", b'{"query": 7}', b'{"schema": "9.0", "query": ""}'])
@pytest.mark.parametrize("verb", ["select", "canachieve"])
def test_nonsense_gets_a_problem(session: zenoh.Session, verb: str, payload: bytes) -> None:
    (reply,) = list(session.get(f"sdt/v1/b/rpc/{verb}", payload=payload, timeout=60))
    assert reply.err is not None
    said = json.loads(reply.err.payload.to_bytes())
    assert said["type"].endswith("invalid-request")
    assert not said["retryable"]


def test_what_a_server_holds_is_described_in_void(session: zenoh.Session) -> None:
    (reply,) = list(session.get("sdt/v1/b/@meta/void", timeout=60))
    assert reply.ok is not None
    held = ox.Store()
    held.load(reply.ok.payload.to_bytes(), format=ox.RdfFormat.N_TRIPLES)
    rows = held.query("""
        PREFIX void: <http://rdfs.org/ns/void#>
        SELECT ?entities { ?dataset a void:Dataset ; void:classPartition ?part .
          ?part void:class <https://example.org/sdt#Drawer> ; void:entities ?entities }""")
    assert [row["entities"].value for row in rows] == ["14"]


def test_a_wrong_attachment_an_unknown_verb_and_a_huge_payload_get_problems(session: zenoh.Session) -> None:
    def kind(key: str, **given: object) -> str:
        (reply,) = list(session.get(key, timeout=30, **given))  # pyright: ignore[reportArgumentType]
        assert reply.err is not None
        return json.loads(reply.err.payload.to_bytes())["type"].rsplit("/", 1)[-1]

    assert kind("sdt/v1/b/rpc/select", attachment=b"}{") == "invalid-request"
    assert kind("sdt/v1/b/rpc/dance") == "invalid-request"
    assert kind("sdt/v1/b/rpc/causes", payload=b" " * (MAX_REQUEST + 1)) == "too-large"


def test_a_deadline_is_an_error_of_its_own_and_the_server_lives_on(connection: Connection) -> None:
    hurried = replace(connection, deadline=0.05)
    with pytest.raises((DeadlineError, OracleUnavailableError)):
        hurried.achieve("open:sink_area_dish_washer_door", "pr2", budget=30.0)
    assert connection.satisfies()


def test_a_query_that_nobody_waits_for_any_more_is_stopped(connection: Connection) -> None:
    hurried, before_its_limit = replace(connection, deadline=0.2), replace(connection, deadline=7.0)
    for _ in range(4):  # as many as there are processes that evaluate
        with pytest.raises((DeadlineError, OracleUnavailableError)):
            hurried.select("SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }")
    assert before_its_limit.ask("ASK { ?d a sdt:Drawer }")


def test_a_killed_worker_is_replaced_and_the_question_answered(
    connection: Connection, bus: tuple[str, Server]
) -> None:
    before = connection.health()[0]
    (pid,) = bus[1].pids()
    os.kill(pid, signal.SIGKILL)
    assert connection.satisfies()
    assert connection.health()[0]["crashed"] == before["crashed"] + 1


def test_servers_are_seen_and_say_how_they_are(connection: Connection, bus: tuple[str, Server]) -> None:
    assert connection.servers() == [bus[1].instance]
    (health,) = connection.health()
    assert health["instance"] == bus[1].instance


def test_silence_is_never_an_answer(session: zenoh.Session) -> None:
    with pytest.raises(OracleUnavailableError, match="no server of 'nowhere'"):
        Connection(session, "nowhere", deadline=5.0).satisfies()
    with pytest.raises(OracleUnavailableError), connect("b", free_endpoint()):
        pass


def test_a_server_that_is_there_and_says_nothing_is_not_waited_for_longer_than_the_deadline() -> None:
    held: list[zenoh.Query] = []
    endpoint = free_endpoint()
    with open_session(listen=endpoint) as mute, open_session(connect=endpoint, mode="client") as session:
        declared = (
            mute.declare_queryable("sdt/v1/mute/rpc/*", held.append),
            mute.liveliness().declare_token(keys.live("mute", "one")),
        )
        asking = Connection(session, "mute", deadline=0.5)
        until = time.monotonic() + 10
        while not asking.servers():
            assert time.monotonic() < until
        with pytest.raises(DeadlineError, match="no reply came in time"):
            asking.ask("ASK { ?d a sdt:Door }")
        declared[1].undeclare()
    assert len(held) == 1, "asked once: a server that is slow is not asked again"


def test_verdicts_are_published(connection: Connection, session: zenoh.Session) -> None:
    heard: list[bytes] = []
    subscriber = session.declare_subscriber(
        "sdt/v1/b/events/verdict/*", lambda sample: heard.append(sample.payload.to_bytes())
    )
    time.sleep(0.5)
    (said,) = connection.achieve(f"close:{DRAWER}", "pr2", seed=2**40).objects
    until = time.monotonic() + 10
    while not heard and time.monotonic() < until:
        time.sleep(0.05)
    subscriber.undeclare()
    assert str(said["iri"]).encode() in b"".join(heard)


def test_too_large_an_answer_is_refused_whole(connection: Connection) -> None:
    with pytest.raises((TooLargeError, DeadlineError)):
        connection.select("SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }")


def test_a_sweep_goes_on_in_the_background_and_can_be_cancelled(connection: Connection) -> None:
    started = connection.sweep("open", "all=open")
    assert (started.total, started.state in {"queued", "running"}) == (17, True)
    until = time.monotonic() + 60
    while connection.progress(started.job).state != "done":
        assert time.monotonic() < until
        time.sleep(0.2)
    found = connection.result(started.job)
    assert len(found["verdicts"]) == 17
    assert {each["outcome"] for each in found["verdicts"]} == {"not_certified"}, "all is open already"

    second = connection.sweep("close", "all=open", budget=30.0)
    assert connection.cancel(second.job).state == "cancelled"
    assert connection.satisfies(), "the worker is free again"
    with pytest.raises(InputError, match="no job"):
        connection.progress("unknown")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"frictoin": 0.3}, "no field 'frictoin'; did you mean 'friction'?"),
        ({"friction": 30.0}, "'friction' of AchieveRequest: Input should be less than or equal to 10"),
        ({"motion": "fridge.npz"}, r"a motion that is a str; allowed: arrays by name, .*read_arrays"),
    ],
)
def test_what_is_wrong_with_a_question_is_told_before_it_is_sent(
    connection: Connection, wrong: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError, match=said):
        connection.achieve(f"open:{DRAWER}", "pr2", **wrong)


def test_the_friction_of_a_sweep_is_that_of_its_verdicts(connection: Connection) -> None:
    tasks = [f"open:{DRAWER}"]
    started = connection.sweep(tasks=tasks, drives=["omni"], friction=0.3)
    until = time.monotonic() + 60
    while connection.progress(started.job).state != "done":
        assert time.monotonic() < until
        time.sleep(0.1)
    (verdict,) = connection.result(started.job)["verdicts"]
    assert "holds that need friction of more than 0.3 are refused: as asked" in verdict["notes"]


def test_a_sweep_is_relative_to_its_class(connection: Connection) -> None:
    asked = {"tasks": [f"open:{DRAWER}"], "tee": "d_artic_dyn", "handle_force": 2.0}
    started = connection.sweep(**asked)
    until = time.monotonic() + 60
    while connection.progress(started.job).state != "done":
        assert time.monotonic() < until
        time.sleep(0.1)
    (verdict,) = connection.result(started.job)["verdicts"]
    assert verdict["outcome"] == "not_certified"
    assert "where 2 N is allowed" in str(verdict["diagnoses"])
    with pytest.raises(RequestError, match="handle_force"):
        connection.sweep(**asked | {"tee": "d_artic"})


def test_the_map_of_base_positions_is_asked_over_the_bus(connection: Connection) -> None:
    found = connection.place(f"open:{DRAWER}", "pr2", budget=1.0)
    assert found["container"].endswith(DRAWER)
    assert {cell["status"] for cell in found["map"]["cells"]} & {"certified", "unknown", "blocked"}
    with pytest.raises(RequestError, match="names no container"):
        connection.place("open", "pr2")


def test_a_task_with_steps_is_asked_over_the_bus_and_its_result_is_kept(connection: Connection) -> None:
    here = load("b", ["pr2"], policy=Policy(budget=20.0))
    made = achieve_task(here, specification_from(here.twin, "open_then_close"))
    said = connection.task("open_then_close", "pr2")
    assert (said["result"], said["outcome"]) == (made.iri, "certified")
    assert [each["verdict"]["iri"] for each in said["steps"]] == [each.verdict.iri for each in made.steps]
    assert "CERTIFIED" in connection.why(said["result"])
    _, rows = connection.select("SELECT ?v { ?r a law:TaskResult ; law:stepResult/law:verdict ?v }")
    assert {each.verdict.iri for each in made.steps} <= {row["v"] for row in rows}


FETCHES = """@prefix law: <https://example.org/law#> .
<t> a law:TaskSpecification ; law:hasStep <s> ; law:avoids <r> .
<s> a law:Task ; law:index 1 ; law:verb law:Open ; law:everyContainer true .
<r> a law:QueryRule ; law:sparql "ASK { SERVICE <http://127.0.0.1:1/> { ?s ?p ?o } }" ."""


@pytest.mark.parametrize("task", ["dance", "/etc/passwd", "../x.ttl", "<a> <b> .", FETCHES])
def test_a_task_that_is_none_reads_a_file_or_fetches_is_refused(connection: Connection, task: str) -> None:
    with pytest.raises(RequestError):
        connection.task(task, "pr2")


def test_a_server_counts_what_it_was_asked_and_how_it_ended(connection: Connection) -> None:
    before = connection.metrics()[0]
    connection.satisfies()
    with pytest.raises(RequestError):
        connection.satisfies("nothing=open")
    after = connection.metrics()[0]
    name = 'sdt_requests_total{{surface="bus",what="satisfies",end="{}"}}'
    for end in ("answer", "invalid-request"):
        assert after[name.format(end)] == before.get(name.format(end), 0) + 1
