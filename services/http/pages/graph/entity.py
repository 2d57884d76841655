"""One resource: what the graphs say about it, and what mentions it."""

from typing import Final
from urllib.parse import quote, urlencode

import pyoxigraph as ox
from starlette.requests import Request

from sdt_kg.iri import ID, RDF, SDT, Iri, local_name
from services.http.pages.terms import cell, iri_cell, ordered
from services.http.pages.view import Json, View
from services.http.world import World

COLUMNS: Final = ("subject", "predicate", "object", "graph")
SHOWN: Final = 300
"""Rows of each table on the page; its data have all that were asked for."""


def entity(request: Request, iri: Iri, quads: list[ox.Quad], most: int) -> View:
    """The page of a resource.

    Args:
        request: For its page.
        iri: Of the resource.
        quads: Those that mention it.
        most: How many quads were asked for, each way.
    """
    node = ox.NamedNode(iri)
    about = [each for each in quads if each.subject == node]
    mentions = [
        each for each in quads if each.object == node != each.subject
    ]  # what it says of itself is above
    kinds = sorted({str(each.object) for each in about if each.predicate.value == RDF + "type"})
    data: Json = {
        "iri": iri,
        "name": local_name(iri) or iri,
        "about": [_json(each) for each in about],
        "mentions": [_json(each) for each in mentions],
        "complete": max(len(about), len(mentions)) < most,
    }
    shown: Json = {
        "kinds": [iri_cell(kind.strip("<>")) for kind in kinds],
        "said": ordered([(cell(each.predicate), cell(each.object), cell(each.graph_name)) for each in about])[
            :SHOWN
        ],
        "mentioned": ordered(
            [(cell(each.subject), cell(each.predicate), cell(each.graph_name)) for each in mentions]
        )[:SHOWN],
        "more": max(len(about), len(mentions)) > SHOWN,
        "rows_shown": SHOWN,
        "most": most,
        "leads": _leads(request.app.state.world, iri, {kind.strip("<>") for kind in kinds}),
        "is_graph": iri.startswith(f"{ID}graph/"),
        "is_own": iri.startswith(ID),
    }
    return View("entity", data, [*data["about"], *data["mentions"]], COLUMNS, shown)


def _leads(world: World, iri: Iri, kinds: set[Iri]) -> list[tuple[str, str]]:
    """Text and address of pages about the same."""
    name = local_name(iri)
    leads: list[tuple[str, str]] = []
    kitchen = next(
        (
            each
            for each in world.kitchens.values()
            if iri == each.twin.environment or iri.startswith(f"{each.twin.environment}/")
        ),
        None,
    )
    if kitchen is not None:
        place = f"/kitchens/{quote(kitchen.name)}"
        leads.append((f"Feasibility in kitchen {kitchen.name}", place))
        leads.append((f"Containers of kitchen {kitchen.name}", f"{place}/containers"))
    for kind, parameter in (("Container", "container"), ("Robot", "robot"), ("Environment", "kitchen")):
        if SDT + kind in kinds:
            leads.append(("Verdicts about it", f"/verdicts?{urlencode({parameter: name})}"))
    return leads


def _json(quad: ox.Quad) -> Json:
    """A quad, IRIs as they are, literals by their text."""
    names = dict(zip(COLUMNS, quad, strict=True))
    return {name: getattr(term, "value", str(term)) for name, term in names.items()}
