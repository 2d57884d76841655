"""How rows, verdicts and progress look on a terminal, on a pipe, and as JSON or CSV."""

import csv
import io
import json
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, cast

import click

from sdt_kg.twin import Twin

if TYPE_CHECKING:
    from rich.progress import Progress

CSV = "sdt.csv"
"""Key in click's context: the reader asked for CSV (`csv_flag`)."""

Row = Mapping[str, object]


def csv_is_asked() -> bool:
    """Whether the command that runs was asked for CSV."""
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.meta.get(CSV))


def print_json(value: object) -> None:
    """JSON on standard output; JSON has no word for a number without end, so that is null."""
    if csv_is_asked():
        raise click.UsageError("--json and --csv: one of them")
    escaped = "utf" not in (sys.stdout.encoding or "").lower()  # elsewhere some letters cannot be written
    click.echo(json.dumps(_finite(value), indent=2, ensure_ascii=escaped))


def _finite(value: object) -> object:
    match value:
        case float():
            return value if math.isfinite(value) else None
        case dict():
            return {name: _finite(each) for name, each in cast(dict[str, object], value).items()}
        case list() | tuple():
            return [_finite(each) for each in cast(Sequence[object], value)]
        case _:
            return value


def print_rows(rows: Sequence[Row], columns: Sequence[str], *, as_json: bool = False) -> None:
    """Rows as a table, CSV where `csv_flag` asks for that, or JSON; columns are shown even without a row.

    On a terminal that is too narrow for its words a table is one row below the other.
    """
    if as_json:
        print_json([{column: row.get(column) for column in columns} for row in rows])
    elif csv_is_asked():
        click.echo(csv_text(rows, columns), nl=False)
    else:
        from services.commands.terminal import print_table  # noqa: PLC0415 - slow to import

        print_table(columns, [[_cell(row.get(column)) for column in columns] for row in rows])


def csv_text(rows: Sequence[Row], columns: Sequence[str]) -> str:
    """Rows as CSV with a head."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(row.get(column)) for column in columns] for row in rows)
    return out.getvalue()


def _cell(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def note_lengths(twin: Twin) -> None:
    """Say on standard error if the kitchen's lengths may not be in metres."""
    for note in twin.mechanism(twin.environment).oversized:
        click.echo(f"note: {twin.name(twin.environment)}: {note}", err=True)


@contextmanager
def progress(label: str, total: int, counted: str) -> Iterator["Progress | None"]:
    """A progress bar on a terminal, nothing on a pipe.

    Args:
        label: What is done.
        total: How much of it there is; 0 where nobody knows yet.
        counted: Of what: containers, cases, steps.
    """
    if not sys.stderr.isatty():
        yield None
        return
    from services.commands.terminal import bar_of  # noqa: PLC0415 - slow to import, and only people look at it

    with bar_of(label, total, counted) as bar:
        yield bar


@contextmanager
def countdown(label: str, budget: float) -> Iterator[None]:
    """On a terminal, how much of a search's budget [s] is left; nothing on a pipe."""
    if not sys.stderr.isatty():
        yield
        return
    from services.commands.terminal import left_of  # noqa: PLC0415 - likewise

    with left_of(label, budget):
        yield
