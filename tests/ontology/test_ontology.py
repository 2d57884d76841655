"""The ontology is OWL 2 DL, documented, consistent, and says everything that twins use."""

import csv
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import rdflib
from rdflib.namespace import DCTERMS, OWL, RDF, RDFS, VANN, XSD
from rdflib.term import Literal, Node, URIRef

import ontology
from sdt_kg.iri import LAW, SDT, TEE
from sdt_kg.load import load_twin

CORE = ("sdt", "tee", "law")
ALIGNMENTS = sorted(path.stem for path in ontology.path("alignments").glob("*.ttl"))
DOCUMENTED = (OWL.Class, OWL.ObjectProperty, OWL.DatatypeProperty)
OUR = (SDT, TEE, LAW)
SERVING_SEVERAL = {
    "sdt": {
        "contentHash",
        "entityGraph",
        "hasNote",
        "hasPose",
        "index",
        "inferredBy",
        "name",
        "partOf",
        "step",
    },
    "tee": set[str](),
    "law": {
        *("robot", "environment", "task", "container", "motion", "bodyMotion"),  # of cases and verdicts
        *("name", "value", "unit", "entity", "duration", "seconds", "time", "link"),
        "containerName",  # of tasks and of rules
        *("replacedModel", "writer"),  # of named graphs
    },
}
BUILT_IN = tuple(str(namespace) for namespace in (OWL, RDF, RDFS, XSD))


def core() -> rdflib.Graph:
    graph = rdflib.Graph()
    for name in CORE:
        graph.parse(ontology.path(f"{name}.ttl"))
    return graph


def with_alignments() -> rdflib.Graph:
    graph = core()
    for name in ALIGNMENTS:
        graph.parse(ontology.path(f"alignments/{name}.ttl"))
    return graph


def ours(graph: rdflib.Graph) -> list[URIRef]:
    kinds = (*DOCUMENTED, OWL.AnnotationProperty, OWL.NamedIndividual)
    terms = {term for kind in kinds for term in graph.subjects(RDF.type, kind)}
    return sorted(term for term in terms if isinstance(term, URIRef) and str(term).startswith(OUR))


@pytest.mark.parametrize("name", [*CORE, *(f"alignments/{name}" for name in ALIGNMENTS)])
def test_every_file_is_an_ontology_with_a_version(name: str) -> None:
    graph = rdflib.Graph().parse(ontology.path(f"{name}.ttl"))
    (head,) = graph.subjects(RDF.type, OWL.Ontology)
    assert graph.value(head, OWL.versionIRI) is not None
    assert graph.value(head, OWL.imports) is None
    assert graph.value(head, DCTERMS.license) == URIRef("https://www.apache.org/licenses/LICENSE-2.0")
    assert graph.value(head, DCTERMS.creator) is not None
    version = str(graph.value(head, OWL.versionInfo))
    assert str(graph.value(head, OWL.versionIRI)) == f"{head}/{version}"
    if name in CORE:
        assert str(graph.value(head, VANN.preferredNamespacePrefix)) == name
        assert str(graph.value(head, VANN.preferredNamespaceUri)) == f"{head}#"
    assert str(head) == f"https://example.org/{name}"


def test_every_term_has_a_label_and_one_english_sentence() -> None:
    graph = core()
    terms = ours(graph)
    assert len(terms) > 150
    for term in terms:
        labels, comments = list(graph.objects(term, RDFS.label)), list(graph.objects(term, RDFS.comment))
        assert len(labels) == len(comments) == 1, term
        (comment,) = comments
        assert isinstance(comment, Literal)
        assert comment.language == "en", term
        assert re.fullmatch(r"[A-Z].*\.", str(comment)), f"{term}: {comment}"


@pytest.mark.parametrize("name", CORE)
def test_every_term_says_where_it_is_defined(name: str) -> None:
    graph = rdflib.Graph().parse(ontology.path(f"{name}.ttl"))
    own = [term for term in ours(graph) if str(term).startswith(f"https://example.org/{name}#")]
    described = [term for term in own if graph.value(term, RDFS.comment) is not None]
    assert described
    for term in described:
        assert list(graph.objects(term, RDFS.isDefinedBy)) == [URIRef(f"https://example.org/{name}")], term


@pytest.mark.parametrize("name", CORE)
def test_every_property_has_a_domain_or_serves_several(name: str) -> None:
    """A property without domain is one that individuals of unrelated classes have."""
    graph = rdflib.Graph().parse(ontology.path(f"{name}.ttl"))
    properties = {term for kind in DOCUMENTED[1:] for term in graph.subjects(RDF.type, kind)}
    free = {
        str(term).split("#")[1]
        for term in properties
        if str(term).startswith(f"https://example.org/{name}#") and graph.value(term, RDFS.domain) is None
    }
    assert free == SERVING_SEVERAL[name]


def test_every_measured_property_names_its_unit() -> None:
    graph = core()
    unit = re.compile(
        r"\b(in|and|or) (rad|m|kg|s|N)\b|without unit|unit that law:unit|inches|\bas hexadecimal"
    )
    measured = [
        term
        for term in graph.subjects(RDF.type, OWL.DatatypeProperty)
        if graph.value(term, RDFS.range) in (None, XSD.double, XSD.decimal, XSD.integer)
    ]
    assert len(measured) > 60
    assert [str(term) for term in measured if not unit.search(_comment(graph, term))] == []


def _comment(graph: rdflib.Graph, term: Node) -> str:
    return str(graph.value(term, RDFS.comment))


def test_no_property_is_both_object_and_datatype_property() -> None:
    graph = with_alignments()
    kinds = (OWL.ObjectProperty, OWL.DatatypeProperty, OWL.AnnotationProperty)
    for one, other in ((0, 1), (0, 2), (1, 2)):
        both = set(graph.subjects(RDF.type, kinds[one])) & set(graph.subjects(RDF.type, kinds[other]))
        assert both == set()


def test_every_term_that_axioms_use_is_declared() -> None:
    graph = with_alignments()
    declared = {
        term for kind in (*DOCUMENTED, OWL.AnnotationProperty) for term in graph.subjects(RDF.type, kind)
    }
    axioms = (RDFS.subClassOf, RDFS.subPropertyOf, RDFS.domain, RDFS.range, OWL.disjointWith, OWL.inverseOf)
    used = {term for axiom in axioms for pair in graph.subject_objects(axiom) for term in pair}
    used |= {predicate for predicate in graph.predicates() if not str(predicate).startswith(BUILT_IN)}
    used |= {kind for kind in graph.objects(None, RDF.type) if not str(kind).startswith(BUILT_IN)}
    assert {str(term) for term in used - declared if not str(term).startswith(BUILT_IN)} == set()


def test_there_are_no_blank_nodes() -> None:
    assert not [node for node in with_alignments().all_nodes() if isinstance(node, rdflib.BNode)]


def test_every_term_in_rules_queries_and_shapes_is_declared() -> None:
    declared = {str(term) for term in ours(core())}
    files = [
        path
        for pattern in ("rules/*.rq", "queries/*.rq", "checks/*.rq", "shapes/*.ttl")
        for path in _files(pattern)
    ]
    assert len(files) > 20
    spaces = {"sdt": SDT, "tee": TEE, "law": LAW}
    for path in files:
        text = re.sub(r"^#.*$|\"[^\"\n]*\"", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
        for prefix, name in re.findall(r"\b(sdt|tee|law):(\w+)", text):
            assert spaces[prefix] + name in declared, f"{path.name}: {prefix}:{name}"


def test_every_term_that_records_write_is_declared() -> None:
    declared = {str(term) for term in ours(core())}
    sources = sorted((Path(__file__).parents[2] / "predicates").rglob("*.py"))
    text = "\n".join(source.read_text(encoding="utf-8") for source in sources)
    written = set(re.findall(r'LAW \+ "(\w+)"', text))
    assert len(written) > 20
    assert {name for name in written if LAW + name not in declared} == set()


def _files(pattern: str) -> list[Path]:
    return sorted(ontology.path("").glob(pattern))


@pytest.mark.parametrize(
    ("begin", "words"),
    [
        ("rules/", {"Rule", "Source", "Gives"}),
        ("queries/", {"Question", "Source", "Known", "Returns"}),
        ("queries/cq", {"Grows"}),
    ],
)
def test_every_rule_and_query_has_its_head(begin: str, words: set[str]) -> None:
    files = _files(f"{begin}*.rq")
    assert files
    for path in files:
        heads = re.findall(r"^# (\w+) ", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
        assert words <= set(heads), path.name


def as_ntriples(path: Path, graph: rdflib.Graph) -> Path:
    path.write_text(graph.serialize(format="nt"), encoding="utf-8")
    return path


def test_owlready2_loads_it(tmp_path: Path) -> None:
    file = as_ntriples(tmp_path / "sdt.nt", with_alignments())
    code = (
        "import owlready2, sys\n"
        "onto = owlready2.get_ontology('https://example.org/test#')\n"
        "onto.load(fileobj=open(sys.argv[1], 'rb'))\n"
        "door = owlready2.default_world['https://example.org/sdt#Door']\n"
        "print(sorted(cls.name for cls in door.ancestors() if cls.iri.startswith('https://example.org/sdt')))\n"
    )
    run = subprocess.run([sys.executable, "-c", code, str(file)], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "['Body', 'Container', 'Door']"


@pytest.mark.skipif(shutil.which("java") is None, reason="HermiT needs Java")
def test_hermit_finds_it_consistent_and_every_class_satisfiable(tmp_path: Path) -> None:
    file = as_ntriples(tmp_path / "sdt.nt", with_alignments())
    code = (
        "import owlready2, sys\n"
        "onto = owlready2.get_ontology('https://example.org/test#')\n"
        "onto.load(fileobj=open(sys.argv[1], 'rb'))\n"
        "owlready2.sync_reasoner_hermit(debug=0)\n"
        "print(list(owlready2.default_world.inconsistent_classes()))\n"
    )
    run = subprocess.run([sys.executable, "-c", code, str(file)], capture_output=True, text=True, check=True)
    assert run.stdout.strip().splitlines()[-1] == "[]"


def clashes(folder: Path, extra: tuple[Node, Node, Node] | None) -> list[str]:
    """Individuals of two disjoint classes, by OWL 2 RL, in the ontology and a twin."""
    reasonable = pytest.importorskip("reasonable")
    graph = with_alignments()
    for s, p, o, _ in load_twin("b", ["stretch"]).to_rdflib().quads():
        graph.add((s, p, o))
    if extra is not None:
        graph.add(extra)
    reasoner = reasonable.PyReasoner()
    reasoner.from_graph(rdflib.Graph().parse(as_ntriples(folder / "twin.nt", graph), format="nt"))
    inferred = rdflib.Graph()
    for triple in reasoner.reason():
        inferred.add(triple)
    assert (DOOR, RDF.type, URIRef(SDT + "Body")) in inferred, "Door is a Container is a Body"
    found: set[Node] = set(inferred.subjects(RDF.type, OWL.Nothing))
    for one, other in core().subject_objects(OWL.disjointWith):
        found |= set(inferred.subjects(RDF.type, one)) & set(inferred.subjects(RDF.type, other))
    return sorted(map(str, found))


DOOR = URIRef("https://example.org/id/b/body/iai_fridge_door")


def test_without_java_a_twin_is_consistent_with_it(tmp_path: Path) -> None:
    assert clashes(tmp_path, None) == []


def test_without_java_a_door_that_is_a_joint_is_found(tmp_path: Path) -> None:
    assert str(DOOR) in clashes(tmp_path, (DOOR, RDF.type, URIRef(SDT + "RevoluteJoint")))


def listed() -> dict[tuple[str, str], set[str]]:
    """Ontology and version → the terms that it had, of the versions that are done (terms.csv)."""
    found: dict[tuple[str, str], set[str]] = {}
    with (Path(__file__).with_name("terms.csv")).open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            found.setdefault((row["ontology"], row["version"]), set()).add(row["term"])
    return found


@pytest.mark.parametrize("name", CORE)
def test_terms_stay_and_a_version_with_others_has_another_number(name: str) -> None:
    graph = rdflib.Graph().parse(ontology.path(f"{name}.ttl"))
    (head,) = graph.subjects(RDF.type, OWL.Ontology)
    declared = {
        str(term).removeprefix(f"{head}#") for term in ours(graph) if str(term).startswith(f"{head}#")
    }
    done = {version: terms for (each, version), terms in listed().items() if each == name}
    assert done
    assert {version: terms - declared for version, terms in done.items() if terms - declared} == {}
    assert done.get(str(graph.value(head, OWL.versionInfo)), declared) == declared
