"""What a hostile client sends ends with a status of its own, and the service lives on."""

import gzip
import re
import socket
import threading
from collections.abc import Callable, Iterator

import pytest

from services.http.app import create_app
from services.http.run import Serving, bound
from services.http.settings import Address, Settings
from services.http.world import World
from services.store.workers import Limits, Workers, bulk

LIMITS = Limits(seconds=1.0, memory=64 * 2**20, rows=1000, size=100_000)
SOME = "".join(f'<http://e/s{i % 50}> <http://e/p{i % 7}> "{i}" <http://e/g> .\n' for i in range(600))
TYPE = {"content-type": "application/sparql-query"}
BOMBS: dict[str, tuple[str, set[int]]] = {
    "optional after optional": (
        "SELECT (COUNT(*) AS ?n) {" + "".join(f" OPTIONAL {{ ?a{i} ?b{i} ?c{i} }}" for i in range(30)) + "}",
        {408, 507},
    ),
    "optional in optional": (
        "SELECT * {" + "".join(f" ?a ?p{i} ?o{i} OPTIONAL {{" for i in range(40)) + "}" * 41,
        {408, 413, 507},
    ),
    "unions": (
        "SELECT (COUNT(*) AS ?n) {"
        + "".join(f" {{ {{ ?a ?b ?c{i} }} UNION {{ ?a ?d ?c{i} }} }}" for i in range(20))
        + "}",
        {408, 507},
    ),
    "a large template": (
        "CONSTRUCT {" + " ".join(f"?a <u:{i}> ?d ." for i in range(500)) + "} WHERE { ?a ?b ?c . ?d ?e ?f }",
        {413},
    ),
    "order of a product": ("SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i } ORDER BY ?i LIMIT 1", {408, 507}),
    "concatenation of a product": (
        "SELECT (GROUP_CONCAT(?c) AS ?t) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }",
        {408, 413, 507},
    ),
    "a text that doubles": (
        "SELECT ?x40 { BIND('ab' AS ?x0) "
        + "".join(f"BIND(CONCAT(?x{i}, ?x{i}) AS ?x{i + 1}) " for i in range(40))
        + "}",
        {408, 507},
    ),
    "stars over stars": (
        "SELECT (COUNT(*) AS ?n) { ?a ((!<u:b>|^!<u:b>)*/(!<u:c>)*)+ ?b . ?b !<u:d>* ?c }",
        {408, 507},
    ),
    "a limit beyond all numbers": ("SELECT * { ?a ?b ?c } LIMIT 99999999999999999999999", {400}),
    "as many as one likes": ("SELECT * { ?a ?b ?c . ?d ?e ?f } LIMIT 18446744073709551615", {413}),
    "SERVICE, two queries down": (
        "SELECT * { { SELECT * { { SELECT * { SERVICE <http://127.0.0.1:9/> { ?a ?b ?c } } } } } }",
        {403},
    ),
    "FROM NAMED of elsewhere": ("SELECT * FROM NAMED <http://127.0.0.1:9/> { GRAPH ?g { ?a ?b ?c } }", {403}),
}  # fmt: skip


@pytest.fixture(scope="module")
def served(serve):
    served = serve(kitchens=("a",), robots=("pr2",), limits=LIMITS, workers=2)
    served.apply(bulk(SOME.encode()))
    return served


@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_ends_at_a_limit_and_the_next_query_is_answered(served, name: str) -> None:
    text, statuses = BOMBS[name]
    answer = served.post("/sparql", content=text, headers=TYPE)
    assert answer.status_code in statuses, answer.text[:300]
    assert answer.headers["content-type"] == "application/problem+json"
    assert served.query("ASK { <http://e/s1> ?p ?o }").json()["boolean"]


JSON = "application/json"
STATE, SEEN, BRANCH = (f"/api/v1/{verb}" for verb in ("state", "observation", "branch"))
OBSERVED = '{"positions": {"low_drawer_joint": %s}, "time": "2026-01-31T12:00:00Z", "by": "%s"}'
EDITED = '{"edit": {"entity": "%s", "changes": {"upperLimit": 1}}}'
BODIES: dict[str, tuple[str, bytes, str, int]] = {
    "brackets without end": (STATE, b"[" * 100_000, JSON, 400),
    "a deep object": (STATE, b'{"state":' * 30_000 + b"1" + b"}" * 30_000, JSON, 400),
    "JSON as a form would send it": (STATE, b'{"state": ["low_drawer=0.1"]}', "text/plain", 415),
    "JSON as nothing": (STATE, b'{"state": ["low_drawer=0.1"]}', "", 415),
    "half a character": (STATE, b'{"state": ["\\ud800"]}', JSON, 422),
    "a name with an end": (STATE, b'{"state": ["low_drawer=\\u0000"]}', JSON, 400),
    "no number that fits": (SEEN, (OBSERVED % ("9" * 5000, "x")).encode(), JSON, 400),
    "infinity": (SEEN, (OBSERVED % ("1e999", "x")).encode(), JSON, 422),
    "half a name": (SEEN, (OBSERVED % ("0.1", "\\ud800")).encode(), JSON, 422),
    "an IRI that ends early": (BRANCH, (EDITED % "https://e/> . <x").encode(), JSON, 404),
    "an IRI with an end": (BRANCH, (EDITED % "urn:\\u0000").encode(), JSON, 404),
    "a parent with an end": (BRANCH, b'{"state": ["low_drawer=0.1"], "parent": "\\u0000"}', JSON, 404),
    "a query in parts": ("/sparql", b'--x\r\n\r\nASK {}\r\n--x--', "multipart/form-data; boundary=x", 415),
    "a query in another alphabet": ("/sparql", b"ASK {}", "application/sparql-query; charset=utf-7", 415),
}  # fmt: skip


@pytest.mark.parametrize("name", BODIES)
def test_a_body_that_is_none_is_refused_and_writes_nothing(served, name: str) -> None:
    path, body, media, status = BODIES[name]
    version = served.world.version
    answer = served.post(path, content=body, headers={"content-type": media} if media else {})
    assert answer.status_code == status, answer.text[:300]
    assert answer.headers["content-type"] == "application/problem+json"
    assert served.world.version == version


def test_what_is_packed_is_not_unpacked(served) -> None:
    bomb = gzip.compress(b"ASK {} #" + bytes(10_000_000))
    for path, media in (("/sparql", TYPE["content-type"]), (STATE, JSON)):
        headers = {"content-type": media, "content-encoding": "gzip"}
        answer = served.post(path, content=bomb, headers=headers)
        assert (answer.status_code, answer.headers["accept-encoding"]) == (415, "identity")


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/static/..%2fsettings.py", 404),
        ("/static/%2e%2e/settings.py", 404),
        ("/id/%2e%2e/%2e%2e/etc/passwd", 404),
        ("/id/a%0d%0aSet-Cookie:%20a=b", 404),
        ("/id/%00", 404),
        ("/kitchens/a.%00", 404),
        ("/about?iri=https://example.org/id/%3E%20.%20%3Cx%3E", 400),
        ("/graphs?graph=https://e/%3E%7D%20DROP%20ALL", 400),
        ("/graphs?graph=urn:%ED%A0%80", 400),
        ("/sparql?query=ASK%7B%7D&default-graph-uri=https://e/%3E%20x", 400),
        ("/api/v1/why?iri=%3E", 404),
        ("/api/v1/satisfies?state=low_drawer%3Dnan", 400),
    ],
)
def test_a_path_that_leads_elsewhere_leads_nowhere(served, path: str, status: int) -> None:
    answer = served.get(path)
    assert answer.status_code == status, answer.text[:300]
    assert "set-cookie" not in answer.headers


Sent = Callable[[bytes], list[int]]


@pytest.fixture(scope="module")
def sent() -> Iterator[Sent]:
    """The statuses that bytes on a real socket are answered with, until the service closes it."""
    listening = bound(Address("127.0.0.1", 0))
    ready = threading.Event()
    server = Serving(create_app(World({}, Workers(1)), Settings()), ready.set)
    thread = threading.Thread(target=server.run, args=([listening],))
    thread.start()
    assert ready.wait(60)

    def send(text: bytes) -> list[int]:
        with socket.create_connection(listening.getsockname(), timeout=0.3) as client:
            client.sendall(text)
            got = b""
            try:
                while part := client.recv(4096):
                    got += part
            except (TimeoutError, ConnectionResetError):  # it is kept open for the next request, or cut
                pass
        return [int(status) for status in re.findall(rb"HTTP/1\.1 (\d+)", got)]

    yield send
    server.should_exit = True
    thread.join()


HOST = b"Host: 127.0.0.1\r\n"
GET, POST = b"GET /version HTTP/1.1\r\n" + HOST, b"POST /sparql HTTP/1.1\r\n" + HOST
HIDDEN = GET + b"\r\n"
SMUGGLED: dict[str, tuple[bytes, list[int]]] = {
    "a plain request": (HIDDEN, [200]),
    "two lengths": (POST + b"Content-Length: 0\r\nContent-Length: 50\r\n\r\n" + HIDDEN, [400]),
    "a length that is none": (POST + b"Content-Length: +5\r\n\r\n" + HIDDEN, [400]),
    "a coding that nobody knows": (POST + b"Transfer-Encoding: xchunked\r\n\r\n" + HIDDEN, [400, 501]),
    "two hosts": (GET + b"Host: evil.example\r\n\r\n", [400]),
    "no host": (b"GET /version HTTP/1.0\r\n\r\n", [400]),
    "another host in the target": (b"GET http://e.example/version HTTP/1.1\r\n" + HOST + b"\r\n", [400, 404]),
    "an end in a header": (GET + b"X: a\x00b\r\n\r\n", [400]),
    "a space before the colon": (GET + b"Content-Length : 5\r\n\r\n", [400]),
}  # fmt: skip


@pytest.mark.parametrize("name", SMUGGLED)
def test_a_head_that_two_readers_may_read_differently_is_refused(sent: Sent, name: str) -> None:
    text, statuses = SMUGGLED[name]
    answered = sent(text)
    assert len(answered) == 1, f"what hides behind it was answered: {answered}"
    assert answered[0] in statuses
    assert sent(HIDDEN) == [200]


def test_a_head_without_end_is_cut(sent: Sent) -> None:
    assert sent(GET + b"X: " + b"a" * 200_000 + b"\r\n\r\n") in ([], [400], [431])
    assert sent(HIDDEN) == [200]
