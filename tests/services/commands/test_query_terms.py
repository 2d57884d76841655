"""What `sdt query` says of a query whose words nobody knows: an empty answer is no "no"."""

from pathlib import Path

import pytest

import ontology
from services.ontology_page.spelling import unknown_terms

QUERIES = sorted(Path(str(ontology.path("queries"))).glob("*.rq"))


def test_a_term_that_the_ontology_does_not_have_is_told_beside_the_answer(sdt) -> None:
    done = sdt("query", "b", "SELECT ?d { ?d sdt:hasHandel ?h ; a <https://example.org/sdt#Dor> }", "--json")
    assert (done.code, done.json) == (0, [])
    assert (
        "sdt:hasHandel is no term of the ontology, and nothing has it; did you mean sdt:hasHandle?"
        in done.err
    )
    assert "sdt:Dor is no term" in done.err


def test_a_prefix_that_is_not_declared_is_told(sdt) -> None:
    done = sdt("query", "b", "SELECT ?d { ?d my:likes ?h }")
    assert done.code == 2
    assert "a prefix that is not declared: error at 1:" in done.err
    assert "PREFIX NAME: <IRI>" in done.err


@pytest.mark.parametrize("path", QUERIES, ids=lambda path: path.stem)
def test_our_own_questions_have_known_terms(path: Path) -> None:
    assert list(unknown_terms(path.read_text(encoding="utf-8"))) == []


def test_a_prefix_or_variable_of_ones_own_is_no_term_of_ours() -> None:
    assert list(unknown_terms("SELECT ?sdt { ?sdt my-sdt:foo ?x . FILTER(?x = 'law: is') }")) == []
