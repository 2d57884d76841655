"""A query about something that is known: a kitchen, a container, a robot."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import pyoxigraph as ox

from sdt_kg.errors import QueryError
from sdt_kg.iri import PREFIXES
from sdt_kg.store import Term

KEPT_TEXTS: Final = 256
"""Queries whose variables are remembered."""

_TOKENS: Final = re.compile(
    r"""(?P<text>\#[^\r\n]* | <[^<>"{}|^`\\\x00-\x20]*>
        | \"{3}(?:\\.|"{0,2}[^"\\])*\"{3} | '{3}(?:\\.|'{0,2}[^'\\])*'{3}
        | "(?:\\.|[^"\\\r\n])*" | '(?:\\.|[^'\\\r\n])*')
    | (?P<word>[?$]?[\w:@%.\-\\]+) | (?P<mark>[(){}])""",
    re.VERBOSE | re.DOTALL,
)
"""Comments, IRIs and strings, in which no brace counts; words; brackets."""

_STEPS: Final = {"(": 1, "{": 1, ")": -1, "}": -1}


def restricted(sparql: str, known: Mapping[str, Term]) -> str:
    """The query, with a VALUES clause at the beginning of its pattern that fixes these variables.

    Unlike a substitution it is seen by the planner, which starts from what is known: the answer then
    takes as long as there is about that, however much the store holds, also where it is grouped and
    counted. Terms are written as N-Triples has them.

    A variable that the pattern computes makes it no SPARQL any more.

    Raises:
        QueryError: It is no SELECT, or its pattern does not bind one of the variables.
    """
    if not known:
        return sparql
    pattern = _pattern(sparql)
    for name in known:
        if name not in pattern.variables:
            allowed = ", ".join(sorted(pattern.variables)) or "a SELECT with variables"
            raise QueryError(f"the query is not about a ?{name}", allowed=allowed)
    names, terms = " ".join(f"?{name}" for name in known), " ".join(str(term) for term in known.values())
    return f"{sparql[: pattern.start]} VALUES ({names}) {{ ({terms}) }} {sparql[pattern.start :]}"


@dataclass(frozen=True, slots=True)
class _Pattern:
    """The WHERE of a SELECT.

    Attributes:
        start: Where its text begins, behind the brace.
        variables: Those which it binds, selected or not.
    """

    start: int
    variables: frozenset[str]


@lru_cache(maxsize=KEPT_TEXTS)
def _pattern(sparql: str) -> _Pattern:
    """The outermost pattern of a query."""
    if not isinstance(_empty_answer(sparql), ox.QuerySolutions):
        raise QueryError("the query is about nothing that could be known", allowed="SELECT")
    select, start, end = _bounds(sparql)
    solutions = _empty_answer(f"{sparql[:select]} SELECT * {sparql[start:end]}")
    assert isinstance(solutions, ox.QuerySolutions), "it is a SELECT"
    return _Pattern(start + 1, frozenset(variable.value for variable in solutions.variables))


def _empty_answer(sparql: str) -> ox.QuerySolutions | ox.QueryBoolean | ox.QueryTriples:
    """What an empty store answers."""
    try:
        return ox.Store().query(sparql, prefixes=PREFIXES)
    except SyntaxError as error:
        raise QueryError(f"the query is not SPARQL: {error}", allowed="SELECT") from None


def _bounds(sparql: str) -> tuple[int, int, int]:
    """Where SELECT, its pattern's first brace, and what follows the last one, begin."""
    select, start, depth = -1, -1, 0
    for token in _read(sparql):
        if token["word"]:
            if select < 0 and token["word"].casefold() == "select":
                select = token.start()
            continue
        if start < 0 and depth == 0 and token["mark"] == "{":
            start = token.start()
        depth += _STEPS[token["mark"]]
        if depth == 0 and token["mark"] == "}":
            return select, start, token.end()
    raise AssertionError("a SELECT that parses has a pattern")


def _read(sparql: str) -> Iterator[re.Match[str]]:
    return (token for token in _TOKENS.finditer(sparql) if token["text"] is None)
