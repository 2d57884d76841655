"""The table tells what cannot be loaded before anything is judged."""

import json
import multiprocessing as mp
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import kitchens
from predicates.case import Verdict
from sdt_kg.annotation import Drive
from sdt_kg.errors import AnnotationError, OracleUnavailableError
from sdt_kg.load import model_name
from services.app import Policy
from services.commands.exits import Exit
from services.sweep.cell import Cell
from services.sweep.worker import prepare, prepare_robot, verdict_of
from services.table import CellResult, cells, run
from tests.services.conftest import Done
from tests.small import FOLDER

LINKS = '<link name="base"/><link name="arm"/>'
PROJECT = Path(__file__).resolve().parents[2]
ALONE = ("iai_fridge_door", "oven_area_oven_door", "sink_area_left_middle_drawer_main")
JOINT = '<joint name="j" type="fixed"><parent link="base"/><child link="arm"/></joint>'


@pytest.fixture
def stranger(tmp_path: Path) -> str:
    """A robot without annotation, which no bundled one fits."""
    path = tmp_path / "stranger.urdf"
    path.write_text(f'<robot name="s">{LINKS}{JOINT}</robot>', encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_robot_without_annotation_stops_the_table_before_its_first_verdict(
    stranger: str, jobs: int
) -> None:
    cases = cells(["b"], ["pr2", stranger], "open", (), Policy(Drive.OMNI))
    judged: list[CellResult] = []
    with pytest.raises(AnnotationError, match="robot 'stranger' has no annotation"):
        run(cases, jobs, judged.append)
    assert judged == []


def test_the_shell_says_so_as_it_does_about_any_bad_input(sdt, stranger: str) -> None:
    done = sdt("table", "--kitchens", "b", "--robots", f"pr2,{stranger}", "--jobs", "2")
    assert (done.code, done.out) == (Exit.BAD_INPUT, "")
    assert done.err.startswith("error: robot 'stranger' has no annotation")
    assert "sdt robot describe" in done.err
    assert "worker" not in done.err
    assert "Cell(" not in done.err


def test_a_kitchen_that_cannot_be_read_stops_it_too(sdt, tmp_path: Path) -> None:
    path = tmp_path / "kitchen.urdf"
    path.write_text("<robot", encoding="utf-8")
    done = sdt("table", "--kitchens", f"b,{path}", "--robots", "pr2", "--jobs", "2")
    assert (done.code, done.out) == (Exit.BAD_INPUT, "")
    assert "kitchen.urdf: is not XML" in done.err


def test_each_container_is_closed_from_where_it_alone_is_open(sdt, tmp_path: Path) -> None:
    """Three of them; `make soak` asks the table about all."""
    store = str(tmp_path / "kept")
    asked = "--kitchens", "b", "--robots", "stretch", "--drive", "omni", "--start", "asked=open"
    tasks = [word for each in ALONE for word in ("--task", f"close:{each}")]
    swept = sdt("sweep", *asked, *tasks, "--jobs", "1", "--save", store)
    assert swept.code == Exit.DONE, swept.err
    found = "SELECT ?c { ?v law:outcome law:Certified ; law:container ?c }"
    rows = sdt("query", store, found, "--json").json
    assert {each["c"].rpartition("/")[2] for each in rows} == set(ALONE)
    check_holds(sdt, store, len(ALONE))


def check_holds(sdt: Callable[..., Done], store: str, verdicts: int) -> None:
    """So many verdicts are stored, and each holds when it is checked again."""
    rechecked = sdt("recheck", store, "--json")
    assert rechecked.code == 0
    assert [each["holds"] for each in json.loads(rechecked.out)] == [True] * verdicts


def test_a_state_of_what_is_asked_about_needs_something_asked_about(sdt) -> None:
    done = sdt("achieve", "--kitchen", "b", "--robot", "stretch", "--task", "close", "--state", "asked=open")
    assert done.code == Exit.BAD_INPUT
    assert "no container is asked about" in done.err


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_what_a_worker_finds_wrong_with_a_model_comes_out_in_its_own_words(
    sdt, tmp_path: Path, jobs: str
) -> None:
    bundled = kitchens.path("b")
    text = (bundled / "b.urdf").read_text(encoding="utf-8")
    broken = re.sub(r"<box size=[^>]*/>", '<mesh filename="broken.stl"/>', text, count=1)
    (tmp_path / "b.urdf").write_text(broken, encoding="utf-8")
    shutil.copy(bundled / "b.ttl", tmp_path)
    (tmp_path / "broken.stl").write_text("no triangles", encoding="utf-8")
    done = sdt("table", "--kitchens", str(tmp_path / "b.urdf"), "--robots", "pr2", "--jobs", jobs)
    assert (done.code, done.out) == (Exit.BAD_INPUT, "")
    assert done.err.startswith(
        f"error: mesh {tmp_path / 'broken.stl'} cannot be read: Could not load resource"
    )
    assert len(done.err.splitlines()) == 1


KILLER = "high_drawer"
"""The container whose case takes its process with it."""


@pytest.fixture
def deadly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers, which begin as copies of this process, die at one container; for others little is searched."""

    def dies(cell: Cell) -> Verdict:
        if cell.container == KILLER:
            assert mp.parent_process() is not None, "only a worker may die"
            os.kill(os.getpid(), signal.SIGKILL)
        return verdict_of(replace(cell, policy=replace(cell.policy, budget=0.0)))

    monkeypatch.setattr("services.table.verdict_of", dies)


SMALL = ("table", "--kitchens", str(FOLDER / "a.urdf"), "--robots", str(FOLDER / "pr2.urdf"), "--jobs", "2")


@pytest.mark.usefixtures("deadly")
def test_a_case_that_kills_its_process_twice_is_the_only_one_without_a_verdict(sdt) -> None:
    done = sdt(*SMALL, "--json")
    assert done.code == Exit.NO_ORACLE
    told = json.loads(done.out)
    assert len(told["verdicts"]) == 4
    (lost,) = told["no_verdict"]
    assert (lost["task"], lost["reason"]) == ("open:high_drawer", "the process that judged it died twice")
    assert told["cells"]["a"]["pr2"][1] == 5


@pytest.mark.usefixtures("deadly")
@pytest.mark.parametrize(("csv", "at"), [((), "out"), (("--csv", "-"), "err")])
def test_people_are_told_which_case_has_no_verdict(sdt, csv: tuple[str, ...], at: str) -> None:
    done = sdt(*SMALL, *csv)
    assert done.code == Exit.NO_ORACLE
    (said,) = [line for line in getattr(done, at).splitlines() if "died twice" in line]
    assert "open:high_drawer" in said


@pytest.mark.usefixtures("deadly")
def test_who_needs_every_verdict_is_told_that_one_is_missing() -> None:
    cases = cells([str(FOLDER / "a.urdf")], [str(FOLDER / "pr2.urdf")], "open", (), Policy())
    with pytest.raises(OracleUnavailableError, match=r"open:high_drawer.*died twice"):
        run(cases, 2, lambda result: None)


def test_the_first_worker_begins_once_robots_are_loaded_and_loads_the_kitchen_of_fewest_cases(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    loaded: list[tuple[str, str]] = []

    def prepared(case: Cell) -> None:
        loaded.append((case.kitchen, case.robot))
        prepare(case)

    def prepared_robot(case: Cell) -> None:
        loaded.append(("", case.robot))
        prepare_robot(case)

    def begun(case: Cell) -> Verdict:
        (tmp_path / f"{time.monotonic_ns()} {model_name(case.kitchen)}").touch()
        return verdict_of(case)

    monkeypatch.setattr("services.table.prepare", prepared)
    monkeypatch.setattr("services.table.prepare_robot", prepared_robot)
    monkeypatch.setattr("services.table.verdict_of", begun)
    small = [str(FOLDER / f"{name}.urdf") for name in ("a", "b")]
    robot = str(FOLDER / "pr2.urdf")
    cases = cells(small, [robot], "open", (), Policy(budget=0.01))
    counts = Counter(case.kitchen for case in cases)
    assert len(run(cases, 2, lambda result: None).results) == len(cases)
    few, many = sorted(small, key=counts.__getitem__)
    assert loaded == [("", robot), (many, robot)], "in the process that begins the others"
    assert min(each.name for each in tmp_path.iterdir()).endswith(f" {model_name(few)}")


def test_what_judges_is_loaded_without_the_parts_of_scipy_which_take_long() -> None:
    code = "import sys, services.table, services.embodiment.oracle; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=PROJECT, capture_output=True, text=True, check=True
    )
    loaded = done.stdout.split()
    assert "services.embodiment.oracle" in loaded
    assert not {"scipy.linalg", "scipy.sparse", "scipy.spatial", "scipy.optimize"} & set(loaded)
