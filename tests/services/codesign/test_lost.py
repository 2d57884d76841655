"""A case that takes its process with it is the only one of a grid without a verdict."""

import multiprocessing as mp
import os
import signal
from functools import partial
from pathlib import Path

from predicates.case import Outcome
from services.app import Policy
from services.codesign.asked import Asked
from services.codesign.entries import Entry, Found, Grid, How
from services.codesign.grid import Job, results, run
from services.codesign.report import counts, entry_rows, reused, turned_rows
from tests.small import FOLDER

KITCHEN, ROBOT = str(FOLDER / "a.urdf"), str(FOLDER / "pr2.urdf")
ASKED = Asked((KITCHEN,), (ROBOT,), "open", (("drive:omni",),), Policy(budget=0.1))
CONTAINERS = ("door", "drawer", "last")
CERTIFIED = Found("", Outcome.CERTIFIED, How.LAW, {})


def killed_by(container: str, died: Path | None, job: Job) -> list[Entry]:
    """Dies at a container: each time, or once where there is a file to remember it by."""
    if container in job.containers and not (died and died.exists()):
        if died:
            died.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return [Entry(job.kitchen, job.robot, each, job.edits, CERTIFIED) for each in job.containers]


def judged(container: str, died: Path | None = None) -> dict[str, Found]:
    """What came of two jobs of three containers each, the second in another world."""
    jobs = [Job(KITCHEN, ROBOT, CONTAINERS, edits) for edits in ((), *ASKED.worlds)]
    found = results(ASKED, partial(killed_by, container, died), jobs, 2, lambda entry: None)
    return {f"{each.container} {'; '.join(each.edits)}".strip(): each.found for each in found}


def test_a_process_that_is_killed_once_costs_no_case(tmp_path: Path) -> None:
    found = judged("drawer", tmp_path / "died")
    assert len(found) == 6
    assert all(each.is_certified for each in found.values())


def test_only_the_container_that_kills_twice_has_no_verdict() -> None:
    found = judged("drawer")
    lost = {name for name, each in found.items() if each.how is How.LOST}
    assert lost == {"drawer", "drawer drive:omni"}
    assert [each["reason"] for each in found["drawer"].diagnoses] == ["the process that judged it died twice"]
    assert sum(each.is_certified for each in found.values()) == 4


def test_a_case_without_a_verdict_turns_nothing_and_is_called_neither_refused_nor_impossible() -> None:
    entries = [
        Entry(KITCHEN, ROBOT, name, edits, each)
        for edits in ((), *ASKED.worlds)
        for name, each in (("door", CERTIFIED), ("drawer", judged("drawer")["drawer"]))
    ]
    grid = Grid(entries)
    assert turned_rows(grid) == []
    assert [each["outcome"] for each in entry_rows(grid)] == ["certified", "no verdict"] * 2
    assert reused(grid)["how"] == {"asked anew": 1, "no verdict: nothing came of it": 1}
    assert [list(each.values())[1:] for each in counts(grid)] == [["1 / 1, 1 without a verdict"]] * 2
    assert [list(each.values())[1:] for each in counts(Grid(entries[1::2]))] == [["no verdict"]] * 2


def test_a_grid_goes_on_when_a_worker_is_killed_from_outside() -> None:
    killed: list[mp.process.BaseProcess] = []

    def report(entry: Entry) -> None:
        del entry
        if not killed:
            killed.append(mp.active_children()[0])
            killed[0].kill()

    grid = run(ASKED, 2, report)
    assert killed
    assert all(each.found.outcome is not None for each in grid.entries)
    assert len(grid.entries) == 2 * len({each.container for each in grid.entries})
