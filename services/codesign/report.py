"""A grid as rows and as JSON: what is certified in each world, what turned and why, what was reused."""

from collections.abc import Sequence

from services.codesign.entries import REUSED, Entry, Grid, How, Json

AS_IT_IS = "as it is"
ENTRY_COLUMNS = (
    "edits",
    "kitchen",
    "robot",
    "container",
    "outcome",
    "satisfiesRequest",
    "causes",
    "canPerform",
    "proof",
    "turned",
    "how",
    "why",
    "iri",
)


def world_name(edits: Sequence[str]) -> str:
    """The edits of a world in one line."""
    return "; ".join(edits) or AS_IT_IS


def outcome_name(entry: Entry) -> str:
    """The outcome, or that there is no such world, or no verdict."""
    if entry.found.outcome is not None:
        return entry.found.outcome.value
    return "no verdict" if entry.found.how is How.LOST else "no such world"


def counts(grid: Grid) -> list[Json]:
    """One row for each world: certified of judged, for each kitchen and robot, and by how many more."""
    rows: dict[tuple[str, ...], dict[str, list[int]]] = {}
    for each in grid.entries:
        count = rows.setdefault(each.edits, {}).setdefault(f"{each.kitchen} {each.robot}", [0, 0])
        count[0] += each.found.is_certified
        count[1] += each.found.outcome is not None
    actual = rows[()]
    made: list[Json] = []
    for edits, row in rows.items():
        made.append({"world": world_name(edits), **{name: _count(row[name], actual[name]) for name in row}})
    return made


def _count(count: Sequence[int], actual: Sequence[int]) -> str:
    if not count[1]:
        return "no such world"
    more = count[0] - actual[0]
    return f"{count[0]} / {count[1]}" + (f" ({more:+d})" if more else "")


def turned_predicates(one: Entry, other: Entry) -> str:
    """Which predicates answer otherwise, in words."""
    words = {True: "yes", False: "no", None: "not asked"}
    return ", ".join(
        f"{name} {words[before]} → {words[after]}"
        for name, before in one.found.holds.items()
        if (after := other.found.holds.get(name)) is not before and after is not None
    )


def turned_rows(grid: Grid) -> list[Json]:
    """What turned, which predicate, and why."""
    return [
        {
            "world": world_name(other.edits),
            "kitchen": other.kitchen,
            "robot": other.robot,
            "container": other.container,
            "outcome": f"{outcome_name(one)} → {outcome_name(other)}",
            "predicates": turned_predicates(one, other),
            "why": why(other) or f"no longer: {why(one)}",
        }
        for one, other in grid.turned()
    ]


def why(entry: Entry) -> str:
    """The first reason, with how sure it is."""
    if not entry.found.diagnoses:
        return ""
    first = entry.found.diagnoses[0]
    basis = entry.found.basis
    return f"{first['reason']}" + (f" ({basis})" if basis else "")


def entry_rows(grid: Grid) -> list[Json]:
    """Every entry on one line."""
    turned = {id(other) for _, other in grid.turned()}
    return [
        {
            "edits": world_name(each.edits),
            "kitchen": each.kitchen,
            "robot": each.robot,
            "container": each.container,
            "outcome": outcome_name(each),
            **each.found.holds,
            "proof": each.found.is_proved,
            "turned": id(each) in turned,
            "how": each.found.how.value,
            "why": why(each),
            "iri": each.found.iri,
        }
        for each in grid.entries
    ]


def reuse(grid: Grid) -> Json:
    """How many outcomes of edited worlds rest on the search in the world as it is, and how much was swept."""
    edited = grid.edited()
    swept = [each.found.swept for each in edited if each.found.swept is not None]
    return {
        "cases": len(edited),
        "without_a_search": sum(each.found.how in REUSED for each in edited),
        "how": {how.value: count for how in How if (count := sum(each.found.how is how for each in edited))},
        "pairs_swept": sum(each.pairs for each in swept),
        "pairs_of_full_certificates": sum(each.of for each in swept),
    }


def reuse_lines(grid: Grid) -> list[str]:
    """The same in words."""
    said = reuse(grid)
    lines = [
        f"{said['without_a_search']} of {said['cases']} cases of edited worlds without a search of their own"
    ]
    how = said["how"]
    assert isinstance(how, dict), "a count for each"
    lines += [f"  {count:5d}  {name}" for name, count in how.items()]
    if said["pairs_of_full_certificates"]:
        swept = f"{said['pairs_swept']} of {said['pairs_of_full_certificates']} pairs of shapes"
        lines.append(f"  certified again by sweeping {swept}: the others neither differ nor move otherwise")
    return lines


def to_json(grid: Grid) -> Json:
    """The object that `sdt whatif --grid --json` prints."""
    return {
        "worlds": counts(grid),
        "turned": turned_rows(grid),
        "cells": [
            row | {"diagnoses": list(entry.found.diagnoses)}
            for row, entry in zip(entry_rows(grid), grid.entries, strict=True)
        ],
        "reused": reuse(grid),
        "seconds": round(grid.seconds, 3),
        "cpu_seconds": round(grid.cpu_seconds, 3),
    }
