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
from rich.cells import cell_len
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

BETWEEN = 2
"""[characters] Between columns of a table."""

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


def print_rows(rows: Sequence[Row], columns: Sequence[str], *, as_json: bool = False) -> None:
    """Rows as a table, CSV where `csv_flag` asks for that, or JSON; columns are shown even without a row.

    On a terminal that is too narrow for its words a table is one row below the other.
    """
    if as_json:
        print_json([{column: row.get(column) for column in columns} for row in rows])
    elif csv_is_asked():
        click.echo(csv_text(rows, columns), nl=False)
    else:
        out = console()
        widths = _widths(rows, columns, out.width)
        narrow = columns and not widths
        out.print(_one_below_the_other(rows, columns) if narrow else _table(rows, columns, widths))


def csv_text(rows: Sequence[Row], columns: Sequence[str]) -> str:
    """Rows as CSV with a head."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(row.get(column)) for column in columns] for row in rows)
    return out.getvalue()


def _table(rows: Sequence[Row], columns: Sequence[str], widths: Sequence[int]) -> Table:
    table = Table(box=None, pad_edge=False)
    for column, width in zip(columns, widths, strict=True):
        table.add_column(column, overflow="fold", width=width)
    for row in rows:
        # As Text, since a name or reason may hold what rich takes for markup.
        table.add_row(*(Text(_cell(row.get(column))) for column in columns))
    return table


def _widths(rows: Sequence[Row], columns: Sequence[str], room: int) -> list[int]:
    """Of each column, in characters: as wide as it wants, or fairly less; none if a word would break."""
    texts = [[column, *(_cell(row.get(column)) for row in rows)] for column in columns]
    wanted = [max(map(cell_len, column)) for column in texts]
    least = [max(cell_len(word) for text in column for word in (text.split() or [""])) for column in texts]
    left = room - sum(least) - BETWEEN * (len(columns) - 1)
    if left < 0:
        return []
    widths = least.copy()
    order = sorted(range(len(columns)), key=lambda k: wanted[k] - least[k])
    for n, k in enumerate(order):
        more = min(wanted[k] - least[k], left // (len(columns) - n))
        widths[k], left = widths[k] + more, left - more
    return widths


def _one_below_the_other(rows: Sequence[Row], columns: Sequence[str]) -> Table:
    """For each row the value of its first column, and below it a line for each other that has one."""
    lines = Table.grid(padding=(0, 2))
    lines.add_column(no_wrap=True)
    lines.add_column(overflow="fold")
    for row in rows:
        lines.add_row(Text(columns[0], style="bold"), Text(_cell(row.get(columns[0])), style="bold"))
        for column in columns[1:]:
            if cell := _cell(row.get(column)):
                lines.add_row(Text(column), Text(cell))
        lines.add_row()
    return lines


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
