"""What can go wrong between a question and its answer, beyond a bad query."""

from enum import Enum

from sdt_kg.errors import InputError, OracleUnavailableError


class Limit(Enum):
    """What a query may not exceed."""

    TIME = "time"
    MEMORY = "memory"
    ROWS = "rows"
    BYTES = "bytes"


class LimitError(InputError):
    """A query was stopped at a limit; there is no partial answer.

    Attributes:
        limit: Which.
    """

    def __init__(self, limit: Limit, allowed: str) -> None:
        self.limit = limit
        remedy = "ask for less: LIMIT, a more selective pattern, or one kitchen at a time"
        super().__init__(f"the query exceeds the {limit.value} limit", allowed=allowed, remedy=remedy)


class NotAcceptableError(InputError):
    """The answer has none of the accepted media types."""


class CrashedQueryError(InputError):
    """The query ended its process, by a stack overflow for example."""


class BusyError(OracleUnavailableError):
    """All workers are busy and too many questions are waiting."""


class WorkersGoneError(OracleUnavailableError):
    """The process that holds the data has ended."""
