"""A container that is held and leads another one, which goes much farther: how exactly it is held counts."""

from dataclasses import replace
from pathlib import Path

import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.task import Task, Verb
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import FOLDER, RESTS, START, gantry_twin, opening

pytestmark = pytest.mark.oracle

RATIO = 50.0  # [m] that the other drawer goes for each metre of the one that is held
OTHER = """<link name="other_drawer"/><joint name="other_drawer_joint" type="prismatic"><parent link="world"/>
<child link="other_drawer"/><origin xyz="5 3 0.5"/><axis xyz="-1 0 0"/>
<limit lower="0" upper="0.5" velocity="1" effort="10"/></joint>
<link name="other_drawer_handle"><collision><geometry><box size="0.01 0.2 0.01"/></geometry></collision>
</link><joint name="other_drawer_handle_joint" type="fixed"><parent link="other_drawer"/>
<child link="other_drawer_handle"/></joint>"""
WAY = 0.49  # [m] of the other drawer


@pytest.mark.parametrize(
    ("slip", "outcome"),
    [(0.0, Outcome.CERTIFIED), (0.0019, Outcome.NOT_CERTIFIED)],
    ids=["as it goes", "slips"],
)
def test_a_tool_may_slip_by_as_much_less_as_another_container_goes_farther(
    tmp_path: Path, slip: float, outcome: Outcome
) -> None:
    # Of 10 mm that a hand pulls, 2 mm of slip are 100 mm of the other drawer.
    gantry_twin(tmp_path, OTHER)
    file = tmp_path / "cell.urdf"
    before, joint, after = file.read_text().partition('<joint name="drawer_main_joint" type="prismatic">')
    file.write_text(f'{before}{joint}<mimic joint="other_drawer_joint" multiplier="{1 / RATIO}"/>{after}')
    twin = load_twin(file, [FOLDER / "gantry.urdf"])
    rests = RESTS.copy()
    rests[-1, 1:7] = rests[-2, 1:7]
    rests[-1, 1] -= WAY / RATIO - slip
    rests[-1, -1] = WAY
    body = replace(opening(rests=rests), kitchen_joints=(joint_iri("cell", "other_drawer_joint"),))
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, twin.container("other_drawer").iri), body_motion=body)
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    assert verdict.outcome is outcome, [each.reason for each in verdict.diagnoses]
