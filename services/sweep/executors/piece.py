"""A piece of work in its worker: what came of each item, or why nothing did."""

import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

from sdt_kg.errors import InputError, OracleUnavailableError, SdtError

_log = logging.getLogger("sdt.sweep")

T = TypeVar("T")
R = TypeVar("R")

TURN: Final = 10.0
"""[s] After which no further item of a piece is begun: what a killed process takes with it, and how seldom
progress is told."""


@dataclass(frozen=True, slots=True)
class Lost:
    """Nothing came of an item.

    Attributes:
        reason: Why.
        is_input: Whether it is the caller's to mend.
    """

    reason: str
    is_input: bool = False

    def error(self, what: str) -> SdtError:
        """The same to be raised, said of what it happened to."""
        return InputError(self.reason) if self.is_input else OracleUnavailableError(f"{what}: {self.reason}")


def work_off(work: Callable[[T], R], piece: Sequence[T]) -> list[R | Lost]:
    """What came of each item of a piece that was begun in time, in the worker.

    One that fails takes none with it. An error travels as text: not every one of ours can be made anew from
    what it says.
    """
    until = time.monotonic() + TURN
    results: list[R | Lost] = []
    for item in piece:
        if results and time.monotonic() >= until:
            break
        results.append(_one(work, item))
    return results


def _one(work: Callable[[T], R], item: T) -> R | Lost:
    try:
        return work(item)
    except SdtError as error:
        return Lost(str(error), isinstance(error, InputError))
    except Exception as error:  # noqa: BLE001 - the edge of a worker: logged, and answered as a failure
        _log.exception("%s failed", item)
        return Lost(f"its worker failed: {type(error).__name__}")
