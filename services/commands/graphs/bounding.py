"""How long a query of a command may take, and how much memory: beyond it is an error, never a cut answer."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

import click

from services.commands.options import FiniteRange
from services.store.workers import ALONE, Ask, Limit, LimitError, Limits, apart

Told = TypeVar("Told")

OPTION = {Limit.TIME: "--timeout SECONDS", Limit.MEMORY: "--memory GIB"}


def bound_options(command: Callable[..., Any]) -> Callable[..., Any]:  # a click command, as click has it
    """`--timeout` and `--memory`."""
    timeout = click.option(
        "--timeout",
        type=FiniteRange(min=0, min_open=True, max=1e6),
        default=ALONE.seconds,
        show_default=True,
        metavar="SECONDS",
        help="How long the query itself may take; what is judged has --budget.",
    )
    memory = click.option(
        "--memory",
        type=FiniteRange(min=0, min_open=True, max=1e6),
        default=ALONE.memory / 2**30,
        show_default=True,
        metavar="GIB",
        help="How much memory the query may take beside the data.",
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
