"""Work handed out to an executor, some at a time; what a dying process took with it is done once more."""

import gc
import logging
from collections import deque
from collections.abc import Callable, Hashable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from functools import partial
from types import TracebackType
from typing import Final, Generic, TypeVar

from services.garbage import unsought
from services.sweep.executors.engines import Engine, Lane, Loading, processes
from services.sweep.executors.piece import Lost, work_off
from services.sweep.executors.waiting import MOST_TOGETHER, Waiting

_log = logging.getLogger("sdt.sweep")

T = TypeVar("T")
R = TypeVar("R")

AHEAD: Final = 2
"""Pieces for each worker that are handed out at once: one is worked on, one waits."""
MEANWHILE: Final = 8
"""Likewise before something is loaded here: meanwhile nobody hands out."""


class Handed(Generic[T, R]):
    """Items that are with executors or wait for them; an executor that breaks is opened anew.

    Left by an error, the workers end at once with what they are at.

    Args:
        engine: Who works.
        work: What is done with an item; it and the items travel to the workers.
        alike: What items have in common that are to be done by one worker.
        prepare: What is loaded for workers that begin as copies of this process.
        most: Items that are handed out together at most: what came of them comes back together.
    """

    def __init__(
        self,
        engine: Engine,
        work: Callable[[T], R],
        alike: Callable[[T], Hashable],
        prepare: Loading[T] | None = None,
        most: int = MOST_TOGETHER,
    ) -> None:
        self._engine, self._work, self._alike = engine, partial(work_off, work), alike
        self._prepare = prepare if engine.copies else None
        self._lanes, self._loaded = [Lane(engine) for _ in range(engine.lanes)], set[Hashable]()
        self._waiting: Waiting[T] = Waiting(engine.workers, alike, most)
        self._futures: dict[Future[list[R | Lost]], tuple[Lane, list[T]]] = {}
        self._suspects: deque[T] = deque()

    def __enter__(self) -> "Handed[T, R]":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            for lane in self._lanes:
                lane.leave()  # side by side: to give back what a process has takes a while
        for lane in self._lanes:
            lane.end(at_once=kind is not None)
        if self._engine.copies:
            gc.unfreeze()

    def add(self, item: T) -> Iterator[tuple[T, R | Lost]]:
        """The item waits for a worker; what is done, until there is room for the next."""
        self._waiting.add(item)
        while self._waiting.is_full:
            yield from self._filled()
            if self._waiting.is_full:
                yield from self._done()

    def rest(self) -> Iterator[tuple[T, R | Lost]]:
        """What is done, until nothing is left."""
        while self._futures or len(self._waiting):
            yield from self._filled()
            yield from self._done()

    def _filled(self) -> Iterator[tuple[T, R | Lost]]:
        """Every worker has a piece, and one that waits; before an error, what was done till then is told."""
        try:
            for lane in self._lanes:
                if not lane.is_open and len(self._waiting):
                    self._begin(lane)
            self._hand_out()
        except BaseException:
            for future in [each for each in self._futures if each.done() and each.exception() is None]:
                yield from self._result(future)
            raise

    def _begin(self, lane: Lane) -> None:
        """The lane's workers begin with their first piece; what it needs is loaded before, others work on."""
        item = self._next(lane)
        need = self._need(item)
        shared = self._shared_alone()
        if shared is not None:
            with unsought(for_good=True):
                shared()
        elif need not in self._loaded:
            self._hand_out(loading=True)
            if self._prepare is not None:
                with unsought(for_good=True):
                    self._prepare.load(item)
            self._loaded.add(need)
        lane.open(self._loaded)
        self._submit(lane)

    def _shared_alone(self) -> Callable[[], None] | None:
        """What alone is loaded here: the next workers are the first, and others need something else."""
        shared = None if self._prepare is None else self._prepare.shared
        if any(each.is_open for each in self._lanes) or len(self._lanes) == 1:
            return None
        needs = {*map(self._need, self._waiting.firsts())}
        return shared if len(self._lanes) <= len(needs) else None

    def _hand_out(self, loading: bool = False) -> None:
        """Lanes that have begun get pieces, who has fewest first.

        One that lacks what its next piece needs has to be idle before; while something is `loading` it waits.
        """
        while len(self._waiting):
            most = self._ahead(loading) * self._engine.workers // self._engine.lanes
            nexts = [(lane, self._need(self._next(lane))) for lane in self._lanes if lane.is_open]
            room = {lane: most if need in lane.has else int(not loading) for lane, need in nexts}
            free = [lane for lane in room if lane.pieces < room[lane]]
            if not free:
                return
            self._submit(min(free, key=lambda lane: lane.pieces))

    def _ahead(self, loading: bool) -> int:
        """Pieces that each worker has at once; the last are kept for those who are free first."""
        if loading:
            return MEANWHILE
        few = self._engine.lanes > 1 and len(self._waiting) <= AHEAD * self._engine.workers
        return 1 if few else AHEAD

    def _next(self, lane: Lane) -> T:
        """With what the lane's next piece begins."""
        return self._waiting.next(*self._sides(lane))

    def _sides(self, lane: Lane) -> tuple[Hashable, set[Hashable]]:
        """What the lane did last, and what the others did."""
        return lane.last, {each.last for each in self._lanes if each is not lane}

    def _need(self, item: T) -> Hashable:
        return None if self._prepare is None else self._prepare.what(item)

    def _submit(self, lane: Lane) -> None:
        """The lane gets its next piece; for what was loaded since its workers began, others begin."""
        piece = self._waiting.piece(*self._sides(lane))
        need = self._need(piece[0])
        if need in self._loaded - lane.has:
            lane.open(self._loaded)
        lane.has.add(need)
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

    def _alone(self, lane: Lane) -> Iterator[tuple[T, R | Lost]]:
        """Those that a process had when it died, one at a time: it shows which of them kills."""
        for future in [each for each, (own, _) in self._futures.items() if own is lane]:
            yield from self._result(future)
        lane.open(self._loaded)
        while self._suspects:
            item = self._suspects.popleft()
            try:
                (result,) = lane.executor.submit(self._work, [item]).result()
            except BrokenExecutor:
                _log.warning("the process died twice at %s", item)
                result = Lost("the process that judged it died twice")
                lane.open(self._loaded)
            yield item, result


def each(
    items: Sequence[T],
    jobs: int,
    work: Callable[[T], R],
    prepare: Loading[T] | None = None,
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
    prepare: Loading[T] | None = None,
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
