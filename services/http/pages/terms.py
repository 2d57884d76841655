"""Terms as people read them: short names, with links into this service."""

import re
from dataclasses import dataclass
from functools import cache
from typing import Final
from urllib.parse import unquote, urlencode

import pyoxigraph as ox

import ontology
from sdt_kg.iri import ID, PREFIXES, RDFS, Iri

LONGEST: Final = 400
"""[characters] Of a literal in a table; the data has all of it."""


@dataclass(frozen=True, slots=True)
class Cell:
    """What stands in a table.

    Attributes:
        text: What is read.
        link: Where it leads within this service, or empty.
        hint: What it means, or the full IRI.
    """

    text: str
    link: str = ""
    hint: str = ""


def cell(term: object) -> Cell:
    """A term as people read it: prefixed or local names, links into this service."""
    if isinstance(term, ox.NamedNode):
        return iri_cell(term.value)
    if isinstance(term, ox.Literal):
        return Cell(_cut(term.value), "", short(term.datatype.value))
    return Cell(str(term))


def iri_cell(iri: Iri) -> Cell:
    """An IRI as people read it."""
    if iri.startswith(ID) and len(iri) > len(ID):
        return Cell(shown_id(iri), id_link(iri), iri)
    return Cell(short(iri), f"/about?{urlencode({'iri': iri})}", meanings().get(iri, iri))


def shown_id(iri: Iri) -> str:
    """One of our individuals without the namespace; hashes by their beginning."""
    return re.sub(r"([0-9a-f]{12})[0-9a-f]{20,}", r"\1…", unquote(iri.removeprefix(ID)))


def id_link(iri: Iri) -> str:
    """Page of one of our individuals."""
    return "/id/" + iri.removeprefix(ID)


def ordered(rows: list[tuple[Cell, ...]]) -> list[tuple[Cell, ...]]:
    """By text, numbers in texts by their size."""
    return sorted(rows, key=_order)


def short(iri: Iri) -> str:
    """With a prefix, where one is known."""
    for prefix, namespace in PREFIXES.items():
        if iri.startswith(namespace):
            return f"{prefix}:{iri.removeprefix(namespace)}"
    return iri


@cache
def meanings() -> dict[Iri, str]:
    """Term → its comment in our vocabularies."""
    comments: dict[Iri, str] = {}
    for file in ("sdt.ttl", "tee.ttl", "law.ttl"):
        for quad in ox.parse(ontology.path(file).read_bytes(), format=ox.RdfFormat.TURTLE):
            if quad.predicate.value == RDFS + "comment" and isinstance(quad.subject, ox.NamedNode):
                comments[quad.subject.value] = str(getattr(quad.object, "value", ""))
    return comments


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}… ({len(text)} characters)"


def _order(row: tuple[Cell, ...]) -> list[tuple[str, int, str]]:
    digits = [re.search(r"(\d+)$", each.text) for each in row]
    return [
        (each.text.rstrip("0123456789"), int(found[1]) if found and len(found[1]) < 10 else 0, each.text)
        for each, found in zip(row, digits, strict=True)
    ]
