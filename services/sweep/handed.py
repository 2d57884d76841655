"""Work handed out to an executor, some at a time; what a dying process took with it is done once more."""

import gc
import logging
import time
from collections import deque
from collections.abc import Callable, Hashable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from types import TracebackType
from typing import Final, Generic, TypeVar

from sdt_kg.errors import InputError, OracleUnavailableError, SdtError
from services.sweep.engines import Engine, processes
from services.sweep.waiting import MOST_TOGETHER, Waiting

_log = logging.getLogger("sdt.sweep")

T = TypeVar("T")
R = TypeVar("R")

AHEAD: Final = 2
"""Pieces for each worker that are handed out at once: one is worked on, one waits."""
TURN: Final = 10.0
"""[s] After which no further item of a piece is begun: what a killed process takes with it, and how seldom
progress is told."""


@dataclass(frozen=True, slots=True)
class Lost:
    """Nothing came of an item.

    Attributes:
        reason: Why.
        is_input: Whether it is the caller's to mend.
    """

    reason: str
    is_input: bool = False

    def error(self, what: str) -> SdtError:
        """The same to be raised, said of what it happened to."""
        return InputError(self.reason) if self.is_input else OracleUnavailableError(f"{what}: {self.reason}")


@dataclass(slots=True, eq=False)
class _Lane:
    """An executor, with how many pieces it is, and what the last of them was alike in."""

    executor: Executor
    pieces: int = 0
    last: Hashable = None


class Handed(Generic[T, R]):
    """Items that are with executors or wait for them; an executor that breaks is opened anew.

    Left by an error, the workers end at once with what they are at.

    Args:
        engine: Who works.
        work: What is done with an item; it and the items travel to the workers.
        alike: What items have in common that are to be done by one worker.
        prepare: Called with the first item before the workers begin, where they begin as copies of this
            process: what it loads they have.
        most: Items that are handed out together at most: what came of them comes back together.
    """

    def __init__(
        self,
        engine: Engine,
        work: Callable[[T], R],
        alike: Callable[[T], Hashable],
        prepare: Callable[[T], None] | None = None,
        most: int = MOST_TOGETHER,
    ) -> None:
        self._engine, self._work, self._alike = engine, partial(_each, work), alike
        self._prepare = prepare if engine.copies else None
        self._lanes: list[_Lane] = []
        self._waiting: Waiting[T] = Waiting(engine.workers, alike, most)
        self._futures: dict[Future[list[R | Lost]], tuple[_Lane, list[T]]] = {}
        self._suspects: deque[T] = deque()

    def __enter__(self) -> "Handed[T, R]":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for lane in self._lanes:
            if kind is None:
                lane.executor.shutdown()
            else:
                self._engine.end(lane.executor)
        if self._engine.copies:
            gc.unfreeze()

    def add(self, item: T) -> Iterator[tuple[T, R | Lost]]:
        """The item waits for a worker; what is done, until there is room for the next."""
        self._waiting.add(item)
        while self._waiting.is_full:
            self._fill()
            if self._waiting.is_full:
                yield from self._done()

    def rest(self) -> Iterator[tuple[T, R | Lost]]:
        """What is done, until nothing is left."""
        while self._futures or len(self._waiting):
            self._fill()
            yield from self._done()

    def _fill(self) -> None:
        """Every worker has a piece, and one that waits, as far as there are any."""
        if not self._lanes and len(self._waiting):
            self._begin(self._waiting.first)
        while len(self._waiting):
            lane = min(self._lanes, key=lambda each: each.pieces)
            if lane.pieces >= self._room():
                return
            self._submit(lane)

    def _room(self) -> int:
        """Pieces that an executor has at once: the last are kept for those who are free first."""
        each = self._engine.workers // self._engine.lanes
        last = self._engine.lanes > 1 and len(self._waiting) <= AHEAD * self._engine.workers
        return each if last else AHEAD * each

    def _begin(self, first: T) -> None:
        if self._prepare is not None:
            with _all_kept():
                self._prepare(first)
        self._lanes = [_Lane(self._engine.open()) for _ in range(self._engine.lanes)]

    def _submit(self, lane: _Lane) -> None:
        elsewhere = {each.last for each in self._lanes if each is not lane}
        piece = self._waiting.piece(lane.last, elsewhere)
        lane.last, lane.pieces = self._alike(piece[0]), lane.pieces + 1
        self._futures[lane.executor.submit(self._work, piece)] = lane, piece

    def _done(self) -> Iterator[tuple[T, R | Lost]]:
        done, _ = wait(self._futures, return_when=FIRST_COMPLETED)
        for future in done:
            if future in self._futures:  # not with its dead process yet
                lane, _ = self._futures[future]
                yield from self._result(future)
                if self._suspects:
                    yield from self._alone(lane)

    def _result(self, future: Future[list[R | Lost]]) -> Iterator[tuple[T, R | Lost]]:
        lane, piece = self._futures.pop(future)
        lane.pieces -= 1
        try:
            results = future.result()
        except BrokenExecutor:
            self._suspects.extend(piece)
        except (Exception, CancelledError) as error:  # noqa: BLE001 - what an executor of others raises
            _log.warning("%s: nothing came of it: %r", piece, error)
            lost = Lost(f"its worker was lost: {type(error).__name__}")
            yield from ((item, lost) for item in piece)
        else:
            self._waiting.back(piece[len(results) :])
            yield from zip(piece, results, strict=False)

    def _alone(self, lane: _Lane) -> Iterator[tuple[T, R | Lost]]:
        """Those that a process had when it died, one at a time: it shows which of them kills."""
        for future in [each for each, (own, _) in self._futures.items() if own is lane]:
            yield from self._result(future)
        self._reopen(lane)
        while self._suspects:
            item = self._suspects.popleft()
            try:
                (result,) = lane.executor.submit(self._work, [item]).result()
            except BrokenExecutor:
                _log.warning("the process died twice at %s", item)
                result = Lost("the process that judged it died twice")
                self._reopen(lane)
            yield item, result

    def _reopen(self, lane: _Lane) -> None:
        lane.executor.shutdown(wait=False)
        lane.executor = self._engine.open()


@contextmanager
def _all_kept() -> Iterator[None]:
    """No garbage is looked for in what is loaded; what compiling leaves, 300 MB, goes with the process."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if collects:
            gc.enable()


def each(
    items: Sequence[T],
    jobs: int,
    work: Callable[[T], R],
    prepare: Callable[[T], None] | None = None,
    alike: Callable[[T], Hashable] = lambda item: item,
) -> Iterator[tuple[T, R]]:
    """Every item with what came of it, as soon as it is there, in no order; one job works in this process.

    Args:
        items: What is to be worked on.
        jobs: Processes.
        work: See `Handed`.
        prepare: Likewise.
        alike: Likewise; without it each item is by itself.

    Raises:
        InputError: What an item names is wrong.
        OracleUnavailableError: Nothing came of an item.
    """
    for item, result in each_or_lost(items, jobs, work, prepare, alike):
        if isinstance(result, Lost):
            raise result.error(str(item))
        yield item, result


def each_or_lost(  # noqa: PLR0913, PLR0917  # the rest has defaults
    items: Sequence[T],
    jobs: int,
    work: Callable[[T], R],
    prepare: Callable[[T], None] | None = None,
    alike: Callable[[T], Hashable] = lambda item: item,
    most: int = MOST_TOGETHER,
) -> Iterator[tuple[T, R | Lost]]:
    """The same, for who goes on where nothing came of an item.

    Args:
        items: As above.
        jobs: Likewise.
        work: Likewise.
        prepare: Likewise.
        alike: Likewise.
        most: See `Handed`.

    Raises:
        InputError: What an item names is wrong.
    """
    if jobs == 1:
        yield from ((item, work(item)) for item in items)
        return
    with Handed(processes(jobs), work, alike, prepare, most) as handed:
        for item in items:
            yield from map(_mended, handed.add(item))
        yield from map(_mended, handed.rest())


def _mended(done: tuple[T, R | Lost]) -> tuple[T, R | Lost]:
    item, result = done
    if isinstance(result, Lost) and result.is_input:
        raise result.error(str(item))
    return done


def _each(work: Callable[[T], R], piece: Sequence[T]) -> list[R | Lost]:
    """What came of each item of a piece that was begun in time, in the worker.

    One that fails takes none with it. An error travels as text: not every one of ours can be made anew from
    what it says.
    """
    until = time.monotonic() + TURN
    results: list[R | Lost] = []
    for item in piece:
        if results and time.monotonic() >= until:
            break
        results.append(_one(work, item))
    return results


def _one(work: Callable[[T], R], item: T) -> R | Lost:
    try:
        return work(item)
    except SdtError as error:
        return Lost(str(error), isinstance(error, InputError))
    except Exception as error:  # noqa: BLE001 - the edge of a worker: logged, and answered as a failure
        _log.exception("%s failed", item)
        return Lost(f"its worker failed: {type(error).__name__}")
