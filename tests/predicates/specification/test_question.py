"""Tasks of one's own: what would keep every rule, or would silently not count, is refused by name."""

import pytest

from predicates.specification.read import read_specification
from predicates.specification.results.result import TaskResult
from predicates.specification.rules import Standing
from sdt_kg.errors import InputError, QueryError
from services.app import Service
from services.specifications import achieve_task
from tests.predicates.specification.test_read import TASK, read
from tests.small import small_twin
from tests.small.lift import Lifts

TWIN = small_twin("a", ("pr2",))

HEAD, _, REST = TASK.partition("t:one a law:Task")
STEP = "t:one a law:Task" + REST.partition("t:rule")[0]
FOREIGN = "PREFIX sdt: <http://example.org/sdt#> "


def written(task: str, *more: str) -> str:
    return HEAD.partition("t:task")[0] + task + "\n" + STEP + "\n".join(more)


def judged(sparql: str, over: str = "States", demand: str = "avoids") -> TaskResult:
    text = (TASK % (over, sparql)).replace("law:avoids", f"law:{demand}")
    return achieve_task(Service(TWIN, oracles=Lifts()), read_specification(TWIN, text, "task.ttl"))


@pytest.mark.parametrize(
    ("sparql", "over", "why"),
    [
        (FOREIGN + "ASK { ?c a sdt:Container }", "States", "names <http://example.org/sdt#Container>"),
        ("PREFIX : <http://x/> ASK { ?c a :Open }", "States", "names <http://x/Open>, which neither"),
        ("BASE <https://example.org/> ASK { ?c a <sdt#Opend> }", "Events", "sdt#Opend>, which neither"),
        (
            "ASK { ?e a sdt:Opened }",
            "States",
            "sdt#Opened>, which nothing has over law:States; allowed: law:over",
        ),
        ("ASK { ?e sdt:about ?c }", "States", "sdt#about>, which nothing has over law:States"),
        (
            "ASK { ?j sdt:position ?p FILTER (?p > 0) }",
            "Events",
            "sdt#position>, which nothing has over law:Ev",
        ),
        ("ASK { ?j sdt:hasJoint/sdt:position ?p }", "Events", "sdt#position>, which nothing has over law:Ev"),
        ("ASK { ?v a law:Verdict }", "States", "law#Verdict>, which no kitchen has"),
        ("ASK FROM <http://x/> { ?s ?p ?o }", "States", "has FROM"),
        ("ASK FROM NAMED <http://x/> { GRAPH ?g { ?s ?p ?o } }", "Events", "has FROM"),
        ("ASK { GRAPH ?g { ?e a sdt:Opened } }", "Events", "has GRAPH, though events are in no named graph"),
        ("ASK { FILTER (RAND() > 2) }", "States", "has RAND, whose answer is another each time"),
        ("SELECT (COUNT(?c) AS ?n) { ?c a sdt:Door }", "States", "counts or adds up, and has a row whatever"),
        (
            "ASK { ?j sdt:position ?p FILTER (?p > '0.3') }",
            "States",
            "compares '0.3', which is text, by order",
        ),
    ],
)
def test_a_query_that_can_have_but_one_answer_is_refused(sparql: str, over: str, why: str) -> None:
    with pytest.raises(InputError) as refused:
        read(sparql, over)
    assert why in str(refused.value)


@pytest.mark.parametrize(
    ("sparql", "over"),
    [
        ("SELECT ?c (COUNT(?h) AS ?n) { ?c sdt:hasHandle ?h } GROUP BY ?c", "States"),
        ("SELECT (COUNT(?c) AS ?n) { ?c a sdt:Door } HAVING (COUNT(?c) > 9)", "States"),
        ("ASK { ?j sdt:position ?p FILTER (?p > '0.3'^^xsd:double) }", "States"),
        ("ASK { GRAPH ?g { ?j sdt:position ?p } }", "States"),
        ("ASK { ?c sdt:name 'from now on' ; sdt:hasHandle ?from }", "States"),
        ("ASK { ?e a sdt:Opened ; sdt:about ?c . ?c a sdt:Door }", "Events"),
    ],
)
def test_a_query_that_may_have_either_answer_is_read(sparql: str, over: str) -> None:
    read(sparql, over)


def test_a_row_is_a_yes_whatever_its_column_is_called_and_holds() -> None:
    (joint,) = (each.joint for each in TWIN.containers() if each.name == "high_drawer")
    asked = f"SELECT ?answer {{ <{joint}> sdt:position ?answer }}"  # of one that stands at 0
    assert [each.standing for each in judged(asked).rules] == [Standing.BROKEN]
    assert [each.standing for each in judged(asked, demand="keeps").rules] == [Standing.KEPT]


@pytest.mark.parametrize("count", [40, 3_000, 100_000])
def test_a_query_that_is_nested_deeply_is_asked_or_refused_and_never_the_end_of_the_process(
    count: int,
) -> None:
    sparql = "ASK " + "{" * count + " ?c a sdt:Contaner " + "}" * count
    with pytest.raises((InputError, QueryError), match=r"nested too deeply|sdt#Contaner>, which neither"):
        read(sparql)
    with pytest.raises((InputError, QueryError), match=r"nested too deeply|sdt#Contaner>, which neither"):
        read("ASK { ?c a sdt:Contaner FILTER (" + "!" * count + " true) }")


@pytest.mark.parametrize(
    ("task", "more", "why"),
    [
        ("[] a law:TaskSpecification ; law:hasStep t:one .", (), "the task has no IRI"),
        ("<a b> a law:TaskSpecification ; law:hasStep t:one .", (), "the task's IRI is none"),
        (
            "t:task a law:TaskSpecification ; law:hasStep t:one .",
            ('t:r a law:StayClosed ; rdfs:label "misspelt" .',),
            "nothing uses r, of which law:StayClosed is said",
        ),
        (
            "t:task a law:TaskSpecification ; law:hasStep t:one .",
            ("t:other law:keeps t:r .",),
            "nothing uses other, of which law:keeps is said",
        ),
        (
            "t:task a law:TaskSpecification ; law:hasStep t:one ; law:keeps t:r .",
            ('t:r a law:QueryRule , law:StaysClosed ; law:sparql "ASK { ?c a sdt:Door }" .',),
            "r is a law:QueryRule and a law:StaysClosed; allowed: one of them",
        ),
        (
            "t:task a law:TaskSpecification ; law:hasStep t:one ; owl:imports <rules.ttl> .",
            (),
            "owl#imports> of task is not followed",
        ),
        (
            "t:task a law:TaskSpecification ; law:hasStep t:one . t:one owl:sameAs t:two .",
            (),
            "owl#sameAs> of one is not followed",
        ),
    ],
)
def test_what_would_silently_not_count_is_refused(task: str, more: tuple[str, ...], why: str) -> None:
    prefixes = "@prefix owl: <http://www.w3.org/2002/07/owl#> .\n"
    prefixes += "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
    with pytest.raises(InputError) as refused:
        read_specification(TWIN, prefixes + written(task, *more), "task.ttl")
    assert why in str(refused.value)


def test_a_relative_iri_is_the_same_in_whatever_folder_it_is_read() -> None:
    text = written("<tea> a law:TaskSpecification ; law:hasStep t:one .")
    assert read_specification(TWIN, text, "task.ttl").iri == "https://example.org/id/task/tea"


def test_a_rule_without_name_makes_no_other_result_each_time() -> None:
    text = written(
        "t:task a law:TaskSpecification ; law:hasStep t:one ; law:keeps [ a law:QueryRule ; "
        'law:sparql "ASK { ?c a sdt:Container }" ] .'
    )
    service = Service(TWIN, oracles=Lifts())
    one, other = (achieve_task(service, read_specification(TWIN, text, "task.ttl")) for _ in range(2))
    assert one.iri == other.iri
    assert [each.rule for each in one.rules] == ["keeps (states): ASK { ?c a sdt:Container }"]
