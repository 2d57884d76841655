"""How far faces that hold look away from the way in which fingers close: a bar that gets thicker inward."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified
from services.embodiment.certify.certificate import read_certificate
from services.embodiment.certify.held.slant import slant
from services.physics.model import Scene
from tests.services.embodiment.gantry import FOLDER, gantry_twin, opening
from tests.services.embodiment.judging import judge

pytestmark = pytest.mark.oracle

TIP, CLOSED = 0.01, 0.005  # [m] of the fingers beyond the bar's middle, and from each other's middle
BOTH = np.sqrt(2)  # a face may look away along both sides at once


def wedge(folder: Path, degrees: float) -> Twin:
    """The fingers' tips touch both faces of the bar, which look back at the hand by that angle."""
    slope, begin, end = np.tan(np.radians(degrees)), -0.004, 0.02
    thick = [(x, CLOSED + slope * (x - TIP)) for x in (begin, end)]
    corners = [(x, y, sign * half) for x, half in thick for y in (-0.1, 0.1) for sign in (-1, 1)]
    trimesh.convex.convex_hull(np.array(corners)).export(folder / "wedge.stl")
    text = (FOLDER / "cell.urdf").read_text()
    bar = text[text.index('<link name="drawer_handle">') : text.index('<joint name="drawer_handle_joint"')]
    mesh = '<collision><geometry><mesh filename="wedge.stl"/></geometry></collision></link>'
    (folder / "cell.urdf").write_text(text.replace(bar, f'<link name="drawer_handle">{mesh}'))
    return load_twin(folder / "cell.urdf", [FOLDER / "gantry.urdf"])


def found(twin: Twin) -> float:
    """Of the certified motion of the gantry [degrees]."""
    verdict = judge(twin, opening())
    assert isinstance(verdict, Certified), verdict.diagnoses
    certificate = read_certificate(verdict.artefact().content)
    return float(np.degrees(slant(Scene(twin, twin.robots[0]), twin, certificate)))


@pytest.mark.parametrize(("degrees", "told"), [(0.0, 0.25), (1.5, 2.0), (8.0, 10.0), (18.0, 20.0)])
def test_faces_that_look_back_are_told_by_no_less(tmp_path: Path, degrees: float, told: float) -> None:
    most = np.degrees(np.arctan(BOTH * np.tan(np.radians(told))))
    assert degrees <= found(wedge(tmp_path, degrees)) == pytest.approx(most, abs=1e-3)


def test_faces_of_a_box_look_along_the_way_that_fingers_close(tmp_path: Path) -> None:
    assert found(gantry_twin(tmp_path)) < 0.4
