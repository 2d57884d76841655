"""Where an embedded store lies: in a directory, or in a file which one process at a time may change."""

import fcntl
import os
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import pyoxigraph as ox

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError, StoreRejectedError, StoreUnavailableError
from sdt_kg.iri import PREFIXES
from services.store.embedded import EmbeddedStore
from services.store.folder import FolderStore, damaged
from services.store.journal import Journal

FORMATS = {".trig": ox.RdfFormat.TRIG, ".nq": ox.RdfFormat.N_QUADS, ".ttl": ox.RdfFormat.TURTLE}
WRITTEN = (".trig", ".nq")

JOURNAL = "sdt.journal"
"""In a store's directory. RocksDB leaves alone what it does not know."""

ATTEMPTS = 5
WAIT = 0.2
"""[s] Between attempts to get what another process holds: a query is soon done."""

BEGUN = re.compile(r"LOCK|LOG|IDENTITY|MANIFEST-000001|\d{6}\.dbtmp")
"""Files of a directory in which nothing was written yet."""

HELD = ("No locks available", "Resource temporarily unavailable")
"""RocksDB's words for a directory that this process, or another one, has open."""

NO_ROOM = ("No space left on device", "File too large", "Disk quota exceeded")
"""The system's words, which RocksDB repeats among its own."""


def in_folder(folder: Path) -> FolderStore:
    """A store of RocksDB in a directory, which is made if it is not there.

    What was written is in the directory's journal when a method returns, so that killing this process loses
    none of it. Losing power may: files are synced by `close`, and whenever much is put into the tables.

    Raises:
        InputError: The directory holds something else, or there is no folder for it.
        StoreUnavailableError: Another process has it open.
        StoreRejectedError: It is damaged, or there is no room for it.
    """
    check_kind(folder)
    for attempt in range(ATTEMPTS):
        if attempt:
            time.sleep(WAIT)
        try:
            return FolderStore(folder, ox.Store(str(folder)), Journal(folder / JOURNAL))
        except RuntimeError as error:
            raise damaged(folder, error) from None
        except OSError as error:
            if not any(reason in str(error) for reason in HELD):
                raise _unopened(folder, str(error)) from None
    raise StoreUnavailableError(
        str(folder),
        "is open in another process",
        remedy="wait until that is done, or share it between processes: oxigraph serve -l DIRECTORY",
    )


def is_only_read(folder: Path) -> bool:
    """Whether something of a store's directory cannot be written, as on a medium that is only read."""
    lasting = (folder / name for name in ("CURRENT", "LOCK", "LOG"))
    return not all(os.access(each, os.W_OK) for each in (folder, *lasting) if each.exists())


def folder_as_it_is(folder: Path) -> ox.Store:
    """What a store's directory has, and is left as it is: nothing of it is written.

    What a killed process left in the journal is put with the rest in memory.

    Raises:
        InputError: It cannot be opened.
        StoreRejectedError: It is damaged.
    """
    with opening(folder):
        tables, entries = ox.Store.read_only(str(folder)), [*Journal(folder / JOURNAL).entries()]
        if not entries:
            return tables
        copy = ox.Store()
        copy.bulk_extend(tables)
    for entry in entries:
        if entry.emptied is not None:
            copy.remove_graph(entry.emptied)
        copy.extend(entry.quads)
    return copy


@contextmanager
def opening(folder: Path) -> Iterator[None]:
    """Why a store's directory cannot be opened to be read is said as everywhere.

    Raises:
        InputError: It cannot be opened.
        StoreRejectedError: It is damaged.
    """
    try:
        yield
    except RuntimeError as error:
        raise damaged(folder, error) from None
    except OSError as error:
        raise InputError(f"cannot open the store {folder}: {error}") from None


def _unopened(folder: Path, why: str) -> InputError | StoreRejectedError:
    """What is wrong with a directory that cannot be opened or made, and what is to be done."""
    for reason in NO_ROOM:
        if reason in why:
            return StoreRejectedError(str(folder), f"cannot be opened: {reason}", remedy="make room there")
    if not folder.parent.is_dir():
        return InputError(f"cannot make the store {folder}", allowed="a place in a folder that is there")
    elsewhere = (
        "copy it to where it can be written" if folder.exists() else "choose a folder that can be written"
    )
    remedy = "" if os.access(folder, os.W_OK) else elsewhere
    return InputError(f"cannot open the store {folder}: {why}", remedy=remedy)


def is_folder(path: Path) -> bool:
    """Whether a store of this name lies, or would lie, in a directory."""
    return path.is_dir() or not path.suffix


def check_kind(path: Path) -> None:
    """A store can be of this name, and a directory that is there holds nothing else.

    Raises:
        InputError: It cannot.
    """
    if not is_folder(path) and path.suffix not in WRITTEN:
        raise InputError(
            f"cannot save verdicts to '{path.name}'", allowed="FILE.trig, FILE.nq or a directory"
        )
    if is_folder(path) and path.exists() and not is_store_folder(path) and not _is_bare(path):
        raise InputError(
            f"{path} holds something else than a store",
            allowed="a new or empty directory, or one that --save made",
        )


def _is_bare(folder: Path) -> bool:
    """Whether a directory has nothing, or what RocksDB had made before it was killed or had no room."""
    return folder.is_dir() and all(BEGUN.fullmatch(each.name) for each in folder.iterdir())


def is_store_folder(folder: Path) -> bool:
    """Whether a directory is a store."""
    return (folder / "CURRENT").is_file()


def in_file(path: Path) -> EmbeddedStore:
    """A `.trig` or `.nq` file in memory, put in place in one step when it is closed.

    A process that is killed leaves the file as it was.

    Args:
        path: Need not be there yet.

    Raises:
        InputError: It is not RDF, or cannot be written.
        StoreRejectedError: When it is closed: there is no room for it.
        StoreUnavailableError: Another process is saving to it.
    """
    check_kind(path)
    if path.exists() and not os.access(path, os.W_OK):
        raise InputError(f"{path} can only be read", remedy="copy it, or save to another file")
    partial = _claimed(path)
    try:
        store = read_file(path) if path.exists() else ox.Store()
    except InputError:
        Path(partial.name).unlink()
        partial.close()
        raise

    def finish(store: ox.Store) -> None:
        try:
            with partial:
                partial.truncate(0)
                store.dump(partial, FORMATS[path.suffix], prefixes=PREFIXES)
                partial.flush()
                os.fsync(partial.fileno())
                Path(partial.name).replace(path)
        except OSError as error:
            Path(partial.name).unlink(missing_ok=True)
            raise StoreRejectedError(
                str(path),
                f"cannot be written: {error.strerror or error}",
                remedy="it is as it was before; make room, or save to another place",
            ) from None

    return EmbeddedStore(store, finish)


def read_file(path: Path) -> ox.Store:
    """The quads of a file, in memory.

    Raises:
        InputError: There is no such file, or it is not RDF.
    """
    check_ends(path)
    store = ox.Store()
    try:
        store.bulk_load(path=str(path), format=FORMATS[path.suffix])
    except SyntaxError as error:
        raise InputError(f"{path} is not valid RDF: {error}", allowed="TriG, N-Quads or Turtle") from None
    except OSError as error:
        raise InputError(f"cannot read {path}: {error}") from None
    return store


def _claimed(path: Path) -> IO[bytes]:
    """The file beside it that will take its place, which this process alone may write.

    The lock goes with the process that holds it; a file that a killed one left behind is used again.
    """
    partial = path.with_name(path.name + ".partial")
    check_ends(partial)
    for attempt in range(ATTEMPTS):
        if attempt:
            time.sleep(WAIT)
        try:
            claimed = partial.open("ab")
        except OSError as error:
            raise InputError(f"cannot write {path}: {error.strerror}") from None
        try:
            fcntl.flock(claimed, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            claimed.close()
            continue
        if partial.exists() and partial.stat().st_ino == os.fstat(claimed.fileno()).st_ino:
            return claimed
        claimed.close()  # its holder has just put it in place
    raise StoreUnavailableError(
        str(path),
        "is being written by another process",
        remedy="wait until that is done, or save to another file, or to a server",
    )
