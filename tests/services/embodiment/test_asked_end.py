"""Where a body motion ends that comes with a τ: by as much as the tolerance, it may be elsewhere."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case, Outcome, Verdict
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import State
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import DRAWER, FOLDER, RESTS, START, gantry_twin, opening

pytestmark = pytest.mark.oracle

GRASPED = 11.0  # [s]


def up_to(end: float) -> BodyMotion:
    """A body motion that opens the drawer so far [m]."""
    rests = RESTS.copy()
    rests[-1, -1] = end
    rests[-1, 1] += RESTS[-1, -1] - end
    return opening(rests=rests)


def wanted(of: str, end: float, timed: bool) -> Motion:
    """τ of a joint, in the times of these body motions."""
    body, scale = opening(), end / RESTS[-1, -1]
    held = body.times >= GRASPED - 1e-9
    values, rates = scale * body.kitchen_q[held], scale * body.kitchen_v[held]
    return Motion(of, body.times[held] - GRASPED, values, timed, rates)


def judged(twin: Twin, motion: Motion, body: BodyMotion) -> Verdict:
    task = Task(Verb.OPEN, twin.container("drawer_main").iri)
    case = Case(twin, twin.robots[0], task, motion, body_motion=body)
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    return verdict


@pytest.mark.parametrize("timed", [True, False])
@pytest.mark.parametrize("beyond", [0.0002, -0.0002])
def test_whether_a_request_is_met_is_asked_of_where_a_body_motion_ends(
    tmp_path: Path, beyond: float, timed: bool
) -> None:
    # It keeps a τ that ends 0.5 mm beyond where open begins, to within 1 mm.
    twin = gantry_twin(tmp_path)
    open_from = twin.container("drawer_main").open_from
    verdict = judged(twin, wanted(DRAWER, open_from + 0.0005, timed), up_to(open_from + beyond))
    assert verdict.can_perform is not None
    assert verdict.can_perform.holds
    assert verdict.outcome is (Outcome.CERTIFIED if beyond > 0 else Outcome.NOT_CERTIFIED)
    assert isinstance(verdict.case.final, State)
    assert verdict.case.final[DRAWER] == pytest.approx(open_from + beyond)


RATIO = 20.0  # [m] that the drawer goes for each metre of the crank
CRANK = """<link name="crank"/><joint name="crank_joint" type="prismatic"><parent link="world"/>
<child link="crank"/><axis xyz="1 0 0"/><limit lower="0" upper="0.025" velocity="1" effort="1"/></joint>"""


def cranked(folder: Path, more: str = "") -> Twin:
    """The cell with a drawer that follows a crank, and with more."""
    gantry_twin(folder, CRANK + more)
    file = folder / "cell.urdf"
    before, joint, after = file.read_text().partition('<joint name="drawer_main_joint" type="prismatic">')
    follows = f'<mimic joint="crank_joint" multiplier="{RATIO:g}"/>'
    file.write_text(f"{before}{joint}{follows}{after}")
    return load_twin(file, [FOLDER / "gantry.urdf"])


@pytest.mark.parametrize("timed", [True, False])
@pytest.mark.parametrize(("short", "outcome"), [(0.0005, Outcome.CERTIFIED), (0.01, Outcome.NOT_CERTIFIED)])
def test_a_container_is_no_farther_off_a_motion_of_what_leads_it_than_off_its_own(
    tmp_path: Path, short: float, outcome: Outcome, timed: bool
) -> None:
    # The drawer ends 10 mm short, and its crank by 0.5 mm; either way it is open.
    twin, crank = cranked(tmp_path), joint_iri("cell", "crank_joint")
    verdict = judged(twin, wanted(crank, 0.46 / RATIO, timed), up_to(0.46 - short))
    assert verdict.outcome is outcome, [each.reason for each in verdict.diagnoses]
    if outcome is Outcome.NOT_CERTIFIED:
        (diagnosis,) = verdict.diagnoses
        assert "crank_joint is up to 0.0005 m off the motion that was asked for" in diagnosis.reason
        assert diagnosis.evidence is not None
        assert diagnosis.evidence.bound == pytest.approx(0.001 / RATIO)


FLAP = """<link name="flap"/><joint name="flap_joint" type="prismatic"><parent link="world"/>
<child link="flap"/><axis xyz="1 0 0"/><limit lower="0" upper="1" velocity="1" effort="1"/>
<mimic joint="crank_joint" multiplier="40"/></joint>"""


@pytest.mark.parametrize("told", ["flap_joint", "crank_joint"])
def test_a_drawer_ends_where_it_was_certified_to_end_if_two_joints_say_a_little_differently(
    tmp_path: Path, told: str
) -> None:
    # As it is listed itself the drawer is open by 0.4 mm, as the other joint has it it is not.
    twin = cranked(tmp_path, FLAP)
    open_from = twin.container("drawer_main").open_from
    body = up_to(open_from - 0.0004)
    rates = np.array(
        [(open_from + 0.0004) / (open_from - 0.0004), 2.0 if told == "flap_joint" else 1 / RATIO]
    )
    joints = DRAWER, joint_iri("cell", told)
    body = replace(
        body, kitchen_joints=joints, kitchen_q=body.kitchen_q * rates, kitchen_v=body.kitchen_v * rates
    )
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, twin.container("drawer_main").iri), body_motion=body)
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    assert verdict.can_perform is not None
    assert verdict.can_perform.figures["container at the end"][0] == pytest.approx(open_from - 0.0004)
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert "open begins at" in verdict.diagnoses[0].reason
