"""Who judges: processes of this machine, or a Dask cluster; each as an executor that can be opened anew."""

import os
import re
import resource
from collections.abc import Callable, Hashable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from sdt_kg.errors import InputError, OracleUnavailableError
from services.sweep.executors.process import OneProcess

T = TypeVar("T")

_ADDRESS = re.compile(r"(tcp|tls)://[^/\s]+:\d{1,5}")
CONNECT = "10 s"
"""A Dask scheduler may take to answer."""


@dataclass(frozen=True, slots=True)
class Engine:
    """Executors that can be opened, and opened anew when a worker has broken one.

    Attributes:
        open: A new executor.
        workers: How many work side by side, in all executors.
        end: Ends an executor at once, with the case that it is at.
        copies: Whether workers begin as copies of this process, with all that it has loaded.
        lanes: How many executors there are, each with its share of the workers: what is alike stays in one.
    """

    open: Callable[[], Executor]
    workers: int
    end: Callable[[Executor], None]
    copies: bool = False
    lanes: int = 1


@dataclass(slots=True, eq=False)
class Lane:
    """An executor that is opened when it gets its first piece, with how many it has.

    Attributes:
        last: What the last of them was alike in.
        has: What was loaded when its workers began, or by them since.
    """

    engine: Engine
    pieces: int = 0
    last: Hashable = None
    has: set[Hashable] = field(default_factory=set[Hashable])
    _executor: Executor | None = None
    _former: list[Executor] = field(default_factory=list[Executor])

    @property
    def is_open(self) -> bool:
        """Whether its workers have begun."""
        return self._executor is not None

    @property
    def executor(self) -> Executor:
        """Its own."""
        assert self._executor is not None, "a lane is opened before anything is submitted"
        return self._executor

    def open(self, loaded: set[Hashable]) -> None:
        """Its workers begin, anew where there are some: those end with what they are at."""
        if self._executor is not None:
            self._executor.shutdown(wait=False)
            self._former.append(self._executor)
        self._executor, self.has = self.engine.open(), set(loaded)

    def leave(self) -> None:
        """Its workers end as soon as they have done what they were given; nobody waits for them yet."""
        for each in self._executors():
            each.shutdown(wait=False)

    def end(self, at_once: bool) -> None:
        """It has no workers any more."""
        for each in self._executors():
            if at_once:
                self.engine.end(each)
            else:
                each.shutdown()

    def _executors(self) -> tuple[Executor, ...]:
        return (*self._former, *(() if self._executor is None else (self._executor,)))


@dataclass(frozen=True, slots=True)
class Loading(Generic[T]):
    """What is loaded once, before workers that begin as copies of this process, and so have it.

    Attributes:
        load: Called with an item, loads what it needs.
        what: What that is; an item that needs what was loaded when its worker had begun gets a new one.
        shared: Loads what items have in common, whatever else they need. If there is such a thing, the first
            worker loads the rest of its own itself, as long as no other needs that: it begins sooner.
    """

    load: Callable[[T], None]
    what: Callable[[T], Hashable] = lambda _: None
    shared: Callable[[], None] | None = None


def processes(count: int) -> Engine:
    """So many processes of this machine; they end with the one that started them."""
    # Each process has one core; a library's own threads would be in each other's way.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    return Engine(OneProcess, count, _killed, copies=True, lanes=count)


def _killed(executor: Executor) -> None:
    """The process is gone: what it was judging is judged again when the sweep is resumed."""
    executor.shutdown(cancel_futures=True)


@contextmanager
def dask(address: str) -> Iterator[Engine]:
    """The workers of the Dask cluster at an address, which have to have sdt-kg and the models.

    Raises:
        InputError: Dask is not installed, or the address is none.
        OracleUnavailableError: No scheduler answers there, or it has no worker.
    """
    client = _client(address)
    try:
        workers = sum(client.nthreads().values())
        if not workers:
            start = f"dask worker {address} --nthreads 1 starts one"
            raise OracleUnavailableError(f"the Dask scheduler at {address} has no worker ({start})")
        # Not pure: a case that is handed out again is judged again.
        yield Engine(lambda: client.get_executor(pure=False), workers, _cancelled)
    finally:
        client.close()


def _client(address: str) -> Any:  # noqa: ANN401 - distributed has no types
    if not _ADDRESS.fullmatch(address):
        raise InputError(f"'{address}' is no address of a Dask scheduler", allowed="tcp://HOST:PORT")
    try:
        from distributed import Client  # noqa: PLC0415 - an extra
    except ModuleNotFoundError as error:
        if error.name != "distributed":
            raise
        raise InputError(
            "Dask is not installed",
            allowed="sdt-kg with its extra",
            remedy="pip install 'sdt-kg[cluster]'",
        ) from None
    try:
        return Client(address, timeout=CONNECT, set_as_default=False)
    except (OSError, TimeoutError) as error:
        raise OracleUnavailableError(
            f"no Dask scheduler answers at {address}: {error} (dask scheduler starts one)"
        ) from None


def _cancelled(executor: Executor) -> None:
    executor.shutdown(wait=False)


def cpu_seconds() -> float:
    """CPU time of this process and of its workers that have ended [s]."""
    usages = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)
