"""A process as an executor: one after the other, in one process, and never a silent end."""

import os
import signal
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager

import pytest

from services.sweep.executors.process import OneProcess


@contextmanager
def one() -> Iterator[OneProcess]:
    executor = OneProcess()
    try:
        yield executor
    finally:
        executor.shutdown(cancel_futures=True)


def is_there(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_what_is_given_is_done_in_one_other_process() -> None:
    with one() as executor:
        assert [executor.submit(divmod, 7 * n, 3).result() for n in (1, 2)] == [(2, 1), (4, 2)]
        pids = {executor.submit(os.getpid).result() for _ in range(3)}
    assert len(pids) == 1
    assert os.getpid() not in pids


def test_work_that_fails_is_told_and_ends_nothing() -> None:
    with one() as executor:
        failed = executor.submit(divmod, 1, 0)
        with pytest.raises(RuntimeError, match="ZeroDivisionError"):
            failed.result()
        assert executor.submit(abs, -1).result() == 1


def test_what_cannot_travel_is_told_and_ends_nothing() -> None:
    with one() as executor:
        with pytest.raises(Exception, match="lambda"):
            executor.submit(lambda: 1).result()
        with pytest.raises(RuntimeError, match="pickle"):
            executor.submit(compile, "(n for n in ())", "", "eval").result()
        assert executor.submit(abs, -1).result() == 1


def test_after_its_death_all_that_it_was_given_is_told_so() -> None:
    with one() as executor:
        waiting = [executor.submit(os.kill, 0, 0), executor.submit(_die), executor.submit(abs, -1)]
        assert waiting[0].result() is None
        for future in (*waiting[1:], executor.submit(abs, -1)):
            with pytest.raises(BrokenExecutor, match="died"):
                future.result()


def _die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def test_the_process_is_gone_when_it_is_shut_down_and_has_done_what_it_was_given() -> None:
    executor = OneProcess()
    pid, last = executor.submit(os.getpid), executor.submit(abs, -1)
    executor.shutdown()
    assert last.result() == 1
    assert not is_there(pid.result())


def test_the_process_is_gone_at_once_when_what_it_does_is_cancelled() -> None:
    executor = OneProcess()
    pid = executor.submit(os.getpid).result()
    slow, began = executor.submit(time.sleep, 60), time.monotonic()
    executor.shutdown(cancel_futures=True)
    assert time.monotonic() - began < 10
    assert not is_there(pid)
    with pytest.raises(BrokenExecutor, match="died"):
        slow.result()
