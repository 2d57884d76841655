"""What `sdt query` says of a query whose words nobody knows: an empty answer is no "no"."""

import re
from pathlib import Path

import pytest

import ontology
from sdt_kg.iri import ID
from sdt_kg.load import load_twin
from services.ontology_page.spelling import misspelled, unknown_terms

QUERIES = sorted(Path(str(ontology.path("queries"))).glob("*.rq"))


def test_a_term_that_the_ontology_does_not_have_is_told_beside_the_answer(sdt) -> None:
    done = sdt("query", "b", "SELECT ?d { ?d sdt:hasHandel ?h ; a <https://example.org/sdt#Dor> }", "--json")
    assert (done.code, done.json) == (0, [])
    assert (
        "sdt:hasHandel is no term of the ontology, and nothing has it; did you mean sdt:hasHandle?"
        in done.err
    )
    assert "sdt:Dor is no term" in done.err


@pytest.mark.parametrize(
    ("query", "note"),
    [
        ("SELECT ?p { id:r2d2 ?p ?o }", "nothing here is called id:r2d2"),
        (r"SELECT ?p { id:b\/body\/dor ?p ?o }", "nothing here is called id:b/body/dor"),
        ("SELECT ?p { <https://example.org/id/c> ?p ?o }", "nothing here is called id:c"),
        ('SELECT ?d { ?d sdt:hasJoint "door" }', "sdt:hasJoint leads to an IRI, and no text is one"),
        ("PREFIX sdt: <urn:x:> SELECT ?d { ?d a sdt:Door }", "sdt: is <https://example.org/sdt#> here"),
    ],
)
def test_what_matches_nothing_is_told_beside_the_answer(sdt, query: str, note: str) -> None:
    done = sdt("query", "b", query, "--json")
    assert (done.code, done.json) == (0, [])
    assert note in done.err


@pytest.mark.parametrize(
    "query",
    [
        r"SELECT ?p { id:b\/body\/iai_fridge_door ?p ?o . id:b ?q ?r } LIMIT 1",
        "PREFIX body: <https://example.org/id/b/body/> SELECT ?p { body:iai_fridge_door ?p ?o } LIMIT 1",
        "PREFIX id: <urn:x:> SELECT ?p { ?s ?p ?o . FILTER(?o != id:r2d2) } LIMIT 1",
    ],
)
def test_of_what_is_there_nothing_is_told(sdt, query: str) -> None:
    done = sdt("query", "b", query, "--json")
    assert (len(done.json), "is called" in done.err) == (1, False)


def test_a_class_of_which_only_subclasses_have_individuals_is_told_with_these(sdt) -> None:
    done = sdt("query", "b", "SELECT ?joint { ?joint a sdt:Joint }", "--json")
    assert (done.code, done.json) == (0, [])
    said = re.search(r"nothing here is said to be a sdt:Joint.*(VALUES .* \?class)$", done.err, re.MULTILINE)
    assert said is not None
    found = sdt("query", "b", f"SELECT DISTINCT ?x {{ {said[1]} }}", "--json")
    assert (len(found.json), "is said to be" in found.err) == (
        len(load_twin("b").mechanism(ID + "b").joints),
        False,
    )


def test_of_a_class_that_has_individuals_nothing_is_told(sdt) -> None:
    assert "is said to be" not in sdt("query", "b", "SELECT ?body { ?body a sdt:Container, sdt:Body }").err


def test_what_no_saved_verdict_is_about_is_told(sdt, tmp_path: Path) -> None:
    store = tmp_path / "v.trig"
    store.write_text("<urn:v> <urn:p> <https://example.org/id/pr2> .", encoding="utf-8")
    asked = "SELECT ?v {{ ?v ?p id:{} }}"
    assert "is called id:tiago:" in sdt("query", str(store), asked.format("tiago")).err
    assert "is called" not in sdt("query", str(store), asked.format("pr2")).err


def test_with_compute_too_it_is_told_that_nothing_is_called_so(sdt) -> None:
    asked = "SELECT ?p { id:r2d2 ?p ?o . id:b ?q ?r }"
    done = sdt("query", "b", asked, "--compute", "--json")
    assert (done.code, done.json["rows"]) == (0, [])
    assert "nothing here is called id:r2d2" in done.err
    assert "called id:b:" not in done.err


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


def test_texts_comments_and_terms_of_another_with_our_prefix_are_not_misspelled() -> None:
    told = """# sdt:hasHandel, it's
    PREFIX law: <urn:x:>
    SELECT ?v { ?v law:foo "sdt:Dor \\" tee:x", '''law:'s sdt:Dor''' ; a <https://example.org/sdt#Dor> }"""
    assert misspelled(told) == {"sdt:Dor": "did you mean sdt:Door?"}
