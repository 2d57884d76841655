"""What commands read and write as RDF: a saved graph or a twin in, TriG or N-Quads out."""

from pathlib import Path

import pyoxigraph as ox

from sdt_kg.errors import InputError
from sdt_kg.history.diff import quads_of_twin
from sdt_kg.iri import PREFIXES
from services.edits import twin_of
from services.store.files import FORMATS, is_saved_graph, readable
from services.store.output import write_file

WRITABLE = {suffix: FORMATS[suffix] for suffix in (".trig", ".nq")}


def graph_of(source: str, robots: tuple[str, ...] = (), annotation: str | None = None) -> ox.Store:
    """The quads of a saved graph, whatever it holds, or of the twin of a kitchen; a copy.

    Raises:
        InputError: There is no such kitchen, file or store.
    """
    if is_saved_graph(source):
        store = readable(source)
        try:
            return store.dump()
        finally:
            store.close()
    copy = ox.Store()
    copy.extend(quads_of_twin(twin_of(source, robots, annotation)))
    return copy


def checked_format(path: Path) -> ox.RdfFormat:
    """The format that the file's name asks for.

    Raises:
        InputError: None that has named graphs.
    """
    if path.suffix not in WRITABLE:
        raise InputError(f"no named graphs in '{path.name}'", allowed=", ".join(WRITABLE))
    return WRITABLE[path.suffix]


def write_graph(path: Path, quads: ox.Store) -> None:
    """All named graphs are in the file.

    Raises:
        InputError: It cannot be written, or its name asks for no format that has named graphs.
    """
    form = checked_format(path)
    dumped = quads.dump(format=form, prefixes=PREFIXES if form == ox.RdfFormat.TRIG else None)
    assert dumped is not None, "pyoxigraph writes to memory where no file is named"
    write_file(path, dumped)
