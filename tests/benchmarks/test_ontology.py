"""Figures of the graph that explains itself, never assertions on time: `make bench`."""

from collections.abc import Callable
from typing import Any

import pyoxigraph as ox
import pytest

from predicates.case import Case
from predicates.law import law
from predicates.record import to_record
from sdt_kg.load import load_twin
from sdt_kg.scope import D_ARTIC, request_graph
from sdt_kg.shacl import check
from sdt_kg.task import Task, Verb
from services.compute import verdict_patterns
from services.ontology_page.page import page
from services.physics.oracle import Kinematics
from services.why import why
from tests.shapes.engines import ENGINES
from tests.small import small_twin
from tests.small.lift import Lift

Benchmark = Callable[..., Any]

QUERY = "SELECT ?r { ?v law:robot ?r ; law:task/law:verb law:Open ; law:environment id:a }"


@pytest.mark.parametrize("name", ENGINES)
def test_scope_check_of_one_request(benchmark: Benchmark, name: str) -> None:
    twin = load_twin("b", ["pr2"])
    container = twin.container("sink_area_left_middle_drawer_main")
    data = request_graph(twin, container, twin.robots[0])
    assert benchmark(check, data, D_ARTIC.shapes, [], ENGINES[name]) == []


def test_why_of_one_verdict(benchmark: Benchmark) -> None:
    twin = small_twin("a", ("pr2", "stretch"))
    (verdict,) = law(
        Case(twin, twin.robots[0], Task(Verb.OPEN, twin.container("low_drawer").iri)), Kinematics(), Lift()
    )
    store = ox.Store()
    store.extend(to_record(verdict).quads())
    assert "CERTIFIED" in benchmark(why, store, verdict.iri)


def test_patterns_of_one_query(benchmark: Benchmark) -> None:
    assert len(benchmark(verdict_patterns, QUERY)) == 1


def test_page_of_the_ontology(benchmark: Benchmark) -> None:
    assert "law:Verdict" in benchmark.pedantic(page, rounds=3)
