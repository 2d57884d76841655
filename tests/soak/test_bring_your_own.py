"""The guide for a robot of one's own, with the reference's Stretch: described, it opens all of kitchen b."""

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
    said = capsys.readouterr().out
    assert "check: one motor drives the telescope 'joint_arm_l3'" in said
    assert run(["robot", "describe", str(urdf), "-o", str(annotation)]) == 2
    assert "--force" in capsys.readouterr().err
    assert run(["scope", "b", "--robot", str(urdf), "--annotation", str(annotation)]) == 0
    words = ("--kitchen", "b", "--robot", str(urdf), "--annotation", str(annotation), "--drive", "omni")
    capsys.readouterr()
    assert run(["achieve", *words, "--budget", "120", "--task", "open"]) == 0  # all 17, as it was guessed
    assert "note: check: gripper 'gripper' is body 'link_wrist_roll'" in capsys.readouterr().out
