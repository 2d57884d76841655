"""Where what is done comes from: the request, and the trace that it is part of."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Origin:
    """A request.

    Attributes:
        request: Its id, as its asker or the service gave it; empty where nobody asked.
        traceparent: W3C trace context of the span under way; empty without one.
    """

    request: str = ""
    traceparent: str = ""


NOBODY: Final = Origin()
_current: Final[ContextVar[Origin]] = ContextVar("origin", default=NOBODY)


@contextmanager
def within(origin: Origin) -> Iterator[None]:
    """What is done within is done for this request."""
    token = _current.set(origin)
    try:
        yield
    finally:
        _current.reset(token)


def current() -> Origin:
    """The request that something is done for here."""
    return _current.get()
