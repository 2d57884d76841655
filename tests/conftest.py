"""Fixtures for all tests."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import hypothesis
import pytest

from sdt_kg.annotation import Drive
from services.app import Policy
from services.table import TableResult, cells, run
from tests.browser import Browser, installed, started

PROJECT = Path(__file__).resolve().parent.parent

hypothesis.settings.register_profile("untimed", deadline=None)  # no test is about speed
hypothesis.settings.load_profile("untimed")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that share something expensive run in the same process: Table 1, a server, a file's own."""
    for item in items:
        shared = "table1" if "table1" in getattr(item, "fixturenames", ()) else _shared(item.path)
        item.add_marker(pytest.mark.xdist_group(shared))


def _shared(path: Path) -> str:
    """What the tests of a file share: a server or a report for all files of the folder, else the file."""
    return str(path.parent if path.parent.name in {"bus", "mcp_server", "reports"} else path)


@pytest.fixture(scope="session")
def reference() -> Path:
    """Folder of the reference data; the test is skipped, visibly, where it is absent."""
    folder = Path(os.environ.get("SDT_REFERENCE", PROJECT.parent / "shared" / "reference"))
    if not folder.is_dir():
        pytest.skip(f"no reference data at {folder}: set SDT_REFERENCE")
    return folder


@pytest.fixture
def browser() -> Iterator[Browser]:
    """Headless Chromium with an empty profile; the test is skipped, visibly, where it is not installed."""
    if not installed():
        pytest.skip("no chromium and chromedriver on the PATH: apt-get install chromium chromium-driver")
    with started() as one:
        yield one


@dataclass(frozen=True)
class Table1:
    """Table 1 in the paper's set-up, with the certified body motions."""

    result: TableResult
    motions: Path
    policy: Policy


@pytest.fixture(scope="session")
def table1(tmp_path_factory: pytest.TempPathFactory) -> Table1:
    """The whole table, run once."""
    policy = Policy(drive=Drive.OMNI)
    motions = tmp_path_factory.mktemp("motions")
    cases = cells(("a", "b"), ("pr2", "tiago_dual", "stretch"), "open", (), policy)
    return Table1(run(cases, 2, lambda result: None, motions), motions, policy)
