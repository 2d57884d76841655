"""What a query may ask for: it reads, and it reads only graphs that are here.

An update is no query to pyoxigraph's parser, which has no LOAD, INSERT or DELETE in it. That leaves
SERVICE, which fetches, and FROM of a graph that is not here, which silently answers nothing.

Two parsers of two grammars may disagree where a comment or a string ends, so the tree of one is no
statement about what the other will do. Hence three walls: rdflib's tree says whether there is a SERVICE
or a FROM; the text which pyoxigraph gets never contains the word SERVICE, since in strings and IRIs it
is written with an escape and anywhere else the escape is a syntax error; and the process which
evaluates it has no network (`services.store.workers.confine`).
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

from sdt_kg.errors import QueryError
from sdt_kg.iri import PREFIXES, Iri

READS: Final = "SELECT, ASK, CONSTRUCT, DESCRIBE over the graphs of this store"
KEPT_TEXTS: Final = 512
"""Parsed queries that are remembered."""

_CODE_POINT: Final = re.compile(r"\\u([0-9A-Fa-f]{4})|\\U([0-9A-Fa-f]{8})")
_NAME_WITH_FROM: Final = re.compile(r"[:?$]\w*from\w*", re.IGNORECASE)
"""Prefixed names and variables: `sdt:openFrom`, `?from`. They end before no keyword."""
_SERVICE: Final = re.compile("service", re.IGNORECASE)
_LONE_RETURN: Final = re.compile(r"\r(?!\n)")
_LAST_CODE_POINT: Final = 0x10FFFF


class RefusedQueryError(QueryError):
    """A query that can be read, and asks for what is not done here: SERVICE, or a graph that is not here."""


@dataclass(frozen=True, slots=True)
class Checked:
    """A query that may be evaluated.

    Attributes:
        text: What to evaluate; it means what was given.
        default_graphs: IRIs after FROM.
        named_graphs: IRIs after FROM NAMED.
    """

    text: str
    default_graphs: tuple[Iri, ...] = ()
    named_graphs: tuple[Iri, ...] = ()

    @property
    def has_dataset(self) -> bool:
        """Whether the query says which graphs it is about."""
        return bool(self.default_graphs or self.named_graphs)


def guarded(sparql: str, is_graph: Callable[[Iri], bool], base: Iri | None = None) -> Checked:
    """The query, if it only reads graphs that are here.

    Args:
        sparql: As it came.
        is_graph: Whether a graph is in the store.
        base: IRI against which relative IRIs are resolved.

    Raises:
        RefusedQueryError: It has a SERVICE, or a FROM of a graph that is not in the store.
        QueryError: It has the word SERVICE or FROM and rdflib's parser does not accept it.
    """
    if not _needs_parsing(sparql):
        return Checked(sparql)
    checked = _parsed(sparql, base)
    known_graphs((*checked.default_graphs, *checked.named_graphs), is_graph)
    return checked


def known_graphs(graphs: tuple[Iri, ...], is_graph: Callable[[Iri], bool]) -> None:
    """Nothing, if all these graphs are in the store.

    Raises:
        RefusedQueryError: One is not; nothing is ever fetched.
    """
    for graph in graphs:
        if not is_graph(graph):
            raise RefusedQueryError(
                f"the graph <{graph}> is not in this store, and nothing is fetched",
                allowed="graphs of this store",
                remedy="SELECT DISTINCT ?g { GRAPH ?g { } } lists them",
            )


def _needs_parsing(sparql: str) -> bool:
    """Whether SERVICE or FROM may be in it: false only where neither word occurs, however it is escaped."""
    text = sparql
    while _CODE_POINT.search(text):
        text = _CODE_POINT.sub(_character, text)
    return any(
        "service" in each.casefold() or "from" in _NAME_WITH_FROM.sub(" ", each).casefold()
        for each in (sparql, text)
    )


def _character(escape: re.Match[str]) -> str:
    code = int(escape[1] or escape[2], 16)
    return chr(code) if code <= _LAST_CODE_POINT else "?"


@lru_cache(KEPT_TEXTS)
def _parsed(sparql: str, base: Iri | None) -> Checked:
    """What rdflib's tree says of SERVICE and FROM; the text for pyoxigraph without the word SERVICE."""
    from rdflib.plugins.sparql.algebra import translateQuery  # noqa: PLC0415 - slow to import, seldom needed
    from rdflib.plugins.sparql.parser import Query  # noqa: PLC0415 - with translateQuery

    _read_alike(sparql)
    try:
        tree = Query.parse_string(sparql, parse_all=True)
        services = _services(tree)  # first, since the translation takes the tree apart
        clause = translateQuery(tree, base=base, initNs=PREFIXES).algebra.datasetClause
    except RecursionError:
        raise QueryError("the query is nested too deeply to be checked", allowed=READS) from None
    except Exception as error:  # noqa: BLE001 - rdflib raises bare Exception for an unknown prefix
        what = " ".join(str(error).split())[:200]
        raise QueryError(f"the query is not SPARQL that reads: {what}", allowed=READS) from None
    if services:
        raise RefusedQueryError(
            "the query has a SERVICE, which asks another server", allowed=READS, remedy="leave it out"
        )
    sources = clause or ()
    return Checked(
        _SERVICE.sub(lambda word: f"\\u{ord(word[0][0]):04X}{word[0][1:]}", sparql),
        tuple(str(each.default) for each in sources if each.default),
        tuple(str(each.named) for each in sources if each.named),
    )


def _read_alike(sparql: str) -> None:
    """Nothing, if the two parsers agree on what the characters mean.

    rdflib decodes escapes before it parses and pyoxigraph after; a comment ends at a lone carriage
    return for pyoxigraph and not for rdflib.
    """
    if _CODE_POINT.search(sparql):
        raise QueryError(
            "the query has the word SERVICE or FROM and an escape \\u or \\U",
            allowed="one or the other",
            remedy="write the character itself",
        )
    if _LONE_RETURN.search(sparql):
        raise QueryError(
            "the query has a carriage return without a line feed", allowed="line feeds", remedy="replace it"
        )


def _services(tree: object) -> int:
    """How many SERVICE patterns rdflib's parse tree has."""
    from rdflib.plugins.sparql.parserutils import CompValue  # noqa: PLC0415 - with the parser

    found, pending = 0, list[Any]([tree])  # rdflib's trees are untyped
    while pending:
        node = pending.pop()
        if isinstance(node, CompValue):
            found += node.name == "ServiceGraphPattern"
            pending.extend(node.values())
        elif not isinstance(node, str) and hasattr(node, "__iter__"):
            pending.extend(node)
    return found
