"""Verdicts kept in a file (.trig, .nq) or a store directory, and asked again later."""

import os
from pathlib import Path
from types import TracebackType
from typing import Self

import pyoxigraph as ox

from predicates.case import Verdict
from predicates.record import Record, to_record, write
from sdt_kg.errors import InputError
from sdt_kg.iri import PREFIXES
from sdt_kg.store import checked_query, rows_of
from sdt_kg.twin import Twin

FORMATS = {".trig": ox.RdfFormat.TRIG, ".nq": ox.RdfFormat.N_QUADS, ".ttl": ox.RdfFormat.TURTLE}


def is_saved_graph(source: str) -> bool:
    """Whether the text names an RDF file or a store directory, rather than a kitchen."""
    path = Path(source)
    return path.suffix in FORMATS or (path.is_dir() and (path / "CURRENT").exists())


class SavedVerdicts:
    """A context in which verdicts are added; on leaving it they are on disk, whatever happened.

    A file is written anew and put in place in one step; a directory is a RocksDB of pyoxigraph.
    Writing a verdict twice changes nothing, since its IRI is a hash of its inputs.
    """

    def __init__(self, path: Path) -> None:
        if path.suffix and path.suffix not in {".trig", ".nq"}:
            raise InputError(
                f"cannot save verdicts to '{path.name}'", allowed="FILE.trig, FILE.nq or a directory"
            )
        self.path = path
        self._is_file = bool(path.suffix)
        self._store = _read(path) if path.exists() or self._is_file else ox.Store(str(path))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._is_file:
            self._store.flush()
            return
        partial = self.path.with_name(self.path.name + ".partial")
        with partial.open("wb") as out:
            self._store.dump(out, FORMATS[self.path.suffix], prefixes=PREFIXES)
        os.replace(partial, self.path)  # noqa: PTH105 - one step, also over an existing file

    def add_twin(self, twin: Twin) -> None:
        """Add the twin's named graphs, so that verdicts can be asked together with what they are about."""
        self._store.load(twin.serialize("nquads"), format=ox.RdfFormat.N_QUADS)

    def add(self, verdict: Verdict) -> None:
        """Add the verdict's triples to its own named graph."""
        self.add_record(to_record(verdict))

    def add_record(self, record: Record) -> None:
        """Add triples that a worker process made."""
        write(self._store, record)


def query_saved(path: Path, sparql: str) -> tuple[list[str], list[dict[str, object]]]:
    """Columns and rows of a query over everything that was saved, all graphs together.

    Raises:
        InputError: There is no such file.
        QueryError: The query does not parse, or would write or fetch.
    """
    if not path.exists():
        raise InputError(f"no file or store at {path}")
    solutions = _read(path).query(checked_query(sparql), use_default_graph_as_union=True, prefixes=PREFIXES)
    return rows_of(solutions)


def _read(path: Path) -> ox.Store:
    if path.is_dir():
        return ox.Store(str(path))
    store = ox.Store()
    if path.exists():
        try:
            store.load(path=str(path), format=FORMATS[path.suffix])
        except SyntaxError as error:
            raise InputError(f"{path} is not valid RDF: {error}", allowed="TriG, N-Quads or Turtle") from None
    return store
