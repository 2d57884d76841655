"""Verdicts as triples: what goes in comes out, twice is once, and the IRI is a hash of the inputs."""

import json
from dataclasses import replace

import pyoxigraph as ox
import pytest

from predicates.case import Case, Code, Diagnosis, Evidence, Kind, Outcome, Quantity, Search, Verdict
from predicates.law import law
from predicates.margins import LOOKED_UP_TO
from predicates.record import diagnosis_json, read_verdicts, to_json, to_record, write
from predicates.record.report import told_evidence
from sdt_kg.errors import InputError
from sdt_kg.iri import ID, LAW
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.far import NEAR_ITSELF, TO_ITSELF, TO_KITCHEN, Far, nearest
from tests.small.lift import Lift

TWIN = small_twin("a", ("pr2", "stretch"))
KEYS = [
    "kitchen",
    "robot",
    "task",
    "container",
    "state",
    "outcome",
    "satisfies_request",
    "causes",
    "can_perform",
    "gripper",
    "drive",
    "parked",
    "tee_class",
    "diagnoses",
    "figures",
    "at_least",
    "nearest",
    "notes",
    "times",
    "seconds",
    "stored",
    "iri",
]


class Slow(Lift):
    """The same oracle, given more time."""

    def settings(self, twin: object, robot: str) -> tuple[tuple[str, str], ...]:
        return (("drive", "omni"), ("budget", "99.0"))


class Differential(Lift):
    """The same oracle, asked about another drive."""

    def settings(self, twin: object, robot: str) -> tuple[tuple[str, str], ...]:
        return (("drive", "differential"), ("budget", "1.0"))


def verdict(container: str = "low_drawer", robot: int = 0, oracle: Lift | None = None) -> Verdict:
    task = Task(Verb.OPEN, TWIN.container(container).iri)
    (made,) = law(Case(TWIN, robot=TWIN.robots[robot], task=task), Kinematics(), oracle or Lift())
    return made


def budget(seconds: float) -> dict[str, str]:
    return {"embodiment.budget": f"{seconds:g} s"}


def searched(of: Verdict, seconds: float) -> Verdict:
    diagnosis = Diagnosis(Kind.EMBODIMENT, "no placement found", search=Search(5, 2, 3, seconds))
    return replace(of, outcome=Outcome.NOT_CERTIFIED, diagnoses=(diagnosis,))


def stored(*verdicts: Verdict) -> ox.Store:
    store = ox.Store()
    for each in verdicts:
        write(store, to_record(each))
    return store


@pytest.mark.parametrize(
    ("container", "robot", "outcome"),
    [("low_drawer", 0, "certified"), ("high_drawer", 1, "not_certified"), ("swing_door", 0, "abstained")],
)
def test_what_is_written_is_read_back(container: str, robot: int, outcome: str) -> None:
    made = verdict(container, robot)
    (read,) = read_verdicts(stored(made))
    assert read.outcome.value == outcome
    assert (read.iri, read.outcome) == (made.iri, made.outcome)
    assert (read.environment, read.robot) == (TWIN.environment, made.case.robot)
    assert (read.verb, read.container) == (Verb.OPEN, TWIN.container(container).iri)
    assert [each.reason for each in read.diagnoses] == [each.reason for each in made.diagnoses]
    assert [each.kind for each in read.diagnoses] == [each.kind for each in made.diagnoses]
    assert read.inputs == made.inputs


def test_a_reason_keeps_its_code_and_records_of_before_have_none() -> None:
    open_at_first = TWIN.at({TWIN.container("low_drawer").joint: 0.45})
    task = Task(Verb.OPEN, TWIN.container("low_drawer").iri)
    (made,) = law(Case(open_at_first, robot=TWIN.robots[0], task=task), Kinematics(), Lift())
    assert [diagnosis_json(each)["code"] for each in made.diagnoses] == ["nothing_to_cause"]
    before = replace(made, diagnoses=tuple(replace(each, code=None) for each in made.diagnoses))
    for written, codes in ((made, [Code.NOTHING_TO_CAUSE]), (before, [None])):
        (read,) = read_verdicts(stored(written))
        assert [each.code for each in read.diagnoses] == codes
        assert read.diagnoses == written.diagnoses


def test_evidence_is_read_back_exactly() -> None:
    made = verdict("high_drawer", 1)
    (read,) = read_verdicts(stored(made))
    assert read.diagnoses == made.diagnoses


def test_a_collision_keeps_links_time_and_scope() -> None:
    links = (f"{TWIN.environment}/body/wall", f"{TWIN.robots[0]}/body/base")  # alphabetical
    evidence = Evidence(Quantity.DISTANCE, -0.012, 0.001, "m", links=links, time=3.25, scope="environment")
    made = replace(
        verdict(),
        outcome=Outcome.NOT_CERTIFIED,
        diagnoses=(Diagnosis(Kind.EMBODIMENT, "base hits wall", evidence, search=Search(1, 2, 3, 0.5)),),
    )
    (read,) = read_verdicts(stored(made))
    assert read.diagnoses == made.diagnoses


def test_a_smallest_distance_keeps_its_bodies_and_time_and_records_of_before_have_none() -> None:
    made = verdict(oracle=Far())
    pair = nearest(TWIN.robots[0])
    before = replace(made, can_perform=replace(made.can_perform, nearest_pairs={}))  # pyright: ignore[reportArgumentType]  # it has one
    for written, pairs in ((made, {TO_ITSELF: pair}), (before, {})):
        (read,) = read_verdicts(stored(written))
        assert read.nearest_pairs == pairs
        assert read.figures == {TO_KITCHEN: (LOOKED_UP_TO, "m"), TO_ITSELF: (NEAR_ITSELF, "m")}
    assert to_json(made)["nearest"] == {TO_ITSELF: {"links": ["base", "carriage"], "time": pair.time}}
    assert to_json(before)["nearest"] == {}


@pytest.mark.parametrize("count", [1, 3])
def test_a_distance_is_between_two_bodies(count: int) -> None:
    written = stored(verdict(oracle=Far()))
    (first, _) = list(written.quads_for_pattern(None, ox.NamedNode(LAW + "link"), None))
    written.remove(first)
    for number in range(2 * (count // 2)):
        other = ox.NamedNode(f"{TWIN.robots[0]}/body/other_{number}")
        written.add(ox.Quad(first.subject, first.predicate, other, first.graph_name))
    with pytest.raises(InputError, match=f"it has {count} values of {LAW}link"):
        list(read_verdicts(written))


def test_a_value_beyond_its_bound_is_told_so_in_json_and_in_words() -> None:
    evidence = Evidence(Quantity.VELOCITY, 0.20000001, 0.2, "m/s", time=1.0)
    said = diagnosis_json(Diagnosis(Kind.EMBODIMENT, "too fast", evidence))["evidence"]
    assert isinstance(said, dict)
    assert (said["value"], said["bound"]) == (0.20000001, 0.2)
    assert told_evidence(said, "none") == "0.20000001 m/s, 0.2 m/s allowed"
    assert told_evidence(said | {"bound": None}, "none") == "0.2 m/s"
    assert told_evidence(said | {"value": None}, "none") == "none, 0.2 m/s allowed"


def test_writing_twice_changes_nothing() -> None:
    made = verdict()
    store = stored(made)
    before = set(store)
    assert not write(store, to_record(replace(made, seconds=made.seconds + 1)))
    assert set(store) == before


def test_a_searched_refusal_gives_way_to_a_later_answer() -> None:
    made = verdict()
    store = stored(searched(made, 1.0))
    assert write(store, to_record(made))
    (read,) = read_verdicts(store)
    assert read.outcome is Outcome.CERTIFIED


def test_a_searched_refusal_stays_where_the_later_search_was_shorter() -> None:
    made = verdict()
    longer, shorter = (
        replace(searched(made, seconds), inputs=tuple((dict(made.inputs) | budget(seconds)).items()))
        for seconds in (20.0, 5.0)
    )
    store = stored(longer)
    assert not write(store, to_record(shorter))
    store = stored(shorter)
    assert write(store, to_record(longer))


def test_a_proved_refusal_stays() -> None:
    refused = verdict("high_drawer", 1)
    store = stored(refused)
    assert not write(store, to_record(replace(refused, outcome=Outcome.CERTIFIED, diagnoses=())))


def test_no_blank_node_and_one_named_graph_for_each_verdict() -> None:
    one, other = verdict(), verdict("side_door")
    quads = list(stored(one, other))
    assert not any(isinstance(term, ox.BlankNode) for quad in quads for term in (quad.subject, quad.object))
    graphs = {quad.graph_name.value for quad in quads}  # type: ignore[union-attr]
    assert graphs == {f"{ID}graph/verdict/{each.iri.rsplit('/', 1)[1]}" for each in (one, other)}


def test_the_vocabulary_is_declared() -> None:
    import ontology  # noqa: PLC0415 - used here alone

    declared = {quad.subject.value for quad in ox.parse(path=str(ontology.path("law.ttl")))}  # type: ignore[union-attr]
    twin = TWIN.at({TWIN.container("low_drawer").joint: 0.45})
    (met,) = law(Case(twin, task=Task(Verb.OPEN, TWIN.container("low_drawer").iri)), Kinematics())
    every = (verdict("high_drawer", 1), verdict(), verdict("swing_door"), met)
    record = [to_record(each) for each in every]
    used = {predicate for each in record for _, predicate, _ in each.triples}
    used |= {
        value.value for each in record for _, _, value in each.triples if isinstance(value, ox.NamedNode)
    }
    assert {each for each in used if each.startswith(LAW)} <= declared


def test_the_iri_is_the_same_for_the_same_question_and_another_for_another() -> None:
    assert verdict().iri == verdict().iri
    assert len({verdict().iri, verdict("side_door").iri, verdict(robot=1).iri}) == 3
    assert verdict(oracle=Differential()).iri != verdict().iri


def test_a_longer_search_asks_the_same_question() -> None:
    assert verdict(oracle=Slow()).iri == verdict().iri


def test_another_state_is_another_question() -> None:
    task = Task(Verb.OPEN, TWIN.container("low_drawer").iri)
    elsewhere = TWIN.at({TWIN.container("side_door").joint: 0.1})
    (made,) = law(Case(elsewhere, robot=TWIN.robots[0], task=task), Kinematics(), Lift())
    assert made.iri != verdict().iri
    assert (to_json(made)["state"], to_json(verdict())["state"]) == ({"side_door_joint": 0.1}, {})


def test_json_has_the_keys_of_sdt_achieve_and_names_instead_of_iris() -> None:
    found = to_json(verdict("high_drawer", 1))
    assert list(found) == KEYS
    assert (found["kitchen"], found["robot"], found["container"]) == ("a", "stretch", "high_drawer")
    assert json.loads(json.dumps(found)) == found
    (diagnosis,) = found["diagnoses"]  # type: ignore[misc]
    assert diagnosis == {
        "kind": "embodiment",
        "reason": "the handle of high_drawer needs the lift at 1.3 m",
        "evidence": {
            "quantity": "position",
            "value": 1.3,
            "bound": 0.98,
            "unit": "m",
            "time": None,
            "entity": "lift_joint",
        },
        "proof": True,
        "code": None,
        "search": None,
    }


def test_abstention_carries_the_shacl_result() -> None:
    found = to_json(verdict("swing_door"))
    assert (found["satisfies_request"], found["causes"], found["can_perform"]) == (None, None, None)
    evidence = [each["evidence"] for each in found["diagnoses"]]  # type: ignore[union-attr]
    assert {"value", "bound", "entity", "path"} <= set(evidence[0])
    assert (-1.0, 0.0) in {(each["value"], each["bound"]) for each in evidence}
