"""Tasks relative to D_artic_dyn: what moves when it is let go, and what the intervals leave open."""

import pyoxigraph as ox
import pytest

from predicates.case import Kind, Outcome
from predicates.oracle import Embodiment, Physics
from predicates.specification.read import read_specification
from predicates.specification.results.record import task_record
from predicates.specification.rules import Standing
from sdt_kg.entities import Replacement
from sdt_kg.twin import Twin
from services.app import Policy, Service
from services.dynamics.data import HAS_FORCE_MODEL, with_forces
from services.dynamics.oracle import Dynamics
from services.dynamics.robot.bearing import Bearing
from services.specifications import TaskResult, achieve_task
from services.why import why
from tests.services.dynamics.forced import HINGE, RUNNERS, edited, forced_twin
from tests.small.lift import Lift

OVEN = "https://example.org/id/b/joint/oven_door_joint"
HEAD = "@prefix law: <https://example.org/law#> . @prefix t: <https://example.org/id/t/> ."
STEP = 't:{0} a law:Task ; law:index {0} ; law:verb law:Open ; law:containerName "{1}" {2} .'


class Forces:
    """Both oracles of D_artic_dyn."""

    def physics(self) -> Physics:
        return Dynamics()

    def embodiment(self, policy: Policy) -> Embodiment:
        return Bearing(Lift())


def run(twin: Twin, *steps: tuple[str, str], keeps: str = "") -> TaskResult:
    """The result of steps that open containers, each by its name and what else is said of it."""
    names = " , ".join(f"t:{k}" for k in range(1, len(steps) + 1))
    told = [STEP.format(k, *step) for k, step in enumerate(steps, 1)]
    rule = "; law:keeps t:rule . t:rule a law:NeverBeyond ; " + keeps if keeps else ""
    text = "\n".join([HEAD, f"t:task a law:TaskSpecification ; law:hasStep {names} {rule} .", *told])
    service = Service(twin, oracles=Forces(), policy=Policy())
    return achieve_task(service, read_specification(twin, text, "task.ttl"))


DOOR, DRAWER = ("oven_door", ""), ("top_drawer", "")


def test_no_step_begins_where_a_door_was_let_go_that_falls_further_open() -> None:
    twin = forced_twin(("pr2",))
    found = run(twin, DOOR, DRAWER)
    assert [each.verdict.outcome for each in found.steps] == [Outcome.CERTIFIED]
    assert (found.outcome, found.of) == (Outcome.ABSTAINED, 2)
    (diagnosis,) = found.diagnoses
    assert (diagnosis.kind, diagnosis.proof) == (Kind.OUT_OF_SCOPE, False)
    assert "oven_door may move when it is let go after 'open oven_door'" in diagnosis.reason
    assert run(twin, DRAWER, DOOR).outcome is Outcome.CERTIFIED, (
        "the drawer stays, and nothing follows the door"
    )


@pytest.mark.parametrize(("of", "outcome"), [(DOOR, Outcome.ABSTAINED), (DRAWER, Outcome.CERTIFIED)])
def test_rules_are_not_bounded_once_a_door_is_let_go_that_falls(
    of: tuple[str, str], outcome: Outcome
) -> None:
    keeps = 'law:containerName "oven_door" ; law:limitPosition 1.4'
    assert run(forced_twin(("pr2",)), of, keeps=keeps).outcome is outcome


def test_rules_are_not_bounded_while_a_door_that_nobody_holds_may_fall() -> None:
    twin = edited(HINGE, forced_twin(("pr2",)), breakAwayFriction=(2.0, 60.0))
    ajar = twin.at({twin.container("oven_door").joint: 1.2})
    keeps = 'law:containerName "oven_door" ; law:limitPosition 1.25'
    found = run(ajar, DRAWER, keeps=keeps)
    assert (found.outcome, found.steps[0].verdict.outcome) == (Outcome.ABSTAINED, Outcome.CERTIFIED)
    (diagnosis,) = found.diagnoses
    assert (diagnosis.kind, diagnosis.proof) == (Kind.OUT_OF_SCOPE, False)
    assert "that nobody holds may move by itself in 'open top_drawer'" in diagnosis.reason
    assert run(ajar, DRAWER).outcome is Outcome.CERTIFIED, "it is taken to stay, and the verdict says so"
    assert run(twin, DRAWER, keeps=keeps).outcome is Outcome.CERTIFIED, "closed, it stays"


def test_a_rule_about_a_container_without_a_force_model_is_not_told_as_kept() -> None:
    only_drawer = Replacement(
        forced_twin().environment,
        frozenset({(OVEN, HAS_FORCE_MODEL, ox.NamedNode(HINGE))}),
        frozenset(),
        "the oven's force model is not known",
    )
    twin = forced_twin(("pr2",)).rewritten(only_drawer)
    found = run(twin, DRAWER, keeps='law:containerName "oven_door" ; law:limitPosition 1.4')
    assert (found.outcome, found.steps[0].verdict.outcome) == (Outcome.ABSTAINED, Outcome.CERTIFIED)
    assert [(each.standing, each.step) for each in found.rules] == [(Standing.UNBOUNDED, 1)]
    (diagnosis,) = found.diagnoses
    assert (diagnosis.kind, diagnosis.proof) == (Kind.OUT_OF_SCOPE, False)
    assert "it is not checked, for want of a force model, whether oven_door stays" in diagnosis.reason
    own = run(twin, DRAWER, keeps='law:containerName "top_drawer" ; law:limitPosition 0.5')
    assert own.outcome is Outcome.CERTIFIED, "what the step moves is known"


def test_a_step_to_a_position_abstains_where_the_law_does() -> None:
    twin = edited(RUNNERS, forced_twin(("pr2",)), allowedHandleForce=6.0)  # between 4 N and 8 N are needed
    for said in ("", "; law:goalPosition 0.3"):
        found = run(twin, ("top_drawer", said))
        assert (found.outcome, found.steps[0].verdict.outcome) == (Outcome.ABSTAINED, Outcome.ABSTAINED)
        assert found.steps[0].verdict.causes is None


def test_a_step_to_a_position_abstains_where_the_container_may_not_stay_when_let_go() -> None:
    """Further open than open does no harm to a request to open; a goal of 1.4 rad it leaves."""
    found = run(forced_twin(("pr2",)), ("oven_door", "; law:goalPosition 1.4"))
    assert (found.outcome, found.steps[0].verdict.outcome) == (Outcome.ABSTAINED, Outcome.ABSTAINED)
    assert (
        "may move when it is let go at 1.4, and leave [1.398, 1.402]"
        in found.steps[0].verdict.diagnoses[0].reason
    )
    assert run(forced_twin(("pr2",)), ("top_drawer", "; law:goalPosition 0.3")).outcome is Outcome.CERTIFIED


def test_a_stored_result_tells_how_to_ask_with_the_class_and_handle_force_of_then() -> None:
    for force, told in ((None, "--tee d_artic_dyn"), (70.0, "--tee d_artic_dyn --handle-force 70.0")):
        result = run(with_forces(forced_twin(("pr2",)), handle_force=force), DRAWER)
        store = ox.Store()
        store.extend(task_record(result).quads())
        asked = f"sdt task FILE --kitchen b --robot pr2 {told}"
        assert asked in why(store, result.iri).splitlines()
