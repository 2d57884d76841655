"""Every report at its full size, as `sdt report` makes it, opened in a browser."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from services.reports.command import report
from services.reports.run.catalogue import notebooks
from tests.browser import Browser

MOST = 10e6
"""[bytes] Of a report."""
READY = "return [...document.querySelectorAll('.sdt-view')].every((each) => each.sdtView)"


@pytest.mark.parametrize("name", [each.name for each in notebooks()])
def test_a_report_with_its_defaults_opens_alone(name: str, tmp_path: Path, browser: Browser) -> None:
    path = tmp_path / f"{name}.html"
    words = [name, "-o", str(path), "--assets", str(tmp_path / "assets")]
    result = CliRunner().invoke(report, words, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    assert path.stat().st_size < MOST
    assert {each.suffix for each in (tmp_path / "assets").iterdir()} == {".svg", ".pdf", ".csv", ".tex"}
    browser.driver.get(path.as_uri())
    browser.until(lambda: browser.driver.execute_script(READY), "the scenes")
    assert browser.console_errors() == []
    assert browser.foreign_requests() == []


def test_a_report_from_a_store_judges_nothing_again(tmp_path: Path) -> None:
    store = str(tmp_path / "store.nq")
    words = ["feasibility", "-pkitchen=b", "-pjobs=2", "--store", store]
    sizes = []
    for name in ("first", "second"):
        result = CliRunner().invoke(
            report, [*words, "-o", str(tmp_path / name) + ".html"], catch_exceptions=False
        )
        assert result.exit_code == 0, result.output
        sizes.append(Path(store).stat().st_size)
    assert sizes[0] == sizes[1]
