"""Which verdicts a SPARQL query can be about: its patterns over law:, and what they demand of a case.

Every bound found here holds of all verdicts that the pattern can match in a solution that survives, so
that leaving the other cases out cannot change the answer. What cannot be told bounds nothing. A query
without any term of law: is no question about verdicts, `?s ?p ?o` or the names of graphs: nothing is
computed for it. In one that has such a term, whatever can match a verdict's record counts.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

from rdflib.plugins.sparql.algebra import translateQuery, traverse
from rdflib.plugins.sparql.parser import parseQuery
from rdflib.plugins.sparql.parserutils import CompValue
from rdflib.term import Literal, Node, URIRef, Variable

from sdt_kg.errors import QueryError
from sdt_kg.iri import LAW, PREFIXES, PROV, Iri, verdict_iri
from services.compute.certain import Algebra, certain
from services.compute.terms import (
    Triple,
    expanded,
    is_about_verdicts,
    is_of_verdict,
    kinds_made_otherwise,
    takes_back,
)

Bound = frozenset[str] | None
"""IRIs or texts that a part of the case may be; None for any."""

_CONJUNCTIVE: Final = {"Join": ("p1", "p2"), "LeftJoin": ("p1",), "Minus": ("p1",)}
_PASSED: Final = {"Project", "Distinct", "Reduced", "OrderBy", "Slice", "Filter", "Extend", "Graph"}
_OWN: Final = {"LeftJoin": ("p2",), "Minus": ("p2",), "Union": ("p1", "p2")}
_BARRIERS: Final = {"AggregateJoin", "Group", "ToMultiSet"}
_UNTRANSLATED: Final = "GroupGraphPatternSub"
"""What rdflib leaves of an EXISTS that is selected: syntax, in which paths are not resolved."""
_TESTS: Final = {"Builtin_EXISTS", "Builtin_NOTEXISTS"}

_ESCAPED: Final = re.compile(r"\\(.)")

_PARTS: Final = {
    "environment": "environments",
    "robot": "robots",
    "container": "containers",
    "verb": "verbs",
    "drive": "drives",
    "teeClass": "classes",
}


@dataclass(frozen=True, slots=True)
class Pattern:
    """What a query demands of the verdicts that one of its variables stands for.

    Attributes:
        environments: IRIs of kitchens; None for any.
        robots: IRIs.
        verbs: law:Open, law:Close.
        containers: IRIs.
        drives: omni, differential, fixed.
        classes: IRIs of classes D.
        verdicts: IRIs of the verdicts themselves.
    """

    environments: Bound = None
    robots: Bound = None
    verbs: Bound = None
    containers: Bound = None
    drives: Bound = None
    classes: Bound = None
    verdicts: Bound = None


@dataclass(frozen=True, slots=True)
class _Scope:
    """What is known of every solution that a group pattern contributes to."""

    triples: tuple[Triple, ...] = ()
    values: Mapping[Node, frozenset[Node]] = field(default_factory=dict[Node, frozenset[Node]])


def verdict_patterns(sparql: str) -> tuple[Pattern, ...]:
    """One pattern for each variable of the query that stands for verdicts, or for parts of them.

    Raises:
        QueryError: rdflib does not parse it, so that nothing is known of what it asks.
    """
    algebra = _translated(sparql)
    if not is_about_verdicts(algebra):
        return ()
    found = [] if algebra.p is None else list(_patterns(algebra.p, _Scope()))
    described = [frozenset({str(each)}) for each in algebra.PV or () if isinstance(each, URIRef)]
    return tuple(dict.fromkeys([*found, *(Pattern(verdicts=each) for each in described)]))


def not_judged(sparql: str) -> tuple[Iri, ...]:
    """Classes of records that the query asks for and that no judging makes; raises as `verdict_patterns`."""
    return kinds_made_otherwise(_translated(sparql))


def may_take_back(sparql: str) -> bool:
    """Whether one more verdict can make an answer of the query false; raises as `verdict_patterns`."""
    return takes_back(_translated(sparql))


def _translated(sparql: str) -> Algebra:
    try:
        parsed = parseQuery(sparql)
        traverse(parsed, _unescaped)
        return translateQuery(parsed, initNs=dict(PREFIXES)).algebra
    except Exception as error:  # noqa: BLE001 - rdflib's translation has no exception of its own
        raise QueryError(
            f"cannot tell what the query asks for: {error}",
            allowed="SPARQL 1.1",
            remedy="ask without --compute",
        ) from None


def _unescaped(node: object) -> None:
    r"""Names as they are meant: of `id:b\/body`, as we write it, rdflib makes an IRI with a backslash."""
    if isinstance(node, CompValue) and node.name == "pname" and "localname" in node:
        node["localname"] = _ESCAPED.sub(r"\1", node["localname"])


def _patterns(group: Algebra, outer: _Scope) -> Iterator[Pattern]:
    """Patterns of a group, then of the groups in it that solutions need not match."""
    if group.name == _UNTRANSLATED:
        yield Pattern()
        return
    own = tuple(step for triple in _triples(group) for step in expanded(triple))
    values = dict(outer.values)
    for variable, found in _values(group):
        values[variable] = values[variable] & found if variable in values else found
    scope = _Scope((*outer.triples, *own), values)
    yield from _own_patterns(own, scope)
    if any(node.name == "Graph" and not any(_triples(node.p)) for node in _conjuncts(group)):
        yield Pattern()  # what matches without a triple matches once in each verdict's graph
    for inner, shared in _inner(group):
        yield from _patterns(inner, scope if shared is None else _of_shared(scope, shared, inner))


def _conjuncts(node: Algebra) -> Iterator[Algebra]:
    """The node, and the nodes in it that every solution of it has matched."""
    yield node
    names = _CONJUNCTIVE.get(node.name, ("p",) if node.name in _PASSED else ())
    for name in names:
        if name in node:
            yield from _conjuncts(node[name])


def _triples(group: Algebra) -> Iterator[Triple]:
    for node in _conjuncts(group):
        if node.name == "BGP":
            yield from node.triples


def _inner(group: Algebra) -> Iterator[tuple[Algebra, frozenset[Node] | None]]:
    """Groups inside that need not match, and the variables through which they hang together with the rest.

    A solution of an OPTIONAL, a MINUS or an EXISTS counts even if it fits nothing that is joined
    later: only what the part before it binds for certain is known there. None: whatever is known.
    """
    for node in _conjuncts(group):
        for name in _OWN.get(node.name, ()):
            yield node[name], None if node.name == "Union" else certain(node.p1)
        if node.name in _BARRIERS and node.p.name != "values":
            yield node.p, frozenset()
        for name in ("expr", "A"):
            if name in node:
                before = certain(node.p1 if node.name == "LeftJoin" else node.p)
                yield from ((test.graph, before) for test in _tests(node[name]))


def _of_shared(scope: _Scope, shared: frozenset[Node], inner: Algebra) -> _Scope:
    """What is known outside, the variables that are not shared having other names than inside."""

    def renamed(node: Node) -> Node:
        return Variable(f"{node}_{id(inner)}") if isinstance(node, Variable) and node not in shared else node

    triples = tuple((renamed(s), p, renamed(o)) for s, p, o in scope.triples)
    return _Scope(triples, {renamed(variable): found for variable, found in scope.values.items()})


def _tests(expression: Algebra) -> Iterator[Algebra]:
    """EXISTS and NOT EXISTS in an expression."""
    if isinstance(expression, list | tuple):
        for each in expression:
            yield from _tests(each)
    elif isinstance(expression, CompValue):
        if expression.name in _TESTS:
            yield expression
        else:
            for each in expression.values():
                yield from _tests(each)


def _values(group: Algebra) -> Iterator[tuple[Node, frozenset[Node]]]:
    """Variables whose value is one of these in every solution: by VALUES, BIND or FILTER."""
    for node in _conjuncts(group):
        if node.name == "ToMultiSet" and node.p.name == "values":
            for variable in {variable for row in node.p.res for variable in row}:
                found = [row.get(variable) for row in node.p.res]
                if all(isinstance(each, URIRef | Literal) for each in found):
                    yield variable, frozenset(found)
        elif node.name == "Extend" and isinstance(node.expr, URIRef | Literal):
            yield node.var, frozenset({node.expr})
        elif node.name == "Filter":
            yield from _equalities(node.expr)


def _equalities(expression: Algebra) -> Iterator[tuple[Node, frozenset[Node]]]:
    """`?x = constant` and `?x IN (constants)`, joined by &&."""
    name = getattr(expression, "name", "")
    if name == "ConditionalAndExpression":
        for each in (expression.expr, *expression.other):
            yield from _equalities(each)
    elif name == "RelationalExpression" and expression.op in {"=", "IN"}:
        left, right = expression.expr, expression.other
        if expression.op == "=" and isinstance(right, Variable):
            left, right = right, left
        constants = list(right) if expression.op == "IN" else [right]
        if isinstance(left, Variable) and all(isinstance(each, URIRef | Literal) for each in constants):
            yield left, frozenset(constants)


def _own_patterns(own: Iterable[Triple], scope: _Scope) -> Iterator[Pattern]:
    """A pattern for each root of the group's law: triples."""
    owners: dict[Node, Node] = {
        value: subject
        for subject, predicate, value in scope.triples
        if isinstance(predicate, URIRef) and str(predicate).startswith((LAW, PROV))
        if isinstance(value, Variable) and str(predicate).removeprefix(LAW) not in _PARTS
    }
    others = {value for _, predicate, value in scope.triples if _part(predicate) is not None}
    others |= {each[0] for each in scope.triples if not is_of_verdict(each, scope.values)}
    for subject, _, _ in own:
        root = _root(subject, owners)
        if not others & {subject, root}:
            yield _pattern(root, owners, scope)


def _part(predicate: object) -> str | None:
    """The bound of a pattern that a property of law: gives."""
    return _PARTS.get(str(predicate).removeprefix(LAW)) if str(predicate).startswith(LAW) else None


def _root(node: Node, owners: Mapping[Node, Node]) -> Node:
    """The verdict of which a node is a part; itself where nobody says of what it is one."""
    seen: set[Node] = set()
    while node in owners and node not in seen:
        seen.add(node)
        node = owners[node]
    return node


def _pattern(root: Node, owners: Mapping[Node, Node], scope: _Scope) -> Pattern:
    """What the scope's triples demand of the case of this verdict."""
    bounds: dict[str, frozenset[str]] = {}
    themselves = scope.values.get(root) if isinstance(root, Variable) else frozenset({root})
    if themselves is not None:
        bounds["verdicts"] = frozenset(_verdict_of(str(each)) for each in themselves)
    for subject, predicate, value in scope.triples:
        name = _part(predicate)
        if name is None or _root(subject, owners) != root:
            continue
        found = scope.values.get(value) if isinstance(value, Variable) else frozenset({value})
        if found is not None:
            texts = frozenset(str(each) for each in found)
            bounds[name] = bounds[name] & texts if name in bounds else texts
    return Pattern(**bounds)


def _verdict_of(iri: str) -> str:
    """The verdict that has a part of this IRI."""
    stem = verdict_iri("")
    return stem + iri.removeprefix(stem).partition("/")[0] if iri.startswith(stem) else iri
