"""What is allowed cannot be widened from within a record: not for a certificate, and not under a proof."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import ArtefactKind, Case, Outcome
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify.certificate import read_certificate, said_in, sealed
from services.embodiment.certify.check import Certified, Refused, certify
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.oracle import WholeBody
from services.embodiment.recheck import recheck_artefact
from services.physics.oracle import Kinematics
from services.policy import MOST_CONTACT
from tests.services.embodiment.gantry import RESTS, START, gantry_twin, opening

pytestmark = pytest.mark.oracle


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return gantry_twin(tmp_path_factory.mktemp("cell"))


@pytest.fixture(scope="module")
def content(twin: Twin) -> bytes:
    drawer = twin.container("drawer_main")
    found = certify(twin, twin.robots[0], opening(), drawer, Tolerances(), drive=Drive.OMNI, start=START)
    assert isinstance(found, Certified)
    return found.artefact().content


def with_tolerance(content: bytes, name: str, value: float) -> bytes:
    said = said_in(content)
    said["tolerances"][name] = value
    return sealed(said)


def refused(name: str, value: float) -> str:
    """What a certificate with that tolerance is refused with."""
    return f"tolerance '{name}'" if np.isfinite(value) else "is no number that bounds anything"


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e3], ids=str)
@pytest.mark.parametrize("name", [name for name in Tolerances.__slots__ if name not in {"margin", "engaged"}])
def test_a_certificate_alone_cannot_loosen_what_it_is_held_to(
    twin: Twin, content: bytes, name: str, value: float
) -> None:
    found = recheck_artefact("loose", with_tolerance(content, name, value), lambda *_: (twin, "given"))
    assert not found.holds
    assert refused(name, value) in found.reasons[0]


@pytest.mark.parametrize(
    ("name", "value"), [("margin", -0.01), ("engaged", 0.0), ("engaged", np.nan), ("engaged", 1e3)]
)
def test_what_has_to_be_kept_cannot_be_less_nor_without_bound(
    twin: Twin, content: bytes, name: str, value: float
) -> None:
    found = recheck_artefact("loose", with_tolerance(content, name, value), lambda *_: (twin, "given"))
    assert not found.holds
    assert refused(name, value) in found.reasons[0]


def test_another_contact_that_was_asked_for_still_holds_and_is_told(twin: Twin) -> None:
    wide, drawer = replace(Tolerances(), contact=0.001), twin.container("drawer_main")
    found = certify(twin, twin.robots[0], opening(), drawer, wide, drive=Drive.OMNI, start=START)
    assert isinstance(found, Certified)
    content = found.artefact().content
    assert read_certificate(content).tolerances == wide
    again = recheck_artefact("wide", content, lambda *_: (twin, "given"))
    assert again.holds, again.reasons
    assert any("own tolerances" in note for note in again.notes)


def test_what_fingers_that_never_close_were_certified_for_no_longer_holds(twin: Twin) -> None:
    """With fingers up to 0.1 m off, an open hand about the bar had it pull the drawer."""
    rests, drawer = RESTS.copy(), twin.container("drawer_main")
    rests[:, 7] = 0.04
    motion, about = opening(rests=rests), (twin, twin.robots[0])
    wide = replace(Tolerances(), contact=0.1)
    kept = certify(*about, motion, drawer, wide, drive=Drive.OMNI, start=START)
    assert isinstance(kept, Certified)
    assert kept.figures["finger to handle"][0] > 0.02
    again = recheck_artefact("open hand", kept.artefact().content, lambda *_: (twin, "given"))
    assert not again.holds
    assert "tolerance 'contact' is 0.1, allowed is 0 to 0.002" in "; ".join(again.reasons)
    found = certify(*about, motion, drawer, Tolerances.within(MOST_CONTACT), drive=Drive.OMNI, start=START)
    assert isinstance(found, Refused)
    assert "moves before it is held" in found.diagnoses[0].reason


@pytest.mark.parametrize(
    ("other", "proved"),
    [({}, True), ({"contact": 0.001}, True), ({"contact": 0.003}, False), ({"depth": 0.003}, False)],
    ids=str,
)
def test_what_looser_tolerances_would_accept_is_not_proved_impossible(
    tmp_path: Path, other: dict[str, float], proved: bool
) -> None:
    """A drawer far above all fingers is refuted for this version's tolerances, and for nearer fingers."""
    kitchen = tmp_path / "high.urdf"
    kitchen.write_text(HIGH)
    twin = load_twin(kitchen, ["stretch"])
    task = Task(Verb.OPEN, twin.container("front_door").iri)
    oracle = WholeBody(Drive.OMNI, (0.0, 0.0, 0.0), 1.0)
    oracle.tolerances = replace(oracle.tolerances, **other)
    (verdict,) = law(Case(twin, twin.robots[0], task), Kinematics(), oracle)
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert any(each.proof for each in verdict.diagnoses) == proved
    assert verdict.can_perform is not None
    artefact = verdict.can_perform.artefact
    assert (artefact is not None and artefact.kind is ArtefactKind.PROOF) == proved


HIGH = """<robot name="high"><link name="world"/>
<link name="front_door"><collision><geometry><box size="0.02 0.4 0.2"/></geometry></collision></link>
<joint name="front_door_joint" type="prismatic"><parent link="world"/><child link="front_door"/>
<origin xyz="1 0 2.2"/><axis xyz="-1 0 0"/><limit lower="0" upper="0.4" velocity="1" effort="100"/></joint>
<link name="front_handle"><collision><geometry><box size="0.012 0.15 0.012"/></geometry></collision></link>
<joint name="front_handle_joint" type="fixed"><parent link="front_door"/><child link="front_handle"/>
<origin xyz="-0.06 0 0"/></joint></robot>
"""


def test_a_motion_that_changes_after_it_was_certified_is_not_in_its_certificate(twin: Twin) -> None:
    drawer, motion = twin.container("drawer_main"), opening()
    found = certify(twin, twin.robots[0], motion, drawer, Tolerances(), drive=Drive.OMNI, start=START)
    assert isinstance(found, Certified)
    artefact, judged = found.artefact(), motion.q.copy()
    motion.q[:] += 0.5
    assert np.array_equal(read_certificate(artefact.content).motion.q, judged)
