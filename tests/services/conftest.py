"""Run `sdt` as a person does, in this process."""

import json
import logging
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import pytest

from services import cli
from services.telemetry.logs import LOGGERS


@dataclass(frozen=True)
class Done:
    """What a run of `sdt` gave."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:  # JSON is any
        return json.loads(self.out)


@pytest.fixture
def loggers() -> Iterator[None]:
    """Loggers write nowhere before the test, whatever an earlier one left, and as before again after it."""
    ours = [logging.getLogger(name) for name in LOGGERS]
    before = [(each.handlers[:], each.level, each.propagate) for each in ours]
    for each in ours:
        each.handlers.clear()
    yield
    for each, known in zip(ours, before, strict=True):
        each.handlers[:], each.level, each.propagate = known


@pytest.fixture
def sdt(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], loggers: None
) -> Callable[..., Done]:
    """`sdt("containers", "b")` → exit code, standard output, standard error."""

    monkeypatch.setenv("SDT_CONFIG", os.devnull)  # whoever runs the tests may have settings
    for name in ("PYTHONSAFEPATH", "OMP_NUM_THREADS"):
        monkeypatch.setenv(name, "1")  # as `main` sets it; afterwards it is as it was

    def run(*arguments: str) -> Done:
        monkeypatch.setattr(sys, "argv", ["sdt", *arguments])
        code = cli.program()
        captured = capsys.readouterr()
        return Done(code, captured.out, captured.err)

    return run
