"""Answers and problems on the wire: sent once, so that the asker knows that this was all, and read."""

import logging

import zenoh
from pydantic import ValidationError

from services.judging.codec import JSON
from services.judging.jobs import Done
from services.judging.problems import Problem, ProblemType, problem

log = logging.getLogger(__name__)


def reply(query: zenoh.Query, key: str, outcome: Done | Problem) -> None:
    """The reply or the error is sent under the key, and the query is over."""
    with query:
        try:
            if isinstance(outcome, Done):
                query.reply(key, outcome.payload, encoding=outcome.encoding)
            else:
                query.reply_err(outcome.model_dump_json().encode(), encoding=JSON)
        except zenoh.ZError as error:  # the asker has gone
            log.info("nobody took the reply under %s: %s", key, error)


def problem_in(error: zenoh.ReplyError) -> Problem | None:
    """What the responder says; None where Zenoh itself says that time is up: that is no JSON."""
    if not str(error.encoding).startswith(JSON):
        return None
    try:
        return Problem.model_validate_json(error.payload.to_bytes())
    except ValidationError:
        return problem(ProblemType.INTERNAL, "the responder's error is not readable")
