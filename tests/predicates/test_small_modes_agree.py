"""What generation makes, verification certifies and explanation names; on small models."""

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from predicates.case import Case, Outcome
from predicates.law import law
from predicates.record import to_json
from sdt_kg.task import UNKNOWN, Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.lift import Lift

PHYSICS, LIFT = Kinematics(), Lift()
TWIN = small_twin("a", ("pr2", "stretch"))
NAMES = ("folding_door", "high_drawer", "low_drawer", "side_door")


@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(st.sampled_from(NAMES), st.sampled_from(TWIN.robots), st.sampled_from(Verb), st.floats(0, 1))
def test_modes_agree(name: str, robot: str, verb: Verb, share: float) -> None:
    container = TWIN.container(name)
    twin = TWIN.at({container.joint: share * container.upper})
    task = Task(verb, container.iri)
    (made,) = law(Case(twin, robot=robot, task=task), PHYSICS, LIFT)
    if made.outcome is not Outcome.CERTIFIED:
        assert made.diagnoses
        return
    with_motion = Case(twin, robot=robot, task=task, motion=made.case.motion)
    with_body = Case(twin, robot=robot, task=task, body_motion=made.case.body_motion)
    for case in (with_motion, with_body):
        (verified,) = law(case, PHYSICS, LIFT)
        assert verified.outcome is Outcome.CERTIFIED, to_json(verified)
        (explained,) = law(replace(case, task=UNKNOWN), PHYSICS, LIFT)
        assert explained.case.task == task
        assert explained.iri == verified.iri


@pytest.mark.parametrize("columns", ["with", "without"])
def test_a_body_motion_is_explained_by_what_its_gripper_drags(columns: str) -> None:
    container = TWIN.container("low_drawer")
    (made,) = law(Case(TWIN, robot=TWIN.robots[0], task=Task(Verb.OPEN, container.iri)), PHYSICS, LIFT)
    body = made.case.body_motion
    assert body is not UNKNOWN
    if columns == "without":
        body = replace(
            body, kitchen_joints=(), kitchen_q=body.kitchen_q[:, :0], kitchen_v=body.kitchen_v[:, :0]
        )
    (explained,) = law(Case(TWIN, body_motion=body), PHYSICS, LIFT)
    assert explained.outcome is Outcome.CERTIFIED, to_json(explained)
    assert explained.case.task == Task(Verb.OPEN, container.iri)
