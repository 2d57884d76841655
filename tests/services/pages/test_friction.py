"""The matrix is about fingers that rub as much as is asked: cases are judged so, others are told apart."""

import csv
import io

import pytest

from services.http.pages.feasibility.asked import asked_about
from tests.services.pages.conftest import PAGE

pytestmark = pytest.mark.oracle


@pytest.fixture(scope="module")
def served(serve):
    return serve(kitchens=("a",), robots=("pr2",))


def test_a_friction_that_is_asked_for_is_what_is_judged(served) -> None:
    (kitchen,) = served.world.kitchens.values()
    for text, friction in (("", None), ("0.3", 0.3)):
        wish = asked_about(kitchen, [("friction", text)]).wish("pr2", "folding_door")
        assert wish is not None
        assert (wish.body().friction, wish.friction) == (friction, friction)


def test_verdicts_with_another_friction_are_told_apart(served) -> None:
    case = {"task": "open:folding_door", "budget": 0.05}
    found = [
        served.post("/api/v1/achieve", json=case | {"friction": friction}).json()["verdicts"][0]["iri"]
        for friction in (None, 0.3)
    ]

    def shown(query: str) -> tuple[list[str], dict[str, int]]:
        data = served.get(f"/kitchens/a.json?{query}").json()
        assert data["friction"] == (float(query.partition("=")[2]) if query else None)
        return [each["verdict"] for each in data["cells"] if each["verdict"]], data["with_other_frictions"]

    assert shown("") == ([found[0]], {"0.3": 1})
    assert shown("friction=0.3") == ([found[1]], {"": 1})
    assert shown("friction=0.5") == ([], {"": 1, "0.3": 1})
    rows = csv.DictReader(io.StringIO(served.get("/kitchens/a.csv?friction=0.3").text))
    assert {row["friction"] for row in rows} == {"0.3"}
    page = served.get("/kitchens/a?friction=0.3", headers=PAGE).text
    assert '<input type="hidden" name="friction" value="0.3">' in page
    assert "holds that need friction of more than 0.3 are refused" in page
    usual = served.get("/kitchens/a", headers=PAGE).text
    assert '<a href="/kitchens/a?friction=0.3">1 verdict with friction 0.3</a>' in usual
    assert '<input type="hidden" name="friction" value="">' in usual
