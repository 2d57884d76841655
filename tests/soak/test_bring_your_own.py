"""The guide for a robot of one's own, followed with the reference's Stretch."""

from pathlib import Path

import pytest

from services.cli import run


@pytest.mark.reference
@pytest.mark.slow
def test_a_robot_of_one_s_own(
    reference: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SDT_CONFIG", "/dev/null")
    urdf, annotation = reference / "robot_stretch" / "stretch_description.urdf", tmp_path / "mine.ttl"
    assert run(["robot", "describe", str(urdf), "-o", str(annotation)]) == 0
    assert annotation.read_text(encoding="utf-8").count("check: ") == 7
    capsys.readouterr()
    assert run(["robot", "describe", str(urdf), "-o", str(annotation)]) == 2
    assert "--force" in capsys.readouterr().err
    assert run(["scope", "b", "--robot", str(urdf), "--annotation", str(annotation)]) == 0
    words = ("--kitchen", "b", "--robot", str(urdf), "--annotation", str(annotation), "--drive", "omni")
    code = run(["achieve", *words, "--task", "open:sink_area_left_middle_drawer_main"])
    said = capsys.readouterr().out
    assert code in {0, 1}  # by what was guessed
    assert "note: check: grippers, their fingers, tool frames and openings are guessed" in said
