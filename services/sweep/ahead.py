"""Kitchens read, and what is asked of their scope, by another process, while this one loads what it needs."""

import multiprocessing as mp
import pickle
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Final, TypeVar

from sdt_kg.entities import Entities
from sdt_kg.errors import SdtError
from sdt_kg.scope import Seen
from sdt_kg.twin import Twin
from services.keeping.text import recalled, told
from services.stopping import end_at_once
from services.sweep.executors.process import end_with_parent

LOOKED_AT: Final = 64
"""[1] Containers at most: as many as are looked at while robots are prepared; workers look at the others."""

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Ahead:
    """What comes from the other process, one after the other; nothing where it died."""

    _pipe: Connection

    def kitchens(self) -> dict[str, Twin]:
        """Those that it could read, once; waits for them."""
        return {name: Twin(recalled(said, containers)) for name, said, containers in self._come([])}

    def seen(self) -> Seen:
        """How what their containers are asked about lies outside, once, after the kitchens; waits for it."""
        return self._come({})

    def _come(self, nothing: T) -> T:
        try:
            return pickle.loads(self._pipe.recv_bytes())  # noqa: S301 - what our own copy has sent
        except EOFError:
            return nothing


@contextmanager
def reading(
    kitchens: Sequence[str],
    read: Callable[[str], Twin],
    look: Callable[[Twin], Seen],
    besides: Callable[[], Seen] = dict,
) -> Iterator[Ahead]:
    """A copy of this process reads them and looks at each, and ends when nobody waits any more.

    Forked: nothing that the copy uses may be locked by another thread of this process.

    Args:
        kitchens: Their names.
        read: Reads one.
        look: How what its containers are asked about lies outside.
        besides: What else is looked at, after them.
    """
    context = mp.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_read, args=(theirs, kitchens, read, look, besides), daemon=True)
    process.start()
    theirs.close()  # with the process's own end its death is the end of what comes in
    try:
        yield Ahead(ours)
    finally:
        ours.close()
        process.kill()  # what nobody waited for, nobody wants
        process.join()


def _read(
    pipe: Connection,
    kitchens: Sequence[str],
    read: Callable[[str], Twin],
    look: Callable[[Twin], Seen],
    besides: Callable[[], Seen],
) -> None:
    """All that can be read is sent, then how it looks; in the new process."""
    end_at_once()
    end_with_parent()
    known: dict[str, Entities] = {}
    for name in kitchens:
        with suppress(SdtError):  # whoever needs it reads it again, and is told
            twin = read(name)
            if not twin.robots:
                known[name] = twin.entities
    pipe.send_bytes(pickle.dumps([(name, told(each), each.containers) for name, each in known.items()]))
    seen: Seen = {}
    for each in known.values():
        if len(seen) + len(each.containers) <= LOOKED_AT:
            seen |= look(Twin(each))
    seen |= besides()
    pipe.send_bytes(pickle.dumps(seen))
