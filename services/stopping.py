"""SIGTERM as an interrupt, for what has something to keep: `timeout`, containers and schedulers send it.

SIGHUP, which a terminal sends that is closed, is taken as SIGTERM.
"""

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final, NoReturn

SOON: Final = 0.05
"""[s] After which an interrupt that was lost comes again: the call in which it was lost is over."""


class Terminated(KeyboardInterrupt):
    """SIGTERM came."""


def terminate(number: int, frame: FrameType | None) -> NoReturn:
    """What is done when it comes, in place of ending at once."""
    del number, frame
    raise Terminated


def _as_terminated(number: int, frame: FrameType | None) -> None:
    del number, frame
    signal.raise_signal(signal.SIGTERM)


@contextmanager
def terminable() -> Iterator[None]:
    """SIGTERM is raised as `Terminated`; not where somebody else handles it, nor beside the main thread.

    So is SIGHUP, unless it is ignored, as `nohup` has it, or handled.
    """
    alone = threading.current_thread() is threading.main_thread()
    if not alone or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return
    handlers = {signal.SIGTERM: terminate, signal.SIGHUP: _as_terminated}
    ours = [number for number in handlers if signal.getsignal(number) is signal.SIG_DFL]
    for number in ours:
        signal.signal(number, handlers[number])
    try:
        yield
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)


def repeat_if_lost() -> None:
    """An interrupt that comes where Python can only print it, as while LLVM calls back, comes again soon.

    Python goes on after what is raised in a callback of C, or where an object is given back.
    """
    told = sys.unraisablehook
    coming: set[int] = set()

    def send(number: int) -> None:
        coming.remove(number)  # first: it may be lost again
        signal.pthread_kill(threading.main_thread().ident or 0, number)

    def hook(lost: "sys.UnraisableHookArgs") -> None:
        if not issubclass(lost.exc_type, KeyboardInterrupt):
            told(lost)
            return
        number = signal.SIGTERM if issubclass(lost.exc_type, Terminated) else signal.SIGINT
        if number not in coming:
            coming.add(number)
            again = threading.Timer(SOON, send, (number,))
            again.daemon = True
            again.start()

    sys.unraisablehook = hook


def end_at_once() -> None:
    """In a copy of this process: both signals end it, as they end a process by themselves."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)
