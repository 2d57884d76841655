"""SIGTERM as an interrupt, for what has something to keep: `timeout`, containers and schedulers send it."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn


class Terminated(KeyboardInterrupt):
    """SIGTERM came."""


def terminate(number: int, frame: FrameType | None) -> NoReturn:
    """What is done when it comes, in place of ending at once."""
    del number, frame
    raise Terminated


@contextmanager
def terminable() -> Iterator[None]:
    """SIGTERM is raised as `Terminated`; not where somebody else handles it, nor beside the main thread."""
    alone = threading.current_thread() is threading.main_thread()
    if not alone or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return
    signal.signal(signal.SIGTERM, terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def end_at_once() -> None:
    """In a copy of this process: both signals end it, as they end a process by themselves."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)
