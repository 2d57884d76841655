"""Each case ends in a verdict or in the reason why there is none, whatever happens to a worker."""

from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from itertools import count, islice
from pathlib import Path

from services.sweep.cell import CellResult, Found, Unjudged
from services.sweep.engines import Engine, processes
from services.sweep.run import run
from tests.services.sweep.judging import cell, obedient


def ends(found: Iterator[Found]) -> dict[str, str]:
    """Container → `verdict`, or why there is none."""
    return {each.cell.container: "verdict" if isinstance(each, CellResult) else each.reason for each in found}


def test_every_case_gets_its_verdict() -> None:
    cells = [cell(f"c{number}") for number in range(20)]
    assert ends(run(cells, processes(2), judging=obedient)) == {each.container: "verdict" for each in cells}


def test_a_process_that_dies_takes_no_case_with_it(tmp_path: Path) -> None:
    cells = [
        *(cell(f"c{number}") for number in range(6)),
        cell(f"die-once {tmp_path / 'died'}"),
        cell("last"),
    ]
    assert set(ends(run(cells, processes(2), judging=obedient)).values()) == {"verdict"}


def test_a_case_that_kills_its_process_twice_is_alone_without_a_verdict() -> None:
    cells = [cell("before"), cell("die"), *(cell(f"c{number}") for number in range(6))]
    found = ends(run(cells, processes(2), judging=obedient))
    assert found.pop("die") == "the process that judged it died twice"
    assert len(found) == 7
    assert set(found.values()) == {"verdict"}


def test_a_worker_that_fails_is_no_verdict_and_no_end() -> None:
    found = list(run([cell("fail badly"), cell("good")], processes(1), judging=obedient))
    assert [type(each) for each in found] == [Unjudged, CellResult]


def test_cases_are_taken_as_there_is_room_so_that_endless_ones_can_be_begun() -> None:
    taken = count()

    def opened() -> Executor:
        return ThreadPoolExecutor(1)

    def ended(executor: Executor) -> None:
        executor.shutdown()

    endless = (cell(f"c{number}") for number in taken)
    found = run(endless, Engine(opened, 4, ended), judging=obedient)
    assert len(list(islice(found, 10))) == 10
    found.close()
    assert next(taken) < 20
