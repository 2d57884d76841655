"""How long `sdt query` may take, and how much memory: beyond it there is an error, never a cut answer."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

import click

from services.commands.options import FiniteRange
from services.store.workers import Ask, Limit, LimitError, Limits, apart

Told = TypeVar("Told")

DEFAULT_TIMEOUT = 60.0
"""[s] Whoever waits at a terminal waits longer than a client of the service."""

DEFAULT_MEMORY = 2.0
"""[GiB] For a million rows of a few columns."""

OPTION = {Limit.TIME: "--timeout SECONDS", Limit.MEMORY: "--memory GIB"}


def bound_options(command: Callable[..., Any]) -> Callable[..., Any]:  # a click command, as click has it
    """`--timeout` and `--memory`."""
    timeout = click.option(
        "--timeout",
        type=FiniteRange(min=0, min_open=True, max=1e6),
        default=DEFAULT_TIMEOUT,
        show_default=True,
        metavar="SECONDS",
        help="How long the query itself may take; what --compute runs before it has --budget.",
    )
    memory = click.option(
        "--memory",
        type=FiniteRange(min=0, min_open=True, max=1e6),
        default=DEFAULT_MEMORY,
        show_default=True,
        metavar="GIB",
        help="How much memory it may take beside the data.",
    )
    return timeout(memory(command))


@contextmanager
def bounded(timeout: float, memory: float) -> Iterator[Ask[Told]]:
    """Does one piece of work in a process of its own, within so many seconds and GiB.

    Raises:
        LimitError: They do not suffice; it says which option gives more.
    """
    try:
        with apart(Limits(seconds=timeout, memory=int(memory * 2**30))) as ask:
            yield ask
    except LimitError as error:
        more = OPTION.get(error.limit)
        raise LimitError(
            error.limit, f"{error.allowed}, or what {more} says" if more else error.allowed
        ) from None
