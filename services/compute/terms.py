"""What the terms of a SPARQL query are about: verdicts, twins, or records that no judging makes."""

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Final

import rdflib
from rdflib.namespace import RDF, RDFS
from rdflib.paths import InvPath, NegatedPath, Path, SequencePath
from rdflib.plugins.sparql.parserutils import CompValue
from rdflib.term import BNode, Identifier, Node, URIRef, Variable

import ontology
from sdt_kg.iri import LAW, SDT, TEE, Iri, graph_iri, verdict_iri

Triple = tuple[Node, Node | Path, Node]
Values = Mapping[Node, frozenset[Node]]

MADE_BY: Final = {
    LAW + "LearnedPhysics": "sdt learn",
    LAW + "Observation": "sdt learn",
    LAW + "TaskSpecification": "sdt task",
    LAW + "Rule": "sdt task",
    LAW + "TaskResult": "sdt task",
    LAW + "StepResult": "sdt task",
    LAW + "RuleAnswer": "sdt task",
}
"""Classes of law: whose individuals come from no judging of a case, and the command that makes them."""

_NO_VERDICT_HAS: Final = {LAW + "taskOutcome": LAW + "TaskResult"}
"""Properties whose domain verdicts belong to, and of which class's records they are."""

_ABOUT_VERDICTS: Final = (LAW, verdict_iri(""), graph_iri("verdict", ""))
"""How terms begin with which a query asks about verdicts."""

_UNREAD: Final = "InversePath"
"""rdflib's parser forgets what stands behind ^ in !(…)."""


_TAKING_BACK: Final = frozenset(
    {
        *("AskQuery", "LeftJoin", "Minus", "AggregateJoin", "Group", "Slice"),
        *("Builtin_EXISTS", "Builtin_NOTEXISTS", "GroupGraphPatternSub"),
    }
)
"""Parts of rdflib's algebra of which one more solution can take an answer away."""


def is_about_verdicts(node: object) -> bool:
    """Whether a term of law:, or the IRI of a verdict or its graph, is in it, in a text too."""
    return any(
        term == _UNREAD or (not isinstance(term, Variable) and str(term).startswith(_ABOUT_VERDICTS))
        for term in _mentioned(node)
    )


def is_of_verdict(triple: Triple, values: Values) -> bool:
    """Whether its subject may be part of a verdict's record: none of these has terms of sdt: or tee:.

    Args:
        triple: Its predicate may be a path, but no sequence.
        values: What variables can be.
    """
    _, predicate, value = triple
    term = value if predicate == RDF.type else predicate
    if str(term) in _made_otherwise():
        return False
    if isinstance(term, Path):
        return _is_negated(term) or not all(map(_is_of_twin, _mentioned(term)))
    if isinstance(term, Variable):
        return term not in values or not all(map(_is_of_twin, values[term]))
    return not _is_of_twin(term)


def kinds_made_otherwise(node: object) -> tuple[Iri, ...]:
    """Classes of records that the terms in it belong to and no judging makes, in alphabetical order."""
    named = {_made_otherwise().get(str(term)) for term in _mentioned(node)}
    return tuple(sorted(kind for kind in named if kind is not None))


def expanded(triple: Triple) -> Iterator[Triple]:
    """A path of steps as triples, step by step, with a variable between two steps and for a blank node."""
    subject, predicate, value = triple
    subject, value = (Variable(f"_:{each}") if isinstance(each, BNode) else each for each in (subject, value))
    if isinstance(predicate, SequencePath):
        steps = list(predicate.args)
        nodes = [subject, *(Variable(f"{id(predicate)}_{index}") for index in range(1, len(steps))), value]
        for index, step in enumerate(steps):
            yield from expanded((nodes[index], step, nodes[index + 1]))
    elif isinstance(predicate, InvPath):
        yield from expanded((value, predicate.arg, subject))
    else:
        yield subject, predicate, value


def _mentioned(node: object) -> Iterator[object]:
    """Every term in a part of rdflib's algebra, those of property paths too."""
    if isinstance(node, Identifier):
        yield node
    elif isinstance(node, CompValue) and node.name == _UNREAD:
        yield _UNREAD
    elif isinstance(node, Mapping):
        yield from _mentioned([*node.keys(), *node.values()])
    elif isinstance(node, Path):
        yield from _mentioned(list(vars(node).values()))
    elif isinstance(node, list | tuple | set | frozenset):
        for part in node:
            yield from _mentioned(part)


def takes_back(part: object) -> bool:
    """Whether a query may answer something only because a verdict is not there: no such thing, fewer, no."""
    if isinstance(part, CompValue) and part.name in _TAKING_BACK:
        return True
    parts = list(part.values()) if isinstance(part, Mapping) else part
    return isinstance(parts, list | tuple) and any(map(takes_back, parts))


def _is_negated(path: object) -> bool:
    """Whether a part of the path is !(…)."""
    parts = list(vars(path).values()) if isinstance(path, Path) else path
    return isinstance(path, NegatedPath) or (isinstance(parts, list) and any(map(_is_negated, parts)))


def _is_of_twin(term: object) -> bool:
    return str(term).startswith((SDT, TEE))


@cache
def _made_otherwise() -> Mapping[str, Iri]:
    """Classes of law: and properties of theirs → the class whose records no judging makes."""
    graph = rdflib.Graph().parse(ontology.path("law.ttl"))
    found = {
        str(narrower): kind
        for kind in MADE_BY
        for narrower in graph.transitive_subjects(RDFS.subClassOf, URIRef(kind))
    }
    properties = graph.subject_objects(RDFS.domain)
    own = {str(each): found[str(domain)] for each, domain in properties if str(domain) in found}
    return found | own | _NO_VERDICT_HAS
