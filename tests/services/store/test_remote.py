"""A server that goes away, comes back, breaks its answer off, or is none."""

import json
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pyoxigraph as ox
import pytest

from sdt_kg.errors import InputError, QueryError, StoreRejectedError, StoreUnavailableError
from sdt_kg.store import rows_of
from services import cli
from services.store.files import opened
from services.store.server.remote import BATCH, Addresses, RemoteStore
from services.store.server.wire import RETRY_WAITS, Wire
from tests.ports import free_port
from tests.services.store.conftest import OXIGRAPH, Server

G = "https://example.org/g"
COUNT = "SELECT (COUNT(*) AS ?n) { ?s ?p ?o }"


def quads(count: int, graph: str = G) -> list[ox.Quad]:
    p, name = ox.NamedNode("https://example.org/p"), ox.NamedNode(graph)
    return [ox.Quad(ox.NamedNode(f"https://example.org/{n}"), p, ox.Literal(n), name) for n in range(count)]


def counted(store: RemoteStore) -> object:
    return rows_of(store.query(COUNT))[1][0]["n"]


def remote(address: str, waits: tuple[float, ...] = (0.01,), timeout: float = 20.0) -> RemoteStore:
    return RemoteStore(Addresses.of(address), Wire(waits, timeout))


def test_there_is_a_server() -> None:
    assert OXIGRAPH.is_file()


def by_updates(server: Server) -> str:
    """Addresses of a server of which nothing is known but that it speaks SPARQL 1.1."""
    return f"{server.address}/query,{server.address}/update"


def test_many_quads_take_several_requests(server: Server) -> None:
    store = remote(by_updates(server))
    store.add(quads(2 * BATCH + 1))
    assert counted(store) == 2 * BATCH + 1
    assert set(store.dump()) == set(quads(2 * BATCH + 1))
    store.close()


@pytest.fixture
def file_size(monkeypatch: pytest.MonkeyPatch) -> int:
    """Quads of which one file is made: the fewest of which files are made at all."""
    monkeypatch.setattr("services.store.server.remote.BULK", BATCH + 1)
    return BATCH + 1


def test_an_oxigraph_takes_many_quads_as_files(server: Server, file_size: int) -> None:
    store, count = remote(server.address), 2 * file_size + 1
    store.add(quads(1))
    store.add(quads(count))
    assert set(store.graph(G)) == set(quads(count))
    store.close()


def test_an_oxigraph_killed_in_a_file_has_it_whole_or_not_at_all(server: Server, file_size: int) -> None:
    store, given = remote(server.address), quads(9 * file_size)
    killer = threading.Timer(1.5 * seconds_of(store, quads(file_size, "https://example.org/h")), server.kill)
    killer.start()
    with pytest.raises(StoreUnavailableError):
        store.add(given)
    killer.join()
    server.start()
    server.wait()
    found = len(store.graph(G))
    assert found % file_size == 0
    assert found < len(given)
    store.close()


def seconds_of(store: RemoteStore, given: list[ox.Quad]) -> float:
    """How long it takes to add them."""
    began = time.monotonic()
    store.add(given)
    return time.monotonic() - began


def test_a_server_that_is_killed_is_named_and_what_it_acknowledged_is_there_later(server: Server) -> None:
    store = remote(server.address)
    store.add(quads(60))
    server.kill()
    for act in (lambda: store.add(quads(1)), lambda: store.query(COUNT), lambda: G in store):
        with pytest.raises(StoreUnavailableError, match="2 times in a row; is the server running") as caught:
            act()
        assert caught.value.place.startswith(server.address)
    server.start()
    server.wait()
    assert counted(store) == 60
    store.close()


def test_a_restart_is_survived(server: Server) -> None:
    store = remote(server.address, RETRY_WAITS)
    store.add(quads(60))
    server.kill()
    again = threading.Timer(0.4, server.start)
    again.start()
    store.add(quads(10, "https://example.org/h"))
    assert counted(store) == 70
    again.join()
    store.close()


def test_a_server_killed_in_a_long_write_has_whole_batches_and_takes_it_again(server: Server) -> None:
    store = remote(by_updates(server))

    def slowly() -> Iterator[ox.Quad]:
        for index, quad in enumerate(quads(4 * BATCH)):
            if index == 2 * BATCH + 7:
                server.kill()
            yield quad

    with pytest.raises(StoreUnavailableError):
        store.add(slowly())
    server.start()
    server.wait()
    assert counted(store) == 2 * BATCH
    store.add(quads(4 * BATCH))
    assert counted(store) == 4 * BATCH
    store.close()


def test_an_answer_that_is_broken_off_by_a_time_limit_is_no_answer(server: Server) -> None:
    server.kill()
    server.start("--timeout-s", "1")
    server.wait()
    store = remote(server.address)
    store.add(quads(1_000))
    few_of_many = "{ ?a ?b ?c . ?d ?e ?f . ?g ?h ?i FILTER (?c + ?f = ?i) }"
    for sparql in (f"SELECT ?c ?f ?i {few_of_many}", f"CONSTRUCT {{ ?a ?e ?i }} WHERE {few_of_many}"):
        with pytest.raises(StoreRejectedError, match="broke its answer off"):
            store.query(sparql)
    store.close()


@contextmanager
def answering(status: int, body: bytes, kind: str, **headers: str) -> Iterator[tuple[str, list[str]]]:
    """A web server that always says the same, and the paths it was asked for."""
    asked: list[str] = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.rfile.read(int(self.headers["content-length"]))
            asked.append(self.path)
            self.send_response(status)
            for name, value in {"content-type": kind, "content-length": str(len(body)), **headers}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:
            return

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as web:
        thread = threading.Thread(target=web.serve_forever, args=(0.02,))
        thread.start()
        try:
            yield f"http://anna:secret@127.0.0.1:{web.server_port}", asked
        finally:
            web.shutdown()
            thread.join()


JSON = "application/sparql-results+json"
STRANGE: dict[str, tuple[int, bytes, str, type[Exception], str]] = {
    "a web page": (200, b"<html>", "text/html", StoreRejectedError, "text/html"),
    "no password": (401, b"who?", "text/plain", StoreRejectedError, "USER:PASSWORD"),
    "another path": (404, b"what?", "text/plain", StoreRejectedError, "both addresses"),
    "elsewhere": (308, b"", "text/plain", StoreRejectedError, "308"),
    "a fault": (500, b"sorry", "text/plain", StoreRejectedError, "sorry"),
    "busy": (503, b"later", "text/plain", StoreUnavailableError, "503"),
    "a bad query": (400, b"column 3", "text/plain", QueryError, "column 3"),
    "half a row": (200, b'{"head":{"vars":[]},"results":{"bindings":[{', JSON, StoreRejectedError, "broke"),
    "half a truth": (200, b'{"head":{},"boolean":false', JSON, StoreRejectedError, "broke"),
    "rows for ASK": (
        200, b'{"head":{"vars":["n"]},"results":{"bindings":[]}}', JSON, StoreRejectedError, "another kind",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", STRANGE)
def test_a_strange_answer_is_a_typed_error_without_the_password(name: str) -> None:
    status, body, kind, error, said = STRANGE[name]
    with answering(status, body, kind) as (address, asked):
        store = remote(address)
        with pytest.raises(error, match=said) as caught:
            store.query("ASK { ?s ?p ?o }", [G])
        store.close()
    assert "secret" not in str(caught.value)
    assert len(asked) == (2 if status == 503 else 1)


def test_a_server_whose_default_graph_is_not_the_union_is_refused() -> None:
    with answering(200, b'{"head":{},"boolean":true}', JSON) as (address, _):
        store = remote(address)
        with pytest.raises(StoreRejectedError, match="union of all"):
            store.query("ASK { ?s ?p ?o }")
        store.close()


def test_a_server_that_rounds_figures_is_refused() -> None:
    double = "http://www.w3.org/2001/XMLSchema#double"
    value = {"type": "literal", "datatype": double, "value": "1.00585"}
    table = {"head": {"vars": ["figure"]}, "results": {"bindings": [{"figure": value}]}}
    with answering(200, json.dumps(table).encode(), JSON) as (address, _):
        store = remote(address)
        for act in (lambda: store.graph(G), lambda: store.query("SELECT ?s { ?s ?p ?o }", [G])):
            with pytest.raises(StoreRejectedError, match=r"gives back 1\.00585 for 1\.0058548015155846"):
                act()
        store.close()


def test_an_answer_that_has_not_all_rows_is_no_answer() -> None:
    whole = b'{"head":{},"boolean":true}'
    with answering(200, whole, JSON, **{"X-SPARQL-MaxRows": "10000"}) as (address, _):
        store = remote(address)
        with pytest.raises(
            StoreRejectedError, match="broke its answer off after 10000 rows; raise its limit"
        ):
            store.query("ASK { ?s ?p ?o }", [G])
        store.close()


def test_a_server_that_says_nothing_is_left_after_the_time_limit() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        store = remote(f"http://127.0.0.1:{silent.getsockname()[1]}", timeout=0.3)
        with pytest.raises(StoreUnavailableError, match="did not answer in"):
            G in store  # noqa: B015 - asked, not used
        store.close()


@pytest.mark.parametrize(
    ("text", "query", "update", "files"),
    [
        ("http://h:7878", "http://h:7878/query", "http://h:7878/update", "http://h:7878/store"),
        ("http://h:7878/", "http://h:7878/query", "http://h:7878/update", "http://h:7878/store"),
        ("https://h/ds/q, https://h/ds/u", "https://h/ds/q", "https://h/ds/u", None),
        ("http://h/sparql", "http://h/sparql", None, None),
    ],
)
def test_addresses(text: str, query: str, update: str | None, files: str | None) -> None:
    assert Addresses.of(text) == Addresses(query, update, files)


@pytest.mark.parametrize(
    "text", ["http://", "http://a/q,ftp://a/u", "http://a/q,", "http://a,http://b,http://c"]
)
def test_what_is_no_address_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="address"):
        opened(text)


def test_one_address_is_only_asked() -> None:
    with pytest.raises(InputError, match="QUERY,http://HOST/UPDATE"):
        opened("http://127.0.0.1:1/sparql").drop(G)


def test_the_command_asks_a_server_and_names_one_that_is_gone(
    server: Server, capsys: pytest.CaptureFixture[str]
) -> None:
    store = remote(server.address)
    store.add(quads(2))
    store.close()
    gone = f"http://127.0.0.1:{free_port()}"
    for address in (server.address, f"{server.address}/query,{server.address}/update"):
        assert cli.run(["query", address, COUNT, "--json"]) == 0
        assert '"n": 2' in capsys.readouterr().out
    assert cli.run(["query", gone, COUNT]) == 4
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert gone in said
