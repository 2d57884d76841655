"""Joints that move together: limits that contradict each other are found, named, and out of scope."""

from pathlib import Path

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from predicates.case import Case, Kind, Outcome
from predicates.law import law
from sdt_kg.entities.coupling import Coupling
from sdt_kg.iri import LAW, joint_iri, local_name
from sdt_kg.load import load_twin
from sdt_kg.mechanism import Body, Joint, JointType, Limits, Mechanism, Mimic
from sdt_kg.scope import D_ARTIC_DYN, violations
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from tests.sdt_kg.conftest import DRAWER, Write, joint, limit, link
from tests.small.lift import Lift

ENDS = st.tuples(st.floats(-3, 3), st.floats(0.1, 3)).map(lambda at: (at[0], at[0] + at[1]))
MIMICS = st.tuples(ENDS, st.sampled_from([-3.0, -1.0, -0.5, 0.25, 1.0, 2.0]), st.floats(-2, 2))


def group(active: tuple[float, float], *followers: tuple[tuple[float, float], float, float]) -> Coupling:
    ends = [(active, None), *((each, Mimic("j0", m, o)) for each, m, o in followers)]
    joints = tuple(
        Joint(f"j{k}", JointType.REVOLUTE, "room", f"b{k}", limits=Limits(*each), mimic=mimic)
        for k, (each, mimic) in enumerate(ends)
    )
    bodies = (Body("room"), *(Body(f"b{k}") for k in range(len(ends))))
    return Coupling.of(Mechanism("k", "room", bodies, joints))


@given(ENDS, st.lists(MIMICS, min_size=1, max_size=4))
@example((0.0, 1.0), [((1.0, 2.0), 1.0, 0.0)])
@example((0.0, 1.0), [((-3.0, -3.0 * (1 - 1e-16)), -3.0, 0.0)])
@example((0.0, 1.0), [((0.0, 0.4), 1.0, 0.0), ((0.5, 1.0), 1.0, 0.0)])
def test_limits_contradict_if_and_only_if_no_state_keeps_them(active, followers) -> None:
    coupling = group(active, *followers)
    at = coupling.start()
    beyond = {
        iri: max(each.limits.lower - at[iri], at[iri] - each.limits.upper)
        for iri, each in coupling.joints.items()
    }
    worst = max(beyond.values())
    assume(not 1e-10 < worst <= 1e-8)  # as far as rounding of limits is allowed for, either may be said
    assert bool(coupling.contradictions) == (worst > 1e-8)
    for each in coupling.contradictions:
        limits = coupling.joints[each.joint].limits
        assert min(abs(each.limit - end) for end in (limits.lower, limits.upper)) < 1e-12
        assert each.joint != each.other


def kitchen(write: Write, flap: str, mimic: str = '<mimic joint="flap"/>') -> Path:
    """A drawer, and two flaps without handles of which one follows the other."""
    flaps = (
        *(link(f"flap_{k}", '<box size="0.4 0.02 0.4"/>') for k in (1, 2)),
        joint("flap", "revolute", "world", "flap_1", limit(0.0, 1.5)),
        joint("second_flap", "revolute", "world", "flap_2", flap + mimic),
    )
    return write(*DRAWER, *flaps)


def test_a_kitchen_without_a_possible_state_is_out_of_scope_whatever_is_asked(write: Write) -> None:
    twin = load_twin(kitchen(write, limit(2.0, 2.5)))
    (container,) = twin.containers()
    (found,) = violations(twin, container, verb=LAW + "Open")
    assert (local_name(found.focus), local_name(found.path or "")) == ("second_flap", "lowerLimit")
    assert (found.value, found.bound, found.component) == (2.0, 1.5, None)
    assert found.message == (
        "no state of the kitchen keeps its limits: 'second_flap' is at most 1.5 wherever 'flap' keeps its "
        "limits, and its own lower limit is 2: repair one of the two"
    )
    assert [each for each in violations(twin, container, tee=D_ARTIC_DYN) if each == found] == [found]


def test_the_law_abstains_there_before_anybody_searches(write: Write) -> None:
    class Unasked(Lift):
        def perform(self, case: Case) -> object:
            raise AssertionError("searched")

    twin = load_twin(kitchen(write, limit(2.0, 2.5)), ["pr2"])
    asked = Case(twin, robot=twin.robots[0], task=Task(Verb.OPEN, twin.containers()[0].iri))
    (verdict,) = law(asked, Kinematics(), Unasked())
    assert verdict.outcome is Outcome.ABSTAINED
    (diagnosis,) = verdict.diagnoses
    assert (diagnosis.kind, diagnosis.proof) == (Kind.OUT_OF_SCOPE, False)
    assert diagnosis.evidence is not None
    assert diagnosis.evidence.entity == joint_iri("k", "second_flap")


def test_limits_that_meet_in_one_position_contradict_nothing(write: Write) -> None:
    twin = load_twin(kitchen(write, limit(1.5, 2.5)))
    (container,) = twin.containers()
    assert violations(twin, container) == []
    assert twin.state[joint_iri("k", "second_flap")] == 1.5


@pytest.mark.parametrize(
    ("multiplier", "ends", "said"),
    [
        (
            -1,
            (0.0, 1.5),
            "'flap' mimics 'slide' with multiplier -1; 'flap' may be at 0 to 1.5, which leaves 'slide' 0 to "
            "0 of its own 0 to 0.5: let the sign of the multiplier, the axis and the limits of the two agree",
        ),
        (
            2,
            (-1.5, 0.0),
            "'flap' mimics 'slide' with multiplier -2 (in its file it has limits [-1.5, 0]: axis turned, so "
            "that positions are [0, 1.5] and count the other way); 'flap' may be at 0 to 1.5",
        ),
    ],
)
def test_a_joint_that_leaves_a_container_no_way_is_named_before_the_equation(
    write: Write, multiplier: float, ends: tuple[float, float], said: str
) -> None:
    mimic = f'<mimic joint="slide" multiplier="{multiplier}"/>'
    flap = joint("flap", "revolute", "world", "flap_1", limit(*ends) + mimic)
    twin = load_twin(write(*DRAWER, link("flap_1", '<box size="0.4 0.02 0.4"/>'), flap))
    (found,) = violations(twin, twin.containers()[0])
    assert (local_name(found.focus), local_name(found.path or "")) == ("slide", "closedTo")
    assert found.message.startswith(said)
    assert "(Eq. (8) needs" in found.message


def test_a_container_that_follows_backwards_is_told_so_with_its_lower_limit(write: Write) -> None:
    drawer = [
        part.replace("</joint>", '<mimic joint="flap" multiplier="-1"/></joint>') for part in DRAWER[3:4]
    ]
    slide = drawer[0].replace('lower="0.0"', 'lower="-0.5"')
    flap = joint("flap", "revolute", "world", "flap_1", limit(0.0, 1.5))
    parts = (*DRAWER[:3], slide, DRAWER[4], link("flap_1", '<box size="0.4 0.02 0.4"/>'), flap)
    twin = load_twin(write(*parts))
    told = {local_name(each.path or ""): each.message for each in violations(twin, twin.containers()[0])}
    assert told["lowerLimit"].startswith(
        "'slide' mimics 'flap' with multiplier -1; 'flap' may be at 0 to 1.5"
    )


def test_a_coupling_that_takes_no_way_is_not_spoken_of(write: Write) -> None:
    flap = joint("flap", "revolute", "world", "flap_1", limit(0.0, 1.5) + '<mimic joint="slide"/>')
    drawer = [part.replace('upper="0.5"', 'upper="0.005"') for part in DRAWER]
    twin = load_twin(write(*drawer, link("flap_1", '<box size="0.4 0.02 0.4"/>'), flap))
    (found,) = violations(twin, twin.containers()[0])
    assert found.message.startswith("Eq. (8) needs")
