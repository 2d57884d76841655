"""Kitchens read by another process, while this one loads what else it needs."""

import multiprocessing as mp
import pickle
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection

from sdt_kg.errors import SdtError
from sdt_kg.twin import Twin
from services.keeping.text import recalled, told
from services.stopping import end_at_once
from services.sweep.process import end_with_parent


@contextmanager
def reading(kitchens: Sequence[str], read: Callable[[str], Twin]) -> Iterator[Callable[[], dict[str, Twin]]]:
    """A copy of this process reads them; what is yielded waits for it, and tells those that it could read.

    Forked: nothing that the copy uses may be locked by another thread of this process.
    """
    context = mp.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_read, args=(theirs, kitchens, read), daemon=True)
    process.start()
    theirs.close()  # with the process's own end its death is the end of what comes in
    try:
        yield lambda: dict(_come(ours))
    finally:
        ours.close()
        process.kill()  # what nobody waited for, nobody wants
        process.join()


def _read(pipe: Connection, kitchens: Sequence[str], read: Callable[[str], Twin]) -> None:
    """Each that can be read is sent; in the new process."""
    end_at_once()
    end_with_parent()
    known: list[bytes] = []  # sent when all are read: a pipe holds less than one of them
    for name in kitchens:
        with suppress(SdtError):  # whoever needs it reads it again, and is told
            twin = read(name)
            if not twin.robots:
                known.append(pickle.dumps((name, told(twin.entities), twin.entities.containers)))
    for each in known:
        pipe.send_bytes(each)


def _come(pipe: Connection) -> Iterator[tuple[str, Twin]]:
    with suppress(EOFError):
        while True:
            # What our own copy has sent.
            name, said, containers = pickle.loads(pipe.recv_bytes())  # noqa: S301
            yield name, Twin(recalled(said, containers))
