"""The guide for a robot of one's own, followed with the reference's Stretch."""

from pathlib import Path

import pytest

from sdt_kg.load import bundled
from services.cli import run

STEM = "https://example.org/id/stretch_description"
ARM = ", ".join(f"<{STEM}/joint/joint_arm_l{k}>" for k in (3, 2, 1, 0))
CHECKED = f"""
<{STEM}/joint/joint_lift> sdt:parkedPosition 0.4 .
<{STEM}/joint/joint_wrist_yaw> sdt:parkedPosition 2.5 .
<{STEM}> sdt:hasCoupling <{STEM}/coupling/telescope> .
<{STEM}/coupling/telescope> a sdt:Coupling ; sdt:couples {ARM} .
"""
"""What the guide's checks end in for this robot: its gripper stays as it was guessed."""


def touching() -> str:
    """The pairs that were proved apart where shapes that contain them meet, of the bundled annotation."""
    lines = bundled("robot", "stretch").with_suffix(".ttl").read_text(encoding="utf-8").splitlines()
    pairs = [each.replace("/id/stretch/", "/id/stretch_description/") for each in lines if "mayTouch" in each]
    assert pairs
    return "\n".join(pairs)


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
    with annotation.open("a", encoding="utf-8") as file:
        file.write(CHECKED + touching())
    assert (
        run(["achieve", *words, "--budget", "120", "--task", "open:sink_area_left_middle_drawer_main"]) == 0
    )
    assert "certified" in capsys.readouterr().out
