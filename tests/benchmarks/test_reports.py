"""How long a report of kitchen A with three robots takes from stored verdicts, and how large it is."""

import os
from pathlib import Path

from click.testing import CliRunner

from services.commands.law.table import table
from services.reports.command import report


def cpu_time() -> float:
    """Of this process and of those that ended, the notebook's kernel [s]."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def test_report_of_kitchen_a_with_three_robots_from_stored_verdicts(benchmark, tmp_path: Path) -> None:
    store, path = str(tmp_path / "store.trig"), tmp_path / "report.html"
    judged = ["--kitchens", "a", "--drive", "omni", "--jobs", "2", "--save", store]
    assert CliRunner().invoke(table, judged, catch_exceptions=False).exit_code == 0
    words = ["feasibility", "--store", store, "-o", str(path)]

    def built() -> None:
        assert CliRunner().invoke(report, words, catch_exceptions=False).exit_code == 0

    before = cpu_time()
    benchmark.pedantic(built, rounds=1)
    benchmark.extra_info["CPU [s]"] = round(cpu_time() - before, 2)
    benchmark.extra_info["megabytes"] = round(path.stat().st_size / 1e6, 2)
