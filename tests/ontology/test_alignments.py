"""Alignments name terms that exist, contradict nothing, and the core does not need them."""

import csv
import re
from pathlib import Path

import rdflib
from rdflib.namespace import PROV, RDF, RDFS, SKOS, SOSA, DefinedNamespace
from rdflib.term import URIRef

import ontology
from predicates.specification.quality import UNITS
from sdt_kg.iri import LAW

FILES = sorted(ontology.path("alignments").glob("*.ttl"))
CLOSED: dict[str, type[DefinedNamespace]] = {str(each): each for each in (PROV, SKOS, SOSA)}
"""Vocabularies whose terms rdflib knows: it refuses any other."""
OWN = ("https://example.org/", *(str(each) for each in (RDF, RDFS)), "http://www.w3.org/2002/07/owl#")
META = ("http://purl.org/dc/terms/", "https://www.apache.org/")


def listed() -> set[str]:
    with Path(__file__).with_name("external_terms.csv").open(encoding="utf-8") as file:
        return {row["namespace"] + name for row in csv.DictReader(file) for name in row["terms"].split()}


def external() -> set[str]:
    graph = rdflib.Graph()
    for path in FILES:
        graph.parse(path)
    named = {str(term) for triple in graph for term in triple if isinstance(term, URIRef)}
    return {term for term in named if not term.startswith((*OWN, *META))}


def test_there_are_alignments_with_soma_prov_qudt_and_sosa() -> None:
    assert [path.stem for path in FILES] == ["prov", "qudt", "soma", "sosa"]


def test_every_term_of_others_is_known_to_exist() -> None:
    of_closed = {term for term in external() if term.startswith(tuple(CLOSED))}
    for term in of_closed:
        namespace = next(each for each in CLOSED if term.startswith(each))
        assert URIRef(term) in dir(CLOSED[namespace]), term
    assert len(of_closed) >= 10
    assert external() - of_closed == listed()


def test_each_unit_of_a_record_is_one_unit_of_qudt() -> None:
    law, qudt = rdflib.Graph().parse(ontology.path("law.ttl")), rdflib.Graph()
    qudt.parse(ontology.path("alignments/qudt.ttl"))
    comment = str(law.value(URIRef(LAW + "unit"), RDFS.comment))
    found = re.fullmatch(
        r"Unit of value, bound and value of J: (.*); of sums .*: (.*), which are .*", comment
    )
    assert found is not None
    texts, sums = re.split(r", | or ", found[1]), found[2].replace(" (squares)", "").split(" or ")
    assert (len(texts), len(sums)) == (10, 2)
    assert set(UNITS.values()) <= {*texts, *sums}
    notations = [str(text) for text in qudt.objects(None, SKOS.notation)]
    assert sorted(notations) == sorted(texts)


def test_the_core_imports_and_names_nothing_of_them() -> None:
    for name in ("sdt", "tee", "law"):
        text = ontology.path(f"{name}.ttl").read_text(encoding="utf-8")
        assert not re.search(r"owl:imports|SOMA\.owl|DUL\.owl|qudt\.org|ns/sosa", text)
