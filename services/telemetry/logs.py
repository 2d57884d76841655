"""Logs on standard error, as lines for people or as JSON objects, with the id of the request."""

import json
import logging
import time
from enum import Enum
from typing import Final

from services.telemetry.origin import current

LOGGERS: Final = ("sdt", "services")


class Form(Enum):
    """How a line looks."""

    TEXT = "text"
    JSON = "json"


def configure(form: Form) -> None:
    """This project's loggers write to standard error in that form: warnings, and as JSON every request."""
    handler = logging.StreamHandler()
    handler.setFormatter(_Json() if form is Form.JSON else logging.Formatter("%(levelname)s %(message)s"))
    for name in LOGGERS:
        logger = logging.getLogger(name)
        logger.handlers[:] = [handler]
        logger.setLevel(logging.INFO if form is Form.JSON else logging.WARNING)
        logger.propagate = False


def is_json() -> bool:
    """Whether lines are JSON: a process that is started then is told so too."""
    return any(isinstance(each.formatter, _Json) for each in logging.getLogger(LOGGERS[0]).handlers)


class _Json(logging.Formatter):
    """One object a line."""

    def format(self, record: logging.LogRecord) -> str:
        """The record's own fields, the request that it is about, and whatever was given as `fields`."""
        seconds = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created))
        said: dict[str, object] = {
            "time": f"{seconds}.{record.msecs:03.0f}Z",
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            "process": record.process,
        }
        request = current().request
        if request:
            said["request"] = request
        said |= getattr(record, "fields", {})
        if record.exc_info:
            said["exception"] = self.formatException(record.exc_info)
        return json.dumps(said, ensure_ascii=False)
