"""A verdict can be sent to another process, with the twin that it is about."""

import pickle

import pytest

from services.app import load

pytestmark = pytest.mark.oracle


def test_a_verdict_comes_out_of_a_pickle_as_it_was() -> None:
    drawer = "sink_area_left_middle_drawer_main"
    (verdict,) = load("b", robots=["pr2"]).achieve(f"open:{drawer}", robot="pr2")
    again = pickle.loads(pickle.dumps(verdict))  # noqa: S301 - made here
    assert (again.iri, str(again), again.inputs) == (verdict.iri, str(verdict), verdict.inputs)
    twin = again.case.twin
    assert twin.container(drawer) == verdict.case.twin.container(drawer)
    asked = "SELECT ?joint ?at { ?joint sdt:position ?at } ORDER BY ?joint"
    assert twin.query(asked) == verdict.case.twin.query(asked)
