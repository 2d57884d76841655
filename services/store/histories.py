"""Histories kept in a file, a directory or on a server, and opened again after a restart."""

from itertools import groupby
from pathlib import Path
from typing import Final

import pyoxigraph as ox

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError
from sdt_kg.history import History, Trajectory, has_history, reopened
from sdt_kg.iri import Iri, local_name
from sdt_kg.store import MemoryStore
from services.store.files import folder_of_place, opened, readable
from services.store.on_disk import check_kind
from services.store.output import check_file, write_file
from services.store.server.remote import is_url

SHORT_KEY: Final = 12
"""[characters] Of a trajectory's hash, in the name of the file with its samples."""


def keep_history(history: History, place: str) -> list[Path]:
    """All branches of the history are at that place; the files beside it that now hold samples.

    Args:
        history: Over a store in memory.
        place: As `services.store.files.opened` takes it; what else is there stays.

    Raises:
        InputError: It is no such place, or a server, beside which no file can lie.
    """
    check_place(place)
    assert isinstance(history.store, MemoryStore), "the caller's promise"
    quads = sorted(history.store.everything(), key=lambda quad: str(quad.graph_name))
    store = opened(place)
    try:
        for graph, content in groupby(quads, key=lambda quad: quad.graph_name):
            assert isinstance(graph, ox.NamedNode), "no other graphs are written"
            store.replace(graph.value, content)
    finally:
        store.close()
    written: list[Path] = []
    for branch in history.branches.values():
        if branch.trajectory is not None:
            written.append(_beside(Path(place), branch.trajectory.iri))
            write_file(written[-1], branch.trajectory.to_bytes())
    return written


def check_before(place: str) -> None:
    """A history can be kept at the place, and what is there can be read, so that it stays.

    Raises:
        InputError: As `check_place` says, or the file is no RDF.
    """
    check_place(place)
    if Path(place).is_file():
        readable(place).close()


def check_place(place: str) -> None:
    """A history can be kept at the place, with samples beside it; looked at before there is one.

    Raises:
        InputError: It is a server, beside which no file can lie, no store is of that name, or no file can be
            written there.
    """
    if is_url(place):
        raise InputError(
            f"no samples can be kept beside {place}", allowed="FILE.trig, FILE.nq or a directory"
        )
    path = Path(place)
    check_kind(path)
    check_file(path.absolute().with_suffix(".npz") if path.is_dir() else path)


def kept_history(place: str, environment: Iri | None = None) -> History | None:
    """The history that is kept at a place; None where there is none.

    Args:
        place: Where something is.
        environment: The kitchen that is meant; may be left out where there is one history.

    Raises:
        GraphError: Something is missing or was changed.
        InputError: There is nothing, or samples are missing.
    """
    store = readable(place)
    try:
        quads = store.dump()
    finally:
        store.close()
    if not has_history(quads):
        return None
    return reopened(quads, samples_beside(place), environment=environment, beside=folder_of_place(place))


def samples_beside(place: str) -> dict[Iri, Trajectory]:
    """The trajectories whose samples lie beside a file or directory, by IRI; none beside a server."""
    folder = folder_of_place(place)
    if folder is None:
        return {}
    paths = sorted(folder.glob(f"{Path(place).stem}.*.npz"))
    for path in paths:
        check_ends(path)
    read = (Trajectory.from_bytes(path.read_bytes()) for path in paths)
    return {each.iri: each for each in read}


def _beside(place: Path, trajectory: Iri) -> Path:
    """Where the samples of a trajectory lie."""
    return place.with_name(f"{place.stem}.{local_name(trajectory)[:SHORT_KEY]}.npz")
