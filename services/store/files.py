"""Verdicts kept in a file (.trig, .nq), a store directory or on a server, and asked again later."""

import os
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Self

from predicates.case import Verdict
from predicates.record import Record, StoredVerdict, to_record
from sdt_kg.annotating.annotate import TEE_GRAPH
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from sdt_kg.store import Row, checked_query, rows_of
from sdt_kg.twin import Twin
from services.stopping import terminable
from services.store.embedded import EmbeddedStore
from services.store.folder import FolderStore
from services.store.models import keep_model, quads_of
from services.store.on_disk import (
    FORMATS,
    folder_as_it_is,
    in_file,
    in_folder,
    is_folder,
    is_only_read,
    is_store_folder,
    read_file,
)
from services.store.quads import QuadStore
from services.store.records import graph_of, keep, recalled
from services.store.server.remote import Addresses, RemoteStore, is_url
from services.store.workers import ALONE, Begin, Limits, apart

__all__ = [
    "FORMATS",
    "SavedVerdicts",
    "is_saved_graph",
    "only_read",
    "opened",
    "query_saved",
    "readable",
    "rows_saved",
]


def is_saved_graph(source: str) -> bool:
    """Whether the text names an RDF file, a store directory or a server, rather than a kitchen."""
    path = Path(source)
    return is_url(source) or path.suffix in FORMATS or (bool(source) and is_store_folder(path))


def opened(place: str | Path) -> QuadStore:
    """The store at a place to which verdicts can be saved; close it after use.

    Args:
        place: `FILE.trig`, `FILE.nq`, a directory, `http://HOST` of an Oxigraph, or
            `http://HOST/QUERY,http://HOST/UPDATE` of any SPARQL 1.1 server.

    Raises:
        InputError: It is no such place, or holds something else.
        StoreUnavailableError: Another process has it.
    """
    if isinstance(place, str) and ("://" in place or not place):
        return RemoteStore(Addresses.of(_address(place)))
    path = Path(place)
    return in_folder(path) if is_folder(path) else in_file(path)


def _address(place: str) -> str:
    """The place, if it is a server's address.

    Raises:
        InputError: It is the address of something else, or nothing, as a variable of a shell may be.
    """
    if not is_url(place):
        raise InputError(
            f"'{place}' is no place for verdicts",
            allowed="FILE.trig, FILE.nq, a directory, http://HOST of an Oxigraph, "
            "http://HOST/QUERY,http://HOST/UPDATE",
        )
    return place


class SavedVerdicts:
    """A context in which verdicts are added; on leaving it they are kept, whatever happened.

    Writing a verdict twice changes nothing, since its IRI is a hash of its inputs.

    Args:
        place: As `opened` takes it, or a store.
    """

    def __init__(self, place: str | Path | QuadStore) -> None:
        self.store = opened(place) if isinstance(place, str | Path) else place
        self._meanwhile = ExitStack()

    def __enter__(self) -> Self:
        self._meanwhile.enter_context(terminable())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._meanwhile:
            self.store.close()
        if isinstance(error, KeyboardInterrupt):
            error.add_note("verdicts which were finished are saved")

    def __contains__(self, verdict: Iri) -> bool:
        """Whether the verdict of this IRI is kept."""
        return graph_of(verdict) in self.store

    def stored(self, verdict: Iri) -> StoredVerdict | None:
        """What is kept of the verdict of this IRI; None where it is damaged, which is logged."""
        return recalled(self.store.graph(graph_of(verdict)), verdict)

    def add_twin(self, twin: Twin) -> None:
        """Keep the twin's named graphs, so that verdicts can be asked together with what they are about.

        A model of that name with other content is replaced, and set aside for a recheck.
        """
        entities, graphs = twin.entities, twin.graphs()
        dumped = entities.store.dump(graphs)
        for model in entities.asserted:
            keep_model(self.store, model, entities.graphs_of(model), dumped)
        for graph in (TEE_GRAPH, graphs[-1]):
            fresh = quads_of(dumped, graph)
            if set(self.store.graph(graph)) != set(fresh):
                with self.store.alone(graph):
                    self.store.replace(graph, fresh)

    def add(self, verdict: Verdict) -> None:
        """Add the verdict's triples to its own named graph."""
        self.add_record(to_record(verdict))

    def add_record(self, record: Record) -> bool:
        """Whether the store has changed; the record may come from a worker process."""
        return keep(self.store, record)


def folder_of_place(place: str | Path) -> Path | None:
    """The folder in which a file or a store's directory lies; None of a server."""
    return None if is_url(str(place)) else Path(place).parent


def query_saved(place: str | Path, sparql: str, limits: Limits = ALONE) -> tuple[list[str], list[Row]]:
    """Columns and rows of a query over everything that was saved, all graphs together.

    It runs in a process of its own, which ends where it takes longer or more memory than it may.

    Args:
        place: As `opened` takes it, or a `.ttl` file.
        sparql: SELECT, ASK, CONSTRUCT or DESCRIBE.
        limits: Its seconds, and its memory beside the data.

    Raises:
        InputError: There is nothing at that place.
        LimitError: The query takes longer, or more memory, than it may.
        QueryError: The query does not parse, or would write or fetch.
        StoreError: The store is held by another process, gone or damaged.
    """
    with apart(limits) as ask:
        return ask(partial(rows_saved, place, checked_query(sparql)))


def rows_saved(place: str | Path, sparql: str, begin: Begin) -> tuple[list[str], list[Row]]:
    """As `query_saved` in this process, which says when all that is asked is loaded."""
    with closing(readable(place)) as store:
        begin()
        return rows_of(store.query(checked_query(sparql)))


def readable(place: str | Path) -> QuadStore:
    """The store at a place where something is; a file, and a directory that is only read, is left as it is.

    Raises:
        InputError: There is nothing at that place.
        StoreError: The store is held by another process, gone or damaged.
    """
    if isinstance(place, str) and "://" in place:
        return opened(place)
    path = Path(place)
    if not place:
        raise InputError("no file or store at ''", allowed="a file or a store")
    if not path.exists():
        raise InputError(
            f"no file or store at {path}", allowed="a .trig or .nq file, or a directory of verdicts"
        )
    if only_read(path):
        return FolderStore(path, folder_as_it_is(path) if path.is_dir() else read_file(path), None)
    if path.is_dir():
        return in_folder(path)
    return EmbeddedStore(read_file(path))


def only_read(place: str | Path) -> bool:
    """Whether a file or a store's directory is there and cannot be written."""
    if not place or (isinstance(place, str) and "://" in place):
        return False
    path = Path(place)
    if path.is_dir():
        return is_store_folder(path) and is_only_read(path)
    return path.exists() and not os.access(path, os.W_OK)
