"""What a query's text tells: whether it only compares numbers, and which triples it asks for."""

import re
from typing import Any, Final, cast

import rdflib
from pyparsing import ParseBaseException
from rdflib.plugins.sparql import prepareQuery

from sdt_kg.iri import PREFIXES, Iri

WORDS: Final = frozenset(
    {
        *("ask", "select", "distinct", "where", "filter", "not", "exists", "minus"),
        *("optional", "union", "prefix", "in", "order", "by", "asc", "desc"),
        *("limit", "offset", "values", "bound", "true", "false", "a", "as"),
    }
)
"""Keywords under which only the order of numbers counts; what is not listed is not trusted."""

_TOKEN: Final = re.compile(
    r"""
    (?P<skip>\s+|\#[^\r\n]*)
  | (?P<iri><[^<>"{}|^`\\\s&(),?$]*>)
  | (?P<string>"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*')
  | (?P<variable>[?$]\w+)
  | (?P<number>(?:\d+\.\d+|\.\d+|\d+)(?:[eE][+-]?\d+)?)
  | (?P<name>(?:[A-Za-z][\w-]*)?:[\w-]*)
  | (?P<word>[A-Za-z]\w*)
  | (?P<mark>&&|\|\||<=|>=|!=|[{}();.,<>=!*])
    """,
    re.VERBOSE,
)


def only_compares(sparql: str) -> bool:
    """Whether the answer depends on numbers by comparisons alone, as far as a look at its words tells.

    Sufficient, not necessary: arithmetic, signs, property paths, functions, typed literals, aggregates
    and named graphs are not trusted, nor is what this does not know.
    """
    before = ""
    for kind, part in tokens(sparql):
        if kind == "unknown":
            return False
        if kind == "word" and part.lower() not in WORDS:
            return False
        if part == "(" and before in {"name", "iri"}:
            return False
        if part == "*" and before != "select":
            return False
        before = part.lower() if kind == "word" else kind
    return True


def numbers_in(sparql: str) -> list[float]:
    """Numbers that the query spells."""
    return [float(part) for kind, part in tokens(sparql) if kind == "number"]


def predicates_in(sparql: str) -> frozenset[Iri] | None:
    """Predicates of all its triple patterns; None where one is a variable or a path, or if in doubt."""
    found = _patterns(sparql)
    named = None if found is None else [predicate for _, predicate, _ in found]
    if named is None or not all(isinstance(each, rdflib.URIRef) for each in named):
        return None
    return frozenset(map(str, named))


def only_asks_for(sparql: str, kinds: frozenset[Iri]) -> bool:
    """Whether all that its triple patterns are about is of one of these classes; no if in doubt."""
    found = _patterns(sparql)
    if found is None or predicates_in(sparql) is None:
        return False
    typed = {subject for subject, name, kind in found if name == rdflib.RDF.type and str(kind) in kinds}
    return all(subject in typed for subject, _, _ in found)


def _patterns(sparql: str) -> list[tuple[object, object, object]] | None:
    """All triple patterns; None if in doubt."""
    algebra = algebra_of(sparql)
    return None if algebra is None else _triples(algebra)


def algebra_of(sparql: str) -> Any:  # noqa: ANN401 - rdflib does not type it
    """What the query means; None where two parsers do not agree on it, or it is nested deeply."""
    try:
        return prepareQuery(sparql, initNs=PREFIXES).algebra
    except (ParseBaseException, RecursionError):
        return None


def _triples(part: Any) -> list[tuple[object, object, object]]:  # noqa: ANN401 - a tree of rdflib's own kinds
    """The triple patterns anywhere in a part of an algebra."""
    found: list[tuple[object, object, object]] = []
    parts: Any = part
    if isinstance(part, dict):  # an algebra's node, whose own get() answers for what it lacks
        if "triples" in part:
            for triples in parts["triples"]:  # each one triple, or several in a row
                found += zip(triples[::3], triples[1::3], triples[2::3], strict=True)
        parts = list(parts.values())
    if isinstance(parts, list | tuple):
        for each in cast("list[Any]", parts):
            found += _triples(each)
    return found


def tokens(sparql: str) -> list[tuple[str, str]]:
    """Kind and text of each part; what is no known part is `unknown`."""
    found: list[tuple[str, str]] = []
    at = 0
    while at < len(sparql):
        match = _TOKEN.match(sparql, at)
        if match is None:
            found.append(("unknown", sparql[at]))
            at += 1
            continue
        if match.lastgroup != "skip":
            found.append((str(match.lastgroup), match.group()))
        at = match.end()
    return found
