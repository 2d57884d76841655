"""Ctrl-C, and SIGTERM where it is as much, while libraries are imported."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

from services.stopping import terminate


@contextmanager
def importing() -> Iterator[None]:
    """An interrupt that comes meanwhile is raised at the end.

    Some libraries catch whatever is raised while they are imported: trimesh would take an interrupt for
    another library that is not there, and the interrupt would be lost.
    """
    handlers = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: terminate}
    ours = [number for number in handlers if signal.getsignal(number) is handlers[number]]
    came: list[signal.Signals] = []
    for number in ours:  # not what is ignored, or somebody else's
        signal.signal(number, lambda number, _: came.append(signal.Signals(number)))
    try:
        yield
    finally:
        for number in ours:
            signal.signal(number, handlers[number])
    if came:
        handlers[came[0]](came[0], None)
