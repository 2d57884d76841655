"""Cases to verdicts through an executor: a few handed out at a time, what is stored not done again."""

import logging
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait

from predicates.record.recall import Recall, nothing_stored
from services.sweep.cell import Cell, Found, Unjudged
from services.sweep.engines import Engine
from services.sweep.worker import judge, stored

_log = logging.getLogger("sdt.sweep")

Judge = Callable[[Cell], Found]


def run(
    cells: Iterable[Cell], engine: Engine, recall: Recall = nothing_stored, judging: Judge = judge
) -> Iterator[Found]:
    """What became of each case, as soon as it is known, in no order.

    A case whose process dies is judged once more, alone; dies it again, the case is unjudged. When the
    iterator is closed, or the user interrupts, the workers end with the cases that they are at.

    Args:
        cells: Taken one by one: a million of them needs no list.
        engine: Who judges.
        recall: What is stored under a verdict's IRI; such cases are not judged again.
        judging: What a worker does with a case.
    """
    handed = _Handed(engine, judging)
    try:
        for cell in cells:
            known = None if recall is nothing_stored else stored(cell, recall)
            if known is not None:
                yield known
                continue
            yield from handed.room()
            handed.out(cell)
        yield from handed.rest()
    except BaseException:
        handed.end()
        raise
    handed.executor.shutdown()


class _Handed:
    """Cases that are with the executor.

    Attributes:
        executor: Opened anew when a worker has broken it.
    """

    def __init__(self, engine: Engine, judging: Judge) -> None:
        self.executor: Executor = engine.open()
        self._engine, self._judging = engine, judging
        self._futures: dict[Future[Found], Cell] = {}
        self._suspects: list[Cell] = []

    def out(self, cell: Cell) -> None:
        """The case is with a worker, or waits for one."""
        try:
            self._futures[self.executor.submit(self._judging, cell)] = cell
        except BrokenExecutor:
            self._suspects.append(cell)

    def room(self) -> Iterator[Found]:
        """What is done, until one more can be handed out."""
        while self._suspects or len(self._futures) >= self._engine.at_once:
            yield from self._done()

    def rest(self) -> Iterator[Found]:
        """What is done, until nothing is out."""
        while self._suspects or self._futures:
            yield from self._done()

    def end(self) -> None:
        """Nobody waits any more."""
        self._engine.end(self.executor)

    def _done(self) -> Iterator[Found]:
        done, _ = wait(self._futures, return_when=FIRST_COMPLETED)
        for future in done:
            yield from self._result(future, self._futures.pop(future))
        if self._suspects:
            yield from self._alone()

    def _result(self, future: Future[Found], cell: Cell) -> Iterator[Found]:
        try:
            yield future.result()
        except BrokenExecutor:
            self._suspects.append(cell)
        except (Exception, CancelledError) as error:  # noqa: BLE001 - what an executor of others raises
            _log.warning("%s has no verdict: %r", cell, error)
            yield Unjudged(cell, f"its worker was lost: {type(error).__name__}")

    def _alone(self) -> Iterator[Found]:
        """Those that were out when a process died, one at a time: it shows which of them kills."""
        suspects = [*self._suspects, *self._futures.values()]
        self._suspects.clear()
        self._futures.clear()
        self._reopen()
        for cell in suspects:
            try:
                yield self.executor.submit(self._judging, cell).result()
            except BrokenExecutor:
                _log.warning("the process died twice at %s", cell)
                yield Unjudged(cell, "the process that judged it died twice")
                self._reopen()

    def _reopen(self) -> None:
        self.executor.shutdown(wait=False)
        self.executor = self._engine.open()
