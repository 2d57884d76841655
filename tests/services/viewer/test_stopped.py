"""`sdt view` is stopped as `sdt serve` is, and leaves no file of those who look."""

import re
import signal
import subprocess
from pathlib import Path

import pytest

from services.commands.exits import Exit
from tests.services.http.test_end_to_end import SERVE_SMALL
from tests.services.http.test_interrupted import heard
from tests.services.viewer.visitor import Visitor

VIEW = ["view" if word == "serve" else word for word in SERVE_SMALL]


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (signal.SIGINT, Exit.INTERRUPTED),
        (signal.SIGTERM, Exit.TERMINATED),
        (signal.SIGHUP, Exit.TERMINATED),
    ],
)
def test_a_page_that_is_stopped_says_so_and_leaves_no_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals, code: Exit
) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    with subprocess.Popen(VIEW, stderr=subprocess.PIPE, text=True, preexec_fn=heard) as process:  # noqa: PLW1509
        try:
            assert process.stderr is not None
            address = process.stderr.readline()
            port = re.search(r":(\d+)/", address)
            assert port, address
            with Visitor(int(port[1])) as visitor:
                visitor.waits_for("Ready.")
                assert list(tmp_path.glob("sdt-view-*"))
                process.send_signal(number)
                said = process.communicate(timeout=60)[1]
        finally:
            process.kill()
    assert (process.returncode, said.splitlines()[-1]) == (code, code.name.lower())
    assert not list(tmp_path.glob("sdt-view-*"))
