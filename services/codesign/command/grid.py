"""`sdt whatif --grid`: many cases in many worlds."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from sdt_kg.errors import InputError
from services.app import Policy
from services.codesign.entries import Entry, Grid, How
from services.codesign.grid import Asked, Report, run, worlds_of
from services.codesign.report import ENTRY_COLUMNS, counts, entry_rows, reuse_lines, to_json, turned_rows
from services.commands.exits import Exit
from services.commands.show import csv_text, print_json, print_rows, progress
from services.relative import Relative
from services.store.output import write_file

TURNED_COLUMNS = ("world", "kitchen", "robot", "container", "outcome", "predicates", "why")


def asked_of(  # noqa: PLR0917 - what the command was told
    kitchens: str,
    robots: str,
    task: str,
    edits: tuple[str, ...],
    states: tuple[str, ...],
    policy: Policy,
    relative: Relative,
) -> Asked:
    """What a grid is about, as it is typed.

    Raises:
        InputError: No such verb, or an edit that is none.
    """
    verb, _, containers = task.partition(":")
    if verb not in {"open", "close"}:
        raise InputError(f"no task type '{verb}'", allowed="open, close, open:CONTAINER,CONTAINER")
    return Asked(
        tuple(kitchens.split(",")),
        tuple(robots.split(",")),
        verb,
        worlds_of(edits),
        policy,
        states,
        tuple(containers.split(",")) if containers else (),
        relative,
    )


def judged(asked: Asked, jobs: int) -> Grid:
    """All entries, with a bar on a terminal."""
    with on_a_bar("worlds") as report:
        return run(asked, jobs, report)


@contextmanager
def on_a_bar(title: str) -> Iterator[Report]:
    """Entries are told by a bar, if this is a terminal."""
    with progress(title, 0, "cases") as bar:

        def report(entry: Entry) -> None:
            if bar:
                bar.update(bar.task_ids[0], advance=1, now=f"{entry.robot} {entry.container}")

        yield report


def told(grid: Grid, csv_file: Path | None, *, as_json: bool) -> None:
    """Print what was found."""
    if csv_file:
        write_file(csv_file, csv_text(entry_rows(grid), ENTRY_COLUMNS))
    if as_json:
        print_json(to_json(grid))
        return
    rows = counts(grid)
    print_rows(rows, tuple(rows[0]))
    turned = turned_rows(grid)
    if turned:
        click.echo("\nwhat turns:\n")
        print_rows(turned, TURNED_COLUMNS)
    click.echo("")
    for line in reuse_lines(grid):
        click.echo(line)
    click.echo(f"\n{len(grid.entries)} cases in {grid.seconds:.0f} s ({grid.cpu_seconds:.0f} s of CPU)")


def ends_with(grid: Grid) -> Exit:
    """What the command ends with: whether every case has a verdict."""
    return Exit.NO_ORACLE if any(each.found.how is How.LOST for each in grid.entries) else Exit.DONE
