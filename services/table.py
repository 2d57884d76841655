"""Many cases at once: every container of some kitchens for some robots, in worker processes."""

import time
from collections import Counter
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from predicates.case import Outcome, Verdict
from predicates.record import to_json, to_record
from predicates.record.recall import Recall, nothing_stored
from sdt_kg.display import grid as html_grid
from sdt_kg.errors import OracleUnavailableError
from sdt_kg.load import model_name
from sdt_kg.motion import BodyMotion
from services.app import Policy
from services.relative import KINEMATIC, Relative
from services.sweep.cell import Cell, CellResult, Found, Unjudged
from services.sweep.executors.engines import Loading, cpu_seconds
from services.sweep.executors.handed import each_or_lost
from services.sweep.executors.piece import Lost
from services.sweep.plan import Axes, grid
from services.sweep.worker import (
    SERVICES_KEPT,
    dear_first,
    prepare,
    prepare_robot,
    remember_looks,
    service_of,
    stored_verdict,
    verdict_of,
)

Keep = Callable[[Cell, Verdict], CellResult]


@dataclass(slots=True)
class TableResult:
    """All verdicts of a table.

    Attributes:
        unjudged: Cases without a verdict, and why.
        seconds: Wall time [s].
        cpu_seconds: CPU time of this process and its workers [s].
    """

    results: list[CellResult] = field(default_factory=list[CellResult])
    unjudged: list[Unjudged] = field(default_factory=list[Unjudged])
    seconds: float = 0.0
    cpu_seconds: float = 0.0

    def cells(self) -> dict[str, dict[str, list[int]]]:
        """Kitchen → robot → [certified, total]; a case without a verdict is not certified."""
        counts: dict[str, dict[str, list[int]]] = {}
        for found in (*self.results, *self.unjudged):
            row = counts.setdefault(model_name(found.cell.kitchen), {})
            count = row.setdefault(model_name(found.cell.robot), [0, 0])
            count[0] += isinstance(found, CellResult) and found.verdict["outcome"] == "certified"
            count[1] += 1
        return counts

    def without_verdict(self) -> list[dict[str, str]]:
        """Kitchen, robot, task and reason of each case that has no verdict."""
        return [
            {
                "kitchen": model_name(lost.cell.kitchen),
                "robot": model_name(lost.cell.robot),
                "task": lost.cell.task,
                "reason": lost.reason,
            }
            for lost in self.unjudged
        ]

    def _repr_html_(self) -> str:
        """Certified of all, and how many have no verdict, kitchen by robot, for Jupyter."""
        counts = self.cells()
        lost = Counter((each["kitchen"], each["robot"]) for each in self.without_verdict())

        def told(kitchen: str, robot: str) -> str:
            without = lost[kitchen, robot]
            certified, total = counts[kitchen].get(robot, (0, 0))
            return (
                f"{certified} / {total}{f', {without} without a verdict' if without else ''}" if total else ""
            )

        robots = list(dict.fromkeys(robot for row in counts.values() for robot in row))
        rows = [(kitchen, *(told(kitchen, robot) for robot in robots)) for kitchen in counts]
        return html_grid(("kitchen", *robots), rows)

    def to_json(self) -> dict[str, object]:
        """The object that `sdt table --json` prints."""
        return {
            "cells": self.cells(),
            "verdicts": [result.verdict for result in self.results],
            "no_verdict": self.without_verdict(),
            "seconds": round(self.seconds, 3),
            "cpu_seconds": round(self.cpu_seconds, 3),
        }


def cells(  # noqa: PLR0913 - the parts of a case
    kitchens: Sequence[str],
    robots: Sequence[str],
    verb: str,
    states: Sequence[str],
    policy: Policy,
    *,
    relative: Relative = KINEMATIC,
) -> list[Cell]:
    """Every container of every kitchen with every robot, kitchen by kitchen.

    A state text that names a joint applies to those kitchens which have it.

    Raises:
        InputError: Two models share a name, or a state names a joint which no kitchen has.
    """
    axes = Axes((verb,), (tuple(states),), (policy,), (relative,))
    return list(grid(kitchens, robots, axes).cells)


def ends(lost: Unjudged) -> None:
    """A case without a verdict ends the table.

    Raises:
        OracleUnavailableError: Always.
    """
    raise OracleUnavailableError(f"{lost.cell}: {lost.reason}")


def run(  # noqa: PLR0913, PLR0917  # who is told of what; the rest has defaults
    cases: Sequence[Cell],
    jobs: int,
    report: Callable[[CellResult], None],
    motions: Path | None = None,
    recall: Recall = nothing_stored,
    lost: Callable[[Unjudged], None] = ends,
    records: bool = True,
) -> TableResult:
    """Verdicts of all cases, in the order of the cases; each is reported as soon as it is there.

    Models are read first, and once: workers begin as copies of this process. An interrupt stops the
    workers; what was reported until then stays reported.

    Args:
        cases: What `cells` gave.
        jobs: Worker processes; 1 works in this one.
        report: Called with each result.
        motions: Folder for the certified body motions, a file for each.
        recall: What is stored under a verdict's IRI; such cases are not judged again.
        lost: Called with each case that got no verdict from a worker, as its process died twice or failed.
        records: Whether verdicts are made triples too; not where nobody keeps them.

    Raises:
        InputError: A model cannot be loaded.
        OracleUnavailableError: What `lost` raises; and of one job, what the case does.
    """
    began, cpu_began = time.perf_counter(), cpu_seconds()
    done: dict[Cell, Found] = {}
    if motions is not None:
        motions.mkdir(parents=True, exist_ok=True)
    keep = partial(_kept, motions=motions, records=records)
    if recall is not nothing_stored:
        for result in filter(None, (_stored(case, recall, keep) for case in cases)):
            done[result.cell] = result
            report(result)
    missing = [case for case in cases if case not in done]
    firsts = list({case.loaded: case for case in reversed(missing)}.values())
    for case in firsts:
        service_of(case)  # what cannot be loaded is told before anything is judged
    begun = missing if jobs == 1 else _small_first(dear_first(missing))
    judge, prepared = partial(_judge, keep=keep), _loading(firsts)
    # One by one, however alike: an interrupt loses nothing but what the workers are at.
    for case, result in each_or_lost(begun, jobs, judge, prepared, _container, most=1):
        if isinstance(result, Lost):
            done[case] = without = Unjudged(case, result.reason)
            lost(without)
        else:
            done[case] = result
            report(result)
    ordered = [done[case] for case in cases]
    judged = [each for each in ordered if isinstance(each, CellResult)]
    unjudged = [each for each in ordered if isinstance(each, Unjudged)]
    return TableResult(judged, unjudged, time.perf_counter() - began, cpu_seconds() - cpu_began)


def _container(cell: Cell) -> Hashable:
    """What the container is asked for every robot is found out by one worker."""
    return cell.kitchen, cell.states, cell.container


def _kitchen(cell: Cell) -> Hashable:
    """What is loaded once for all workers; they begin with a kitchen each, as far as there are some."""
    return cell.kitchen


def _small_first(cells: Sequence[Cell]) -> list[Cell]:
    """Kitchens with few cases first: the smallest is loaded soonest, and worked on while others are."""
    count = Counter(cell.kitchen for cell in cells)
    return sorted(cells, key=lambda cell: count[cell.kitchen])


def _loading(firsts: Sequence[Cell]) -> Loading[Cell]:
    """Kitchens one by one, and robots with all that is compiled before."""
    robots = list({case.robot: case for case in firsts}.values())[:SERVICES_KEPT]
    return Loading(partial(_prepare, firsts), _kitchen, partial(_prepare_robots, robots))


def _prepare_robots(robots: Sequence[Cell]) -> None:
    for case in robots:
        prepare_robot(case)
    remember_looks()


def _prepare(firsts: Sequence[Cell], asked: Cell) -> None:
    """What workers keep of what they load of a kitchen is loaded."""
    for case in [each for each in firsts if each.kitchen == asked.kitchen][:SERVICES_KEPT]:
        prepare(case)


def _stored(cell: Cell, recall: Recall, keep: Keep) -> CellResult | None:
    verdict = stored_verdict(cell, recall)
    return None if verdict is None else keep(cell, verdict)


def _judge(cell: Cell, keep: Keep) -> CellResult:
    return keep(cell, verdict_of(cell))


def _kept(cell: Cell, verdict: Verdict, motions: Path | None, records: bool) -> CellResult:
    """The result, its certified body motion written to the folder."""
    body_motion = verdict.case.body_motion
    if motions is not None and verdict.outcome is Outcome.CERTIFIED and isinstance(body_motion, BodyMotion):
        from services.motions import write_motion  # noqa: PLC0415 - slow to import; kitchens are read meanwhile

        write_motion(motions / cell.file_name, body_motion)
    return CellResult(cell, to_json(verdict), to_record(verdict) if records else None)
