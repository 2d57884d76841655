"""Tables and progress as people read them, on a terminal or a pipe."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

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

PIPE_WIDTH = 10**9
"""[characters] Wider than any line: on a pipe none is cut or folded, whatever it says."""

BETWEEN = 2
"""[characters] Between columns of a table."""

Cells = Sequence[Sequence[str]]


class _Console(Console):
    def on_broken_pipe(self) -> None:
        """Rich would end with 1 where nobody reads on, which says "no" here."""
        self.quiet = True
        raise BrokenPipeError


def console() -> Console:
    """Where people read: full width and no colour on a pipe."""
    return _Console() if sys.stdout.isatty() else _Console(width=PIPE_WIDTH, no_color=True)


def print_table(columns: Sequence[str], rows: Cells) -> None:
    """Rows under their columns; on a terminal that is too narrow for their words one row below the other.

    Before that, names of columns go over several lines: `not_` and `certified` below it.
    """
    out = console()
    for heads in (columns, [each.replace("_", "_\n") for each in columns]):
        widths = _widths(heads, rows, out.width)
        if widths or not columns:
            out.print(_table(heads, rows, widths))
            return
    out.print(_one_below_the_other(columns, rows))


def _table(columns: Sequence[str], rows: Cells, widths: Sequence[int]) -> Table:
    table = Table(box=None, pad_edge=False)
    for column, width in zip(columns, widths, strict=True):
        table.add_column(column, overflow="fold", width=width)
    for row in rows:
        # As Text, since a name or reason may hold what rich takes for markup.
        table.add_row(*map(Text, row))
    return table


def _widths(columns: Sequence[str], rows: Cells, room: int) -> list[int]:
    """Of each column, in characters: as wide as it wants, or fairly less; none if a word would break."""
    texts = [[column, *(row[k] for row in rows)] for k, column in enumerate(columns)]
    wanted = [max(cell_len(line) for text in column for line in text.split("\n")) for column in texts]
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


def _one_below_the_other(columns: Sequence[str], rows: Cells) -> Table:
    """For each row the value of its first column, and below it a line for each other that has one."""
    lines = Table.grid(padding=(0, 2))
    lines.add_column(no_wrap=True)
    lines.add_column(overflow="fold")
    for row in rows:
        lines.add_row(Text(columns[0], style="bold"), Text(row[0], style="bold"))
        for column, cell in zip(columns[1:], row[1:], strict=True):
            if cell:
                lines.add_row(Text(column), Text(cell))
        lines.add_row()
    return lines


@contextmanager
def bar_of(label: str, total: int, counted: str) -> Iterator[Progress]:
    """A bar of what is done: `open  3/17 containers`."""
    columns = (
        TextColumn(label),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn(counted),
        TimeRemainingColumn(),
        TextColumn("{task.fields[now]}"),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        bar.add_task(label, total=total or None, now="")
        yield bar


@contextmanager
def left_of(label: str, budget: float) -> Iterator[None]:
    """How much of a search's budget [s] is left."""
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
