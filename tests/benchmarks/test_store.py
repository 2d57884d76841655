"""Figures of stores: questions, write-back and load, in process and over HTTP. `make bench`.

The data are verdicts that `law` gave about small kitchens, multiplied (tests/services/store/multiplied).
A question is asked about the kitchen, container, … that its head says may be known, as a user of one
kitchen does, and as it is: what is counted over everything takes as long as there is, and is not flat.
"""

import io
import itertools
import re
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any

import pyoxigraph as ox
import pytest
import rdflib

import ontology
from predicates.case import Case
from predicates.law import law
from predicates.record import Record, to_record
from sdt_kg.iri import PREFIXES, body_iri, model_iri, verdict_iri
from sdt_kg.scope import D_ARTIC
from sdt_kg.store import Row, Term, rows_of
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from services.store.embedded import EmbeddedStore
from services.store.files import SavedVerdicts
from services.store.known import restricted
from services.store.on_disk import in_folder, read_file
from services.store.quads import QuadStore, content
from services.store.server.remote import Addresses, RemoteStore
from services.store.server.wire import Wire
from tests.ports import free_port
from tests.services.store.conftest import Server
from tests.services.store.multiplied import multiplied
from tests.small import small_twin
from tests.small.lift import Lift

Benchmark = Callable[..., Any]
QUERIES = sorted(Path(str(ontology.path("queries"))).glob("cq*.rq"))
COUNTED = [query for query in QUERIES if "GROUP BY" in query.read_text()]
SIZES = [100_000, 1_000_000]
ABOUT: dict[str, Term] = {
    "class": ox.NamedNode(D_ARTIC.iri),
    "container": ox.NamedNode(body_iri("a", "folding_door")),
    "environment": ox.NamedNode(model_iri("a")),
    "handle": ox.NamedNode(body_iri("a", "folding_door_handle")),
    "model": ox.NamedNode(model_iri("a")),
    "robot": ox.NamedNode(model_iri("pr2")),
}
RDFLIB_SIZE = 20_000
"""[quads] What rdflib answers in seconds rather than minutes."""


@cache
def judged() -> tuple[Any, Any]:
    """Twins and verdicts, as tests/services/store has them."""
    twins = [small_twin(kitchen, ("pr2", "stretch")) for kitchen in ("a", "b")]
    verdicts = [
        each for twin in twins for each in law(Case(twin, task=Task(Verb.OPEN)), Kinematics(), Lift())
    ]
    return tuple(twins), tuple(verdicts)


@cache
def text(size: int) -> bytes:
    return b"".join(multiplied(size, *judged()))


@cache
def store(size: int) -> EmbeddedStore:
    held = ox.Store()
    held.bulk_load(text(size), format=ox.RdfFormat.N_QUADS)
    return EmbeddedStore(held)


def known(query: Path) -> dict[str, Term]:
    """What a question is asked about: the variable that its head says may be known."""
    asked = re.search(r"^# Known .*\?(\w+)", query.read_text(), re.MULTILINE)
    return {asked[1]: ABOUT[asked[1]]} if asked else {}


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("query", QUERIES, ids=lambda path: path.stem)
def test_question_in_process(benchmark: Benchmark, query: Path, size: int) -> None:
    _ask(benchmark, query, size, known(query))


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("query", COUNTED, ids=lambda path: path.stem)
def test_count_over_everything(benchmark: Benchmark, query: Path, size: int) -> None:
    _ask(benchmark, query, size, {})


def _ask(benchmark: Benchmark, query: Path, size: int, about: dict[str, Term]) -> None:
    asked, held = query.read_text(), store(size)
    benchmark.group, benchmark.extra_info["about"] = query.stem[:4], sorted(about)
    rows = benchmark.pedantic(lambda: rows_of(held.query(asked, known=about))[1], rounds=15, warmup_rounds=2)
    benchmark.extra_info["rows"] = len(rows)


@pytest.mark.filterwarnings("ignore:Dataset.contexts is deprecated")  # rdflib's own evaluator calls it
@pytest.mark.parametrize("query", QUERIES, ids=lambda path: path.stem)
def test_question_against_rdflib(benchmark: Benchmark, query: Path) -> None:
    """How many times as long rdflib's own evaluator takes over its own store, in one run (extra_info)."""
    held, about = store(RDFLIB_SIZE), known(query)
    asked = restricted(query.read_text(), about)
    dataset = rdflib_dataset()
    rows = benchmark.pedantic(lambda: rows_of(held.query(asked))[1], rounds=9, warmup_rounds=1)
    began = time.perf_counter()
    theirs = list(dataset.query(asked, initNs=PREFIXES))
    seconds = time.perf_counter() - began
    assert len(theirs) == len(rows)
    benchmark.extra_info["rdflib takes times"] = round(seconds / benchmark.stats.stats.median)


@cache
def rdflib_dataset() -> rdflib.Dataset:
    dataset = rdflib.Dataset(default_union=True)
    dataset.parse(io.BytesIO(text(RDFLIB_SIZE)), format="nquads")
    return dataset


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RemoteStore]:
    """An Oxigraph server with the smaller of the sizes."""
    folder = tmp_path_factory.mktemp("served") / "store"
    filled = ox.Store(str(folder))
    filled.bulk_load(text(SIZES[0]), format=ox.RdfFormat.N_QUADS)
    filled.flush()
    del filled
    server = Server(folder, free_port())
    server.start()
    try:
        server.wait()
        remote = RemoteStore(Addresses.of(server.address), Wire())
        yield remote
        remote.close()
    finally:
        server.kill()


@pytest.mark.parametrize("query", QUERIES, ids=lambda path: path.stem)
def test_question_over_http(benchmark: Benchmark, served: RemoteStore, query: Path) -> None:
    asked, about = query.read_text(), known(query)
    ask: Callable[[], list[Row]] = lambda: rows_of(served.query(asked, known=about))[1]  # noqa: E731 - timed
    benchmark.group = query.stem[:4]
    benchmark.pedantic(ask, rounds=15, warmup_rounds=2)


@pytest.mark.parametrize("where", ["memory", "folder"])
def test_write_back_of_a_verdict(benchmark: Benchmark, tmp_path: Path, where: str) -> None:
    """A verdict that is new, read before it is written, next to many others."""
    kept: QuadStore = store(SIZES[0]) if where == "memory" else in_folder(tmp_path / "store")
    _write_back(benchmark, kept, where)
    if where == "folder":
        kept.close()


@pytest.mark.parametrize("where", ["memory", "folder"])
def test_write_back_to_a_server(benchmark: Benchmark, tmp_path: Path, where: str) -> None:
    """The same on an Oxigraph; in the same run [ms], one request with one quad or its quads (extra_info)."""
    server = Server(tmp_path / "store" if where == "folder" else None, free_port())
    server.start()
    try:
        server.wait()
        wire = Wire()
        remote = RemoteStore(Addresses.of(server.address), wire)
        _write_back(benchmark, remote, where)
        for name, count in (("one quad", 1), ("all its quads", None)):
            times: list[float] = []
            for number in range(200):
                quads = list(islice(_another(f"bare{count}{number}").quads(), count))
                update = f"INSERT DATA {{ {content(quads)} }}"
                began = time.perf_counter()
                wire.update(f"{server.address}/update", update)
                times.append(time.perf_counter() - began)
            benchmark.extra_info[f"{name}, bare"] = round(1e3 * statistics.median(times), 2)
        remote.close()
    finally:
        server.kill()


def _write_back(benchmark: Benchmark, kept: QuadStore, where: str) -> None:
    saved, numbers = SavedVerdicts(kept), itertools.count()
    fresh: Callable[[], Any] = lambda: ((_another(f"{where}{next(numbers)}"),), {})  # noqa: E731 - of a round
    assert benchmark.pedantic(saved.add_record, setup=fresh, rounds=200)


def _another(name: str) -> Record:
    """A verdict as if of other inputs."""
    return to_record(replace(judged()[1][0], iri=verdict_iri(name)))


@pytest.mark.parametrize("size", SIZES)
def test_load(benchmark: Benchmark, tmp_path: Path, size: int) -> None:
    """Quads in a second, of wall time and of CPU time, from a .nq file (extra_info)."""
    path = tmp_path / "all.nq"
    path.write_bytes(text(size))
    cpu: list[float] = []

    def load() -> int:
        began = time.process_time()
        held = read_file(path)
        cpu.append(time.process_time() - began)
        return len(held)

    assert benchmark.pedantic(load, rounds=3) > 0
    lines = text(size).count(b"\n")
    benchmark.extra_info["quads a second"] = round(lines / benchmark.stats.stats.median)
    benchmark.extra_info["quads a second of CPU"] = round(lines / statistics.median(cpu))


@pytest.mark.parametrize("where", ["memory", "folder"])
def test_load_to_a_server(benchmark: Benchmark, tmp_path: Path, where: str) -> None:
    """Quads in a second of CPU time: of this process, of an Oxigraph server, and into memory (extra_info)."""
    quads = list(ox.parse(text(SIZES[0]), format=ox.RdfFormat.N_QUADS))
    server = Server(tmp_path / "store" if where == "folder" else None, free_port())
    server.start()
    try:
        server.wait()
        remote = RemoteStore(Addresses.of(server.address))
        ours, theirs = time.process_time(), server.seconds()
        benchmark.pedantic(remote.add, (quads,), rounds=1)
        ours, theirs = time.process_time() - ours, server.seconds() - theirs
        assert len(remote.dump([quads[0].graph_name.value])) > 0
        remote.close()
    finally:
        server.kill()
    began = time.process_time()
    EmbeddedStore(ox.Store()).add(quads)
    memory = time.process_time() - began
    for name, seconds in (("client", ours), ("server", theirs), ("memory", memory)):
        benchmark.extra_info[f"{name}, quads a second of CPU"] = round(len(quads) / seconds)
