"""Small workers: they answer, die or fail, as the case's container says."""

import os
import signal
from pathlib import Path

from predicates.record import Record
from services.app import Policy
from services.sweep.cell import Cell, CellResult, Found


def cell(name: str) -> Cell:
    return Cell("b", "pr2", f"open:{name}", (), Policy())


def obedient(asked: Cell) -> Found:
    """Does what the container's name says."""
    word, _, rest = asked.container.partition(" ")
    if word == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if word == "die-once" and not Path(rest).exists():
        Path(rest).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if word == "fail":
        raise RuntimeError(rest)
    return CellResult(asked, {"outcome": "certified", "stored": False}, Record("https://a.example", "", ()))
