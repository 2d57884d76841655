"""An interrupt that comes where Python can raise nothing is not lost."""

import ctypes
import os
import signal
import sys
import time
from collections.abc import Iterator

import pytest

from services.stopping import Terminated, repeat_if_lost, terminable


@pytest.fixture
def _repeating(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    repeat_if_lost()
    # A shell's job beside others ignores SIGINT; whoever runs the tests may handle SIGTERM.
    before = {
        signal.SIGINT: signal.signal(signal.SIGINT, signal.default_int_handler),
        signal.SIGTERM: signal.signal(signal.SIGTERM, signal.SIG_DFL),
    }
    try:
        with terminable():
            yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@pytest.mark.usefixtures("_repeating")
@pytest.mark.parametrize(
    ("number", "error"), [(signal.SIGTERM, Terminated), (signal.SIGINT, KeyboardInterrupt)]
)
def test_an_interrupt_in_a_callback_of_c_stops_what_called_it(
    number: int, error: type[KeyboardInterrupt]
) -> None:
    @ctypes.CFUNCTYPE(None)
    def interrupted() -> None:
        os.kill(os.getpid(), number)

    def work() -> None:
        for _ in range(3):  # they come again as one
            interrupted()
        time.sleep(10)

    with pytest.raises(KeyboardInterrupt) as stopped:
        work()
    assert stopped.type is error


def test_other_errors_there_are_told_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[type[BaseException]] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda lost: told.append(lost.exc_type))
    repeat_if_lost()

    @ctypes.CFUNCTYPE(None)
    def failing() -> None:
        raise LookupError

    failing()
    assert told == [LookupError]
