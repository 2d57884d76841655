"""A record explains itself: the answer of each predicate, and for an abstention the SHACL report."""

import pyoxigraph as ox
import pytest

from predicates.case import Case, Verdict
from predicates.law import law
from predicates.record import read_verdicts, to_record, write
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, PREFIXES, local_name
from sdt_kg.store import rows_of
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.lift import Lift

TWIN = small_twin("a", ("pr2", "stretch"))


def verdict(container: str, robot: int = 0) -> Verdict:
    task = Task(Verb.OPEN, TWIN.container(container).iri)
    (made,) = law(Case(TWIN, robot=TWIN.robots[robot], task=task), Kinematics(), Lift())
    return made


def rows(of: Verdict, pattern: str) -> list[dict[str, object]]:
    store = ox.Store()
    write(store, to_record(of))
    query = f"SELECT * WHERE {{ {pattern} }}"
    return rows_of(store.query(query, prefixes=PREFIXES, use_default_graph_as_union=True))[1]


@pytest.mark.parametrize(
    ("container", "robot", "performed"), [("low_drawer", 0, True), ("high_drawer", 1, False)]
)
def test_each_predicate_answers_with_version_and_seconds(container: str, robot: int, performed: bool) -> None:
    found = rows(
        verdict(container, robot),
        "?v law:answer ?a . ?a law:predicate ?p ; law:holds ?holds ; law:version ?version ; law:seconds ?s",
    )
    assert {local_name(str(row["p"])): row["holds"] for row in found} == {
        "SatisfiesRequest": True,
        "Causes": True,
        "CanPerform": performed,
    }
    versions = {local_name(str(row["p"])): str(row["version"]) for row in found}
    assert versions["CanPerform"] == "lift 1"
    assert versions["Causes"].startswith("kinematics ")
    assert versions["SatisfiesRequest"].startswith("satisfied_requests.rq ")
    assert all(isinstance(row["s"], float) and row["s"] > 0 for row in found)


@pytest.mark.parametrize(
    ("container", "robot", "before"),
    [
        # The robot executes slower than was proposed: Causes is then about what it executes.
        ("low_drawer", 0, {("SatisfiesRequest", "Causes"), ("Causes", "CanPerform")}),
        ("high_drawer", 1, {("SatisfiesRequest", "Causes"), ("CanPerform", "Causes")}),
    ],
)
def test_an_answer_is_derived_from_the_one_whose_motion_it_judges(
    container: str, robot: int, before: set[tuple[str, str]]
) -> None:
    pattern = "?a law:predicate ?p ; prov:wasDerivedFrom ?b . ?b law:predicate ?q"
    found = rows(verdict(container, robot), pattern)
    assert {(local_name(str(row["p"])), local_name(str(row["q"]))) for row in found} == before


def test_an_answer_is_derived_from_the_inputs_that_it_uses() -> None:
    pattern = "?a law:predicate law:CanPerform ; prov:wasDerivedFrom/law:name ?name"
    names = {row["name"] for row in rows(verdict("high_drawer", 1), pattern)}
    assert names == {"environment", "state", "robot", "embodiment", "embodiment.drive", "embodiment.budget"}


def test_a_refusal_without_a_robot_has_no_answer_of_can_perform() -> None:
    task = Task(Verb.OPEN, TWIN.container("low_drawer").iri)
    (made,) = law(Case(TWIN, task=task), Kinematics())
    found = rows(made, "?v law:answer/law:predicate ?p")
    assert {local_name(str(row["p"])) for row in found} == {"SatisfiesRequest", "Causes"}


def test_joints_elsewhere_than_at_the_start_are_recorded() -> None:
    joint = TWIN.container("side_door").joint
    task = Task(Verb.OPEN, TWIN.container("low_drawer").iri)
    (made,) = law(Case(TWIN.at({joint: 0.25}), task=task), Kinematics())
    (row,) = rows(made, "?v law:jointPosition ?p . ?p law:entity ?joint ; law:value ?at")
    assert (row["joint"], row["at"]) == (joint, 0.25)
    assert rows(verdict("low_drawer"), "?v law:jointPosition ?p") == []


@pytest.mark.parametrize("term", ["reason", "proof", "outcome"])
def test_a_record_that_says_something_else_than_when_it_was_written_is_refused(term: str) -> None:
    store = ox.Store()
    record = to_record(verdict("high_drawer", 1))
    write(store, record)
    (quad,) = store.quads_for_pattern(None, ox.NamedNode(LAW + term), None, None)
    store.remove(quad)
    other = {"proof": ox.Literal(False), "outcome": ox.NamedNode(LAW + "Abstained")}
    changed = other.get(term, ox.Literal("something else"))
    store.add(ox.Quad(quad.subject, quad.predicate, changed, quad.graph_name))
    with pytest.raises(InputError, match="was changed after it was written"):
        list(read_verdicts(store))


@pytest.mark.parametrize("lost", ["outcome", "environment", "reason", "bound"])
def test_a_damaged_record_is_refused_with_what_is_missing(lost: str) -> None:
    store = ox.Store()
    write(store, to_record(verdict("high_drawer", 1)))
    for quad in list(store.quads_for_pattern(None, ox.NamedNode(LAW + lost), None, None)):
        store.remove(quad)
    with pytest.raises(InputError, match=f"damaged: .*{lost}"):
        list(read_verdicts(store))


def test_an_abstention_carries_its_shacl_report() -> None:
    made = verdict("swing_door")
    assert rows(made, "?v law:answer ?a") == []
    found = rows(
        made,
        """?v law:scopeReport ?report ; law:diagnosis/prov:wasDerivedFrom ?result .
        ?report sh:conforms false ; sh:result ?result .
        ?result sh:focusNode ?focus ; sh:resultPath ?path ; sh:value ?value ; law:demanded ?bound ;
          sh:resultMessage ?message ; sh:sourceShape ?shape ; sh:sourceConstraintComponent ?component""",
    )
    assert {(row["path"], row["value"], row["bound"]) for row in found} == {
        ("https://example.org/sdt#lowerLimit", -1.0, 0),
        ("https://example.org/sdt#effectiveLowerLimit", -1.0, 0),
    }
    assert {row["focus"] for row in found} == {TWIN.container("swing_door").joint}
    assert {local_name(str(row["shape"])) for row in found} == {
        "JointShape-lowerLimit",
        "JointShape-effectiveLowerLimit",
    }


def test_the_shacl_results_are_read_back_exactly() -> None:
    made = verdict("swing_door")
    store = ox.Store()
    write(store, to_record(made))
    (read,) = read_verdicts(store)
    assert read.diagnoses == made.diagnoses
    assert [each.violation for each in read.diagnoses] != [None, None]
