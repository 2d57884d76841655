"""Each case ends in a verdict or in the reason why there is none, whatever happens to a worker."""

import gc
import os
import signal
import time
from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from itertools import count, islice
from pathlib import Path

import pytest

from sdt_kg.errors import InputError, OracleUnavailableError, UnknownEntityError
from services.app import Policy
from services.sweep.cell import Cell, CellResult, Found, Unjudged
from services.sweep.executors import handed, piece
from services.sweep.executors.engines import Engine, Loading, processes
from services.sweep.executors.handed import AHEAD, each, each_or_lost
from services.sweep.executors.waiting import MOST_TOGETHER, Waiting
from services.sweep.run import run
from services.sweep.worker import OF_OTHERS, as_asked, judge, service_of
from tests.services.sweep.judging import cell, obedient
from tests.small import FOLDER


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


def test_a_process_that_dies_disturbs_no_other(tmp_path: Path) -> None:
    work = partial(_begun_in, tmp_path)
    done = dict(each_or_lost(range(8), 2, work, alike=lambda number: number % 2, most=1))
    assert done == {number: number for number in range(8)}
    begun = [len(list(tmp_path.glob(f"{number} *"))) for number in range(8)]
    assert begun[0] == 2, "it killed its process, and was begun again"
    assert begun[1::2] == [1] * 4, "the other process went on"


def _begun_in(folder: Path, number: int) -> int:
    """The number itself, noted as begun; the first time that it is, 0 kills its process."""
    first = not any(folder.glob("0 *"))
    (folder / f"{number} {os.getpid()}").touch()
    if number == 0 and first:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_a_verdict_about_other_models_is_none_about_the_case(tmp_path: Path) -> None:
    # As a worker elsewhere may give, which read its files earlier, or has others at the same paths.
    (tmp_path / "b.urdf").write_text((FOLDER / "b.urdf").read_text().replace('upper="0.5"', 'upper="0.4"', 1))
    ours, theirs = (
        Cell(
            str(folder / "b.urdf"),
            str(FOLDER / "pr2.urdf"),
            "open:top_drawer",
            ("top_drawer=open",),
            Policy(),
        )
        for folder in (FOLDER, tmp_path)
    )
    found = judge(theirs)
    assert as_asked(found) is found
    assert isinstance(found, CellResult)
    assert as_asked(replace(found, cell=ours)) == Unjudged(ours, OF_OTHERS)
    assert as_asked(Unjudged(ours, "why")) == Unjudged(ours, "why")


def test_a_worker_that_fails_is_no_verdict_and_no_end() -> None:
    found = list(run([cell("fail badly"), cell("good")], processes(1), judging=obedient))
    assert {each.cell.container: type(each) for each in found} == {"fail badly": Unjudged, "good": CellResult}


def test_cases_are_taken_as_there_is_room_so_that_endless_ones_can_be_begun() -> None:
    taken = count()

    def opened() -> Executor:
        return ThreadPoolExecutor(1)

    def ended(executor: Executor) -> None:
        executor.shutdown()

    endless = (cell(f"c{number}") for number in taken)
    found = run(endless, Engine(opened, 1, ended), judging=obedient)
    assert len(list(islice(found, 10))) == 10
    found.close()
    assert next(taken) <= (1 + 1) * MOST_TOGETHER + AHEAD * MOST_TOGETHER


def test_what_workers_begin_with_is_loaded_once_before_them_with_the_first_case() -> None:
    loaded: list[str] = []

    def prepared(asked: Cell) -> None:
        loaded.append(asked.container)

    cells = [cell(f"c{number}") for number in range(6)]
    found = list(run(cells, processes(2), judging=partial(_having, loaded), prepare=prepared))
    assert loaded == ["c0"]
    assert [type(each) for each in found] == [CellResult] * 6


def _having(loaded: list[str], asked: Cell) -> Found:
    """A verdict, if what was loaded before is here."""
    return obedient(asked if loaded == ["c0"] else cell("fail empty-handed"))


def test_no_garbage_is_looked_for_in_what_workers_begin_with_and_after_them_as_before() -> None:
    looked_for: list[bool] = []
    work = each([1, 2], 2, partial(pow, 2), prepare=Loading(lambda _: looked_for.append(gc.isenabled())))
    assert next(work)[1] in {2, 4}
    assert (looked_for, gc.isenabled(), gc.get_freeze_count() > 0) == ([False], True, True)
    assert len(list(work)) == 1
    assert gc.get_freeze_count() == 0


LOADED: list[str] = []
"""What this process has loaded, or the one that it is a copy of."""


def test_a_worker_begins_once_its_own_is_loaded_and_anew_for_what_was_loaded_since(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(f"{__name__}.LOADED", [])
    items = [("a", number) for number in range(3)] + [("b", number) for number in range(8)]
    prepare = Loading(_load, _kind)
    done = dict(each(items, 2, _loaded_by, prepare))
    assert LOADED == ["a", "b"], "each once, in the process that begins the others"
    of_a, of_b = ({done[item] for item in items if item[0] == which} for which in "ab")
    assert [loaded for _, loaded in of_a] == [("a",)]
    assert [loaded for _, loaded in of_b] == [("a", "b")] * 2, "the first has ended, and another begun"
    assert {pid for pid, _ in of_a}.isdisjoint(pid for pid, _ in of_b)


def _kind(item: tuple[str, int]) -> str:
    return item[0]


def _load(item: tuple[str, int]) -> None:
    LOADED.append(item[0])


def _loaded_by(item: tuple[str, int]) -> tuple[int, tuple[str, ...]]:
    """The process, and what it began with."""
    time.sleep(0.1 if item[0] == "b" else 0.0)
    return os.getpid(), tuple(LOADED)


def test_what_was_done_while_something_was_loaded_is_told_before_an_interrupt(tmp_path: Path) -> None:
    def interrupted(item: tuple[str, int]) -> None:
        if item[0] == "b":
            while len(list(tmp_path.iterdir())) < 2:
                time.sleep(0.01)
            time.sleep(0.5)
            raise KeyboardInterrupt

    def tells() -> None:
        for item, _ in each(items, 2, work, prepare):
            told.append(item)

    told: list[tuple[str, int]] = []
    items, prepare = [("a", 0), ("a", 1), ("b", 0)], Loading(interrupted, _kind)
    work = partial(_noted_in, tmp_path)
    with pytest.raises(KeyboardInterrupt):
        tells()
    assert told == [("a", 0), ("a", 1)]


def _noted_in(folder: Path, item: tuple[str, int]) -> None:
    (folder / f"{item}").touch()


def test_workers_that_are_no_copies_load_for_themselves() -> None:
    def prepared(asked: Cell) -> None:
        raise AssertionError(asked)

    engine = Engine(lambda: ThreadPoolExecutor(1), 1, lambda executor: executor.shutdown())
    assert len(list(run([cell("c")], engine, judging=obedient, prepare=prepared))) == 1


def test_what_is_alike_stays_together_until_the_last_workers_share_it() -> None:
    waiting: Waiting[str] = Waiting(2, lambda item: item[0])
    for group in "abc":
        for number in range(17):
            waiting.add(f"{group}{number}")
    pieces = []
    while len(waiting):
        pieces.append(waiting.piece())
    assert [len(piece) for piece in pieces] == [17, 9, 7, 1, 5, 3, 3, 2, 1, 1, 1, 1]
    assert all(len({item[0] for item in piece}) == 1 for piece in pieces)
    assert [item for piece in pieces for item in piece] == [
        f"{group}{number}" for group in "abc" for number in range(17)
    ]


def test_a_worker_goes_on_with_what_is_alike_and_takes_what_others_are_at_last() -> None:
    waiting: Waiting[str] = Waiting(2, lambda item: item[0], most=1)
    for item in ("a0", "a1", "b0", "b1", "c0"):
        waiting.add(item)
    assert waiting.next() == "a0"
    taken = [waiting.piece(), waiting.piece(None, "a"), waiting.piece("b", "a"), waiting.piece("b", "a")]
    assert taken == [["a0"], ["b0"], ["b1"], ["c0"]]
    assert waiting.piece("c", "a") == ["a1"]


def test_a_worker_goes_on_with_what_is_nearest_and_begins_far_from_the_others() -> None:
    waiting: Waiting[tuple[str, int]] = Waiting(2, lambda item: item)
    for item in (("a", 0), ("a", 1), ("b", 0), ("a", 2), ("b", 1)):
        waiting.add(item)
    assert waiting.piece() == [("a", 0)]
    assert waiting.piece(None, [("a", 0)]) == [("b", 0)]
    assert waiting.piece(("b", 0), [("a", 0)]) == [("b", 1)]
    assert waiting.piece(("a", 0), [("b", 1)]) == [("a", 1)]
    assert waiting.piece(("b", 1), [("a", 1)]) == [("a", 2)], "there is no more of its own"


def test_what_is_left_of_a_piece_is_next() -> None:
    waiting: Waiting[str] = Waiting(2, lambda item: item[0])
    for item in ("a0", "b0", "b1", "c0"):
        waiting.add(item)
    assert waiting.piece() == ["a0"]
    taken = waiting.piece()
    waiting.back(taken[1:])
    waiting.back([])
    assert [waiting.piece() for _ in range(2)] == [["b1"], ["c0"]]
    waiting.back(["a1", "a2"])
    assert [waiting.piece() for _ in range(2)] == [["a1"], ["a2"]]


def test_after_its_turn_a_worker_begins_no_more_and_what_is_left_is_done_later(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(piece, "TURN", 0.0)
    began: list[int] = []
    engine = Engine(lambda: ThreadPoolExecutor(1), 1, lambda executor: executor.shutdown())
    with handed.Handed(engine, began.append, lambda _: None) as working:
        done = [one for item in range(70) for one in working.add(item)]
        done += working.rest()
    assert sorted(item for item, _ in done) == sorted(began) == list(range(70))


def test_an_item_whose_name_is_wrong_is_the_caller_s_error_with_its_own_words() -> None:
    with pytest.raises(InputError, match=r"no robot named 'pr3'.*did you mean 'pr2'"):
        list(each(["pr2", "pr3"], 2, _known))
    assert sorted(each(["pr2", "stretch"], 2, _known)) == [("pr2", 3), ("stretch", 7)]


def test_an_item_that_kills_its_process_twice_is_no_result() -> None:
    with pytest.raises(OracleUnavailableError, match="died twice"):
        list(each(["die"], 2, _known))


def _known(robot: str) -> int:
    if robot == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if robot == "pr3":
        raise UnknownEntityError("robot", robot, ["pr2"])
    return len(robot)


def test_a_model_that_was_edited_is_loaded_again(tmp_path: Path) -> None:
    copy = tmp_path / "a.urdf"
    text = (FOLDER / "a.urdf").read_text()
    copy.write_text(text)
    asked = Cell(str(copy), str(FOLDER / "pr2.urdf"), "open:low_drawer", (), Policy())
    first = service_of(asked)
    assert service_of(asked) is first
    copy.write_text(text.replace('upper="0.5"', 'upper="0.4"'))
    opens = [one.twin.container("low_drawer").open_from for one in (first, service_of(asked))]
    assert opens == pytest.approx([0.45, 0.36])
