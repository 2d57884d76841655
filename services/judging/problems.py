"""What goes wrong on the bus: one shape in the manner of RFC 9457, one exception for each type.

A false verdict and an abstention are replies, never problems.
"""

from enum import Enum

from pydantic import BaseModel, ConfigDict, Field

from sdt_kg.errors import (
    InputError,
    NoModeError,
    OracleError,
    OracleUnavailableError,
    SdtError,
    StoreError,
)

TYPE_ROOT = "https://example.org/sdt/problems/"


class ProblemType(Enum):
    """Kinds of problem, and whether asking again may help."""

    UNAVAILABLE = "unavailable"
    DEADLINE = "deadline"
    INVALID_REQUEST = "invalid-request"
    FORBIDDEN = "forbidden"
    TOO_LARGE = "too-large"
    CONFLICT = "conflict"
    INTERNAL = "internal"


MOST_TOLD = 4_000
"""Characters of an explanation."""

RETRYABLE = {ProblemType.UNAVAILABLE, ProblemType.DEADLINE}

_TITLES = {
    ProblemType.UNAVAILABLE: "Nobody can answer now",
    ProblemType.DEADLINE: "The deadline passed before there was an answer",
    ProblemType.INVALID_REQUEST: "The request is wrong",
    ProblemType.FORBIDDEN: "The request is not allowed",
    ProblemType.TOO_LARGE: "The request or its answer is too large",
    ProblemType.CONFLICT: "The request contradicts what the server holds",
    ProblemType.INTERNAL: "The server failed",
}


class Problem(BaseModel):
    """The payload of a ReplyErr.

    Attributes:
        type: IRI of the kind of problem.
        detail: What was wrong, what is allowed, what to do.
        retryable: Whether the same request may succeed later.
        retry_after: Seconds to wait before asking again, where that is known.
        report: Id of the request in the server's log.
        what, allowed, remedy: The detail of an invalid request in its parts.
    """

    model_config = ConfigDict(extra="ignore")

    type: str
    title: str
    detail: str
    retryable: bool
    retry_after: float | None = Field(default=None, ge=0)
    report: str = ""
    what: str = ""
    allowed: str = ""
    remedy: str = ""

    @property
    def kind(self) -> ProblemType:
        """The kind; what an older client does not know is INTERNAL."""
        try:
            return ProblemType(self.type.removeprefix(TYPE_ROOT))
        except ValueError:
            return ProblemType.INTERNAL


class BusError(OracleError):
    """A question over the bus has no answer.

    Attributes:
        problem: What the server said, or what the client concluded.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        super().__init__(f"{problem.title}: {problem.detail}")


class BusUnavailableError(BusError, OracleUnavailableError):
    """Nobody answered: there is no verdict."""

    def __init__(self, problem: Problem) -> None:
        BusError.__init__(self, problem)


class DeadlineError(BusError):
    """The deadline passed first."""


class ForbiddenError(BusError):
    """This user may not ask this, or the query asks for what is done for nobody."""


class TooLargeError(BusError):
    """The request or its answer is above a limit."""


class ConflictError(BusError):
    """The request is about another twin, or another version, than the server's."""


class InternalError(BusError):
    """The server failed; its log has the report id."""


class RequestError(InputError):
    """The server says that the request is wrong.

    Attributes:
        problem: What the server said.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        super().__init__(problem.what or problem.detail, allowed=problem.allowed, remedy=problem.remedy)


_ERRORS: dict[ProblemType, type[BusError]] = {
    ProblemType.UNAVAILABLE: BusUnavailableError,
    ProblemType.DEADLINE: DeadlineError,
    ProblemType.FORBIDDEN: ForbiddenError,
    ProblemType.TOO_LARGE: TooLargeError,
    ProblemType.CONFLICT: ConflictError,
    ProblemType.INTERNAL: InternalError,
}


def problem(kind: ProblemType, detail: str, *, retry_after: float | None = None, report: str = "") -> Problem:
    """A problem of that kind; what an asker sent is not told back at any length."""
    return Problem(
        type=TYPE_ROOT + kind.value,
        title=_TITLES[kind],
        detail=_short(detail),
        retryable=kind in RETRYABLE,
        retry_after=retry_after,
        report=report,
    )


def problem_of(error: SdtError, kind: ProblemType | None = None) -> Problem:
    """What a server says when a question raises this; of that kind, where one knows better than the error."""
    if isinstance(error, BusError | RequestError):
        return error.problem
    detail = str(error)
    if isinstance(error, StoreError):  # where it lies is not for everybody
        detail = "; ".join(part for part in (f"the store of this service {error.what}", error.remedy) if part)
    said = problem(kind or _kind_of(error), detail)
    if not isinstance(error, InputError):
        return said
    parts = {"what": error.what, "allowed": error.allowed, "remedy": error.remedy}
    return said.model_copy(update={name: _short(text) for name, text in parts.items()})


def _kind_of(error: SdtError) -> ProblemType:
    if isinstance(error, InputError | NoModeError):
        return ProblemType.INVALID_REQUEST
    may_pass = isinstance(error, OracleUnavailableError | StoreError)
    return ProblemType.UNAVAILABLE if may_pass else ProblemType.INTERNAL


def _short(text: str) -> str:
    return text if len(text) <= MOST_TOLD else f"{text[:MOST_TOLD]} …"


def error_of(said: Problem) -> SdtError:
    """The exception that a client raises for a problem."""
    if said.kind is ProblemType.INVALID_REQUEST:
        return RequestError(said)
    return _ERRORS[said.kind](said)
