"""What became of the cases: kept in a store, and counted."""

import time
from collections import Counter
from typing import Final

from sdt_kg.load import model_name
from services.relative import Relative
from services.store.files import SavedVerdicts
from services.sweep.cell import CellResult, Found
from services.sweep.worker import service_of

OUTCOMES: Final = ("certified", "not_certified", "abstained")


class Kept:
    """New verdicts go into the store, each after the twin and state that it is about.

    Args:
        saved: None: nothing is kept.
    """

    def __init__(self, saved: SavedVerdicts | None) -> None:
        self._saved = saved
        self._twins: set[tuple[str, str, tuple[str, ...], Relative]] = set()

    def add(self, found: Found) -> None:
        """The verdict is kept, if it is one and new."""
        if self._saved is None or not isinstance(found, CellResult) or found.stored:
            return
        cell = found.cell
        about = (cell.kitchen, cell.robot, cell.states, cell.relative)
        if about not in self._twins:
            self._saved.add_twin(service_of(cell).twin)
            self._twins.add(about)
        self._saved.add_record(found.record)


class Summary:
    """What became of the cases, counted.

    Attributes:
        stored: Verdicts that were stored before.
        unjudged: Cases without a verdict, and why.
    """

    def __init__(self) -> None:
        self.stored = 0
        self.unjudged: list[dict[str, str]] = []
        self._began = time.perf_counter()
        self._counts: dict[tuple[str, str, str], Counter[str]] = {}

    def add(self, found: Found) -> None:
        """One more."""
        cell = found.cell
        kitchen, robot = model_name(cell.kitchen), model_name(cell.robot)
        counts = self._counts.setdefault((kitchen, robot, cell.task.partition(":")[0]), Counter())
        if isinstance(found, CellResult):
            counts[str(found.verdict["outcome"])] += 1
            self.stored += found.stored
        else:
            counts["no_verdict"] += 1
            self.unjudged.append(
                {"kitchen": kitchen, "robot": robot, "task": cell.task, "reason": found.reason}
            )

    @property
    def total(self) -> int:
        """Cases."""
        return sum(counts.total() for counts in self._counts.values())

    @property
    def seconds(self) -> float:
        """[s] Since the beginning."""
        return time.perf_counter() - self._began

    def rows(self) -> list[dict[str, object]]:
        """Kitchen, robot, task, and how many of each outcome."""
        return [
            {
                "kitchen": kitchen,
                "robot": robot,
                "task": task,
                **{name: counts[name] for name in (*OUTCOMES, "no_verdict")},
                "cases": counts.total(),
            }
            for (kitchen, robot, task), counts in sorted(self._counts.items())
        ]

    def to_json(self) -> dict[str, object]:
        """The object that `sdt sweep --json` prints."""
        return {
            "counts": self.rows(),
            "cases": self.total,
            "stored_before": self.stored,
            "no_verdict": self.unjudged,
            "seconds": round(self.seconds, 3),
        }
