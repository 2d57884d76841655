"""`sdt query --compute`: verdicts that a query asks for and nobody has computed yet, made before it runs."""

import os
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from typing import Any

import click
import pyoxigraph as ox

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.lines import of_lines, to_lines
from sdt_kg.load import load_twin, model_path
from sdt_kg.store import Row, checked_query, rows_of
from services.app import Policy
from services.commands.completion.types import KITCHEN, ROBOT
from services.commands.options import (
    KITCHEN_HELP,
    ROBOT_HELP,
    FiniteRange,
    WholeRange,
    drive_option,
    friction_option,
    states_option,
)
from services.commands.show import print_json, print_rows
from services.compute import Bounds, Computed, Loaded, compute
from services.compute.besides import BESIDES, besides
from services.ontology_page.spelling import matching_nothing
from services.store.embedded import EmbeddedStore
from services.store.files import SavedVerdicts, is_saved_graph, readable
from services.store.workers import Ask, Begin

ComputedTold = tuple[tuple[list[str], list[Row]], list[Row], list[str]]
"""Columns and rows, what is beside them, and notes."""

ALL_KITCHENS, ALL_ROBOTS = ("a", "b"), ("pr2", "tiago_dual", "stretch")

DEFAULT_BUDGET = 120.0
"""[s] For all cases of one query together."""

DEFAULT_LIMIT = 50
"""[cases] For one query."""


@dataclass(frozen=True, slots=True)
class Asked:
    """The options of `--compute` as they were given."""

    kitchens: tuple[str, ...]
    robots: tuple[str, ...]
    states: tuple[str, ...]
    drive: str | None
    friction: float | None
    budget: float
    limit: int
    jobs: int


def compute_options(command: Callable[..., Any]) -> Callable[..., Any]:  # a click command, as click has it
    """`--compute` and what goes with it."""
    options = (
        click.option("--compute", "computes", is_flag=True, help="First run the cases that the query needs."),
        click.option(
            "--kitchen",
            "kitchens",
            multiple=True,
            type=KITCHEN,
            help=KITCHEN_HELP + " Repeatable; else a and b.",
        ),
        click.option(
            "--robot", "robots", multiple=True, type=ROBOT, help=ROBOT_HELP + " Repeatable; else all bundled."
        ),
        states_option,
        drive_option,
        friction_option,
        click.option(
            "--budget",
            type=FiniteRange(min=0, min_open=True),
            default=DEFAULT_BUDGET,
            show_default=True,
            help="Seconds for all cases together.",
        ),
        click.option(
            "--limit",
            type=WholeRange(min=0),
            default=DEFAULT_LIMIT,
            show_default=True,
            help="Cases at most.",
        ),
        click.option(
            "--jobs",
            type=WholeRange(min=1),
            default=os.cpu_count() or 1,
            show_default="all cores",
            help="Worker processes.",
        ),
    )
    for option in reversed(options):
        command = option(command)
    return command


def refuse_without_compute(asked: Asked) -> None:
    """Options that say what may be computed go with `--compute` only."""
    named = {
        "--kitchen": asked.kitchens,
        "--robot": asked.robots,
        "--state": asked.states,
        "--drive": asked.drive,
        "--friction": asked.friction,
    }
    if given := [name for name, value in named.items() if value]:
        raise InputError(f"{', '.join(given)} without --compute", remedy="add --compute")


def print_computed(source: str, sparql: str, asked: Asked, ask: Ask[ComputedTold], *, as_json: bool) -> None:
    """Rows as `print_rows` does, and what was computed: within the JSON, else on standard error."""
    columns, rows, done, besides, notes = computed_rows(source, sparql, asked, ask)
    if as_json:
        found = [{column: row.get(column) for column in columns} for row in rows]
        print_json({"rows": found, "computed": done.to_json() | {"besides": besides}})
    else:
        print_rows(rows, columns)
    click.echo(done.told(), err=True)
    for which, count in besides.items():
        what = f"{count} verdicts there are {which.replace('_', ' ')}"
        click.echo(f"note: {what}: a query that names no input counts them too", err=True)
    for note in notes:
        click.echo(f"note: {note}", err=True)


def computed_rows(
    source: str, sparql: str, asked: Asked, ask: Ask[ComputedTold]
) -> tuple[list[str], list[Row], Computed, dict[str, int], list[str]]:
    """Columns and rows of the query after what it needs was run, what that was, what is beside it, notes.

    Args:
        source: Where verdicts are kept, old and new; or a kitchen, whose verdicts are then not kept.
        sparql: A query that only reads.
        asked: What may be run.
        ask: Asks the query, when it has what it needs, within its limits.
    """
    text = checked_query(sparql)
    is_store = is_saved_graph(source) or (bool(asked.kitchens) and not _is_kitchen(source))
    if not is_store and asked.kitchens:
        raise InputError(f"{source} is a kitchen, and --kitchen names more", allowed="a STORE with --kitchen")
    kitchens = asked.kitchens or (ALL_KITCHENS if is_store else (source,))
    policy = Policy(Drive(asked.drive) if asked.drive else None, friction=asked.friction)
    loaded = Loaded(kitchens, asked.robots or ALL_ROBOTS, asked.states, policy)
    place = source if is_store else EmbeddedStore(ox.Store())
    with SavedVerdicts(place) as saved:
        if not is_store:
            saved.add_twin(load_twin(source))
        done = compute(text, loaded, Bounds(asked.budget, asked.limit, asked.jobs), saved)
        data = source if is_store else to_lines(saved.store.dump())
    (columns, rows), kept, notes = ask(partial(_asked_of, data, text, bool(done.models)))
    said = [{name: str(value) for name, value in row.items() if value is not None} for row in kept]
    return columns, rows, done, dict(besides(said, done.models)), notes


def _asked_of(data: str | bytes, sparql: str, with_besides: bool, begin: Begin) -> ComputedTold:
    """Columns and rows, those of `BESIDES`, and notes; of a store, or of N-Quads."""
    with closing(readable(data) if isinstance(data, str) else EmbeddedStore(of_lines(data))) as store:
        begin()
        found = rows_of(store.query(sparql))
        kept = rows_of(store.query(BESIDES))[1] if with_besides else []
        return found, kept, list(matching_nothing(sparql, lambda ask: bool(store.query(checked_query(ask)))))


def _is_kitchen(source: str) -> bool:
    try:
        model_path("kitchen", source)
    except UnknownEntityError:
        return False
    return True
