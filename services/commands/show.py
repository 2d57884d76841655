"""How rows, verdicts and progress look on a terminal, on a pipe, and as JSON or CSV."""

import csv
import io
import json
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import cast

import click
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TextColumn,
    TimeRemainingColumn,
)
from rich.table import Table
from rich.text import Text

PIPE_WIDTH = 400
"""[characters] Wide enough that nothing is cut on a pipe, where no terminal tells its width."""

CSV = "sdt.csv"
"""Key in click's context: the reader asked for CSV (`csv_flag`)."""

Row = Mapping[str, object]


class _Console(Console):
    def on_broken_pipe(self) -> None:
        """Rich would end with 1 where nobody reads on, which says "no" here."""
        self.quiet = True
        raise BrokenPipeError


def console() -> Console:
    """Where people read: full width and no colour on a pipe."""
    return _Console() if sys.stdout.isatty() else _Console(width=PIPE_WIDTH, no_color=True)


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


def print_rows(rows: Sequence[Row], columns: Sequence[str], form: str) -> None:
    """Rows as `table`, `csv` or `json`; the columns are shown even where there is no row.

    A table is CSV where the reader asked for that with `csv_flag`.
    """
    form = "csv" if form == "table" and csv_is_asked() else form
    if form == "json":
        print_json([{column: row.get(column) for column in columns} for row in rows])
    elif form == "csv":
        click.echo(csv_text(rows, columns), nl=False)
    else:
        console().print(_table(rows, columns))


def csv_text(rows: Sequence[Row], columns: Sequence[str]) -> str:
    """Rows as CSV with a head."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(row.get(column)) for column in columns] for row in rows)
    return out.getvalue()


def _table(rows: Sequence[Row], columns: Sequence[str]) -> Table:
    table = Table(box=None, pad_edge=False)
    for column in columns:
        table.add_column(column, overflow="fold")
    for row in rows:
        # As Text, since a name or reason may hold what rich takes for markup.
        table.add_row(*(Text(_cell(row.get(column))) for column in columns))
    return table


def _cell(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


@contextmanager
def progress(label: str, total: int) -> Iterator[Progress | None]:
    """A progress bar on a terminal, nothing on a pipe."""
    if not sys.stderr.isatty():
        yield None
        return
    columns = (
        TextColumn(label),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.fields[now]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        bar.add_task(label, total=total, now="")
        yield bar


@contextmanager
def countdown(label: str, budget: float) -> Iterator[None]:
    """On a terminal, how much of a search's budget [s] is left; nothing on a pipe."""
    if not sys.stderr.isatty():
        yield
        return
    columns = (SpinnerColumn(), TextColumn(label), _Left(budget))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        bar.add_task(label)
        yield


class _Left(ProgressColumn):
    """What is left of a budget [s]."""

    def __init__(self, budget: float) -> None:
        super().__init__()
        self._budget = budget

    def render(self, task: Task) -> Text:
        spent = task.elapsed or 0.0
        return Text(f"{spent:.0f} s, at most {max(self._budget - spent, 0.0):.0f} s more")
