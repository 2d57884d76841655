"""A question that is asked about one kitchen has the answer that it has where there is no other kitchen."""

from pathlib import Path

import pyoxigraph as ox
import pytest

import ontology
from sdt_kg.iri import PREFIXES, model_iri
from sdt_kg.store import Row, rows_of
from services.store.known import restricted

QUERIES = [
    query
    for query in sorted(Path(str(ontology.path("queries"))).glob("cq*.rq"))
    if "# Known     nothing, or ?environment" in query.read_text()
]


KITCHENS = ("a", "b")


@pytest.fixture(scope="session")
def alone(verdicts: ox.Store) -> dict[str, ox.Store]:
    """Kitchen → everything but what is about the other one."""
    stores = {kitchen: ox.Store() for kitchen in KITCHENS}
    for kitchen, other in zip(KITCHENS, reversed(KITCHENS), strict=True):
        stores[kitchen].extend(verdicts)
        about = f"{{ GRAPH ?g {{ ?x law:environment|sdt:partOf <{model_iri(other)}> }} }}"
        stores[kitchen].update(
            f"DELETE {{ GRAPH ?g {{ ?s ?p ?o }} }} WHERE {{ {about} GRAPH ?g {{ ?s ?p ?o }} }}",
            prefixes=PREFIXES,
        )
    return stores


def rows(store: ox.Store, sparql: str) -> list[Row]:
    return rows_of(store.query(sparql, use_default_graph_as_union=True))[1]


def test_there_are_such_questions() -> None:
    assert len(QUERIES) >= 12


@pytest.mark.parametrize("query", QUERIES, ids=lambda path: path.stem)
def test_asked_about_one_kitchen(verdicts: ox.Store, alone: dict[str, ox.Store], query: Path) -> None:
    text = query.read_text()
    found = {
        kitchen: rows(verdicts, restricted(text, {"environment": ox.NamedNode(model_iri(kitchen))}))
        for kitchen in KITCHENS
    }
    assert found == {kitchen: rows(store, text) for kitchen, store in alone.items()}
    assert any(found.values()), "a question without an answer tests nothing"
    assert found["a"] != found["b"]
