"""`sdt why`: a stored verdict in plain words that say neither more nor less than the verdict."""

from dataclasses import replace

import numpy as np
import pyoxigraph as ox
import pytest

from predicates.case import Case, Diagnosis, Evidence, Kind, Outcome, Quantity, Search, Verdict
from predicates.law import law
from predicates.record import to_record, write
from predicates.scope import outside
from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import local_name
from sdt_kg.motion import Motion
from sdt_kg.scope import D_ARTIC, violations
from sdt_kg.task import Task, Verb
from services.dynamics.oracle import Dynamics
from services.embodiment.certify.tolerances import Tolerances
from services.physics.oracle import Kinematics
from services.versions import KINEMATICS_VERSION
from services.why import used, why
from services.why.words import reasons
from tests.small import small_twin
from tests.small.before import Before
from tests.small.lift import Lift

TWIN = small_twin("a", ("pr2", "stretch"))


def verdict(container: str, robot: int = 0, **known: object) -> Verdict:
    task = Task(Verb.OPEN, TWIN.container(container).iri)
    case = replace(Case(TWIN, robot=TWIN.robots[robot], task=task), **known)  # type: ignore[arg-type]
    (made,) = law(case, Kinematics(), Lift())
    return made


def stored(*verdicts: Verdict) -> ox.Store:
    store = ox.Store()
    for each in verdicts:
        write(store, to_record(each))
    return store


def told(of: Verdict) -> str:
    return why(stored(of), of.iri)


def test_a_certificate_is_told_with_drive_start_answers_and_margins() -> None:
    text = told(verdict("low_drawer"))
    assert text.startswith("Can pr2 open low_drawer in kitchen a? CERTIFIED\nAll three predicates hold;")
    assert "Relative to D_artic" in text
    assert "robot: pr2, its base moves: omni" in text
    assert "kitchen: everything at its start" in text
    assert "motion: to be found" in text
    for name in ("SatisfiesRequest", "Causes", "CanPerform"):
        assert f"\n{name}: yes" in text
    assert "answered by lift 1" in text
    assert "margin: 0 m" in text
    assert "Reasons" not in text


def test_what_another_version_judged_is_told_as_outdated_with_what_to_do() -> None:
    task = Task(Verb.OPEN, TWIN.container("low_drawer").iri)
    (made,) = law(Case(TWIN, robot=TWIN.robots[0], task=task), Before(), Lift())
    title, means, then, *_ = told(made).splitlines()
    assert title == "Can pr2 open low_drawer in kitchen a? OUTDATED, WAS CERTIFIED"
    assert means.startswith("All three predicates hold;")
    assert then.startswith(f"Judged by kinematics 0 (here {KINEMATICS_VERSION}): this is not the answer")
    assert "Ask again, and it is judged anew" in then


def test_a_proof_is_told_as_a_proof_with_its_measurement() -> None:
    text = told(verdict("high_drawer", 1))
    assert "NOT CERTIFIED" in text.splitlines()[0]
    assert "excludes every motion of the class D_artic" in text
    assert "1. embodiment: the handle of high_drawer needs the lift at 1.3 m" in text
    assert "measured: position of lift_joint 1.3 m, compared with 0.98 m" in text
    assert "\n  proved" in text


def test_of_a_proof_that_is_a_calculation_nobody_is_told_that_it_is_none_or_that_it_is_kept() -> None:
    low = TWIN.container("low_drawer")
    already = replace(
        Case(TWIN.at({low.joint: low.upper}), robot=TWIN.robots[0]), task=Task(Verb.OPEN, low.iri)
    )
    (made,) = law(already, Kinematics(), Lift())
    text = told(made)
    assert "nothing to cause" in text
    assert "\n  proved\n" in text
    assert "no certificate or proof goes with this verdict: what it calls proved is a calculation" in text
    assert "neither certificate nor proof" not in text


def test_of_a_refusal_that_proves_nothing_it_is_told_that_nothing_is_kept() -> None:
    made = verdict("low_drawer")
    gave_up = Diagnosis(Kind.EMBODIMENT, "no placement found", search=Search(5, 2, 3, 1.25))
    text = told(replace(made, outcome=Outcome.NOT_CERTIFIED, diagnoses=(gave_up,)))
    assert "neither certificate nor proof goes with this verdict" in text
    assert "calculation" not in text


def test_a_search_that_gave_up_is_never_told_as_a_proof() -> None:
    gave_up = Diagnosis(Kind.EMBODIMENT, "no placement found", search=Search(5, 2, 3, 1.25))
    text = told(replace(verdict("low_drawer"), outcome=Outcome.NOT_CERTIFIED, diagnoses=(gave_up,)))
    assert "Nothing is proved: the search gave up" in text
    tried = "5 postures at the handle, 2 ways to follow it, 3 ways to come to it"
    assert f"not proved: searched {tried} in 1.2 s, then gave up" in text
    assert str(Search(1, 1, 1, 0.5)).startswith("searched 1 posture at the handle, 1 way to follow it, 1 way")
    assert "\n  proved" not in text
    assert str(Search(seconds=0.09)) == "searched 0.1 s, and found no hold to try"


def test_a_measured_refusal_tells_of_no_search_where_none_was_made() -> None:
    deep = Evidence(Quantity.DISTANCE, -0.0128, 0.0, "m")
    measured = Diagnosis(Kind.EMBODIMENT, "base_link and crate are 12.8 mm in each other", deep)
    text = told(replace(verdict("low_drawer"), outcome=Outcome.NOT_CERTIFIED, diagnoses=(measured,)))
    assert "Nothing is proved: this was measured of what was tried; another" in text
    assert "measured: distance -0.0128 m, at least 0 m needed" in text
    assert "  of this motion and start; of others nothing is proved" in text
    assert "not proved" not in text
    assert "search" not in text


def test_a_proof_about_a_given_motion_says_nothing_of_other_motions() -> None:
    joint = TWIN.container("low_drawer").joint
    ajar = Motion(joint, np.array([0.0, 2.0]), np.array([[0.0], [0.1]]))
    text = told(verdict("low_drawer", motion=ajar))
    assert "motion: the container's motion was given, to be verified" in text
    assert "Proved of the motion that was given; another motion may still do it." in text
    assert "every motion" not in text
    assert "--motion FILE" in text


def test_an_abstention_is_told_with_the_shacl_result_and_claims_nothing() -> None:
    text = told(verdict("swing_door"))
    assert "nothing is claimed: neither that it can be done nor that it cannot" in text
    assert "SHACL result: swing_door_joint, property lowerLimit, shape JointShape-lowerLimit" in text
    assert "value -1, demanded: at least 0" in text
    assert "not proved" not in text
    assert "CanPerform: not asked" in text


def test_figures_of_a_shacl_result_are_told_with_as_many_digits_as_it_takes() -> None:
    found = replace(next(iter(violations(TWIN, TWIN.container("swing_door")))), value=32.00267674901752)
    about = [outside(replace(found, bound=each), D_ARTIC) for each in (30.0, 32.0026767)]
    lines = [line for line in reasons(about) if "demanded" in line]
    assert [line.strip() for line in lines] == [
        "value 32.0027, demanded: at least 30",
        "value 32.00267675, demanded: at least 32.0026767",
    ]


def test_reasons_beside_one_that_is_out_of_scope_are_neither_proved_nor_said_not_to_be() -> None:
    door = TWIN.container("swing_door")
    text = told(verdict("swing_door", twin=TWIN.at({door.joint: door.upper})))
    assert "nothing to cause: swing_door" in text
    assert "proved" not in text.partition("To check again")[0]


def test_joints_elsewhere_are_told_and_go_into_the_command() -> None:
    text = told(verdict("low_drawer", twin=TWIN.at({TWIN.container("side_door").joint: 0.25})))
    assert "kitchen: side_door_joint at 0.25, all else at its start" in text
    assert "--state side_door_joint=0.25 --drive omni" in text


def test_versions_and_inputs_are_all_told() -> None:
    made = verdict("low_drawer")
    text = told(made)
    assert all(
        value.replace("https://example.org/id/", "") in text for _, value in made.inputs if value != "unknown"
    )


def test_a_verdict_is_found_by_the_beginning_of_its_hash_if_that_is_one() -> None:
    one, other = verdict("low_drawer"), verdict("side_door")
    store = stored(one, other)
    assert why(store, local_name(one.iri)[:10]) == why(store, one.iri)
    assert why(list(store), one.iri) == why(store, one.iri)
    for unknown in ("", "zzz", "https://example.org/id/verdict/zz"):
        with pytest.raises(
            UnknownEntityError, match=r"no verdict named.*edited worlds are not kept: .sdt whatif"
        ):
            why(store, unknown)


STARTS = {
    "0, 1, 0, turned to the handle": (
        "x 0 m, y 1 m, turned to the handle, arms parked",
        "--drive omni --budget 1.0 --seed 0",
    ),
    "0, 1, 0.5": ("x 0 m, y 1 m, yaw 0.5 rad, arms parked", "--base 0,1,0.5"),
    "where and as the motion begins": ("where and as the motion begins", "--any-start"),
}


def test_a_class_and_a_tolerance_go_into_the_command() -> None:
    class Loose(Lift):
        def settings(self, twin, robot):
            return (*super().settings(twin, robot), ("tolerances", repr(Tolerances.within(0.001, 0.3))))

    case = Case(TWIN, robot=TWIN.robots[0], task=Task(Verb.OPEN, TWIN.container("low_drawer").iri))
    (loose,) = law(case, Kinematics(), Loose())
    assert "--contact-tolerance 0.001 --friction 0.3" in told(loose)
    (forced,) = law(case, Dynamics(), Lift())
    assert "--tee d_artic_dyn --drive" in told(forced)
    usual = told(verdict("low_drawer"))
    assert "--tee" not in usual
    assert "--contact-tolerance" not in usual
    assert "--friction" not in usual


@pytest.mark.parametrize("start", STARTS)
def test_every_start_is_told_and_goes_into_the_command(start: str) -> None:
    class Starting(Lift):
        def settings(self, twin, robot):
            return (*super().settings(twin, robot), ("start", start), ("seed", "0"))

    case = Case(TWIN, robot=TWIN.robots[0], task=Task(Verb.OPEN, TWIN.container("low_drawer").iri))
    (made,) = law(case, Kinematics(), Starting())
    text, (words, options) = told(made), STARTS[start]
    assert f"start of the base: {words}\n" in text
    assert options in text


def test_settings_are_told_as_people_write_them_and_other_inputs_as_they_are() -> None:
    hashed = (
        ("embodiment.tolerances", repr(replace(Tolerances(), facing=0.5))),
        ("embodiment.grasp set", "0123(a=1)"),
        ("body_motion", "unknown"),
    )
    (name, tolerances), grasps = used(hashed)
    assert name == "tolerances"
    assert tolerances.startswith(
        "margin 0, resolution 0.0001, contact 0.002, depth 0.002, engaged 0.003, facing 0.5,"
    )
    assert tolerances.endswith("drift 0.01 (SI units)")
    assert grasps == ("grasp set", "0123(a=1)")
