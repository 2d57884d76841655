"""One report, as `sdt report` writes it."""

import re
from dataclasses import dataclass
from pathlib import Path

import pytest
from click.testing import CliRunner

from services.reports.command import report

DRAWER = "sink_area_left_middle_drawer_main"
PARAMETERS = ("kitchen=b", "robots=stretch", f"task=open:{DRAWER}", "drive=omni", "budget=30", "jobs=1")


@dataclass(frozen=True)
class Written:
    """The report `feasibility` about one drawer and one robot."""

    html: Path
    assets: Path
    store: Path

    @property
    def text(self) -> str:
        return self.html.read_text()

    def words(self) -> str:
        """What a reader reads, without code and data."""
        body = re.sub(r"<(script|style)\b.*?</\1>", " ", self.text, flags=re.DOTALL)
        return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", body.replace("<wbr>", "")))


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    folder = tmp_path_factory.mktemp("report")
    found = Written(folder / "report.html", folder / "assets", folder / "store.nq")
    options = [f"-p{each}" for each in PARAMETERS]
    paths = ["-o", str(found.html), "--assets", str(found.assets), "--store", str(found.store)]
    result = CliRunner().invoke(report, ["feasibility", *options, *paths], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return found
