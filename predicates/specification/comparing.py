"""Whether a query can do no more with a number than to compare it, and with which numbers."""

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
        *("bind"),
    }
)
"""Keywords under which only the order of numbers counts; what is not listed is not trusted."""

_TOKEN: Final = re.compile(
    r"""
    (?P<skip>\s+|\#[^\n]*)
  | (?P<iri><[^<>"{}|^`\\\s]*>)
  | (?P<string>"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*')
  | (?P<variable>[?$]\w+)
  | (?P<number>(?:\d+\.\d+|\.\d+|\d+)(?:[eE][+-]?\d+)?)
  | (?P<name>[A-Za-z][\w-]*:[\w-]*)
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
    for kind, part in _tokens(sparql):
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
    return [float(part) for kind, part in _tokens(sparql) if kind == "number"]


def predicates_in(sparql: str) -> frozenset[Iri] | None:
    """Predicates of all its triple patterns; None where one is a variable or a path, or if in doubt."""
    try:
        algebra: Any = prepareQuery(sparql, initNs=PREFIXES).algebra  # rdflib does not type it
    except ParseBaseException:  # what two parsers do not agree on
        return None
    found: set[Iri] = set()
    for predicate in _predicates(algebra):
        if not isinstance(predicate, rdflib.URIRef):
            return None
        found.add(str(predicate))
    return frozenset(found)


def _predicates(part: Any) -> list[object]:  # noqa: ANN401 - a tree of rdflib's own kinds
    """Predicates of the triple patterns anywhere in a part of an algebra."""
    found: list[object] = []
    parts: Any = part
    if isinstance(part, dict):  # an algebra's node, whose own get() answers for what it lacks
        if "triples" in part:
            for triples in parts["triples"]:  # each one triple, or several in a row
                found += triples[1::3]
        parts = list(parts.values())
    if isinstance(parts, list | tuple):
        for each in cast("list[Any]", parts):
            found += _predicates(each)
    return found


def _tokens(sparql: str) -> list[tuple[str, str]]:
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
