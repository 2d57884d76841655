"""What is stored is not judged again, also after kill −9."""

import json
import subprocess
import sys
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner

from sdt_kg.errors import AnnotationError
from services.cli import sdt

PROJECT = Path(__file__).resolve().parents[3]
PATIENCE = 60.0
"""[s] For processes to end, on a busy machine."""


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of a sweep of 17 cases that was killed when five were kept."""
    store = tmp_path_factory.mktemp("sweep") / "store"
    command = [sys.executable, "-m", "tests.services.sweep.killed", str(store)]
    with subprocess.Popen(
        command, cwd=PROJECT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as sweep:
        assert sweep.stdin is not None
        assert sweep.stdout is not None
        workers = sweep.stdout.readline().split()[1:]
        for _ in range(4):
            sweep.stdin.write("\n")
            sweep.stdin.flush()
            sweep.stdout.readline()
        sweep.kill()
        sweep.stdin.close()
    until = time.monotonic() + PATIENCE
    while any(Path("/proc", pid).exists() for pid in workers) and time.monotonic() < until:
        time.sleep(0.05)
    assert len(workers) == 2
    assert not [pid for pid in workers if Path("/proc", pid).exists()], "workers end with their parent"
    return store


def swept(store: Path, *options: str) -> dict[str, object]:
    """What `sdt sweep --json` says, in this process."""
    arguments = ["sweep", "--kitchens", "b", "--robots", "pr2", "--task", "close", "--save", str(store)]
    said = CliRunner().invoke(sdt, [*arguments, "--jobs", "1", "--json", *options], catch_exceptions=False)
    assert said.exit_code == 0, said.output
    return json.loads(said.stdout)


@pytest.mark.oracle
def test_a_killed_sweep_goes_on_where_it_was(killed: Path, tmp_path: Path) -> None:
    assert swept(killed, "--plan") == {"cases": 17, "stored": 5}
    first = swept(killed, "--parquet", str(tmp_path / "first.parquet"))
    assert (first["cases"], first["stored_before"], first["no_verdict"]) == (17, 5, [])
    again = swept(killed, "--parquet", str(tmp_path / "again.parquet"))
    assert again["stored_before"] == 17
    one, other = (pq.read_table(tmp_path / f"{name}.parquet") for name in ("first", "again"))
    assert sorted(one.column("iri").to_pylist()) == sorted(other.column("iri").to_pylist())
    assert set(other.column("outcome").to_pylist()) == {"not_certified"}
    assert {each.name for each in tmp_path.iterdir()} == {"first.parquet", "again.parquet"}


@pytest.mark.oracle
def test_a_query_of_what_is_saved_chooses_what_is_judged_next(killed: Path) -> None:
    of = "law:environment ?kitchen ; law:robot ?robot ; law:container ?container"
    sparql = f"SELECT ?kitchen ?robot ?container {{ ?verdict {of} ; law:outcome law:NotCertified }}"
    said = CliRunner().invoke(sdt, ["sweep", "--query", sparql, "--of", str(killed), "--plan", "--json"])
    assert json.loads(said.stdout)["cases"] >= 5


def test_a_file_that_is_written_at_the_end_is_no_place_to_resume_from() -> None:
    said = CliRunner().invoke(sdt, ["sweep", "--kitchens", "b", "--save", "verdicts.trig"])
    assert "would lose what is in verdicts.trig" in str(said.exception)


def test_a_robot_that_cannot_be_loaded_is_told_before_anything_is_judged(tmp_path: Path) -> None:
    (tmp_path / "bare.urdf").write_text('<robot name="bare"><link name="base"/></robot>')
    robots = f"pr2,{tmp_path / 'bare.urdf'}"
    said = CliRunner().invoke(sdt, ["sweep", "--kitchens", "b", "--robots", robots, "--jobs", "2"])
    assert isinstance(said.exception, AnnotationError)
    assert "robot 'bare' has no annotation" in str(said.exception)
