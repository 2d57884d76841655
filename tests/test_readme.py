"""What the README shows is true: its Python runs, and its commands exist."""

import re
import shlex
from pathlib import Path

import click
import pytest

from services.cli import sdt

README = (Path(__file__).resolve().parent.parent / "README.md").read_text()
CODE = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
COMMANDS = [line for line in README.splitlines() if line.startswith("sdt ")]


@pytest.mark.oracle
def test_the_python_of_the_readme_runs(capsys: pytest.CaptureFixture[str]) -> None:
    assert len(CODE) == 1
    exec(compile(CODE[0], "README.md", "exec"), {})  # noqa: S102 - our own README
    assert "certified" in capsys.readouterr().out


def test_there_are_commands() -> None:
    assert len(COMMANDS) > 5


@pytest.mark.parametrize("line", COMMANDS)
def test_every_command_of_the_readme_parses(line: str) -> None:
    command: click.Command = sdt
    words = shlex.split(re.split(r"\s{3,}", line)[0])[1:]
    while isinstance(command, click.Group):
        command = command.commands[words.pop(0)]
    known = {option for parameter in command.params for option in parameter.opts}
    assert [word for word in words if word.startswith("-") and word not in known] == []
