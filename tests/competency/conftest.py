"""Verdicts that `law` really gave, about small kitchens named a and b and lifts named pr2 and stretch."""

from collections.abc import Iterator

import pyoxigraph as ox
import pytest

from predicates.case import Case
from predicates.law import law
from predicates.margins import LOOKED_UP_TO
from predicates.record import to_record, write
from predicates.specification.read import read_specification
from predicates.specification.results.record import task_record
from predicates.specification.results.result import TaskResult
from sdt_kg.task import Task, Verb
from services.app import Service
from services.physics.oracle import Kinematics
from services.specifications import achieve_task
from tests.small import small_twin
from tests.small.far import NEAR_ITSELF, Far
from tests.small.lift import Lifts

NEARER = 0.011
"""[m] How near the lifts come to themselves in kitchen b."""

TASK = """
@prefix law: <https://example.org/law#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix t: <https://example.org/id/t/> .
t:task a law:TaskSpecification ; rdfs:label "top drawer, never beyond {limit}" ;
  law:hasStep t:one ; law:keeps t:rule .
t:one a law:Task ; law:index 1 ; law:verb law:Open ; law:containerName "top_drawer" .
t:rule a law:NeverBeyond ; law:containerName "top_drawer" ; law:limitPosition {limit} .
"""


def task_results() -> Iterator[TaskResult]:
    """Of a task whose rule is broken and one whose rule is kept; their steps are among the verdicts."""
    service = Service(small_twin("b", ("pr2", "stretch")), oracles=Lifts())
    for limit in (0.3, 0.5):
        specification = read_specification(service.twin, TASK.format(limit=limit), "task.ttl")
        yield achieve_task(service, specification, "pr2")


@pytest.fixture(scope="session")
def verdicts() -> ox.Store:
    """Twins and verdicts: open() in kitchens a and b, close() in b with its drawer half open."""
    store = ox.Store()
    for kitchen, near in (("a", NEAR_ITSELF), ("b", NEARER)):
        twin = small_twin(kitchen, ("pr2", "stretch"))
        store.extend(twin.entities.store.dump(twin.graphs()))
        for verdict in law(Case(twin, task=Task(Verb.OPEN)), Kinematics(), Far(near)):
            write(store, to_record(verdict))
    for result in task_results():
        write(store, task_record(result))
    twin = small_twin("b", ("pr2", "stretch"))
    half_open = twin.at({twin.container("top_drawer").joint: 0.25})
    store.extend(half_open.entities.store.dump(half_open.graphs()))
    for verdict in law(Case(half_open, task=Task(Verb.CLOSE)), Kinematics(), Far(LOOKED_UP_TO)):
        write(store, to_record(verdict))
    return store
