"""What lies in the folder where `sdt` is run is never imported: neither by it nor by its processes."""

import re
import signal
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from services.commands.exits import Exit

SDT = Path(sys.executable).with_name("sdt")
MODULES = ("services", "numpy", "select", "mcp", "pyoxigraph", "sdt_kg")
TRAP = "raise SystemExit('imported from the current folder: ' + __file__)\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with modules of the names of those that are needed."""
    for name in MODULES:
        (tmp_path / f"{name}.py").write_text(TRAP)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    return tmp_path


@pytest.mark.usefixtures("folder")
def test_a_service_asks_its_own_processes() -> None:
    command = (SDT, "serve", "--http", "127.0.0.1:0", "--kitchen", "b")
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        found = re.match(r"http://127\.0\.0\.1:\d+", process.stderr.readline())
        try:
            assert found
            with httpx.Client(base_url=found[0], timeout=180) as client:
                rows = client.get("/sparql", params={"query": "ASK { ?door a sdt:Door }"})
                causes = client.post("/api/v1/causes", json={"task": "open:iai_fridge_door"})
        finally:
            process.send_signal(signal.SIGINT)
            said = process.stderr.read()
    assert "imported" not in said
    assert rows.json()["boolean"] is True
    assert [each["holds"] for each in causes.json()] == [True]


@pytest.mark.usefixtures("folder")
def test_the_doctor_finds_no_fault_with_compiled_modules() -> None:
    done = subprocess.run((SDT, "doctor"), capture_output=True, text=True, check=False)
    assert done.returncode in {Exit.DONE, Exit.NO}
    assert "imported" not in done.stdout + done.stderr
