"""Several writers of one record on a server."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pyoxigraph as ox
import pytest

from predicates.case import Diagnosis, Kind, Outcome, Search
from predicates.record import Record, to_record
from sdt_kg.errors import StoreUnavailableError
from sdt_kg.iri import LAW
from services.store.files import SavedVerdicts
from services.store.records import keep
from services.store.server import turns
from services.store.server.turns import WRITERS
from tests.services.store.conftest import Server
from tests.services.store.test_every_store import Judged
from tests.services.store.test_remote import remote


def test_writers_of_one_record_at_once_leave_one_and_the_certified(server: Server, judged: Judged) -> None:
    certified = next(each for each in judged[1] if each.outcome is Outcome.CERTIFIED)
    searched = Diagnosis(Kind.EMBODIMENT, "none found", search=Search(1, 1, 1, 1.0))
    others = [
        replace(
            certified,
            outcome=Outcome.NOT_CERTIFIED,
            diagnoses=(replace(searched, reason=f"none found by {n}"),),
        )
        for n in range(3)
    ]
    for turn in range(12):
        records = [to_record(replace(each, iri=f"{each.iri}{turn}")) for each in (*others, certified)]
        start = threading.Barrier(len(records))

        def write(record: Record, start: threading.Barrier = start) -> None:
            with SavedVerdicts(remote(server.address)) as saved:
                start.wait()
                saved.add_record(record)

        with ThreadPoolExecutor(len(records)) as pool:
            list(pool.map(write, records))
        store = remote(server.address)
        assert set(store.graph(records[-1].graph)) == set(records[-1].quads())
        assert not store.graph(WRITERS)
        store.close()


def test_a_writer_that_died_is_waited_for_and_then_forgotten(
    server: Server, judged: Judged, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = to_record(judged[1][0])
    monkeypatch.setattr(turns, "LEASE", 0.3)
    with SavedVerdicts(remote(server.address)) as saved:
        store = remote(server.address)
        store.insert(
            ox.Quad(
                ox.NamedNode(record.graph),
                ox.NamedNode(LAW + "writer"),
                ox.Literal("dead"),
                ox.NamedNode(WRITERS),
            )
        )
        began = time.monotonic()
        assert saved.add_record(record)
        assert time.monotonic() - began >= 0.3
        assert not store.graph(WRITERS)
        store.close()


def test_a_writer_that_does_not_end_is_told(
    server: Server, judged: Judged, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = to_record(judged[1][0])
    monkeypatch.setattr(turns, "PATIENCE", 0.2)
    one, other = remote(server.address), remote(server.address)
    with one.alone(record.graph), pytest.raises(StoreUnavailableError, match="all the time; try again"):
        keep(other, record)
    assert not one.graph(record.graph)
    assert not one.graph(WRITERS)
    one.close()
    other.close()
