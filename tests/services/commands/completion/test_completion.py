"""What a shell completes, asked as the shells ask, in a real bash where there is one."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from services import cli
from tests.services.conftest import Done

LINES = {
    "sdt ach": ["achieve"],
    "sdt achieve --kitchen ": ["a", "b"],
    "sdt achieve --kitchen b --robot ": ["pr2", "stretch", "tiago_dual"],
    "sdt achieve --kitchen b --task op": ["open", "open:"],
    "sdt achieve --kitchen b --task open:iai": ["iai_fridge_door"],
    "sdt satisfies b --state iai_fridge_door": ["iai_fridge_door=", "iai_fridge_door_joint="],
    "sdt satisfies b --state iai_fridge_door=": ["open", "closed"],
    "sdt satisfies b --state all=o": ["open"],
    "sdt learn track.csv --kitchen b --container iai": ["iai_fridge_door"],
    "sdt achieve --drive o": ["omni"],
    "sdt query b -f joint_of": ["joint_of_container"],
    "sdt satisfies no_such_kitchen --state all=c": ["closed"],
}


@pytest.fixture
def completed(
    sdt: Callable[..., Done], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[str], list[str]]:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv(cli.COMPLETE, "bash_complete")

    def complete(line: str) -> list[str]:
        monkeypatch.setenv("COMP_LINE", line)
        monkeypatch.setenv("COMP_POINT", str(len(line)))
        return [word.removeprefix("plain,") for word in sdt().out.split()]

    return complete


@pytest.mark.parametrize("line", LINES)
def test_names_are_completed_from_the_twin(completed: Callable[[str], list[str]], line: str) -> None:
    assert completed(line) == LINES[line]


def test_the_kitchen_may_come_from_the_settings(
    completed: Callable[[str], list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SDT_KITCHEN", "b")
    assert completed("sdt achieve --task open:iai") == ["iai_fridge_door"]


def test_names_are_kept_until_the_model_changes(
    completed: Callable[[str], list[str]], tmp_path: Path
) -> None:
    text = '<robot name="k"><link name="{}"/></robot>'
    model = tmp_path / "k.urdf"
    for link in ("l", "longer"):
        model.write_text(text.format(link))
        assert completed(f"sdt satisfies {model} --state all=c") == ["closed"]
    assert len(list((tmp_path / "sdt" / "names").iterdir())) == 2


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash here")
def test_bash_takes_a_task_for_one_word(tmp_path: Path) -> None:
    line = "sdt achieve --kitchen b --task open:iai"
    program = tmp_path / "sdt"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m services.cli "$@"\n')
    program.chmod(0o755)
    script = f"""
        source <({program} completion bash)
        COMP_LINE='{line}' COMP_POINT={len(line)}
        _sdt_completion {program}
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    done = subprocess.run(
        [str(shutil.which("bash")), "-c", script],
        capture_output=True,
        text=True,
        check=True,
        env=environment,
        cwd=Path(cli.__file__).parents[1],
    )
    assert done.stdout.split() == ["iai_fridge_door"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_script_is_printed_for_each_shell(sdt: Callable[..., Done], shell: str) -> None:
    assert f"_SDT_COMPLETE={shell}_complete" in sdt("completion", shell).out
