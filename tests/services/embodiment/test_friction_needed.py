"""The friction that a certified hold takes: fingers at a bar that gets thicker inward."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified
from tests.services.embodiment.gantry import FOLDER, gantry_twin, opening
from tests.services.embodiment.judging import judge

pytestmark = pytest.mark.oracle

TIP, CLOSED = 0.01, 0.005  # [m] of the fingers beyond the bar's middle, and from each other's middle


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


def needed(twin: Twin) -> float:
    """Of the certified motion of the gantry [1]."""
    verdict = judge(twin, opening())
    assert isinstance(verdict, Certified), verdict.diagnoses
    value, unit = verdict.figures["friction needed"]
    assert unit == "1"
    return value


@pytest.mark.parametrize("degrees", [0.0, 1.5, 8.0, 18.0])
def test_faces_that_look_back_need_friction_of_the_tangent_of_their_angle(
    tmp_path: Path, degrees: float
) -> None:
    least = np.tan(np.radians(degrees))
    assert least <= needed(wedge(tmp_path, degrees)) <= least + 0.01


def test_faces_of_a_box_need_hardly_any(tmp_path: Path) -> None:
    assert needed(gantry_twin(tmp_path)) < 0.01


def test_where_nothing_shows_how_faces_look_no_figure_is_given_but_a_word(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("services.embodiment.certify.held.grip.moved.slope", lambda *_: np.inf)
    verdict = judge(gantry_twin(tmp_path), opening())
    assert isinstance(verdict, Certified)
    assert "friction needed" not in verdict.figures
    assert "friction needed: not known" in " ".join(verdict.nearest)
