"""The page of the bus is true: its commands answer, and its Python runs, with our library and without."""

import re
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import services.bus
from services.bus.sessions import DEFAULT_ENDPOINT
from tests.ports import free_endpoint

pytestmark = pytest.mark.oracle

PAGE = (Path(services.bus.__file__).parent / "README.md").read_text()
SDT = (sys.executable, "-m", "services.cli")
SERVE = next(line for line in PAGE.splitlines() if line.startswith("sdt serve "))
ASKED = [re.split(r"\s{3,}", line)[0] for line in PAGE.splitlines() if line.startswith("sdt ask ")]
TOLD = {
    "satisfies": "close",
    "select": "door",
    "achieve": "certified",
    "whatif": "pr2",
    "place": "margin",
}
"""Verb → what its answer has."""
CODE = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the commands are typed: one reads what another wrote."""
    return tmp_path_factory.mktemp("page")


@pytest.fixture(scope="module")
def endpoint() -> Iterator[str]:
    """Where the command of the page listens: at a free port in place of the usual one."""
    where = free_endpoint()
    words = shlex.split(SERVE.removesuffix("&").replace(DEFAULT_ENDPOINT, where))[1:]
    process = subprocess.Popen([*SDT, *words, "--http", "127.0.0.1:0"], stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    while "bus at" not in (line := process.stderr.readline()):
        assert line, "it ended"
    yield where
    process.send_signal(signal.SIGINT)
    assert "Traceback" not in process.communicate(timeout=60)[1]


def test_the_page_has_commands_and_python() -> None:
    assert (len(ASKED), len(CODE)) == (9, 2)


@pytest.mark.parametrize("line", ASKED)
def test_each_command_answers(endpoint: str, folder: Path, line: str) -> None:
    late = () if "--deadline" in line else ("--deadline", "120")
    words = [*SDT, *shlex.split(line)[1:], "--connect", endpoint, *late]
    done = subprocess.run(words, capture_output=True, text=True, timeout=180, check=False, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert TOLD[words[5]] in done.stdout.lower()


@pytest.mark.parametrize("code", CODE)
def test_its_python_runs(endpoint: str, code: str) -> None:
    written = code.replace(DEFAULT_ENDPOINT, endpoint)
    done = subprocess.run(
        [sys.executable, "-c", written], capture_output=True, text=True, timeout=180, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "certified" in done.stdout or "iai_fridge_door" in done.stdout
