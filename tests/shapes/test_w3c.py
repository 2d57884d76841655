"""The SHACL core tests of the W3C, through the scope's own path, with both engines.

What an engine misses is listed by name, so that a miss more, or one less, is seen.
"""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest
import rdflib
from rdflib.namespace import RDF, SH
from rdflib.term import Node

from sdt_kg.shacl import Engine, Violation, check, read_report
from tests.shapes.engines import ENGINES

SHT = rdflib.Namespace("http://www.w3.org/ns/shacl-test#")
MF = rdflib.Namespace("http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#")

TESTS = 98

MISSES = {
    "pyshacl": {"uniqueLang-002"},  # takes "1"^^xsd:boolean for true
    "pyshifty": {
        "and-001",  # of a property: reports each violation of sh:and twice
        "nodeKind-001",  # of a property: reports blank nodes twice
        "or-datatypes-001",  # takes an ill-typed boolean for one
        "qualifiedValueShape-001",  # names the other component of the two
        "uniqueLang-002",
    },
}

pytestmark = [pytest.mark.reference, pytest.mark.filterwarnings("ignore")]


def parsed(path: Path) -> rdflib.Graph:
    return rdflib.Graph().parse(path, publicID=path.as_uri(), format="turtle")


def named(iri: Node | None) -> rdflib.Graph:
    return parsed(Path(unquote(urlparse(str(iri)).path)))


def cases(folder: Path) -> Iterator[tuple[str, rdflib.Graph, rdflib.Graph, rdflib.Graph]]:
    """Name, data, shapes and the expected report of each test."""
    for path in sorted(folder.rglob("*.ttl")):
        manifest = parsed(path)
        for case in manifest.subjects(RDF.type, SHT.Validate):
            action, result = manifest.value(case, MF.action), manifest.value(case, MF.result)
            assert result != SHT.Failure, "no core test asks for a failure"
            report = rdflib.Graph()
            for each in manifest.objects(result, SH.result):
                report.add((case, SH.result, each))
                for triple in manifest.triples((each, None, None)):
                    report.add(triple)
            data, shapes = (manifest.value(action, graph) for graph in (SHT.dataGraph, SHT.shapesGraph))
            yield path.stem, named(data), named(shapes), report


def comparable(found: list[Violation]) -> Counter[tuple[str, ...]]:
    """Results without messages; blank nodes have no name to compare by."""

    def name(term: str | None) -> str:
        return str(term) if term is None or "://" in term else "_"

    return Counter(
        (name(each.focus), name(each.path), str(each.value), str(each.component), name(each.shape))
        for each in found
    )


@pytest.mark.parametrize("name", ENGINES)
def test_the_shacl_core_tests_pass_but_for_those_that_are_named(name: str, reference: Path) -> None:
    engine: Engine = ENGINES[name]
    count, missed = 0, set[str]()
    for test, data, shapes, report in cases(reference / "w3c" / "shacl" / "tests" / "core"):
        count += 1
        expected = comparable(read_report(data, shapes, report))
        if comparable(check(data, shapes, [], engine)) != expected:
            missed.add(test)
    assert count == TESTS
    assert missed == MISSES[name]
