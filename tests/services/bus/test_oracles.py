"""The same contract in process and over several processes with a router between."""

import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from multiprocessing.process import BaseProcess

import numpy as np
import pytest

from predicates.case import Case, Outcome, Verdict
from predicates.satisfies_request import demanded
from sdt_kg.errors import GraphError, InputError, OracleUnavailableError
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task, Verb
from services.app import Policy, Service, load, whole_body
from services.bus.keys import Oracle
from services.bus.oracles.codec import policy_plain, twin_key
from services.bus.oracles.handler import Causing, Twins, UnknownTwinError
from services.bus.oracles.remote import BusOracles
from services.bus.oracles.server import oracle
from services.bus.sessions import open_session
from services.judging.codec import CBOR, to_cbor
from services.judging.problems import Problem, ProblemType
from services.judging.workers.jobs import Task as Asked
from tests.ports import free_endpoint
from tests.services.bus.routed import START, routed

pytestmark = pytest.mark.oracle

DRAWER = "sink_area_left_middle_drawer_main"
Routed = tuple[BusOracles, list[BaseProcess]]


@pytest.fixture(scope="module")
def on_bus() -> Iterator[Routed]:
    endpoint = free_endpoint()
    with routed(endpoint, ("causes", "canperform", "canperform")) as processes:
        session = open_session(connect=endpoint, mode="client")
        oracles = BusOracles.on(session)
        until = time.monotonic() + START
        while len(oracles.canperform.instances()) < 2 or not oracles.causes.instances():
            assert time.monotonic() < until, "the oracles did not come"
            time.sleep(0.2)
        yield oracles, processes
        session.close()


@pytest.fixture(scope="module")
def here() -> Service:
    return load("b", ["pr2"], policy=Policy(budget=20.0))


def test_physics_answers_alike_over_several_processes(here: Service, on_bus: Routed) -> None:
    _physics_answers_alike(here, on_bus[0])


def test_physics_answers_alike_over_a_bus_within_this_process(here: Service) -> None:
    with open_session(listen=free_endpoint()) as session, oracle(session, Oracle.CAUSES):
        _physics_answers_alike(here, BusOracles.on(session))


def _physics_answers_alike(here: Service, oracles: BusOracles) -> None:
    there = oracles.physics()
    container = here.twin.container(DRAWER)
    assert there.version == here.physics.version
    goal = demanded(container, Verb.OPEN)
    (ours,), (theirs,) = (list(each.generate(here.twin, goal)) for each in (here.physics, there))
    assert np.array_equal(ours.values, theirs.values)
    assert here.physics.replay(here.twin, ours).final == there.replay(here.twin, theirs).final
    beyond = replace(ours, values=ours.values * 3)
    assert here.physics.replay(here.twin, beyond).violations == there.replay(here.twin, beyond).violations
    with pytest.raises(InputError):
        there.replay(here.twin, replace(ours, of="https://example.org/id/nothing"))


def test_verdicts_are_the_same_and_the_work_is_shared(here: Service, on_bus: Routed) -> None:
    oracles, _ = on_bus
    ours, theirs = (_judged(each, DRAWER) for each in (here, replace(here, oracles=oracles)))
    assert (ours.iri, ours.outcome, ours.diagnoses) == (theirs.iri, theirs.outcome, theirs.diagnoses)
    assert isinstance(theirs.case.body_motion, BodyMotion)
    assert theirs.can_perform is not None
    assert theirs.can_perform.artefact is not None
    assert len(oracles.canperform.asked) == 2, "each of the two was asked"


def test_an_oracle_judges_under_the_whole_policy_that_it_is_sent(here: Service, on_bus: Routed) -> None:
    robot = here.twin.robots[0]
    policies = (
        Policy(any_start=True),
        Policy(contact=0.001, friction=0.4),
        Policy(seed=3, base=(0.5, 0.0, 0.0)),
    )
    for policy in policies:
        there = on_bus[0].embodiment(policy)
        assert there.settings(here.twin, robot) == whole_body(policy).settings(here.twin, robot)


def test_an_oracle_that_has_just_come_gets_its_share_and_no_more(on_bus: Routed) -> None:
    callers = replace(on_bus[0].canperform, asked=Counter())
    long_there, new = callers.instances()
    callers.asked[long_there] = 1000
    for _ in range(4):
        callers.call("version", None, str, policy=policy_plain(Policy()))
    assert callers.asked == {long_there: 1002, new: 1002}


def test_a_twin_that_was_edited_is_judged_as_edited(here: Service, on_bus: Routed) -> None:
    joint = here.twin.container(DRAWER).joint
    edited = here.twin.with_edit(joint, upperLimit=0.2)
    there = replace(here, twin=edited, oracles=on_bus[0])
    (answer,) = there.causes(Task(Verb.OPEN, here.twin.container(DRAWER).iri))
    assert isinstance(answer.case.motion, Motion)
    assert answer.case.motion.values.max() <= 0.2


def test_a_twin_that_is_sent_under_the_key_of_another_is_refused(here: Service) -> None:
    # Who asks next sends the key alone, and would be answered about the kitchen that was sent.
    edited = here.twin.with_edit(here.twin.container(DRAWER).joint, upperLimit=0.2)
    sent = {"quads": edited.serialize("nquads"), "environment": edited.environment, "robots": edited.robots}
    twins = Twins()
    with pytest.raises(GraphError, match="and the key is"):
        twins.of({"key": twin_key(here.twin), "state": {}, **sent})
    with pytest.raises(UnknownTwinError):
        twins.of({"key": twin_key(here.twin), "state": {}})
    assert twin_key(twins.of({"key": twin_key(edited), "state": {}, **sent})) == twin_key(edited)


def test_a_twin_that_an_oracle_cannot_read_is_no_fault_of_who_asked(here: Service) -> None:
    quads = [each for each in here.twin.serialize("nquads").splitlines() if b"openFrom" not in each]
    sent = {"quads": b"\n".join(quads), "environment": here.twin.environment, "robots": here.twin.robots}
    asked = {"version": here.physics.version, "twin": {"key": "k", "state": {}, **sent}}
    found = Causing()(Asked("b", "replay", to_cbor(asked), CBOR, 60.0), lambda _: None)
    assert isinstance(found, Problem)
    assert found.kind is ProblemType.CONFLICT
    assert "this oracle cannot read that twin" in found.detail


def test_who_has_another_version_than_the_verdict_would_name_does_not_judge(
    here: Service, on_bus: Routed
) -> None:
    container = here.twin.container(DRAWER)
    physics, body = on_bus[0].physics(), on_bus[0].embodiment(Policy())
    for there, asked in (
        (physics, lambda: list(physics.generate(here.twin, demanded(container, Verb.OPEN)))),
        (body, lambda: body.settings(here.twin, here.twin.robots[0])),
    ):
        there.pinned.told = "one before"
        with pytest.raises(OracleUnavailableError, match="and 'one before' is asked"):
            asked()
        assert there.version != "one before"
        assert asked()


def test_oracles_judge_with_forces_as_this_process_does(here: Service, on_bus: Routed) -> None:
    ours = here.with_forces()
    theirs = replace(ours, oracles=on_bus[0].with_forces())
    assert ours.embodiment.version == theirs.embodiment.version
    mine, its = (_judged(each, DRAWER) for each in (ours, theirs))
    assert mine.outcome is Outcome.CERTIFIED
    assert (mine.iri, mine.outcome) == (its.iri, its.outcome)
    assert mine.causes is not None
    assert its.causes is not None
    assert mine.causes.figures
    assert (mine.causes.notes, mine.causes.figures) == (its.causes.notes, its.causes.figures)


def test_a_force_that_is_not_allowed_is_refused_by_an_oracle_too(here: Service, on_bus: Routed) -> None:
    there = replace(here, oracles=on_bus[0]).with_forces(handle_force=2.0)
    (answer,) = there.causes(f"open:{DRAWER}")
    assert "where 2 N is allowed" in answer.diagnoses[0].reason


def test_an_oracle_refuses_a_question_or_class_that_it_does_not_know(on_bus: Routed) -> None:
    causes = on_bus[0].causes
    for asked in ("dance", "version;d_other"):
        with pytest.raises(InputError, match=asked.rpartition(";")[2]):
            causes.call(asked, None, str)


def test_a_dead_oracle_is_noticed_and_another_asked_until_there_is_none(
    here: Service, on_bus: Routed
) -> None:
    oracles, processes = on_bus
    there = replace(here, oracles=oracles)
    task = f"open:{DRAWER}"
    processes[1].kill()
    assert next(there.achieve(task)).outcome == _judged(here, DRAWER).outcome
    processes[2].kill()
    with pytest.raises(OracleUnavailableError, match="canperform"):
        next(there.achieve(task))


def _judged(service: Service, container: str) -> Verdict:
    (verdict,) = service.achieve(f"open:{container}")
    assert isinstance(verdict.case, Case)
    return verdict
