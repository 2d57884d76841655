"""Pages for people: the start page and one page for each resource. No script, nothing from elsewhere."""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import jinja2
import pyoxigraph as ox
from starlette.requests import Request
from starlette.responses import HTMLResponse

import ontology
from sdt_kg.iri import ID, PREFIXES, RDFS, Iri, local_name

EXAMPLE = """SELECT ?container ?robot ?outcome WHERE {
  ?verdict law:container ?container ; law:robot ?robot ; law:outcome ?outcome .
}
LIMIT 100"""


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


def home(request: Request) -> HTMLResponse:
    """The start page."""
    kitchens = request.app.state.world.kitchens.values()
    listed = [
        (
            cell(ox.NamedNode(kitchen.twin.environment)),
            [cell(ox.NamedNode(robot)) for robot in kitchen.twin.robots],
        )
        for kitchen in kitchens
    ]
    return HTMLResponse(_template("home").render(kitchens=listed, example=EXAMPLE, prefixes=sorted(PREFIXES)))


def resource(iri: Iri, quads: list[ox.Quad], story: str) -> HTMLResponse:
    """What the graphs say about a resource, and who mentions it."""
    node = ox.NamedNode(iri)
    about = sorted(
        (
            (cell(quad.predicate), cell(quad.object), cell(quad.graph_name))
            for quad in quads
            if quad.subject == node
        ),
        key=_order,
    )
    mentions = sorted(
        (
            (cell(quad.subject), cell(quad.predicate), cell(quad.graph_name))
            for quad in quads
            if quad.object == node
        ),
        key=_order,
    )
    page = _template("resource").render(
        iri=iri, name=local_name(iri) or iri, about=about, mentions=mentions, story=story
    )
    return HTMLResponse(page)


def cell(term: object) -> Cell:
    """A term as people read it: prefixed or local names, links into this service."""
    if isinstance(term, ox.NamedNode):
        iri = term.value
        if iri.startswith(ID):
            return Cell(iri.removeprefix(ID), "/id/" + iri.removeprefix(ID), iri)
        return Cell(_short(iri), "", _meanings().get(iri, iri))
    if isinstance(term, ox.Literal):
        return Cell(term.value, "", _short(term.datatype.value))
    return Cell(str(term))


def _order(row: tuple[Cell, ...]) -> list[tuple[str, int, str]]:
    """By text, numbers in texts by their size."""
    digits = [re.search(r"(\d+)$", each.text) for each in row]
    return [
        (each.text.rstrip("0123456789"), int(found[1]) if found and len(found[1]) < 10 else 0, each.text)
        for each, found in zip(row, digits, strict=True)
    ]


def _short(iri: Iri) -> str:
    for prefix, namespace in PREFIXES.items():
        if iri.startswith(namespace):
            return f"{prefix}:{iri.removeprefix(namespace)}"
    return iri


@cache
def _meanings() -> dict[Iri, str]:
    """Term → its comment in our vocabularies."""
    comments: dict[Iri, str] = {}
    for file in ("sdt.ttl", "tee.ttl", "law.ttl"):
        for quad in ox.parse(ontology.path(file).read_bytes(), format=ox.RdfFormat.TURTLE):
            if quad.predicate.value == RDFS + "comment" and isinstance(quad.subject, ox.NamedNode):
                comments[quad.subject.value] = str(getattr(quad.object, "value", ""))
    return comments


@cache
def _template(name: str) -> jinja2.Template:
    folder = Path(__file__).resolve().parent / "templates"
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder), autoescape=True, undefined=jinja2.StrictUndefined
    )
    return environment.get_template(f"{name}.html")
