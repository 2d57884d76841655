"""The friction that a certified hold takes: fingers at a bar that gets thicker inward."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from predicates.case import Outcome
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.app import Policy, load
from services.embodiment.certify import Certified, Refused, Tolerances
from services.embodiment.recheck import Saved, recheck_verdict
from services.store.files import SavedVerdicts
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


def test_where_nothing_shows_how_faces_look_no_figure_is_given_and_no_friction_is_enough(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("services.embodiment.certify.held.grip.moved.slope", lambda *_: np.inf)
    verdict = judge(gantry_twin(tmp_path), opening())
    assert isinstance(verdict, Certified)
    assert "friction needed" not in verdict.figures
    assert "friction needed: not known" in " ".join(verdict.nearest)
    refused = judge(gantry_twin(tmp_path), opening(), tolerances=Tolerances.within(None, 5.0))
    assert isinstance(refused, Refused)
    (found,) = refused.diagnoses
    assert "may take any friction, and 5 is asked" in found.reason


@pytest.mark.parametrize(("asked", "kept"), [(0.13, False), (0.16, True), (2.0, True)])
def test_holds_that_need_more_friction_than_is_asked_are_refused(
    tmp_path: Path, asked: float, kept: bool
) -> None:
    tolerances = Tolerances.within(None, asked)
    assert tolerances.friction == asked
    assert isinstance(judge(wedge(tmp_path, 8.0), opening(), tolerances=tolerances), Certified) is kept


def test_faces_that_look_away_along_both_sides_are_refused_for_what_both_take(tmp_path: Path) -> None:
    tolerances = replace(Tolerances(), cone=np.arctan(0.13))
    refused = judge(wedge(tmp_path, 8.0), opening(), tolerances=tolerances)
    assert isinstance(refused, Refused)
    (found,) = refused.diagnoses
    assert "which takes friction of 0.14" in found.reason
    assert found.evidence is not None
    assert found.evidence.value == pytest.approx(np.radians(8.0), abs=0.01)
    assert found.evidence.bound == np.arctan(0.13)


def test_a_search_finds_a_hold_that_needs_no_more_than_is_asked() -> None:
    needed = []
    for friction in (None, 0.3):
        service = load("b", ["stretch"], policy=Policy(drive=Drive.OMNI, friction=friction))
        (verdict,) = service.achieve("open:oven_area_oven_door")
        assert verdict.outcome is Outcome.CERTIFIED
        assert verdict.can_perform is not None
        needed.append(verdict.can_perform.figures["friction needed"][0])
    assert needed[1] <= 0.3 < needed[0]


def test_a_handle_that_only_slanted_faces_can_hold_is_said_to_be_so() -> None:
    service = load("a", ["stretch"], policy=Policy(drive=Drive.OMNI, friction=0.5))
    (verdict,) = service.achieve("open:cabinet6_drawer_top")
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    (found,) = verdict.diagnoses
    assert "holds it by faces that look along the way in which fingers close" in found.reason
    assert not found.proof


@pytest.mark.parametrize("asked", [{"friction": 0.6}, {"contact": 0.001}], ids=["friction", "contact"])
@pytest.mark.parametrize(("drive", "kind"), [(Drive.FIXED, "proof"), (Drive.OMNI, "certificate")])
def test_what_is_said_of_less_friction_or_of_nearer_fingers_is_verified_again(
    tmp_path: Path, drive: Drive, kind: str, asked: dict[str, float]
) -> None:
    service = load("b", ["stretch"], policy=Policy(drive=drive, **asked))
    (verdict,) = service.achieve("open:iai_fridge_door")
    file = tmp_path / "kept.nq"
    with SavedVerdicts(file) as saved:
        saved.add_twin(service.twin)
        saved.add(verdict)
    stored = Saved(file)
    (entry,) = stored.entries()
    assert entry.stored is not None
    assert entry.artefact is not None
    assert entry.artefact.kind.value == kind
    assert recheck_verdict(entry.stored, entry.artefact, stored.twin).reasons == ()
