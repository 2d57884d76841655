"""`sdt scope --explain`: the map of a kitchen over all TEE classes."""

from pathlib import Path

import click

from sdt_kg.iri import Iri, local_name
from sdt_kg.naming import few
from services.app import load
from services.commands.exits import Exit
from services.commands.show import note_lengths, print_json, print_rows
from services.scoping import End, Lack, ScopeMap, scope_map, to_json

LACK_COLUMNS = ("class", "containers", "property", "value", "bound", "missing", "needs", "what to do")
END_COLUMNS = ("class", "containers", "property", "value", "bound", "room")
NAMED = 3
"""[1] Containers that a row names; of more it says how many."""


def explain(
    kitchen: str,
    robot: str | None,
    annotation: str | None,
    forces: tuple[Path | None, float | None],
    *,
    as_json: bool,
) -> int:
    """Print the map; the exit code: 0 if every container is in some class, else 3.

    Forces are those of the file, else what is bundled for the kitchen; a force [N] that is given besides is
    allowed at every handle.
    """
    service = load(kitchen, [robot] if robot else [], annotation=annotation).with_forces(*forces)
    twin = service.twin
    note_lengths(twin)
    found = scope_map(twin, twin.robots[0] if robot else None)
    if as_json:
        print_json(to_json(twin.name(twin.environment), found))
    else:
        _print(found)
    somewhere = {name for each in found.classes for name in found.inside(each)}
    everywhere = {each.container for each in found.members}
    return Exit.DONE if somewhere == everywhere else Exit.ABSTAINED


def _print(found: ScopeMap) -> None:
    count = len({each.container for each in found.members})
    rows = [
        {
            "class": each.name,
            "refines": "" if each.refined is None else each.refined.name,
            "in": len(found.inside(each)),
            "of": count,
        }
        for each in found.classes
    ]
    print_rows(rows, ("class", "refines", "in", "of"))
    lacking = _lack_rows(found)
    if lacking:
        click.echo("\noutside, and what would bring them in:\n")
        print_rows(lacking, LACK_COLUMNS)
    ends = _end_rows(found)
    if ends:
        click.echo("\nwhere the interval ends, for what comes nearest to an end:\n")
        print_rows(ends, END_COLUMNS)
    if found.left_out:
        click.echo("\nno containers, and why:\n")
        left = [{"body": local_name(each.body), "reason": each.reason} for each in found.left_out]
        print_rows(left, ("body", "reason"))


def _lack_rows(found: ScopeMap) -> list[dict[str, object]]:
    """One row for each thing that is lacking, with the containers that lack it."""
    groups: dict[tuple[str, str, object, object, str], tuple[Lack, list[str]]] = {}
    for member in found.members:
        for lack in member.lacks:
            key = member.tee.name, lack.path or "", lack.value, lack.bound, lack.message
            names = groups.setdefault(key, (lack, []))[1]
            if member.container not in names:  # several of its joints may lack the same
                names.append(member.container)
    return [
        {
            "class": name,
            "containers": few(containers, NAMED),
            "property": "" if lack.path is None else local_name(lack.path),
            "value": "not given" if lack.is_unmeasured else _short(lack.value),
            "bound": lack.bound,
            "missing": lack.missing,
            "needs": lack.demanded,
            "what to do": lack.message,
        }
        for (name, *_), (lack, containers) in groups.items()
    ]


def _short(value: object) -> object:
    return local_name(value) if isinstance(value, str) else value


def _end_rows(found: ScopeMap) -> list[dict[str, object]]:
    """Of each container the end that is nearest, and on which no value lies by its own meaning, as 0 does."""
    groups: dict[tuple[str, Iri, float, float], tuple[End, list[str]]] = {}
    for member in found.members:
        end = next((each for each in member.ends if each.room > 0), None)
        if end is not None:
            key = member.tee.name, end.path, end.value, end.bound
            groups.setdefault(key, (end, []))[1].append(member.container)
    return [
        {
            "class": name,
            "containers": few(containers, NAMED),
            "property": local_name(end.path),
            "value": end.value,
            "bound": end.bound,
            "room": end.room,
        }
        for (name, *_), (end, containers) in groups.items()
    ]
