"""Ctrl-C in the first seconds of a service, which reaches all its processes."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from services.commands.exits import Exit
from tests.services.http.test_end_to_end import SERVE_SMALL


def heard() -> None:
    """Interrupts are, also where a shell runs the tests in its background, or by nohup, and ignores them."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


@pytest.mark.parametrize("after", [1.0, 2.0, 3.0])
def test_a_service_that_is_interrupted_while_it_begins_ends_as_later(tmp_path: Path, after: float) -> None:
    # Libraries are imported, processes begin, the page's are there already: as fast as the machine is.
    command = [*SERVE_SMALL, "--view", "127.0.0.1:0", "--store", str(tmp_path / "kept.nq")]
    process = subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heard,  # noqa: PLW1509 - one call of the system, between fork and exec
    )
    time.sleep(after)
    os.killpg(process.pid, signal.SIGINT)
    try:
        said = process.communicate(timeout=60)[1]
    finally:
        process.kill()
    assert (process.returncode, said.splitlines()[-1]) == (Exit.INTERRUPTED, "interrupted")
    assert "Traceback" not in said
