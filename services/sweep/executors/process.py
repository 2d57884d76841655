"""One process of this machine as an executor: what is given to it is done by it, one after the other."""

import gc
import logging
import multiprocessing as mp
import os
import pickle
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any, Final, ParamSpec, TypeVar

from services.stopping import end_at_once

_log = logging.getLogger("sdt.sweep")

P = ParamSpec("P")
R = TypeVar("R")

KILLED_WITHIN: Final = 10.0
"""[s] In which a process is gone that was killed."""

DIED: Final = "the process died"
"""What is told of work that it had."""


class OneProcess(Executor):
    """A copy of this process that waits for work, and ends with the one that made it.

    Work is sent as it is given, so that the next is there when the process is free; a thread waits for
    answers, from the first on. An executor that is made later is copied while it waits: nothing that the
    copy uses is locked by it.
    """

    def __init__(self) -> None:
        # Forked: a new interpreter would import for seconds what is here already.
        context = mp.get_context("fork")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()  # with the process's own end its death is the end of what comes in
        self._given: deque[Future[Any]] = deque()
        self._sending = threading.Lock()
        self._thread = threading.Thread(target=self._hear, daemon=True)

    def submit(self, fn: Callable[P, R], /, *args: P.args, **kwargs: P.kwargs) -> "Future[R]":
        """What comes of it; a `BrokenExecutor` once the process has died. It cannot be cancelled alone."""
        future: Future[R] = Future()
        future.set_running_or_notify_cancel()
        with self._sending:
            self._given.append(future)
            try:
                self._pipe.send((fn, args, kwargs))
            except Exception as error:  # noqa: BLE001 - it cannot travel, or nobody is there; told to who asked
                self._given.pop().set_exception(BrokenExecutor(DIED) if isinstance(error, OSError) else error)
        self._begin_to_hear()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """The process ends when it has done what it was given; at once, if that is cancelled."""
        with self._sending, suppress(OSError):  # it has died, or ends already
            self._pipe.send(None)
        self._begin_to_hear()
        if cancel_futures:
            self._process.kill()
            self._process.join(KILLED_WITHIN)
        elif wait:
            self._thread.join()
            self._process.join()

    def _begin_to_hear(self) -> None:
        if not self._thread.ident:
            self._thread.start()

    def _hear(self) -> None:
        """Answers come in the order of the work; when no more can come, all that is left is told so."""
        while True:
            try:
                good, answer = self._pipe.recv()
            except (EOFError, OSError):
                break
            except Exception as error:  # noqa: BLE001 - what cannot be read here; told to who asked
                self._given.popleft().set_exception(error)
            else:
                future = self._given.popleft()
                future.set_result(answer) if good else future.set_exception(RuntimeError(answer))
        with self._sending:
            self._pipe.close()
            while self._given:
                self._given.popleft().set_exception(BrokenExecutor(DIED))


def _serve(pipe: Connection) -> None:
    """What comes in is done and answered until there is no more; in the new process."""
    end_at_once()
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
