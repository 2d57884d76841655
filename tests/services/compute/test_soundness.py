"""Leaving out what no pattern matches never changes an answer, whatever the query is made of.

A query without any term of law: is no question about verdicts: `?s ?p ?o`, or which named graphs there are.
"""

from functools import cache

import pyoxigraph as ox
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from predicates.case import Case
from predicates.law import law
from predicates.record import StoredVerdict, read_verdicts, to_record
from predicates.scope import verb_iri
from sdt_kg.iri import ID, PREFIXES, graph_iri, local_name
from sdt_kg.task import Task, Verb
from services.compute import Pattern, verdict_patterns
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.lift import Lift

VARIABLES = ("?v", "?v", "?w", "[]")
ROBOTS = (f"<{ID}pr2>", f"<{ID}stretch>", "?r", "?s")
CONTAINERS = (f"<{ID}b/body/oven_door>", f"<{ID}b/body/top_drawer>", "?c")
VERBS = ("law:Open", "law:Close", "?b")
OUTCOMES = ("law:Certified", "law:NotCertified", "?o")


@cache
def judged() -> tuple[ox.Store, tuple[StoredVerdict, ...]]:
    """Everything that can be asked in kitchen b: two robots, two containers, two verbs."""
    twin, store = small_twin("b", ("pr2", "stretch")), ox.Store()
    for verb in Verb:
        for verdict in law(Case(twin, task=Task(verb)), Kinematics(), Lift()):
            store.extend(to_record(verdict).quads())
    return store, tuple(read_verdicts(store))


def matches(pattern: Pattern, verdict: StoredVerdict) -> bool:
    assert verdict.verb is not None
    asked = (
        (verdict.environment, pattern.environments),
        (verdict.robot, pattern.robots),
        (verb_iri(verdict.verb), pattern.verbs),
        (verdict.container, pattern.containers),
        (verdict.iri, pattern.verdicts),
    )
    return all(bound is None or value in bound for value, bound in asked)


def without_what_is_not_matched(patterns: tuple[Pattern, ...]) -> tuple[ox.Store, int]:
    """The verdicts that a pattern matches, and how many are left out."""
    store, verdicts = judged()
    kept, left_out = ox.Store(), 0
    for verdict in verdicts:
        graph = ox.NamedNode(graph_iri("verdict", local_name(verdict.iri)))
        if any(matches(pattern, verdict) for pattern in patterns):
            kept.extend(store.quads_for_pattern(None, None, None, graph))
        else:
            left_out += 1
    return kept, left_out


def rows(store: ox.Store, query: str) -> list[str]:
    found = store.query(query, prefixes=PREFIXES, use_default_graph_as_union=True)
    assert isinstance(found, ox.QuerySolutions)
    return sorted(str([str(term) for term in row]) for row in found)


@st.composite
def triples(draw: st.DrawFn) -> str:
    verdict = draw(st.sampled_from(VARIABLES))
    part = draw(st.sampled_from(("robot", "container", "verb", "outcome")))
    choices = {"robot": ROBOTS, "container": CONTAINERS, "verb": VERBS, "outcome": OUTCOMES}[part]
    path = "law:task/law:verb" if part == "verb" else f"law:{part}"
    return f"{verdict} {path} {draw(st.sampled_from(choices))} ."


OPEN_PREDICATES = (
    "?p", "prov:wasDerivedFrom", "prov:wasGeneratedBy/prov:used", "a", "!law:robot", "law:answer|^law:task",
    "(law:task|law:diagnosis)*/law:verb", "!(rdf:type|^law:robot)", "law:diagnosis/law:reason",
    "law:task [] ; law:answer",
)  # fmt: skip


@st.composite
def unbounded(draw: st.DrawFn) -> str:
    """A triple whose property says little; beside it, one of law:."""
    value = draw(st.sampled_from(("?o", "?w", "?k", "law:Open", "law:Certified", "false")))
    beside = draw(triples())
    return f"{draw(st.sampled_from(VARIABLES))} {draw(st.sampled_from(OPEN_PREDICATES))} {value} . {beside}"


@st.composite
def values(draw: st.DrawFn) -> str:
    robots = draw(st.lists(st.sampled_from(ROBOTS[:2]), min_size=1, max_size=2, unique=True))
    variable = draw(st.sampled_from(("?r", "?s")))
    form = draw(st.sampled_from(("FILTER ({v} = {one})", "FILTER ({v} != {one})", "FILTER ({v} IN ({all}))",
                                 "VALUES {v} {{ {some} }}", "VALUES {v} {{ {some} UNDEF }}")))  # fmt: skip
    return form.format(v=variable, one=robots[0], all=", ".join(robots), some=" ".join(robots))


def nested(group: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        group.map(lambda inner: f"OPTIONAL {{ {inner} }}"),
        group.map(lambda inner: f"MINUS {{ {inner} }}"),
        group.map(lambda inner: f"FILTER EXISTS {{ {inner} }}"),
        group.map(lambda inner: f"FILTER NOT EXISTS {{ {inner} }}"),
        group.map(lambda inner: f"{{ SELECT ?r (COUNT(*) AS ?n) WHERE {{ {inner} }} GROUP BY ?r }}"),
        st.tuples(triples(), group).map(lambda two: f"GRAPH ?g {{ {two[0]} {two[1]} }}"),
        st.tuples(group, group).map(lambda two: f"{{ {two[0]} }} UNION {{ {two[1]} }}"),
    )


def groups(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.lists(inner, min_size=1, max_size=3).map(" ".join)


LEAF = groups(st.one_of(triples(), triples(), values(), unbounded()))
GROUP = st.recursive(LEAF, lambda group: groups(st.one_of(triples(), values(), nested(group))), max_leaves=6)


@settings(max_examples=40, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(GROUP)
def test_the_answer_does_not_need_what_is_left_out(group: str) -> None:
    query = f"SELECT * WHERE {{ {group} }}"
    kept, _ = without_what_is_not_matched(verdict_patterns(query))
    assert rows(kept, query) == rows(judged()[0], query)


def test_something_is_left_out() -> None:
    robot = verdict_patterns("SELECT * WHERE { ?v law:robot id:pr2 ; law:task/law:verb law:Open }")
    assert without_what_is_not_matched(robot)[1] == 6
