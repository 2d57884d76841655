"""One question in a process of its own, forked before it opens anything: it can be killed, and is bounded."""

import multiprocessing
import os
import resource
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import TypeVar

from sdt_kg.errors import InputError
from services.store.workers.confine import die_with_parent, limit_memory, own_size
from services.store.workers.errors import CrashedQueryError, Limit, LimitError
from services.store.workers.pool import Limits

ALONE = Limits(seconds=60.0, memory=2 * 2**30)
"""Of a question that nobody else waits for: longer than a client of the service waits, and room for a million
rows of a few columns."""

Told = TypeVar("Told")
Begin = Callable[[], None]
"""Called when all is loaded that is asked: from then on the limits count."""
Ask = Callable[[Callable[[Begin], Told]], Told]


@contextmanager
def apart(limits: Limits) -> Iterator[Ask[Told]]:
    """Does one piece of work, which can be pickled, in a process of its own within time and memory.

    The process is there when the context begins, so that it has no thread of what comes before the question.

    Raises:
        LimitError: The work reached a limit of time or memory.
        CrashedQueryError: It ended its process in another way.
    """
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(ours, theirs, limits), daemon=True)
    process.start()
    theirs.close()

    def ask(work: Callable[[Begin], Told]) -> Told:
        try:
            ours.send(work)
            done, told = ours.recv()
        except (EOFError, ConnectionError):
            process.join()
            raise _cause(-(process.exitcode or 0), limits) from None
        if done:
            return told
        raise told

    try:
        yield ask
    finally:
        process.kill()
        process.join()
        ours.close()


def _cause(number: int, limits: Limits) -> InputError:
    """Why the process died: the clock's signal, or the one with which Rust ends when it gets no memory."""
    if number == signal.SIGALRM:
        return _late(limits)
    if number == signal.SIGABRT:
        return _large(limits)
    return CrashedQueryError(f"the query ended its process (signal {number})", remedy="simplify it")


def _late(limits: Limits) -> LimitError:
    return LimitError(Limit.TIME, f"{limits.seconds:g} s")


def _large(limits: Limits) -> LimitError:
    return LimitError(Limit.MEMORY, f"{limits.memory / 2**30:g} GiB")


def _work(ours: Connection, channel: Connection, limits: Limits) -> None:
    """Do what is sent, if anything is, and send what came of it."""
    ours.close()
    die_with_parent()
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as a shell has it in its background
            signal.signal(number, signal.SIG_DFL)  # pyoxigraph would hear of none before it has an answer
    try:
        work = channel.recv()
    except EOFError:
        return
    try:
        channel.send((True, work(lambda: _begin(limits))))
    except MemoryError:
        channel.send((False, _large(limits)))
    except Exception as error:  # noqa: BLE001 - who asked raises it
        channel.send((False, error))


def _begin(limits: Limits) -> None:
    """From now on the limits count; what Rust says when it gets no memory is said by who asked."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, limits.seconds)
    limit_memory(own_size() + limits.memory)
