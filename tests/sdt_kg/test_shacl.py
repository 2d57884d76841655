"""pySHACL is imported without rdflib's SPARQL, and whoever needs that, a shape too, has all of it."""

from tests.sdt_kg.test_loader import said

JUDGE = (
    "import rdflib, sys; from sdt_kg.shacl import pyshacl_report; "
    "shapes = rdflib.Graph().parse(data='''"
    "@prefix sh: <http://www.w3.org/ns/shacl#> . "
    "<e:shape> a sh:NodeShape ; sh:targetNode <e:a> ; {} .''', format='turtle'); "
    "data = rdflib.Graph().parse(data='<e:a> <e:p> 1 .', format='turtle'); "
    "report = pyshacl_report(data, shapes); "
    "found = len(list(report.subjects(None, rdflib.SH.ValidationResult))); "
)
PLAIN = "sh:property [ sh:path <e:p> ; sh:minCount 2 ]"
SPARQL = 'sh:sparql [ sh:message "one" ; sh:select "SELECT $this ?value { $this <e:p> ?value }" ]'
GRAMMAR = "'rdflib.plugins.sparql.parser' in sys.modules"


def test_shapes_are_judged_without_a_grammar_of_sparql() -> None:
    assert said(JUDGE.format(PLAIN) + f"print(found, {GRAMMAR})") == "1 False"


def test_a_shape_with_sparql_is_judged_as_ever() -> None:
    assert said(JUDGE.format(SPARQL) + f"print(found, {GRAMMAR})") == "1 True"


def test_rdflib_answers_queries_after_it_and_gives_its_parser() -> None:
    later = "rows = list(data.query('SELECT ?s { ?s ?p 1 }')); "
    parsed = "from rdflib.plugins.sparql import prepareQuery, operators; prepareQuery('ASK {}'); "
    shown = "print(len(rows), operators is sys.modules['rdflib.plugins.sparql.operators'])"
    assert said(JUDGE.format(PLAIN) + later + parsed + shown) == "1 True"


def test_beside_other_threads_it_is_imported_whole() -> None:
    threaded = "import threading; stop = threading.Event(); threading.Thread(target=stop.wait).start(); "
    assert said(threaded + JUDGE.format(PLAIN) + f"print(found, {GRAMMAR}); stop.set()") == "1 True"
