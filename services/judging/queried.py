"""What it is to whoever asked when a query gets no answer: the same over Zenoh and to agents."""

from typing import Final

from sdt_kg.errors import SdtError
from services.judging.problems import Problem, ProblemType, problem_of
from services.store.guard import RefusedQueryError
from services.store.workers import BusyError, Limit, LimitError

COME_BACK: Final = 1.0
"""[s] After which a query may be asked again that found everybody busy."""


def problem_of_query(error: SdtError) -> Problem:
    """What is said when a query raises this."""
    if isinstance(error, BusyError):
        return problem_of(error).model_copy(update={"retry_after": COME_BACK})
    if isinstance(error, RefusedQueryError):
        return problem_of(error, ProblemType.FORBIDDEN)
    if isinstance(error, LimitError):
        late = error.limit is Limit.TIME
        return problem_of(error, ProblemType.DEADLINE if late else ProblemType.TOO_LARGE)
    return problem_of(error)
