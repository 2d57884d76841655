"""Queries in processes that can be killed: no network, bounded time, memory and answers."""

from services.store.workers.apart import ALONE, Ask, Begin, apart
from services.store.workers.deltas import DEFAULT_GRAPH, Delta, bulk, drop, put
from services.store.workers.errors import (
    BusyError,
    CrashedQueryError,
    Limit,
    LimitError,
    NotAcceptableError,
    WorkersGoneError,
)
from services.store.workers.evaluate import Answered, Asked
from services.store.workers.pool import Limits, Workers

__all__ = [
    "ALONE",
    "DEFAULT_GRAPH",
    "Answered",
    "Ask",
    "Asked",
    "Begin",
    "BusyError",
    "CrashedQueryError",
    "Delta",
    "Limit",
    "LimitError",
    "Limits",
    "NotAcceptableError",
    "Workers",
    "WorkersGoneError",
    "apart",
    "bulk",
    "drop",
    "put",
]
