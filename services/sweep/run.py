"""Cases to verdicts through an executor: a few handed out at a time, what is stored not done again."""

from collections.abc import Callable, Generator, Iterable

from predicates.record.recall import Recall, nothing_stored
from services.sweep.cell import Cell, Found, Unjudged
from services.sweep.executors.engines import Engine, Loading
from services.sweep.executors.handed import Handed
from services.sweep.executors.piece import Lost
from services.sweep.worker import judge, prepare, stored

Judge = Callable[[Cell], Found]


def run(
    cells: Iterable[Cell],
    engine: Engine,
    recall: Recall = nothing_stored,
    judging: Judge = judge,
    prepare: Callable[[Cell], None] = prepare,
) -> Generator[Found, None, None]:
    """What became of each case, as soon as it is known, in no order.

    A case whose process dies is judged once more, alone; dies it again, the case is unjudged. When the
    iterator is closed, or the user interrupts, the workers end with the cases that they are at.

    Args:
        cells: Taken as there is room: a million of them needs no list.
        engine: Who judges.
        recall: What is stored under a verdict's IRI; such cases are not judged again.
        judging: What a worker does with a case.
        prepare: Called with the first case before workers that are copies of this process begin.
    """
    with Handed(engine, judging, lambda cell: cell.loaded, Loading(prepare)) as handed:
        for cell in cells:
            known = None if recall is nothing_stored else stored(cell, recall)
            if known is not None:
                yield known
            else:
                yield from map(_found, handed.add(cell))
        yield from map(_found, handed.rest())


def _found(done: tuple[Cell, Found | Lost]) -> Found:
    cell, found = done
    return Unjudged(cell, found.reason) if isinstance(found, Lost) else found
