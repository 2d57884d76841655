"""A limb whose joints move together, as a telescope or by <mimic>, moves where all of them may be."""

import re
import shutil
from pathlib import Path

import pytest

import robots
from sdt_kg.errors import AnnotationError
from sdt_kg.load import load_twin
from services.embodiment.body.limb import Limb, make_limb
from services.embodiment.body.world import World
from services.physics.model import Scene
from tests.services.embodiment.gantry import FOLDER

pytestmark = pytest.mark.oracle

SEGMENT = re.compile(r'(<joint name="joint_arm_l2".*?<limit )lower="[^"]*" upper="[^"]*"([^>]*>)', re.DOTALL)
COUPLED = "<https://example.org/id/stretch/joint/joint_arm_l2>, "


def limb(folder: Path, limits: str, mimic: str = "") -> Limb:
    """Stretch's, of whose telescope one segment has other limits, and perhaps follows by <mimic>."""
    for name in ("stretch.urdf", "stretch.ttl"):
        shutil.copy(Path(robots.__file__).parent / "stretch" / name, folder)
    urdf, annotation = folder / "stretch.urdf", folder / "stretch.ttl"
    changed, count = SEGMENT.subn(rf"\g<1>{limits}\2{mimic}", urdf.read_text(encoding="utf-8"))
    assert count == 1
    urdf.write_text(changed, encoding="utf-8")
    if mimic:
        text = annotation.read_text(encoding="utf-8")
        assert COUPLED in text
        annotation.write_text(text.replace(COUPLED, "", 1), encoding="utf-8")
    scene = Scene(load_twin(FOLDER / "cell.urdf", [urdf]), "https://example.org/id/stretch")
    return make_limb(World(scene), scene.annotation.grippers[0])


def test_joints_that_move_together_move_as_far_as_the_shortest(tmp_path: Path) -> None:
    free = limb(tmp_path, 'lower="0" upper="0.13"')
    short = limb(tmp_path, 'lower="0" upper="0.05"')
    (changed,) = (free.upper != short.upper).nonzero()[0]
    assert short.upper[changed] == pytest.approx(0.05)
    assert free.upper[changed] == pytest.approx(0.13)


def test_joints_with_one_position_in_common_stay_there(tmp_path: Path) -> None:
    free, stuck = limb(tmp_path, 'lower="0" upper="0.13"'), limb(tmp_path, 'lower="-0.13" upper="0"')
    (changed,) = (free.upper != stuck.upper).nonzero()[0]
    assert stuck.lower[changed] == stuck.upper[changed] == pytest.approx(0.0, abs=1e-9)


def test_joints_without_a_position_in_common_are_told(tmp_path: Path) -> None:
    with pytest.raises(AnnotationError, match=r"no position in common within their limits: joint_arm_l"):
        limb(tmp_path, 'lower="0.2" upper="0.3"', '<mimic joint="joint_arm_l3"/>')
