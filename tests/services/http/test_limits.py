# ruff: noqa: S608 - the queries are the subject
"""A limit reached is an error with its own status, never a shorter answer; the service lives on."""

import os
import re
import signal
import time
from pathlib import Path

import pytest

from services.store.workers import Limits, bulk, put
from tests.services.http.canary import singing

FEW_SECONDS, ROWS, SIZE = 2.0, 2000, 200_000
LIMITS = Limits(seconds=FEW_SECONDS, memory=128 * 2**20, rows=ROWS, size=SIZE)
SUBJECTS = 3000

SLOW = """SELECT (COUNT(*) AS ?n) {
  ?a ?b ?c . ?d ?e ?f FILTER(CONTAINS(SHA512(SHA512(CONCAT(?c, ?f))), "nothing has this"))
}"""
THOUSAND = "x" * 1000
MEMORY_HOG = f"""SELECT (STRLEN(?large) AS ?n) {{
  BIND(REPLACE("{THOUSAND}", "x", "{THOUSAND}") AS ?million)
  BIND(REPLACE(?million, "x", "{THOUSAND}") AS ?large)
}}"""
HUGE = "SELECT * { ?a ?b ?c . ?d ?e ?f }"
TOO_MANY_ROWS = "SELECT ?c { ?a ?b ?c }"
TOO_MANY_TRIPLES = "CONSTRUCT WHERE { ?a ?b ?c }"
CHAIN = "".join(
    f"<http://e/n{i}> <http://e/next> <http://e/n{(i * 7 + k) % 400}> .\n"
    for i in range(400)
    for k in (1, 2, 3)
)
PATH_BOMB = """SELECT (COUNT(*) AS ?n) {
  ?a (<http://e/next>|^<http://e/next>)* ?b . ?b (<http://e/next>/<http://e/next>?)* ?c . ?c !<http://e/x>* ?d
}"""
VALUES_BOMB = (
    "SELECT * {" + "".join(f" VALUES ?v{i} {{ {' '.join(map(str, range(60)))} }}" for i in range(8)) + "}"
)
CONCAT_BOMB = "SELECT (GROUP_CONCAT(STR(?s); separator='" + "x" * 60_000 + "') AS ?t) { ?s ?p ?o }"
GROUP_BOMB = "SELECT ?a ?d (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f } GROUP BY ?a ?d"
REGEX_BOMB = "ASK { ?s ?p ?o FILTER(REGEX(STR(?s), '((((a{1,99}){1,99}){1,99}){1,99}){1,99}')) }"
NESTED = "ASK { " + "{" * 100_000 + "}" * 100_000 + " }"


@pytest.fixture(scope="module")
def served(serve):
    served = serve(limits=LIMITS, workers=2)
    lines = (f'<http://e/s{i}> <http://e/p> "value {i}" <http://e/g{i % 5}> .\n' for i in range(SUBJECTS))
    served.apply(bulk(("".join(lines)).encode()), put("http://e/chain", CHAIN.encode()))
    return served


def lives_on(served) -> bool:
    answers = [served.query("ASK { <http://e/s1> ?p ?o }") for _ in range(3)]
    return all(answer.status_code == 200 and answer.json()["boolean"] for answer in answers)


@pytest.mark.parametrize(
    ("query", "status", "limit"),
    [
        (SLOW, 408, "time"),
        (MEMORY_HOG, 507, "memory"),
        (HUGE, 413, "bytes"),
        (TOO_MANY_ROWS, 413, "rows"),
        (TOO_MANY_TRIPLES, 413, "rows"),
    ],
)
def test_a_limit_reached_is_an_error_of_its_own(served, query: str, status: int, limit: str) -> None:
    answer = served.query(query)
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert problem["limit"] == limit
    assert problem["allowed"]
    assert lives_on(served)


@pytest.mark.parametrize(
    "accept",
    [
        "application/sparql-results+json",
        "application/sparql-results+xml",
        "text/csv",
        "text/tab-separated-values",
    ],
)
def test_rows_are_counted_exactly_in_every_format(served, accept: str) -> None:
    most = served.query(f"{TOO_MANY_ROWS} LIMIT {ROWS}", headers={"accept": accept})
    more = served.query(f"{TOO_MANY_ROWS} LIMIT {ROWS + 1}", headers={"accept": accept})
    assert (most.status_code, more.status_code) == (200, 413)


def test_a_query_that_crashes_its_worker_is_answered(served) -> None:
    answer = served.post("/sparql", content=NESTED, headers={"content-type": "application/sparql-query"})
    assert answer.status_code in {400, 408, 507}, answer.text  # stack, time or memory: whichever ends first
    assert lives_on(served)


@pytest.mark.parametrize(
    ("query", "statuses"),
    [
        (PATH_BOMB, {408, 507}),
        (VALUES_BOMB, {408, 413, 507}),
        (CONCAT_BOMB, {413, 507}),
        (GROUP_BOMB, {408, 413, 507}),
        (REGEX_BOMB, {200, 400, 408, 507}),
    ],
    ids=["paths", "values", "concatenation", "groups", "regular expression"],
)
def test_a_bomb_ends_at_a_limit_and_the_service_lives_on(served, query: str, statuses: set[int]) -> None:
    answer = served.post("/sparql", content=query, headers={"content-type": "application/sparql-query"})
    assert answer.status_code in statuses, answer.text[:300]
    assert lives_on(served)


def test_slow_queries_do_not_keep_others_waiting(served) -> None:
    """With two workers, one is slow; a quick query is answered long before the slow one is stopped."""

    async def slow() -> int:
        return (await served.client.get("/sparql", params={"query": SLOW})).status_code

    stopped = served.portal.start_task_soon(slow)
    time.sleep(0.1)
    began = time.perf_counter()
    assert served.query("ASK {}").status_code == 200
    assert time.perf_counter() - began < FEW_SECONDS / 2
    assert stopped.result() == 408


def test_the_text_of_a_query_is_bounded(served) -> None:
    text = "ASK {} #" + "x" * 300_000
    answer = served.post("/sparql", content=text, headers={"content-type": "application/sparql-query"})
    assert answer.status_code == 413


def test_random_terms_differ_between_workers(served) -> None:
    """Forked processes would share their random numbers."""
    found = set()
    for _ in range(3):
        assert served.query(MEMORY_HOG).status_code == 507  # costs a worker its life
        answer = served.query("SELECT (STRUUID() AS ?u) {}")
        found.add(answer.json()["results"]["bindings"][0]["u"]["value"])
    assert len(found) == 3


def test_a_worker_can_open_neither_socket_nor_file(served) -> None:
    """What the process itself is allowed, whatever it is asked: all its descriptors are taken."""
    pids = served.world.workers.pids
    assert len(pids) == 2
    for pid in pids:
        process = Path(f"/proc/{pid}")
        assert re.search(r"Max open files +4 +4 ", (process / "limits").read_text())
        targets = {each.name: str(each.readlink()) for each in (process / "fd").iterdir()}
        assert set(targets) == {"0", "1", "2", "3"}
        assert [target.partition(":")[0] for _, target in sorted(targets.items())][2:] == ["pipe", "socket"]
        if served.world.workers.namespace:
            assert (process / "ns/net").readlink() != Path("/proc/self/ns/net").readlink()


def test_nothing_is_ever_fetched(served) -> None:
    with singing() as canary:
        url = canary.url
        for text in (
            f"SELECT * {{ SERVICE <{url}> {{ ?a ?b ?c }} }}",
            f"SELECT * {{ SERVICE SILENT <{url}> {{ ?a ?b ?c }} }}",
            f"SELECT * {{ \\u0053ERVICE <{url}> {{ ?a ?b ?c }} }}",
            f"SELECT * FROM <{url}> {{ ?a ?b ?c }}",
            f"SELECT * FROM NAMED <{url}> {{ GRAPH ?g {{ ?a ?b ?c }} }}",
            f"LOAD <{url}>",
            f"SELECT * {{ GRAPH <{url}> {{ ?a ?b ?c }} }}",
            f"DESCRIBE <{url}>",
        ):
            assert served.query(text).status_code in {200, 400, 403}
        for parameters in ({"default-graph-uri": url}, {"named-graph-uri": url}):
            assert served.get("/sparql", params={"query": "ASK {}"} | parameters).status_code == 403
        assert served.get("/graphs", params={"graph": url}).status_code == 404
        assert served.post("/sparql", data={"update": f"LOAD <{url}>"}).status_code == 403
        assert canary.hits == []


def state_of(pid: int) -> str:
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]


@pytest.mark.parametrize("unread", [False, True], ids=["idle", "with a change unread"])
def test_workers_that_are_killed_are_replaced_and_lost_data_is_said(serve, unread: bool) -> None:
    served = serve(workers=2)
    deadline = time.monotonic() + 10
    killed = served.world.workers.pids
    if unread:
        for pid in killed:
            os.kill(pid, signal.SIGSTOP)
        served.apply(put("http://e/late", b'<http://e/s> <http://e/p> "1" .'))
    for pid in killed:
        os.kill(pid, signal.SIGKILL)
    while any(state_of(pid) != "Z" for pid in killed) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert [served.query("ASK {}").status_code for _ in range(4)] == [200] * 4, "no query is blamed for it"
    assert len(served.world.workers.pids) == 2
    (nursery,) = {int(Path(f"/proc/{pid}/stat").read_text().split()[3]) for pid in served.world.workers.pids}
    os.kill(nursery, signal.SIGKILL)
    deadline = time.monotonic() + 10
    while served.get("/readyz").status_code == 200 and time.monotonic() < deadline:
        time.sleep(0.02)
    assert served.get("/readyz").status_code == 503
    assert served.query("ASK {}").status_code == 503
    assert served.get("/healthz").status_code == 200


def test_an_interrupt_of_a_terminal_is_not_for_the_processes_that_query(served) -> None:
    # Not even for those that still begin, and do not ignore it yet.
    assert os.getpgid(0) not in {os.getpgid(pid) for pid in served.world.workers.pids}
