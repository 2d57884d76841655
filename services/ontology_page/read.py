"""What the page shows, read from the files of the ontology."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import rdflib
from rdflib.namespace import OWL, RDF, RDFS, SH, VANN
from rdflib.term import Literal, Node, URIRef

import ontology
from sdt_kg.iri import PREFIXES

VOCABULARIES = ("sdt", "tee", "law")
KINDS = {
    "Classes": (OWL.Class,),
    "Properties": (OWL.ObjectProperty, OWL.DatatypeProperty, OWL.AnnotationProperty),
    "Individuals": (OWL.NamedIndividual,),
}
_SAID_ELSEWHERE = {RDF.type, RDFS.label, RDFS.comment, RDFS.isDefinedBy}
_HEAD = re.compile(r"^# (\w+(?: not)?) +(.*(?:\n# {2,}.*)*)", flags=re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Fact:
    """One statement about a term: what is said, and of what, each linked where the page shows it."""

    name: str
    values: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Term:
    """A class, property or individual.

    Attributes:
        name: With prefix, `law:Verdict`.
        facts: Superclasses, domain, range, and so on, as names with prefix or texts.
    """

    name: str
    label: str
    comment: str
    facts: tuple[Fact, ...]


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """One ontology file: its head, and its terms by kind."""

    name: str
    title: str
    comment: str
    facts: tuple[Fact, ...]
    terms: dict[str, tuple[Term, ...]]


@dataclass(frozen=True, slots=True)
class Shape:
    """A node shape: what it looks at, and what it asks of each property, with the message.

    Attributes:
        targets: Empty for a shape that others use.
        parts: Path, constraints, message.
    """

    name: str
    comment: str
    targets: tuple[str, ...]
    parts: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True, slots=True)
class Query:
    """A rule, question or check: the lines of its head, and its text."""

    name: str
    head: tuple[Fact, ...]
    text: str


def vocabulary(name: str) -> Vocabulary:
    """One of the core ontologies."""
    graph = _graph(f"{name}.ttl")
    (head,) = graph.subjects(RDF.type, OWL.Ontology)
    terms = {
        title: tuple(
            _term(graph, each)
            for each in _own(graph, kinds, str(graph.value(head, VANN.preferredNamespaceUri)))
        )
        for title, kinds in KINDS.items()
    }
    said = _facts(graph, head)
    return Vocabulary(
        name, str(graph.value(head, RDFS.label)), str(graph.value(head, RDFS.comment)), said, terms
    )


def shapes(name: str) -> tuple[Shape, ...]:
    """The node shapes of a shapes file; those without a target are parts of others."""
    graph = _graph(f"shapes/{name}.shapes.ttl")
    targets = (SH.targetClass, SH.targetObjectsOf)
    found = sorted(each for each in graph.subjects(RDF.type, SH.NodeShape) if isinstance(each, URIRef))
    return tuple(
        Shape(
            _short(shape, graph),
            str(graph.value(shape, RDFS.comment) or ""),
            tuple(
                f"{_short(target)} {_short(value)}"
                for target in targets
                for value in graph.objects(shape, target)
            ),
            tuple(_part(graph, part) for part in _parts(graph, shape)),
        )
        for shape in found
    )


def queries(pattern: str) -> tuple[Query, ...]:
    """Rules, questions or checks: files of the ontology that match."""
    return tuple(_query(path) for path in sorted(ontology.path("").glob(pattern)))


def alignments() -> dict[str, tuple[tuple[str, str, str], ...]]:
    """Title of each alignment → what it says: our term, how, theirs."""
    found: dict[str, tuple[tuple[str, str, str], ...]] = {}
    for path in sorted(ontology.path("alignments").glob("*.ttl")):
        graph = _graph(f"alignments/{path.name}")
        (head,) = graph.subjects(RDF.type, OWL.Ontology)
        ours = tuple(str(namespace) for prefix, namespace in PREFIXES.items() if prefix in VOCABULARIES)
        rows = sorted(
            (_short(subject, graph), _short(predicate, graph), _short(value, graph))
            for subject, predicate, value in graph
            if str(subject).startswith(ours) and predicate != RDF.type
        )
        found[str(graph.value(head, RDFS.label))] = tuple(rows)
    return found


def _graph(name: str) -> rdflib.Graph:
    return rdflib.Graph().parse(ontology.path(name))


def _own(graph: rdflib.Graph, kinds: Iterable[URIRef], namespace: str) -> list[URIRef]:
    found = {term for kind in kinds for term in graph.subjects(RDF.type, kind)}
    own = [term for term in found if isinstance(term, URIRef) and term.startswith(namespace)]
    return sorted(
        (term for term in own if graph.value(term, RDFS.comment)), key=lambda term: str(term).lower()
    )


def _term(graph: rdflib.Graph, term: URIRef) -> Term:
    inverse = [
        Fact(title, tuple(sorted(_short(each) for each in graph.subjects(predicate, term))))
        for title, predicate in (
            ("subclasses", RDFS.subClassOf),
            ("properties", RDFS.domain),
            ("values of", RDFS.range),
            ("individuals", RDF.type),
        )
    ]
    kinds = [each for each in graph.objects(term, RDF.type) if each not in {OWL.Class, OWL.NamedIndividual}]
    is_a = Fact("is a", tuple(sorted(_short(kind) for kind in kinds)))
    facts = (is_a, *_facts(graph, term), *inverse)
    label, comment = (str(graph.value(term, each)) for each in (RDFS.label, RDFS.comment))
    return Term(_short(term), label, comment, tuple(fact for fact in facts if fact.values))


def _facts(graph: rdflib.Graph, subject: Node) -> tuple[Fact, ...]:
    """Everything that is said of a subject beyond its type, label and comment."""
    said = {each for each in graph.predicates(subject) if each not in _SAID_ELSEWHERE}
    return tuple(
        Fact(
            _short(each, graph), tuple(sorted(_short(value, graph) for value in graph.objects(subject, each)))
        )
        for each in sorted(said, key=str)
    )


def _parts(graph: rdflib.Graph, shape: Node) -> list[Node]:
    """The shape itself, if it asks for something by itself, and its property shapes."""
    own = [shape] if graph.value(shape, SH.message) is not None else []
    return own + sorted(graph.objects(shape, SH.property), key=str)


def _part(graph: rdflib.Graph, part: Node) -> tuple[str, str, str]:
    """Path, constraints, message of a shape; its path is `itself` where it has none."""
    skipped = {RDF.type, RDFS.label, RDFS.comment, SH.path, SH.message, SH.property}
    skipped |= {SH.targetClass, SH.targetObjectsOf}
    constraints = sorted(
        f"{_short(predicate)} {_value(graph, value)}"
        for predicate, value in graph.predicate_objects(part)
        if predicate not in skipped
    )
    path, message = graph.value(part, SH.path), graph.value(part, SH.message)
    return "itself" if path is None else _short(path), ", ".join(constraints), str(message or "")


def _value(graph: rdflib.Graph, node: Node) -> str:
    """A value, or the values of a list."""
    if graph.value(node, RDF.first) is None:
        return _short(node, graph)
    return "( " + " ".join(_short(each, graph) for each in graph.items(node)) + " )"


def _query(path: Path) -> Query:
    text = path.read_text(encoding="utf-8")
    facts = tuple(Fact(name, (_joined(value),)) for name, value in _HEAD.findall(text))
    body = "\n".join(line for line in text.splitlines() if not line.startswith("#"))
    return Query(path.name.split(".")[0], facts, body.strip())


def _joined(value: str) -> str:
    return " ".join(line.lstrip("# ").strip() for line in value.splitlines())


def _short(node: Node | None, graph: rdflib.Graph | None = None) -> str:
    """A name with prefix, a literal's text, or the IRI."""
    if node is None or isinstance(node, Literal):
        return "" if node is None else str(node)
    prefixes = {**(dict(_prefixes(graph)) if graph is not None else {}), **PREFIXES}
    for prefix, namespace in sorted(prefixes.items(), key=lambda each: -len(each[1])):
        local = str(node).removeprefix(namespace)
        if local != str(node) and local:
            return f"{prefix}:{local}"
    return str(node)


def _prefixes(graph: rdflib.Graph) -> Iterator[tuple[str, str]]:
    yield from ((prefix, str(namespace)) for prefix, namespace in graph.namespaces() if prefix)
