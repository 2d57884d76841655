"""Φ of D_artic_dyn in the Law: a failure of its own, abstentions, and verdicts of D_artic untouched."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyoxigraph as ox
import pytest

from predicates.case import Answer, Case, Kind, Outcome, Quantity, Verdict
from predicates.causes import causes
from predicates.law import law
from predicates.record import to_json, to_record
from sdt_kg.entities import Replacement
from sdt_kg.errors import AnnotationError, InputError, OracleRejectedError
from sdt_kg.iri import LAW, local_name
from sdt_kg.motion import Motion
from sdt_kg.scope import D_ARTIC, D_ARTIC_DYN
from sdt_kg.shacl import TOO_MANY
from sdt_kg.state import Interval, Region
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services import load
from services.dynamics.data import HAS_FORCE_MODEL, with_forces
from services.dynamics.judge import forced
from services.dynamics.oracle import Dynamics
from services.dynamics.rest import at_rest, driven
from services.physics.oracle import Kinematics
from tests.services.dynamics.forced import DATA, HINGE, RUNNERS, edited, forced_twin
from tests.small import FOLDER, small_twin

PHYSICS = Dynamics()


def asked(twin: Twin, container: str = "top_drawer", verb: Verb = Verb.OPEN) -> Case:
    return Case(twin, task=Task(verb, twin.container(container).iri))


def answered(twin: Twin, container: str = "top_drawer", verb: Verb = Verb.OPEN) -> Answer:
    (answer,) = causes(asked(twin, container, verb), PHYSICS)
    return answer


def judged(twin: Twin, container: str = "top_drawer") -> Verdict:
    (verdict,) = law(asked(twin, container), PHYSICS)
    return verdict


def test_a_drawer_that_needs_less_than_is_allowed_opens_and_the_bound_is_told() -> None:
    answer = answered(forced_twin())
    assert answer.holds
    most, unit = answer.figures["handle force, at most"]
    assert (8 <= most <= 60, unit) == (True, "N")
    assert "for every value of force model runners" in answer.notes[0]


def test_excessive_force_is_a_causal_failure_of_its_own() -> None:
    answer = answered(edited(RUNNERS, latchForce=(176, 200)))
    (diagnosis,) = answer.diagnoses
    assert diagnosis.kind is Kind.CAUSAL
    assert diagnosis.proof
    assert "top_drawer opens, but needs 180.0 N where 60 N is allowed" in diagnosis.reason
    evidence = diagnosis.evidence
    assert evidence is not None
    assert (evidence.quantity, evidence.unit, evidence.bound, evidence.time) == (Quantity.FORCE, "N", 60, 0.0)
    assert evidence.value == pytest.approx(180)
    assert local_name(evidence.entity or "") == "top_drawer_handle"
    assert judged(edited(RUNNERS, latchForce=(176, 200))).outcome is Outcome.NOT_CERTIFIED


def test_a_force_that_is_refused_is_told_as_more_than_is_allowed() -> None:
    (diagnosis,) = answered(edited(RUNNERS, latchForce=(56.04, 70))).diagnoses
    assert "needs 60.04 N where 60 N is allowed" in diagnosis.reason


@pytest.mark.parametrize(
    ("figures", "element"),
    [
        ({"latchForce": (176, 200), "latchWidth": 0.0}, "latch"),
        ({"softCloserForce": (176, 200), "softCloserRange": 0.0}, "soft closer"),
        ({"softCloserDamping": (0, 200), "softCloserRange": 0.0}, "soft closer"),
    ],
)
def test_a_latch_or_closer_with_a_force_and_no_way_is_not_left_out_unsaid(
    figures: dict[str, tuple[float, float] | float], element: str
) -> None:
    # Such a drawer was said to need what it needs without, 15 N.
    verdict = judged(edited(RUNNERS, None, **figures))
    assert verdict.outcome is Outcome.ABSTAINED
    assert f"a {element} that " in str(verdict)
    assert "would not be felt" in str(verdict)


@pytest.mark.parametrize("spread", [0.9, 0.5])
def test_the_largest_spread_of_masses_is_inside(spread: float) -> None:
    assert "massSpread" not in str(judged(edited(RUNNERS, massSpread=spread)))


def test_where_the_intervals_leave_it_open_the_law_abstains() -> None:
    verdict = judged(edited(RUNNERS, latchForce=(20, 200)))
    assert verdict.outcome is Outcome.ABSTAINED
    (diagnosis,) = verdict.diagnoses
    assert "leave open whether top_drawer needs more than 60 N" in diagnosis.reason
    assert diagnosis.violation is not None
    assert diagnosis.violation.focus == RUNNERS
    assert not diagnosis.proof


@pytest.mark.parametrize("name", ["massSpread", "breakAwayFrictionTo", "allowedHandleForce"])
def test_a_missing_parameter_is_out_of_scope_with_its_shacl_result_and_never_guessed(name: str) -> None:
    verdict = judged(edited(RUNNERS, **{name: None}))
    assert verdict.outcome is Outcome.ABSTAINED
    assert name in {local_name(each.violation.path or "") for each in verdict.diagnoses if each.violation}


def test_without_force_data_nothing_is_in_scope() -> None:
    answer = answered(small_twin("b"))
    assert {each.kind for each in answer.diagnoses} == {Kind.OUT_OF_SCOPE}
    with pytest.raises(OracleRejectedError, match="0 force models"):
        PHYSICS.mechanics(small_twin("b"), small_twin("b").container("top_drawer"))


def test_two_force_models_of_one_joint_are_named_and_neither_is_taken() -> None:
    twin = forced_twin()
    more = frozenset({(twin.container("top_drawer").joint, HAS_FORCE_MODEL, ox.NamedNode(HINGE))})
    two = twin.rewritten(Replacement(twin.environment, frozenset(), more, "another model"))
    diagnoses = answered(two).diagnoses
    (found,) = (each for each in diagnoses if each.violation and each.violation.path == HAS_FORCE_MODEL)
    assert found.kind is Kind.OUT_OF_SCOPE
    assert found.violation is not None
    assert (found.violation.component, found.violation.bound) == (TOO_MANY, 1)
    assert found.reason.endswith(
        "there are several, and which counts is not guessed: keep one of hinge and runners"
    )
    assert "nothing is known" not in found.reason


def test_a_door_that_falls_further_open_when_let_go_is_open_all_the_same() -> None:
    answer = answered(forced_twin(), "oven_door")
    assert answer.holds
    assert "when let go oven_door moves further open, or may" in answer.notes


def test_a_drawer_that_springs_back_when_let_go_is_not_opened() -> None:
    answer = answered(edited(RUNNERS, springStiffness=(60, 60)))
    (diagnosis,) = answer.diagnoses
    assert diagnosis.kind is Kind.CAUSAL
    assert "does not stay: it moves shut" in diagnosis.reason
    unsure = answered(edited(RUNNERS, springStiffness=(10, 60)))
    assert [each.kind for each in unsure.diagnoses] == [Kind.OUT_OF_SCOPE]


def test_what_springs_back_and_may_stay_open_is_not_refused() -> None:
    """Surely it leaves its upper stop; whether it stays within open_from to upper nothing here decides."""
    twin = edited(RUNNERS, springStiffness=(400, 400), springRestPosition=0.47, allowedHandleForce=400.0)
    drawer = twin.container("top_drawer")
    times, values = np.array([0.0, 2.0, 4.0]), np.array([[0.0], [drawer.upper / 2], [drawer.upper]])
    motion = Motion(drawer.joint, times, values)
    mechanics = PHYSICS.mechanics(twin, drawer)
    assert at_rest(mechanics, drawer.upper).surely
    assert not driven(mechanics, drawer.upper, drawer.open_from, shut=True)
    assert driven(mechanics, drawer.upper, drawer.upper, shut=True)
    found = forced(mechanics, drawer, replace(motion, timed=True)).diagnoses
    told = [each for each in found if "may move shut" in each.reason]
    assert [(each.kind, each.proof) for each in told] == [(Kind.OUT_OF_SCOPE, False)]
    assert not any("does not stay" in each.reason for each in found)


def test_a_door_that_falls_further_open_does_not_stay_where_a_final_region_wants_it() -> None:
    twin = forced_twin()
    door = twin.container("oven_door")
    near, open_ = (
        Region(((door.joint, Interval(door.open_from + 0.018, upper)),))
        for upper in (door.open_from + 0.022, door.upper)
    )
    (made,) = causes(Case(twin, final=open_), PHYSICS)
    assert made.holds
    (answer,) = causes(Case(twin, final=near), PHYSICS)
    (again,) = causes(Case(twin, final=near, motion=answer.case.motion), PHYSICS)
    for each in (answer, again):
        (diagnosis,) = each.diagnoses
        assert (each.holds, diagnosis.kind, diagnosis.proof) == (False, Kind.OUT_OF_SCOPE, False)
        assert "oven_door may move when it is let go at 1.372, and leave [1.368, 1.372]" in diagnosis.reason


def test_a_door_that_would_fall_from_where_it_begins_is_no_state_to_ask_about() -> None:
    twin = forced_twin().at({forced_twin().container("oven_door").joint: 1.0})
    verdict = judged(twin, "oven_door")
    assert verdict.outcome is Outcome.ABSTAINED
    assert "does not surely stay where it begins" in verdict.diagnoses[0].reason


def test_a_failure_for_every_value_outweighs_what_is_left_open() -> None:
    answer = answered(edited(RUNNERS, latchForce=(176, 200), springStiffness=(10, 60)))
    assert [each.kind for each in answer.diagnoses] == [Kind.CAUSAL]
    assert any("may move shut" in note for note in answer.notes)


def test_a_motion_is_made_slower_where_that_spares_force() -> None:
    heavy = edited(RUNNERS, movedMass=(60, 60))
    quick, slow = answered(forced_twin()).case.motion, answered(heavy).case.motion
    assert isinstance(quick, Motion)
    assert isinstance(slow, Motion)
    assert slow.times[-1] == pytest.approx(2 * quick.times[-1])


def test_modes_agree_about_forces() -> None:
    made = answered(forced_twin())
    assert isinstance(made.case.motion, Motion)
    (again,) = causes(replace(asked(forced_twin()), motion=made.case.motion), PHYSICS)
    assert (again.holds, again.figures) == (made.holds, made.figures)


def test_too_much_force_is_proved_for_times_that_are_demanded_only() -> None:
    heavy, motion = edited(RUNNERS, movedMass=(120, 120)), answered(forced_twin()).case.motion
    assert isinstance(motion, Motion)
    (proposed,) = causes(replace(asked(heavy), motion=motion), PHYSICS)
    (demanded,) = causes(replace(asked(heavy), motion=replace(motion, timed=True)), PHYSICS)
    assert [each.proof for each in (*proposed.diagnoses, *demanded.diagnoses)] == [False, True]


@pytest.mark.parametrize("begins", [0.0009, 0.0015, 0.00199])
@pytest.mark.parametrize("timed", [True, False])
def test_a_motion_that_begins_beyond_a_latch_does_not_spare_the_container_that(
    begins: float, timed: bool
) -> None:
    """τ may begin up to 2 mm from where the drawer is: that is where the latch holds it."""
    twin = edited(RUNNERS, latchForce=(100, 120), latchWidth=0.001)
    drawer = twin.container("top_drawer")
    values = np.array([[begins], [drawer.upper / 2], [drawer.upper]])
    motion = Motion(drawer.joint, np.array([0.0, 2.0, 4.0]), values, timed)
    assert forced(PHYSICS.mechanics(twin, drawer), drawer, motion).figures["handle force, at most"][0] < 60
    (answer,) = causes(replace(asked(twin), motion=motion), PHYSICS)
    assert [each.kind for each in answer.diagnoses] == [Kind.OUT_OF_SCOPE]
    assert "leave open whether top_drawer needs more than 60 N" in answer.diagnoses[0].reason


def test_a_motion_that_begins_in_a_latch_proves_nothing_of_a_container_beyond_it() -> None:
    joint = forced_twin().container("top_drawer").joint
    twin = edited(RUNNERS, latchForce=(100, 120), latchWidth=0.001).at({joint: 0.0015})
    motion = Motion(joint, np.array([0.0, 2.0, 4.0]), np.array([[0.0], [0.2], [0.45]]))
    (answer,) = causes(replace(asked(twin), motion=motion), PHYSICS)
    assert [(each.kind, each.proof) for each in answer.diagnoses] == [(Kind.OUT_OF_SCOPE, False)]


def test_the_verdict_says_its_class_and_that_of_d_artic_is_what_it_was() -> None:
    (kinematic,) = law(asked(small_twin("b")), Kinematics())
    dynamic = judged(forced_twin())
    assert dict(kinematic.inputs)["tee_class"] == D_ARTIC.content_hash
    assert dict(dynamic.inputs)["tee_class"] == D_ARTIC_DYN.content_hash
    assert (to_json(kinematic)["tee_class"], to_json(dynamic)["tee_class"]) == ("D_artic", "D_artic_dyn")
    for verdict, tee in ((kinematic, D_ARTIC), (dynamic, D_ARTIC_DYN)):
        said = [value for _, name, value in to_record(verdict).triples if name == LAW + "teeClass"]
        assert [each.value for each in said] == [tee.iri]
    (same,) = law(asked(forced_twin()), Kinematics())
    assert len({kinematic.iri, dynamic.iri, same.iri}) == 3


def test_force_data_change_no_verdict_of_d_artic() -> None:
    plain, forced = load(FOLDER / "b.urdf"), load(FOLDER / "b.urdf").with_forces(DATA)
    assert plain.twin.content_hash(plain.twin.environment) != forced.twin.content_hash(
        forced.twin.environment
    )
    assert (
        load("b").twin.entities.facts.all(
            "https://example.org/id/b/joint/iai_fridge_door_joint", "hasForceModel"
        )
        == []
    )


def test_force_data_of_another_kitchen_are_refused(tmp_path: Path) -> None:
    with pytest.raises(AnnotationError, match="moves no container of a"):
        with_forces(small_twin("a"), DATA)
    (tmp_path / "no.ttl").write_text("<https://example.org/x> a <https://example.org/y> .")
    with pytest.raises(AnnotationError, match="gives no joint a force model"):
        with_forces(small_twin("b"), tmp_path / "no.ttl")
    assert with_forces(small_twin("b")) is small_twin("b")


def test_other_oracles_know_no_forces() -> None:
    service = replace(load(FOLDER / "b.urdf"), oracles=load(FOLDER / "b.urdf").with_forces(DATA).oracles)
    with pytest.raises(InputError, match="know no forces"):
        service.with_forces(DATA)
