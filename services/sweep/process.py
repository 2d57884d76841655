"""One process of this machine as an executor: what is given to it is done by it, one after the other."""

import gc
import logging
import multiprocessing as mp
import os
import pickle
import queue
import signal
import threading
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any, Final, ParamSpec, TypeVar

_log = logging.getLogger("sdt.sweep")

P = ParamSpec("P")
R = TypeVar("R")

_Task = tuple["Future[Any]", Callable[..., Any], tuple[Any, ...], dict[str, Any]]

KILLED_WITHIN: Final = 10.0
"""[s] In which a process is gone that was killed."""


class OneProcess(Executor):
    """A copy of this process that waits for work, and ends with the one that made it.

    A thread hands it the work, from the first on. An executor that is made later is copied while it waits
    for an answer: nothing that the copy uses is locked by it.
    """

    def __init__(self) -> None:
        # Forked: a new interpreter would import for seconds what is here already.
        context = mp.get_context("fork")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()  # with the process's own end its death is the end of what comes in
        self._tasks: queue.SimpleQueue[_Task | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._hand, daemon=True)

    def submit(self, fn: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> "Future[R]":
        """What comes of it; a `BrokenExecutor` once the process has died."""
        future: Future[R] = Future()
        self._tasks.put((future, fn, args, kwargs))
        if not self._thread.ident:
            self._thread.start()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """The process ends when it has done what it was given; at once, if that is cancelled."""
        self._tasks.put(None)
        if not self._thread.ident:
            self._thread.start()
        if cancel_futures:
            self._process.kill()
            self._process.join(KILLED_WITHIN)
        elif wait:
            self._thread.join()
            self._process.join()

    def _hand(self) -> None:
        """One after the other is sent, and answered; after the process has died all are answered so."""
        while (task := self._tasks.get()) is not None:
            future, *work = task
            if not future.set_running_or_notify_cancel():
                continue
            try:
                self._pipe.send(work)
                good, answer = self._pipe.recv()
            except (EOFError, OSError):
                future.set_exception(BrokenExecutor("the process died"))
            except Exception as error:  # noqa: BLE001 - what cannot travel; told to who asked
                future.set_exception(error)
            else:
                future.set_result(answer) if good else future.set_exception(RuntimeError(answer))
        with suppress(OSError):  # it has died already
            self._pipe.send(None)
        self._pipe.close()


def _serve(pipe: Connection) -> None:
    """What comes in is done and answered until there is no more; in the new process."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # it ends at once when the user interrupts
    gc.freeze()  # looking for garbage in what the parent has loaded would copy all of it
    end_with_parent()
    while (work := pipe.recv()) is not None:
        function, args, kwargs = work
        try:
            answer = True, function(*args, **kwargs)
        except Exception as error:  # noqa: BLE001 - the edge of a worker: logged, and answered as a failure
            _log.exception("work failed in a worker")
            answer = False, repr(error)
        try:
            pipe.send(answer)
        except (TypeError, AttributeError, pickle.PicklingError) as error:
            pipe.send((False, repr(error)))


def end_with_parent() -> None:
    """From now on this process ends soon after the one that started it, whatever it is doing."""
    threading.Thread(target=_ended_with_parent, daemon=True).start()


def _ended_with_parent() -> None:
    parent = mp.parent_process()
    assert parent is not None, "in a worker"
    parent.join()
    os._exit(1)
