"""Tools that read: entities, vocabulary, rows, and what lies inside a class of the theory."""

import asyncio
import re
from difflib import get_close_matches
from functools import lru_cache
from typing import Final

import pyoxigraph as ox

import ontology
from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import PREFIXES, Iri, local_name
from sdt_kg.scope import D_ARTIC, violations
from sdt_kg.twin import Container, Twin
from services.mcp_server import arguments
from services.mcp_server.desk import ROWS, VOCABULARIES, Desk
from services.mcp_server.report import Json, Report
from services.ontology_page.spelling import absences, unknown_terms

CELL: Final = 160
"""[characters] Of one value in a table; longer ones are cut, with a mark."""
NEAR: Final = 8
"""Names that are told when none fits."""

ENTITIES: Final = """
SELECT DISTINCT ?entity ?type ?label
WHERE { ?entity a ?type . OPTIONAL { ?entity rdfs:label ?label } }
ORDER BY ?entity ?type
"""
TERMS: Final = """
SELECT ?term ?kind ?comment ?domain ?range
WHERE {
  ?term a ?kind ; rdfs:comment ?comment .
  FILTER(?kind IN (owl:Class, owl:ObjectProperty, owl:DatatypeProperty, owl:NamedIndividual))
  OPTIONAL { ?term rdfs:domain ?domain }
  OPTIONAL { ?term rdfs:range ?range }
}
ORDER BY ?term
"""


async def lookup(desk: Desk, asked: arguments.Lookup) -> Report:
    """Entities whose name, label or IRI has the text in it; exact ones first."""
    twin = desk.service(asked.kitchen).twin
    known = entities(twin)
    text = asked.name.casefold()
    ranked = sorted((rank, iri) for iri, names in known.items() if (rank := _rank(text, names)) is not None)
    if not ranked:
        near = get_close_matches(asked.name, [names[0] for names in known.values()], NEAR, 0.5)
        allowed = "did you mean " + ", ".join(near) + "?" if near else "a name in this kitchen"
        said = f"nothing in kitchen {twin.name(twin.environment)} has '{asked.name}' in its name; {allowed}"
        return Report((said,), {"entities": [], "near": near, "left_out": 0})
    containers = {each.iri: each for each in twin.containers()}
    found = [_entity(iri, known[iri], containers.get(iri)) for _, iri in ranked]
    lines = [f"{len(found)} in kitchen {twin.name(twin.environment)}", *(_words(each) for each in found)]
    return Report(tuple(lines), {"entities": found}, "entities", "ask for a longer part of the name")


@lru_cache(maxsize=16)
def entities(twin: Twin) -> dict[Iri, tuple[str, ...]]:
    """IRI → name, label, then types of everything in the twin."""
    found: dict[Iri, tuple[str, ...]] = {}
    for row in twin.query(ENTITIES)[1]:
        iri = str(row["entity"])
        first = (local_name(iri), str(row["label"] or ""))
        found[iri] = (*found.get(iri, first), local_name(str(row["type"])))
    return found


def _rank(text: str, names: tuple[str, ...]) -> int | None:
    """0 exact, 1 at the beginning, 2 inside; None: not there."""
    own = [each.casefold() for each in names[:2] if each]
    if text in own:
        return 0
    if any(each.startswith(text) for each in own):
        return 1
    return 2 if any(text in each for each in own) else None


def _entity(iri: Iri, names: tuple[str, ...], container: Container | None) -> Json:
    found: Json = {"name": names[0], "iri": iri, "types": list(dict.fromkeys(names[2:]))}
    if container is None:
        return found
    return found | {
        "joint": local_name(container.joint),
        "handle": local_name(container.handle),
        "limits": [container.lower, container.upper],
        "open_from": container.open_from,
        "unit": "rad" if container.kind == "door" else "m",
    }


def _words(entity: Json) -> str:
    text = f"{entity['name']} ({', '.join(entity['types'])}) <{entity['iri']}>"
    if "joint" not in entity:
        return text
    lower, upper = entity["limits"]
    return (
        f"{text}: joint {entity['joint']} {lower:g} to {upper:g} {entity['unit']}, "
        f"open from {entity['open_from']:g}, handle {entity['handle']}"
    )


async def schema(desk: Desk, asked: arguments.Schema) -> Report:
    """All names of the vocabulary, or what one of them means."""
    del desk
    known = terms()
    if asked.term is None:
        lines = [
            "Prefixes: " + ", ".join(f"{name}: <{iri}>" for name, iri in PREFIXES.items() if name in _OWN)
        ]
        for kind in dict.fromkeys(each["kind"] for each in known.values()):
            names = [name for name, each in known.items() if each["kind"] == kind]
            lines.append(f"{kind}: {' '.join(names)}")
        lines.append("schema with 'term' says what one means")
        return Report(tuple(lines), {"terms": list(known)}, "terms", "ask with 'term'")
    short = asked.term.split(":")[-1].rsplit("#", 1)[-1]
    found = {name: each for name, each in known.items() if name.split(":")[1] == short}
    if not found:
        raise UnknownEntityError(
            "term", asked.term, (name.split(":")[1] for name in known), "schema lists all"
        )
    lines = [line for name, each in found.items() for line in _meaning(name, each)]
    return Report(tuple(lines), {"terms": [{"name": name, **each} for name, each in found.items()]}, "terms")


_PLAIN: Final = re.compile(r"[A-Za-z_][\w-]*")
_OWN: Final = ("sdt", "law", "tee", "id")


@lru_cache(maxsize=1)
def terms() -> dict[str, Json]:
    """Prefixed name → kind, comment, domain and range, of our own vocabularies."""
    store = ox.Store()
    for file in VOCABULARIES:
        store.load(ontology.path(file).read_bytes(), format=ox.RdfFormat.TURTLE)
    solutions = store.query(TERMS, prefixes=PREFIXES)
    assert isinstance(solutions, ox.QuerySolutions), "a SELECT"
    found: dict[str, Json] = {}
    for row in solutions:
        term, kind, comment, domain, range_ = (
            row[name] for name in ("term", "kind", "comment", "domain", "range")
        )
        parts = {
            "kind": _short(kind),
            "comment": comment.value,
            "domain": _short(domain),
            "range": _short(range_),
        }
        found[_short(term)] = {name: value for name, value in parts.items() if value}
    return dict(sorted(found.items(), key=lambda item: (item[1]["kind"], item[0])))


def _short(node: object) -> str:
    """With a prefix, where SPARQL reads it back so; else the IRI as it is."""
    if not isinstance(node, ox.NamedNode):
        return ""
    for name, iri in PREFIXES.items():
        local = node.value.removeprefix(iri)
        if local != node.value and _PLAIN.fullmatch(local):
            return f"{name}:{local}"
    return f"<{node.value}>"


def _meaning(name: str, term: Json) -> list[str]:
    ends = [f"{end} {term[end]}" for end in ("domain", "range") if end in term]
    return [f"{name} ({', '.join([term['kind'], *ends])})", f"  {term['comment']}"]


async def select(desk: Desk, asked: arguments.Select) -> Report:
    """Rows of a query over twins, present states, vocabularies and the verdicts of this session."""
    found = await desk.query(asked.query)
    notes = list(unknown_terms(asked.query))
    notes += [absent for ask, absent in absences(asked.query).items() if not await desk.query(ask)]
    told: Json = {"notes": notes} if notes else {}
    if isinstance(found, ox.QueryBoolean):
        return Report(("yes" if found else "no", *notes), {"answer": bool(found)} | told)
    columns = [each.value for each in found.variables]
    rows = [[_cell(solution[name]) for name in columns] for solution in found]
    shown = rows[: asked.rows]
    head = f"{len(rows)} rows" + (f", the first {len(shown)} of them here" if len(shown) < len(rows) else "")
    lines = (head, *notes, " | ".join(columns), *(" | ".join(row) for row in shown))
    more = f"ask for more 'rows' (up to 200) or with LIMIT and OFFSET; {ROWS} rows are the most of any query"
    data: Json = {"columns": columns, "count": len(rows), "rows": shown}
    return Report(lines, data | told, "rows", more, len(rows) - len(shown))


def _cell(node: object) -> str:
    if node is None:
        return ""
    text = _short(node) or (node.value if isinstance(node, ox.Literal) else str(node))
    text = " ".join(text.split())
    return text if len(text) <= CELL else f"{text[:CELL]}… ({len(text)} characters)"


async def list_scopes(desk: Desk, asked: arguments.ListScopes) -> Report:
    """Each TEE class, and for each kitchen and robot which containers are inside."""
    kitchens = [asked.kitchen] if asked.kitchen else list(desk.services)
    found: list[Json] = []
    for name in kitchens:
        service = desk.service(name)
        robots = [desk.robot(service, asked.robot)] if asked.robot else list(service.twin.robots)
        found += await asyncio.to_thread(_scopes, service.twin, tuple(robots))
    lines = [f"{D_ARTIC.name} <{D_ARTIC.iri}>: {terms()['tee:D_artic']['comment']}"]
    lines.append("Outside of it the Law abstains.")
    for each in found:
        lines.append(f"kitchen {each['kitchen']}, {', '.join(each['robots'])}: {len(each['inside'])} inside")
        lines += [f"  inside: {', '.join(each['inside'])}"] if each["inside"] else []
        lines += [f"  outside: {out['container']}: {out['why']}" for out in each["outside"]]
    data = {"class": D_ARTIC.iri, "scopes": found}
    return Report(tuple(lines), data, "scopes", "ask with 'kitchen' and 'robot'")


@lru_cache(maxsize=16)
def _scopes(twin: Twin, robots: tuple[Iri, ...]) -> list[Json]:
    """What is inside; robots for which it is the same are told together."""
    found: list[Json] = []
    for robot in robots:
        inside, outside = list[str](), list[Json]()
        for container in twin.containers():
            wrong = violations(twin, container, robot)
            if wrong:
                outside.append(
                    {"container": container.name, "why": wrong[0].message, "violations": len(wrong)}
                )
            else:
                inside.append(container.name)
        same = [each for each in found if (each["inside"], each["outside"]) == (inside, outside)]
        if same:
            same[0]["robots"].append(twin.name(robot))
        else:
            found.append(
                {
                    "kitchen": twin.name(twin.environment),
                    "robots": [twin.name(robot)],
                    "inside": inside,
                    "outside": outside,
                }
            )
    return found
