"""Verdicts about the small kitchen, made by the Law with a small oracle, to be shown on pages."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from html import unescape
from pathlib import Path

import pytest

from predicates.case import Case
from predicates.law import law
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from services.store.files import SavedVerdicts, opened
from tests.browser import PATIENCE, Browser, installed, started
from tests.services.http.conftest import Serve, Served, serve  # noqa: F401 - a fixture
from tests.small import FOLDER, small_twin
from tests.small.lift import Lift

TOKEN = "a-token-of-decent-length"  # noqa: S105 - of a test
PAGE = {"accept": "text/html,application/xhtml+xml,*/*;q=0.8"}
LEFT_OPEN = ("swing_door", "folding_door")
"""Containers that nobody has asked about for pr2."""


@pytest.fixture(scope="session")
def seed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with verdicts of two robots about opening; some of the first robot are left open."""
    twin = small_twin("a", ("pr2", "stretch"))
    path = tmp_path_factory.mktemp("seed") / "verdicts.nq"
    with SavedVerdicts(str(path)) as saved:
        for robot in twin.robots:
            for verdict in law(Case(twin, robot=robot, task=Task(Verb.OPEN)), Kinematics(), Lift()):
                task = verdict.case.task
                assert isinstance(task, Task)
                if not (robot.endswith("pr2") and str(task.container).endswith(LEFT_OPEN)):
                    saved.add(verdict)
    return path


@pytest.fixture(scope="module")
def served(serve: Serve, seed: Path) -> Iterator[Served]:  # noqa: F811 - the fixture
    """The small kitchen with its verdicts, to be written with a token."""
    with closing(opened(seed)) as archive:
        yield serve(kitchens=("a",), robots=("pr2", "stretch"), archive=archive, token=TOKEN)


@contextmanager
def sdt_serve(*options: str, token: str | None = None) -> Iterator[str]:
    """`sdt serve` in a process of its own, at the address that it says."""
    command = (sys.executable, "-m", "services.cli", "serve", "--http", "127.0.0.1:0", *options)
    environment = {name: value for name, value in os.environ.items() if name != "SDT_TOKEN"}
    environment |= {"SDT_TOKEN": token} if token else {}
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)
    assert process.stderr is not None
    try:
        said = process.stderr.readline()
        found = re.match(r"http://127\.0\.0\.1:\d+", said)
        assert found, said
        yield found[0]
    finally:
        process.send_signal(signal.SIGINT)
        rest = process.communicate(timeout=PATIENCE)[1]
        assert "Traceback" not in rest, rest


@pytest.fixture(scope="module")
def address(seed: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The same as a process, for a browser; a copy, since it writes."""
    copy = tmp_path_factory.mktemp("served") / "verdicts.nq"
    copy.write_bytes(seed.read_bytes())
    models = [f"{FOLDER / name}.urdf" for name in ("a", "pr2", "stretch")]
    options = ("--kitchen", models[0], "--robot", models[1], "--robot", models[2], "--store", str(copy))
    with sdt_serve(*options) as where:
        yield where


def verdict_link(served, **wanted: object) -> str:
    rows = served.get("/verdicts.json").json()["verdicts"]
    return next(row["link"] for row in rows if wanted.items() <= row.items())


def text_of(page: str) -> str:
    return unescape(re.sub(r"<[^>]*>", "", page)).replace("\u200b", "")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One browser for a whole file."""
    if not installed():
        pytest.skip("no chromium and chromedriver on the PATH: apt-get install chromium chromium-driver")
    with started() as one:
        yield one
