"""A grid as rows and as JSON: what is certified in each world, what turned and why, what was reused."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from sdt_kg.load import model_name
from services.codesign.entries import REUSED, Entry, Found, Grid, How, Json

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
    """One row for each world: what `certified_of_judged` says, for each kitchen and robot."""
    rows: dict[tuple[str, ...], dict[str, list[Found]]] = {}
    for each in grid.entries:
        models = f"{model_name(each.kitchen)} {model_name(each.robot)}"
        rows.setdefault(each.edits, {}).setdefault(models, []).append(each.found)
    actual = rows[()]
    return [
        {"world": world_name(edits), **{name: certified_of_judged(row[name], actual[name]) for name in row}}
        for edits, row in rows.items()
    ]


def certified_of_judged(founds: Sequence[Found], actual: Sequence[Found]) -> str:
    """Certified of judged, by how many more than in the world as it is, and how many have no verdict."""
    judged, lost = _judged(founds), sum(each.how is How.LOST for each in founds)
    if not judged:
        return "no verdict" if lost else "no such world"
    certified, before = (sum(each.is_certified for each in some) for some in (founds, actual))
    more = f" ({certified - before:+d})" if certified != before and judged == _judged(actual) else ""
    return f"{certified} / {judged}{more}" + (f", {lost} without a verdict" if lost else "")


def _judged(founds: Sequence[Found]) -> int:
    return sum(each.outcome is not None for each in founds)


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
            "kitchen": model_name(other.kitchen),
            "robot": model_name(other.robot),
            "container": other.container,
            "outcome": f"{outcome_name(one)} → {outcome_name(other)}",
            "predicates": turned_predicates(one, other),
            "why": why(other) or f"no longer: {why(one)}",
        }
        for one, other in grid.turned()
    ]


def why(entry: Entry) -> str:
    """The first reason, with how sure that one is."""
    if not entry.found.diagnoses:
        return ""
    first, *_ = entry.found.diagnoses
    basis = replace(entry.found, diagnoses=(first,)).basis
    return f"{first['reason']}" + (f" ({basis})" if basis else "")


def entry_rows(grid: Grid) -> list[Json]:
    """Every entry on one line."""
    turned = {id(other) for _, other in grid.turned()}
    return [
        {
            "edits": world_name(each.edits),
            "kitchen": model_name(each.kitchen),
            "robot": model_name(each.robot),
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


def reused(grid: Grid) -> Json:
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


def reuse_lines(said: Mapping[str, Any]) -> list[str]:  # JSON
    """What `reused` says, in words."""
    lines = [
        f"{said['without_a_search']} of {said['cases']} cases of edited worlds without a search of their own"
    ]
    lines += [f"  {count:5d}  {name}" for name, count in said["how"].items()]
    if said["pairs_of_full_certificates"]:
        swept = f"{said['pairs_swept']} of {said['pairs_of_full_certificates']} pairs of shapes"
        lines.append(f"  certified again by sweeping {swept}: the others neither differ nor move otherwise")
    return lines


def to_json(grid: Grid) -> Json:
    """The object that `sdt whatif --grid --json` prints; models by their names."""
    return {
        "worlds": counts(grid),
        "turned": turned_rows(grid),
        "cells": [
            row | {"diagnoses": list(entry.found.diagnoses)}
            for row, entry in zip(entry_rows(grid), grid.entries, strict=True)
        ],
        "reused": reused(grid),
        "seconds": round(grid.seconds, 3),
        "cpu_seconds": round(grid.cpu_seconds, 3),
    }
