"""Variables that every solution of a group binds."""

from typing import Any

from rdflib.paths import Path
from rdflib.term import Literal, Node, URIRef, Variable

Algebra = Any  # rdflib's CompValue, whose parts are looked up by name

NOTHING: frozenset[Node] = frozenset()


def certain(node: Algebra) -> frozenset[Node]:
    """Variables that are bound in every solution; rather too few of them than one too many."""
    name = node.name
    if name == "BGP":
        terms = {term for triple in node.triples for term in triple if not isinstance(term, Path)}
        return frozenset(term for term in terms if isinstance(term, Variable))
    if name in {"Join", "Union"}:
        first, second = certain(node.p1), certain(node.p2)
        return first | second if name == "Join" else first & second
    if name in {"LeftJoin", "Minus"}:
        return certain(node.p1)
    if name == "ToMultiSet":
        return _of_values(node.p)
    own = {node.var} if name == "Extend" and isinstance(node.expr, URIRef | Literal) else NOTHING
    return certain(node.p) | own if name in {"Filter", "Graph", "Extend"} else NOTHING


def _of_values(node: Algebra) -> frozenset[Node]:
    """Variables which each row of VALUES defines; none of a subquery."""
    rows = node.res if node.name == "values" else []
    bound = [{each for each, term in row.items() if isinstance(term, URIRef | Literal)} for row in rows]
    return frozenset(set.intersection(*bound)) if bound else NOTHING
