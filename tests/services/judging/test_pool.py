"""Whoever asks a pool of workers is answered once: rightly, late, or that it failed."""

import logging
import math
import queue
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from sdt_kg.errors import StoreRejectedError
from services.judging.problems import Problem, ProblemType
from services.judging.workers import lane
from services.judging.workers.jobs import Done, Kept, Task, Waiter
from services.judging.workers.pool import Pool
from tests.services.judging.handlers import Interrupted, Loading, Reader, obedient

SOON = 60.0
"""[s] Long after everything here is over."""


class Shelf:
    """Remembers what is kept."""

    def __init__(self) -> None:
        self.kept: dict[str, bytes] = {"known": b"stored quads"}

    def recall(self, iri: str) -> bytes | None:
        return self.kept.get(iri)

    def keep(self, kept: Iterable[Kept]) -> None:
        self.kept |= dict(kept)


class FullShelf(Shelf):
    """Remembers nothing more, and cannot be asked either, until there is room."""

    full = True

    def recall(self, iri: str) -> bytes | None:
        self._check()
        return super().recall(iri)

    def keep(self, kept: Iterable[Kept]) -> None:
        self._check()
        super().keep(kept)

    def _check(self) -> None:
        if self.full:
            raise StoreRejectedError("/its/place", "cannot be written: No space left on device")


class Asker:
    """Asks a pool and waits for answers."""

    def __init__(self, pool: Pool) -> None:
        self.pool = pool

    def send(self, text: str, seconds: float = SOON, *, share: bool = False) -> Callable[[], object]:
        answers: queue.Queue[Done | Problem] = queue.Queue()
        waiter = Waiter(time.monotonic() + seconds, answers.put)
        self.pool.submit(Task("b", "do", text.encode(), "text/plain", seconds), waiter, share=share)
        return lambda: answers.get(timeout=SOON)

    def ask(self, text: str, seconds: float = SOON) -> Done | Problem:
        answer = self.send(text, seconds)()
        assert isinstance(answer, Done | Problem)
        return answer


@contextmanager
def pool_of(size: int, waiting: int = 8, shelf: Shelf | None = None) -> Iterator[tuple[Asker, Shelf]]:
    shelf = shelf or Shelf()
    pool = Pool(obedient, size, shelf, waiting)
    try:
        yield Asker(pool), shelf
    finally:
        pool.close()


@pytest.fixture(scope="module")
def asker() -> Iterator[Asker]:
    with pool_of(1) as (one, _):
        yield one


def text(answer: object) -> str:
    assert isinstance(answer, Done), answer
    return answer.payload.decode()


def kind(answer: object) -> ProblemType:
    assert isinstance(answer, Problem), answer
    return answer.kind


def test_a_worker_answers(asker: Asker) -> None:
    assert text(asker.ask("hello world")) == "hello world"


def test_a_worker_asks_for_what_is_stored(asker: Asker) -> None:
    assert text(asker.ask("recall known")) == "stored quads"
    assert text(asker.ask("recall unknown")) == "nothing"


def test_a_deadline_is_kept_while_the_worker_is_busy_and_it_recovers(asker: Asker) -> None:
    began = time.monotonic()
    assert kind(asker.ask("sleep 30", 0.2)) is ProblemType.DEADLINE
    assert time.monotonic() - began < 2
    assert text(asker.ask("still there")) == "still there"


def test_a_question_whose_worker_dies_once_is_answered(asker: Asker, tmp_path: Path) -> None:
    assert text(asker.ask(f"die-once {tmp_path / 'died'}")).startswith("die-once")


def test_a_question_that_kills_its_worker_twice_fails_and_the_pool_lives_on(asker: Asker) -> None:
    assert kind(asker.ask("die")) is ProblemType.INTERNAL
    assert text(asker.ask("alive")) == "alive "


def test_a_worker_that_has_read_other_files_gives_way_to_one_that_reads_them_anew() -> None:
    with closing(Pool(Reader, 1, Shelf(), 8)) as pool:
        asker = Asker(pool)
        before = text(asker.ask("who"))
        assert kind(asker.ask("changed")) is ProblemType.UNAVAILABLE
        assert text(asker.ask("who")) != before
        assert pool.counts.crashed == 0


def test_two_equal_questions_at_once_are_computed_once(asker: Asker, tmp_path: Path) -> None:
    log = tmp_path / "log"
    answers = [asker.send(f"count {log}", share=True) for _ in range(3)]
    assert {text(answer()) for answer in answers} == {f"count {log}"}
    assert log.read_text() == "x"


def test_who_has_more_time_does_not_get_the_answer_of_who_has_less(asker: Asker, tmp_path: Path) -> None:
    log = tmp_path / "log"
    hurried, patient = (asker.send(f"count {log}", seconds, share=True) for seconds in (SOON, 2 * SOON))
    assert text(hurried()) == text(patient()) == f"count {log}"
    assert log.read_text() == "xx"


def test_a_full_queue_refuses_at_once_and_says_when_to_come_back() -> None:
    with pool_of(1, waiting=1) as (asker, _):
        running = asker.send("sleep 1")
        time.sleep(0.3)
        waits = asker.send("next")
        refused = asker.ask("one too many")
        assert kind(refused) is ProblemType.UNAVAILABLE
        assert isinstance(refused, Problem)
        assert refused.retry_after is not None
        assert text(running()) == "sleep 1"
        assert text(waits()) == "next "


def test_what_is_acknowledged_is_kept_first() -> None:
    with pool_of(1) as (asker, shelf):
        assert text(asker.ask("keep verdict")) == "kept"
        assert "verdict" in shelf.kept


def test_a_store_that_is_full_or_gone_is_said_and_the_pool_lives_on() -> None:
    with pool_of(1, shelf=(shelf := FullShelf())) as (asker, _):
        for word in ("keep verdict", "recall known"):
            refused = asker.ask(word)
            assert kind(refused) is ProblemType.UNAVAILABLE
            assert isinstance(refused, Problem)
            assert refused.detail == "the store of this service cannot be written: No space left on device"
        shelf.full = False
        assert text(asker.ask("keep verdict")) == "kept"
        assert text(asker.ask("recall known")) == "stored quads"
        assert asker.pool.counts.crashed == 0


def test_a_cancelled_job_frees_its_worker() -> None:
    with pool_of(1) as (asker, _):
        answers: queue.Queue[Done | Problem] = queue.Queue()
        waiter = Waiter(time.monotonic() + 60, answers.put)
        job = asker.pool.submit(Task("b", "do", b"sleep 60", "text/plain", 60), waiter)
        time.sleep(0.3)
        job.cancelled.set()
        assert kind(answers.get(timeout=SOON)) is ProblemType.CONFLICT
        assert text(asker.ask("free")) == "free "


def test_what_its_asker_left_ends_soon_and_nothing_is_answered() -> None:
    with pool_of(1) as (asker, _):
        answers: queue.Queue[Done | Problem] = queue.Queue()
        waiter = Waiter(math.inf, answers.put)
        asker.pool.submit(Task("b", "do", b"sleep 60", "text/plain", math.inf), waiter)
        time.sleep(0.3)
        waiter.leave()
        assert text(asker.ask("free")) == "free "
        assert answers.empty()


def test_what_is_urgent_goes_first() -> None:
    with pool_of(1) as (asker, _):
        asker.send("sleep 0.5")
        answers: queue.Queue[Done | Problem] = queue.Queue()
        for word, urgent in (("late", False), ("soon", True)):
            task = Task("b", "do", word.encode(), "text/plain", SOON)
            waiter = Waiter(time.monotonic() + SOON, answers.put)
            asker.pool.submit(task, waiter, urgent=urgent)
        assert [text(answers.get(timeout=SOON)) for _ in range(2)] == ["soon ", "late "]


def test_closing_answers_everybody() -> None:
    with pool_of(1) as (asker, _):
        waiting = [asker.send("sleep 60", 100), asker.send("never", 100)]
    assert {kind(each()) for each in waiting} <= {ProblemType.UNAVAILABLE, ProblemType.CONFLICT}


@pytest.mark.skipif(
    not Path("/proc/self/statm").exists(), reason="the system does not tell a process' memory"
)
def test_a_worker_that_has_grown_too_large_is_replaced_when_its_job_is_done(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pool_of(1) as (asker, _):
        assert isinstance(asker.ask("pid"), Done)
        before = asker.pool.pids()
        loaded = asker.pool.telemetry.metrics.to_json()["sdt_process_resident_bytes"]
        monkeypatch.setattr(lane, "MOST_MEMORY", loaded + 100 * 2**20)
        assert isinstance(asker.ask("pid"), Done)
        assert asker.pool.pids() == before, "it has not grown"
        assert isinstance(asker.ask("hoard 200"), Done)
        assert isinstance(asker.ask("pid"), Done)
        assert asker.pool.pids() != before
        counted = asker.pool.telemetry.metrics.to_json()
        assert (counted["sdt_process_replacements_total"], counted["sdt_process_deaths_total"]) == (1, 0)
        assert counted["sdt_process_resident_bytes"] < loaded + 100 * 2**20


def test_a_pool_that_still_loads_is_closed_without_a_word(caplog: pytest.LogCaptureFixture) -> None:
    before = set(threading.enumerate())
    pool = Pool(Loading(), 1, Shelf())
    pool.warm(seconds=1.0)
    with caplog.at_level(logging.WARNING):
        pool.close()
    assert [each for each in threading.enumerate() if each not in before] == []
    assert caplog.messages == []


def test_an_interrupt_passes_a_process_by_that_has_not_begun() -> None:
    pool = Pool(Interrupted(), 1, Shelf())
    try:
        assert Asker(pool).ask("echo hello") == Done(b"echo hello", "text/plain")
        assert pool.counts.crashed == 0
    finally:
        pool.close()
