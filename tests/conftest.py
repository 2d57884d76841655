"""Fixtures for all tests."""

import os
from dataclasses import dataclass
from pathlib import Path

import pytest

from sdt_kg.annotation import Drive
from services.app import Policy
from services.table import TableResult, cells, run

PROJECT = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def reference() -> Path:
    """Folder of the reference data; the test is skipped, visibly, where it is absent."""
    folder = Path(os.environ.get("SDT_REFERENCE", PROJECT.parent / "shared" / "reference"))
    if not folder.is_dir():
        pytest.skip(f"no reference data at {folder}: set SDT_REFERENCE")
    return folder


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
