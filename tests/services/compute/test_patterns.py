"""What a query demands of verdicts: every bound holds of all that could change the answer."""

import pytest

import ontology
from predicates.case import Case
from predicates.law import law
from predicates.record import to_record
from sdt_kg.errors import QueryError
from sdt_kg.iri import ID, LAW, RDF, TEE
from sdt_kg.task import Task, Verb
from services.compute import Pattern, not_judged, verdict_patterns
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.lift import Lift

ANY = Pattern()
PR2, STRETCH = frozenset({f"{ID}pr2"}), frozenset({f"{ID}stretch"})
A, OPEN = frozenset({f"{ID}a"}), frozenset({f"{LAW}Open"})
ONE = frozenset({f"{ID}verdict/0a"})
DRAWER = frozenset({f"{ID}a/body/low_drawer"})


def select(where: str) -> set[Pattern]:
    return set(verdict_patterns(f"SELECT * WHERE {{ {where} }}"))


@pytest.mark.parametrize(
    ("where", "expected"),
    [
        ("?v law:robot id:pr2 ; law:environment id:a", Pattern(environments=A, robots=PR2)),
        ("?v law:task/law:verb law:Open", Pattern(verbs=OPEN)),
        ("?v law:task ?t . ?t law:verb law:Open ; law:container <https://example.org/id/a/body/low_drawer>",
         Pattern(verbs=OPEN, containers=DRAWER)),
        ("?t law:verb law:Open . ?t ^law:task ?v . ?v law:robot id:pr2", Pattern(verbs=OPEN, robots=PR2)),
        ("?v law:robot ?r . FILTER(?r = id:pr2)", Pattern(robots=PR2)),
        ("?v law:robot ?r . FILTER(id:pr2 = ?r && ?r != id:x)", Pattern(robots=PR2)),
        ("?v law:robot ?r . FILTER(?r IN (id:pr2, id:stretch))", Pattern(robots=PR2 | STRETCH)),
        ("VALUES ?r { id:pr2 id:stretch } ?v law:robot ?r", Pattern(robots=PR2 | STRETCH)),
        ("BIND(id:pr2 AS ?r) ?v law:robot ?r", Pattern(robots=PR2)),
        ("GRAPH ?g { ?v law:robot id:pr2 } ?v law:outcome ?o", Pattern(robots=PR2)),
        ('?v law:drive "omni"', Pattern(drives=frozenset({"omni"}))),
        ("<https://example.org/id/verdict/0a> law:outcome ?o", Pattern(verdicts=ONE)),
        ("<https://example.org/id/verdict/0a/diagnosis/1> law:reason ?o", Pattern(verdicts=ONE)),
        ("?v law:robot id:pr2, id:stretch", Pattern(robots=frozenset())),  # one verdict has one robot
        ("?v law:teeClass tee:D_artic_dyn", Pattern(classes=frozenset({f"{TEE}D_artic_dyn"}))),
        ("?v law:robot id:pr2 ; ?p ?o", Pattern(robots=PR2)),
        ("<https://example.org/id/verdict/0a> ?p ?o", Pattern(verdicts=ONE)),
        ("[] law:robot id:pr2 ; law:outcome ?o", Pattern(robots=PR2)),
        ("_:v law:robot id:pr2 ; law:task [ law:verb law:Open ]", Pattern(robots=PR2, verbs=OPEN)),
        ("?v law:robot id:pr2 ; law:container ?c . ?c ?p ?o", Pattern(robots=PR2)),
        ("?v law:robot id:pr2 ; law:motion/law:entity ?j . ?j sdt:upperLimit|sdt:lowerLimit ?o ; ?p ?q",
         Pattern(robots=PR2)),
        ("?v law:robot id:pr2 . VALUES ?p { sdt:upperLimit } ?j ?p ?o", Pattern(robots=PR2)),
        (r"?v law:container id:a\/body\/low_drawer", Pattern(containers=DRAWER)),
        (r"?v law:container ?c . FILTER(?c IN (id:a\/body\/low_drawer))", Pattern(containers=DRAWER)),
    ],
)  # fmt: skip
def test_what_binds_every_solution_bounds_the_case(where: str, expected: Pattern) -> None:
    assert select(where) == {expected}


@pytest.mark.parametrize(
    "where",
    [
        "?v a law:Verdict",
        "?d law:reason ?r",  # of which verdict, nobody says
        "?v law:robot ?r . FILTER(?r != id:pr2)",
        "?v law:robot ?r . FILTER(?r = id:pr2 || ?r = id:stretch)",
        "?v law:robot ?r . FILTER(STR(?r) = 'pr2')",
        "?v law:outcome ?o OPTIONAL { ?v law:robot ?r . FILTER(?r = id:pr2) }",
        "VALUES (?r) { (id:pr2) (UNDEF) } ?v law:robot ?r",
        "?v law:robot|law:environment id:pr2",
        "?v law:task/law:verb? law:Open",
        "?v ?p law:Certified",
        "VALUES ?p { law:outcome } ?v ?p ?o",
        "?v ?p ?o FILTER(STRSTARTS(STR(?p), STR(law:)))",
        "?v law:robot id:pr2 . ?a prov:wasDerivedFrom ?b",
        "?v !(rdf:type|^law:robot) ?x",
        "?v (!law:robot)/law:verb ?x",
        "BIND(EXISTS { ?v !(rdf:type|^law:robot) ?x } AS ?y)",
        "GRAPH <https://example.org/id/graph/verdict/0a> { ?s ?p ?o }",
        "GRAPH ?g { OPTIONAL { ?v law:robot id:pr2 } }",
    ],
)
def test_what_does_not_bind_every_solution_bounds_nothing(where: str) -> None:
    assert ANY in select(where)


def test_each_branch_and_each_test_has_its_own_bounds() -> None:
    union = select("{ ?v law:robot id:pr2 } UNION { ?v law:robot id:stretch }")
    assert union == {Pattern(robots=PR2), Pattern(robots=STRETCH)}
    other = select("?v law:robot id:pr2 FILTER NOT EXISTS { ?w law:robot id:stretch }")
    assert other == {Pattern(robots=PR2), Pattern(robots=STRETCH)}
    minus = select("?v law:outcome ?o MINUS { ?w law:robot id:stretch }")
    assert minus == {ANY, Pattern(robots=STRETCH)}


def test_what_is_known_outside_holds_in_optional_and_in_tests() -> None:
    assert select("?v law:robot id:pr2 OPTIONAL { ?v law:diagnosis ?d . ?d law:bound ?b }") == {
        Pattern(robots=PR2)
    }
    assert select("?v law:robot id:pr2 ; law:diagnosis ?d OPTIONAL { ?d law:bound ?b }") == {
        Pattern(robots=PR2)
    }
    tested = select("?v law:robot id:pr2 FILTER EXISTS { ?v law:task/law:verb law:Open }")
    assert tested == {Pattern(robots=PR2), Pattern(robots=PR2, verbs=OPEN)}


def test_an_optional_before_what_binds_its_variable_is_not_bounded_by_it() -> None:
    """Its solutions count even if they fit nothing that is joined later: they decide what is bound."""
    late = select("OPTIONAL { ?v law:robot id:pr2 } ?v law:robot id:stretch")
    assert late == {Pattern(robots=PR2), Pattern(robots=STRETCH)}
    early = select("?v law:robot id:stretch OPTIONAL { ?v law:robot id:pr2 }")
    assert early == {Pattern(robots=frozenset()), Pattern(robots=STRETCH)}


def test_a_test_inside_a_selected_expression_is_seen() -> None:
    query = "SELECT (EXISTS { ?v law:robot id:pr2 } AS ?yes) WHERE {}"
    assert verdict_patterns(query) == (ANY,)


def test_nothing_known_outside_bounds_a_subquery_or_an_aggregate() -> None:
    inner = "{ SELECT ?r (COUNT(?w) AS ?n) { ?w law:robot ?r } GROUP BY ?r }"
    sub = select(f"?v law:robot ?r . FILTER(?r = id:pr2) {inner}")
    assert sub == {Pattern(robots=PR2), ANY}
    having = "SELECT ?r (COUNT(?v) AS ?n) { ?v law:robot ?r } GROUP BY ?r HAVING (?r = id:pr2)"
    assert verdict_patterns(having) == (ANY,)


@pytest.mark.parametrize(
    ("where", "kind"),
    [
        ("?p a law:LearnedPhysics ; law:name ?n", "LearnedPhysics"),
        ("?p law:residual ?r ; law:unit ?u", "LearnedPhysics"),
        ("?o law:trackHash ?h", "Observation"),
        ("?r law:firstBroken ?b ; law:environment id:a", "TaskResult"),
        ("?r law:taskOutcome law:Certified", "TaskResult"),
        ("?r a law:StaysClosed", "Rule"),
    ],
)
def test_what_no_judging_makes_is_not_computed_and_said(where: str, kind: str) -> None:
    assert select(where) == set()
    assert select(f"{where} . ?v law:robot id:pr2") == {Pattern(robots=PR2)}
    assert f"{LAW}{kind}" in not_judged(f"SELECT * WHERE {{ {where} . ?v law:robot id:pr2 }}")


@pytest.mark.parametrize("query", ["ASK { ?door a sdt:Door }", "SELECT * { ?s ?p ?o }", "DESCRIBE id:a"])
def test_a_query_without_law_terms_touches_nothing(query: str) -> None:
    assert verdict_patterns(query) == ()
    assert not_judged(query) == ()


def test_a_verdict_that_is_described_is_asked_for() -> None:
    assert set(verdict_patterns("DESCRIBE <https://example.org/id/verdict/0a>")) == {Pattern(verdicts=ONE)}
    asked = verdict_patterns("DESCRIBE ?v <https://example.org/id/verdict/0a> { ?v law:robot id:pr2 }")
    assert set(asked) == {Pattern(verdicts=ONE), Pattern(robots=PR2)}


@pytest.mark.parametrize("name", ["cq01", "cq02", "cq07"])
def test_competency_questions_are_bounded_as_they_read(name: str) -> None:
    (file,) = ontology.path("queries").glob(f"{name}_*.rq")
    expected = {
        "cq01": {Pattern(robots=STRETCH)},
        "cq02": {Pattern(environments=A, verbs=OPEN)},
        "cq07": {Pattern(verbs=OPEN)},
    }
    assert set(verdict_patterns(file.read_text())) == expected[name]


def test_what_does_not_parse_is_refused() -> None:
    with pytest.raises(QueryError, match="cannot tell what the query asks for"):
        verdict_patterns("SELECT WHERE")


def test_every_property_of_a_record_is_seen_as_about_verdicts() -> None:
    twin = small_twin("a", ("pr2", "stretch"))
    case = Case(twin, robot=twin.robots[1], task=Task(Verb.OPEN))
    records = [to_record(each) for each in law(case, Kinematics(), Lift())]
    used = {p for record in records for _, p, _ in record.triples}
    kinds = {value.value for record in records for _, p, value in record.triples if p == RDF + "type"}
    assert len(used) > 20
    for predicate in used:
        assert select(f"?x <{predicate}> ?y . ?w law:robot id:pr2") - {Pattern(robots=PR2)}, predicate
    for kind in kinds:
        assert select(f"?x a <{kind}> . ?w law:robot id:pr2") - {Pattern(robots=PR2)}, kind
