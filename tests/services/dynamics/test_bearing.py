"""CanPerform of D_artic_dyn: a robot that follows the motion must also bear what the handle asks."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from predicates.case import Answer, Case, Kind, Outcome, Verdict
from predicates.causes import causes
from predicates.law import law
from predicates.record import to_record
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.dynamics.oracle import Dynamics
from services.dynamics.robot.bearing import Bearing
from services.dynamics.robot.load import moments
from services.physics.model import Scene
from tests.services.dynamics.forced import forced_twin
from tests.small.lift import Lift

PHYSICS = Dynamics()
ROBOT = "https://example.org/id/pr2"
GRIPPER, LIFT = f"{ROBOT}/gripper/gripper", f"{ROBOT}/joint/lift_joint"


def judged(container: str, **known: Mapping[str, object]) -> Verdict:
    """The verdict with what is known of gripper, lift and robot: `gripper={"gripForce": 40.0}`."""
    twin = forced_twin(("pr2",))
    for subject, name in ((GRIPPER, "gripper"), (LIFT, "lift"), (ROBOT, "robot")):
        if name in known:
            twin = twin.with_edit(subject, **known[name])  # pyright: ignore[reportArgumentType] - values of terms
    (verdict,) = law(asked(twin, container), PHYSICS, Bearing(Lift()))
    return verdict


def asked(twin: Twin, container: str) -> Case:
    return Case(twin, robot=ROBOT, task=Task(Verb.OPEN, twin.container(container).iri))


def performed(verdict: Verdict) -> Answer:
    assert verdict.can_perform is not None
    return verdict.can_perform


def test_what_is_not_known_is_not_checked_and_the_verdict_says_so() -> None:
    verdict = judged("top_drawer")
    assert verdict.outcome is Outcome.CERTIFIED
    notes = " ".join(performed(verdict).notes)
    for what in ("efforts of lift_joint", "grip at the handle", "slip of the base", "tipping of the base"):
        assert f"not checked: {what}" in notes


def test_pads_that_hold_the_handle_are_checked_and_the_share_is_told() -> None:
    verdict = judged("top_drawer", gripper={"gripForce": 200.0, "padFriction": 0.5})
    assert verdict.outcome is Outcome.CERTIFIED
    (share,) = [v for name, (v, _) in performed(verdict).figures.items() if "pads" in name]
    assert 0 < share < 1
    assert "not checked: grip" not in " ".join(performed(verdict).notes)


def test_pads_that_slip_whatever_the_drawer_needs_are_a_refusal_of_the_motion_that_was_found() -> None:
    verdict = judged("top_drawer", gripper={"gripForce": 2.0, "padFriction": 0.3})
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    (diagnosis,) = verdict.diagnoses
    assert (diagnosis.kind, diagnosis.proof) == (Kind.EMBODIMENT, False)
    assert "pull across the pads is" in diagnosis.reason
    assert diagnosis.evidence is not None
    assert (diagnosis.evidence.bound, diagnosis.evidence.unit) == (pytest.approx(1.2), "N")


def test_pads_that_may_slip_leave_it_open() -> None:
    verdict = judged("top_drawer", gripper={"gripForce": 10.0, "padFriction": 0.3})
    assert verdict.outcome is Outcome.ABSTAINED
    assert (verdict.satisfies_request, verdict.causes, verdict.can_perform) == (None, None, None)
    assert "leave open whether the robot bears it" in verdict.diagnoses[0].reason
    assert to_record(verdict).triples


def test_a_lift_that_is_too_weak_for_the_oven_door_is_refused() -> None:
    strong = judged("oven_door", lift={"effortLimitKnown": True})
    assert strong.outcome is Outcome.CERTIFIED
    weak = judged("oven_door", lift={"effortLimitKnown": True, "effortLimit": 1.0})
    assert weak.outcome is Outcome.NOT_CERTIFIED
    assert "effort of lift_joint" in weak.diagnoses[0].reason


def test_a_robot_without_weight_slips_on_any_floor() -> None:
    verdict = judged("top_drawer", robot={"wheelFriction": 0.5})
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert "sideways push on the wheels" in verdict.diagnoses[0].reason


def test_the_handle_pulls_on_the_robot_as_virtual_work_says() -> None:
    """A joint's effort for one newton is what its motion moves the tool along the handle's path."""
    twin = forced_twin(("pr2",))
    (caused,) = causes(asked(twin, "oven_door"), PHYSICS)
    answer = Lift().perform(replace(asked(twin, "oven_door"), motion=caused.case.motion))
    body, container = answer.case.body_motion, twin.container("oven_door")
    assert isinstance(body, BodyMotion)
    scene, mechanics = Scene(twin, ROBOT), PHYSICS.mechanics(twin, container)
    carried = PHYSICS.carried(twin, body, container)
    assert isinstance(carried, Motion)
    found = list(moments(scene, body, container, carried, mechanics))
    assert len(found) > 20
    lift = scene.coordinate[LIFT]
    for moment in found[:: len(found) // 7]:
        above = moment.q.copy()
        above[lift] += 1e-6
        frame = scene.tool_frame("gripper")
        step = scene.placement(above, frame).translation - scene.placement(moment.q, frame).translation
        assert moment.each[lift] == pytest.approx(float(step @ moment.along) / 1e-6, abs=1e-6)
        assert np.linalg.norm(moment.along) == pytest.approx(1.0)
        assert moment.force[0] <= moment.force[1]
