"""What an annotation names is there, is what it is named as, and is whole; else that is told at once."""

import re
import shutil
from pathlib import Path

import pytest

from sdt_kg.errors import AnnotationError
from sdt_kg.load import load_twin
from tests.services.embodiment.gantry import FOLDER

GANTRY = "https://example.org/id/gantry"
TOOL = f"sdt:hasPose <{GANTRY}/tool>"
CORE = f"b:palm sdt:hasCore <{GANTRY}/core> . <{GANTRY}/core> "
SIZES = "sdt:sizeX 0.01 ; sdt:sizeY 0.01"


def refused(folder: Path, pattern: str, replacement: str, more: str = "") -> str:
    """Why the gantry is refused with its annotation changed so, and more said at its end."""
    for suffix in (".urdf", ".ttl"):
        shutil.copy(FOLDER / f"gantry{suffix}", folder)
    file = folder / "gantry.ttl"
    text, count = re.subn(pattern, replacement, file.read_text(encoding="utf-8"), count=1)
    assert count
    file.write_text(text + more, encoding="utf-8")
    with pytest.raises(AnnotationError) as caught:
        load_twin(FOLDER / "cell.urdf", [folder / "gantry.urdf"])
    return str(caught.value)


LACKS = {
    "x of the tool": (r"sdt:x 0.07 ;", "", "", "lacks: tool sdt:x; robots/README.md"),
    "the tool's pose": (r"/tool> a sdt:Pose", "/tl> a sdt:Pose", "", "tool sdt:x, "),
    "a core's size": ("$", "", f"{CORE} a sdt:Box ; {TOOL} ; {SIZES} .", "lacks: core sdt:sizeZ;"),
    "a core's pose": ("$", "", f"{CORE} a sdt:Box ; {SIZES} ; sdt:sizeZ 1 .", "lacks: core sdt:hasPose;"),
    "a core's kind": ("$", "", f"{CORE} {TOOL} ; {SIZES} ; sdt:sizeZ 1 .", "lacks: core a sdt:Box;"),
    "one kind": (
        "$",
        "",
        f"{CORE} a sdt:Box, sdt:Sphere ; {TOOL} ; {SIZES} ; sdt:sizeZ 1 .",
        "lacks: core a sdt:Box;",
    ),
    "a core": ("$", "", f"b:palm sdt:hasCore <{GANTRY}/core> .", "lacks: core sdt:hasPose, core sdt:sizeX,"),
}


@pytest.mark.parametrize("case", LACKS)
def test_what_a_part_lacks_is_named(tmp_path: Path, case: str) -> None:
    pattern, replacement, more, reason = LACKS[case]
    assert reason in refused(tmp_path, pattern, replacement, more)


def test_a_start_pose_that_lacks_a_number_is_refused(tmp_path: Path) -> None:
    shutil.copy(FOLDER / "cell.urdf", tmp_path)
    said = "sdt:x 0.0 ; sdt:y 0.0 ; sdt:z 0.0 ; sdt:qx 0.0 ; sdt:qy 0.0 ; sdt:qw 1.0"
    (tmp_path / "cell.ttl").write_text(
        f"@prefix sdt: <https://example.org/sdt#> . <https://example.org/id/cell> a sdt:Environment ; "
        f"sdt:startPose <https://example.org/id/cell/start> . <https://example.org/id/cell/start> {said} .",
        encoding="utf-8",
    )
    with pytest.raises(AnnotationError, match=r"lacks: start sdt:qz; kitchens/README.md"):
        load_twin(tmp_path / "cell.urdf")
