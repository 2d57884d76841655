"""Answering a Zenoh query: once, and so that the asker knows that this was all."""

import logging

import zenoh

from services.judging.codec import JSON
from services.judging.jobs import Done
from services.judging.problems import Problem

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
