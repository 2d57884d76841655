"""A stream is closed (`>&-`), or leads where there is no room: nothing is heard there, the answer stands."""

import subprocess
import sys

import pytest

from services.commands.exits import Exit

MCP = "mcp --kitchen b --robot pr2"


@pytest.mark.parametrize(
    ("words", "closed", "code", "said"),
    [
        ("containers b", ">&-", Exit.DONE, ""),
        ("containers nowhere", ">&- 2>&-", Exit.BAD_INPUT, ""),
        ("containers nowhere", "<&- >&-", Exit.BAD_INPUT, "error: no kitchen named 'nowhere'"),
        ("containers nowhere", "2>/dev/full", Exit.BAD_INPUT, ""),
        ("containers b --nothing", "2>/dev/full", Exit.BAD_INPUT, ""),
        (MCP, "<&-", Exit.DONE, ""),
    ],
)
def test_a_command_ends_as_it_would(words: str, closed: str, code: Exit, said: str) -> None:
    line = f'exec "$0" -m services.cli {words} {closed}'
    done = subprocess.run(
        ["/bin/sh", "-c", line, sys.executable], capture_output=True, text=True, check=False
    )
    assert done.returncode == code, done.stderr
    assert done.stderr.startswith(said)
    assert "Traceback" not in done.stderr
