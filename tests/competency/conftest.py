"""Verdicts that `law` really gave, about small kitchens named a and b and lifts named pr2 and stretch."""

import pyoxigraph as ox
import pytest

from predicates.case import Case
from predicates.law import law
from predicates.record import to_record, write
from sdt_kg.task import Task, Verb
from services.physics.oracle import Kinematics
from tests.small import small_twin
from tests.small.lift import Lift


@pytest.fixture(scope="session")
def verdicts() -> ox.Store:
    """Twins and verdicts: open() in kitchens a and b, close() in b with its drawer half open."""
    store = ox.Store()
    for kitchen in ("a", "b"):
        twin = small_twin(kitchen, ("pr2", "stretch"))
        store.extend(twin.entities.store.dump(twin.graphs()))
        for verdict in law(Case(twin, task=Task(Verb.OPEN)), Kinematics(), Lift()):
            write(store, to_record(verdict))
    twin = small_twin("b", ("pr2", "stretch"))
    half_open = twin.at({twin.container("top_drawer").joint: 0.25})
    store.extend(half_open.entities.store.dump(half_open.graphs()))
    for verdict in law(Case(half_open, task=Task(Verb.CLOSE)), Kinematics(), Lift()):
        write(store, to_record(verdict))
    return store
