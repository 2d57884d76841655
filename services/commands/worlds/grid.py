"""`sdt whatif --grid`: many cases in many worlds."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from services.app import Policy
from services.codesign.asked import Asked, task_of_grid, worlds_of
from services.codesign.entries import Entry, Grid, How
from services.codesign.grid import Report, run
from services.codesign.report import ENTRY_COLUMNS, reuse_lines
from services.commands.exits import Exit
from services.commands.show import csv_is_asked, csv_text, print_json, print_rows, progress
from services.commands.verdicts import Json
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
    verb, containers = task_of_grid(task)
    models = tuple(kitchens.split(",")), tuple(robots.split(","))
    return Asked(*models, verb, worlds_of(edits), policy, states, containers, relative)


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


def told(said: Json, csv_file: Path | None = None, *, as_json: bool) -> None:
    """Print what was found, of the JSON object of a grid; every case where CSV is asked for."""
    if csv_file:
        write_file(csv_file, csv_text(said["cells"], ENTRY_COLUMNS))
    if as_json:
        print_json(said)
        return
    if csv_is_asked():
        print_rows(said["cells"], ENTRY_COLUMNS)
        return
    print_rows(said["worlds"], tuple(said["worlds"][0]))
    if said["turned"]:
        click.echo("\nwhat turns:\n")
        print_rows(said["turned"], TURNED_COLUMNS)
    click.echo("")
    for line in reuse_lines(said["reused"]):
        click.echo(line)
    click.echo(
        f"\n{len(said['cells'])} cases in {said['seconds']:.0f} s ({said['cpu_seconds']:.0f} s of CPU)"
    )


def ends_with(said: Json) -> Exit:
    """What the command ends with: whether every case has a verdict."""
    return Exit.NO_ORACLE if any(each["how"] == How.LOST.value for each in said["cells"]) else Exit.DONE
