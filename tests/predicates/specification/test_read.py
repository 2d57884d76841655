"""Tasks written by hand: what is misspelt must not be a rule that nothing can break."""

import pytest

from predicates.specification.read import read_specification
from sdt_kg.errors import InputError, UnknownEntityError
from tests.small import small_twin

TWIN = small_twin("a")
TASK = """
@prefix law: <https://example.org/law#> .
@prefix t: <https://example.org/id/t/> .
t:task a law:TaskSpecification ; law:hasStep t:one ; law:avoids t:rule .
t:one a law:Task ; law:index 1 ; law:verb law:Open ; law:containerName "low_drawer" .
t:rule a law:QueryRule ; law:over law:%s ; law:sparql \"\"\"%s\"\"\" .
"""


def read(sparql: str, over: str = "States") -> None:
    read_specification(TWIN, TASK % (over, sparql), "task.ttl")


@pytest.mark.parametrize(
    ("sparql", "named", "meant"),
    [
        ("ASK { ?c a sdt:Contaner }", "sdt#Contaner", "sdt#Container"),
        ("ASK { ?c sdt:hasJoint/sdt:positon ?p }", "sdt#positon", "sdt#position"),
        ("PREFIX x: <https://example.org/sdt#> ASK { ?c a x:Contaner }", "sdt#Contaner", "sdt#Container"),
        ("ASK { ?c a <https://example.org/sdt#Contaner> }", "sdt#Contaner", "sdt#Container"),
        ("ASK { <https://example.org/id/a/joint/low_draw_joint> sdt:position ?p }", "low_draw_joint", ""),
    ],
)
def test_a_query_that_names_what_nothing_has_is_refused(sparql: str, named: str, meant: str) -> None:
    with pytest.raises(InputError, match=f"{named}>, which neither .*{meant}"):
        read(sparql)


def test_an_event_of_no_kind_is_refused() -> None:
    with pytest.raises(InputError, match="law#Opened>, which neither"):
        read("ASK { ?event a law:Opened }", "Events")


@pytest.mark.parametrize(
    "sparql",
    [
        "ASK { ?c a sdt:Container ; sdt:hasJoint ?j . ?j sdt:position ?p FILTER (?p > 0.1) }",
        'ASK { ?c sdt:name "sdt:Contaner" } # sdt:Contaner',
        "PREFIX d: <http://purl.org/dc/terms/> ASK { ?c d:source ?it }",
        "ASK { ?c a/rdfs:subClassOf* sdt:Container }",
        "ASK { ?c a sdt:Door ; sdt:hasJoint ?j . ?j sdt:upperLimit ?u FILTER (xsd:float(?u) > 0.1) }",
        "ASK { <https://example.org/id/a/joint/low_drawer_joint> sdt:position ?p }",
        "SELECT ?c WHERE { ?c a sdt:Drawer , <https://example.org/sdt#Container> }",
    ],
)
def test_what_is_known_or_the_kitchens_is_read(sparql: str) -> None:
    read(sparql)


def test_a_rule_in_another_namespace_is_no_rule_that_is_passed_over() -> None:
    text = (TASK % ("States", "ASK { ?c a sdt:Door }")).replace(
        "law:avoids t:rule", "<http://example.org/law#keeps> t:rule"
    )
    with pytest.raises(InputError, match=r"http://example\.org/law#keeps is no law:keeps"):
        read_specification(TWIN, text, "task.ttl")


def test_a_text_that_ends_too_early_is_no_turtle() -> None:
    with pytest.raises(InputError, match="is not Turtle"):
        read_specification(TWIN, TASK.partition("; law:avoids")[0], "task.ttl")


def test_a_container_of_another_kitchen_is_told_with_the_task_and_the_kitchen() -> None:
    text = (TASK % ("States", "ASK { ?c a sdt:Door }")).replace("low_drawer", "lower_drawer")
    with pytest.raises(UnknownEntityError) as refused:
        read_specification(TWIN, text, "task.ttl")
    assert str(refused.value).startswith(
        "task.ttl, asked in kitchen a: no container named 'lower_drawer'; did you mean 'low_drawer'"
    )
