"""A verdict says how a container may be held: its certificate holds it so."""

from pathlib import Path

import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from predicates.record.inputs import inputs_of, verdict_iri
from predicates.record.stored import StoredVerdict
from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.oracle import WholeBody
from services.embodiment.recheck import Rechecked, recheck_verdict
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import START, TWICE, gantry_twin, opening
from tests.services.embodiment.two_hands import taken_over, two_handed

pytestmark = pytest.mark.oracle

HIGH = """<link name="high_drawer"><collision><geometry><box size="0.02 0.4 0.2"/></geometry>
</collision></link>
<joint name="high_drawer_joint" type="prismatic"><parent link="world"/><child link="high_drawer"/>
<origin xyz="1.26 0 1.5"/><axis xyz="-1 0 0"/><limit lower="0" upper="0.5" velocity="1" effort="10"/>
<mimic joint="drawer_main_joint"/></joint>
<link name="high_drawer_handle"><collision><geometry><box size="0.01 0.2 0.01"/></geometry></collision></link>
<joint name="high_drawer_handle_joint" type="fixed"><parent link="high_drawer"/>
<child link="high_drawer_handle"/><origin xyz="-0.055 0 0"/></joint>"""


def again(twin: Twin, container: str, motion: BodyMotion, said_of: WholeBody) -> Rechecked:
    """Recheck of a verdict with the inputs of that judge, and the certificate of one that allows more."""
    task, physics = Task(Verb.OPEN, twin.container(container).iri), Kinematics()
    case = Case(twin, twin.robots[0], task, body_motion=motion)
    (verdict,) = law(case, physics, WholeBody(Drive.OMNI, START))
    assert verdict.outcome is Outcome.CERTIFIED, verdict.diagnoses
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is not None
    inputs = inputs_of(case, physics, said_of)
    answers = verdict.satisfies_request, verdict.causes, verdict.can_perform
    stored = StoredVerdict(
        iri=verdict_iri(inputs),
        outcome=Outcome.CERTIFIED,
        environment=twin.environment,
        robot=twin.robots[0],
        verb=task.verb,
        container=twin.container(container).iri,
        satisfies_request=True,
        causes=True,
        can_perform=True,
        diagnoses=(),
        notes=(),
        figures={name: figure for each in answers if each for name, figure in each.figures.items()},
        inputs=inputs,
        seconds=0.0,
    )
    return recheck_verdict(stored, verdict.can_perform.artefact, lambda *_: (twin, "given"))


@pytest.mark.parametrize("regrasps", [True, False])
def test_a_certificate_of_two_holds_shows_nothing_of_a_verdict_about_one(
    tmp_path: Path, regrasps: bool
) -> None:
    said_of = WholeBody(Drive.OMNI, START, regrasps=regrasps)
    found = again(gantry_twin(tmp_path), "drawer_main", opening(rests=TWICE), said_of)
    refused = ("the verdict is about one hold, and its certificate has several",)
    assert found.reasons == (() if regrasps else refused)


def test_a_certificate_of_two_hands_is_verified_with_its_verdict(tmp_path: Path) -> None:
    found = again(two_handed(tmp_path), "drawer_main", taken_over(), WholeBody(Drive.OMNI, START))
    assert found.reasons == ()


@pytest.mark.parametrize("coupled", [True, False])
def test_a_certificate_by_another_container_shows_nothing_of_a_verdict_about_its_own_handles(
    tmp_path: Path, coupled: bool
) -> None:
    said_of = WholeBody(Drive.OMNI, START, coupled=coupled)
    found = again(gantry_twin(tmp_path, HIGH), "high_drawer", opening(), said_of)
    refused = "the verdict is about handles of high_drawer itself, and its certificate holds drawer_main"
    assert found.reasons == (() if coupled else (refused,))
