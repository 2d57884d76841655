"""Cases that somebody has listed: rows of a CSV file, or of a query over kitchens or saved verdicts."""

import csv
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import Final, TypeVar

from predicates.meant import counted
from sdt_kg.annotation import Drive
from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.iri import local_name
from sdt_kg.load import load_twin, model_name
from sdt_kg.numbers import number_in, whole_in
from services.app import Policy
from services.relative import Relative, tee_of
from services.requests import parse_base
from services.store.files import rows_saved
from services.store.workers import Begin
from services.sweep.cell import Cell
from services.sweep.plan import Axes, Known, Plan, cell_about

COLUMNS: Final = (
    *("kitchen", "robot", "container", "task", "state", "drive", "base", "budget", "seed"),
    *("friction", "tee", "handle_force"),
)
"""Of a row; what it leaves out is taken from the options, each of their combinations."""
STATE_SEPARATOR: Final = ";"
_OTHERS: Final = (STATE_SEPARATOR, "\t", "|")
"""What spreadsheets put between cells instead of commas."""

Row = Mapping[str, str]
Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class Listed:
    """Rows turned into cases.

    Attributes:
        kitchens: Sources for rows without a kitchen; one of them may be named by its model's name.
        robots: Likewise.
        axes: For what a row leaves out.
    """

    kitchens: tuple[str, ...]
    robots: tuple[str, ...]
    axes: Axes
    _known: Known = field(default_factory=Known)

    def plan(self, rows: Iterable[tuple[str, Row]]) -> Plan:
        """The cases of the rows, each once; each row with the place where it was found.

        Raises:
            InputError: A row names what is not there; the message says where.
        """
        found: dict[Cell, None] = {}
        for where, row in rows:
            try:
                for cell in self._cells(row):
                    self._known.check(cell)
                    found[cell] = None
            except InputError as error:
                what = f"{where}: {error.what}"
                raise InputError(what, allowed=error.allowed, remedy=error.remedy) from None
        if not found:
            raise InputError(
                "there is no row, so there is no case",
                allowed="a line below the head for each case, or a query that has rows",
            )
        return Plan(len(found), tuple(found))

    def _cells(self, row: Row) -> Iterator[Cell]:
        for kitchen in _models(row, "kitchen", self.kitchens):
            for robot in _models(row, "robot", self.robots):
                for states in _states(row, self.axes):
                    for policy, relative in product(self.axes.policies, _classes(row, self.axes)):
                        for task in self._tasks(row, kitchen):
                            yield cell_about(kitchen, robot, task, states, _policy(row, policy), relative)

    def _tasks(self, row: Row, kitchen: str) -> Iterator[str]:
        """The row's task about its container, or about each where it names none."""
        for text in [row["task"]] if "task" in row else self.axes.tasks:
            verb, _, about = text.partition(":")
            name = row.get("container", about)
            if "task" in row and about not in {"", name}:
                raise InputError(f"the task is about '{about}', and the container is '{name}'")
            if name:
                yield f"{verb.lower()}:{name}"
            else:
                yield from (f"{verb.lower()}:{each.name}" for each in counted(self._known.twin(kitchen)))


def csv_rows(file: Path) -> Iterator[tuple[str, Row]]:
    """Rows of a CSV file with a head; an empty cell is left out.

    Raises:
        InputError: The head has a column that means nothing here, or a row is longer than it.
    """
    check_ends(file)
    try:
        with file.open(newline="", encoding="utf-8-sig") as opened:
            reader = csv.DictReader(opened, strict=True)  # a quote that nothing closes ends no row
            head = reader.fieldnames or ()
            if len(head) == 1 and (other := next((each for each in _OTHERS if each in head[0]), None)):
                raise InputError(f"{file} has '{other}' between its cells", allowed="commas")
            _check_columns(head, str(file))
            for row in reader:
                if None in row:
                    raise InputError(
                        f"{file} line {reader.line_num} has more cells than the head",
                        remedy='quote a cell that has commas: "0,0,1.57"',
                    )
                yield f"{file} line {reader.line_num}", _filled(row)
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{file} is no CSV: {error}", allowed="UTF-8 text with a head") from None


def query_rows(
    sparql: str, kitchens: Sequence[str], robots: Sequence[str], store: str | None, begin: Begin
) -> list[tuple[str, Row]]:
    """Rows of a SELECT over a store, or over each kitchen with its robots; an IRI is its last part.

    Args:
        sparql: The SELECT.
        kitchens: Whose twins are asked, where no store is.
        robots: That are in them.
        store: Saved verdicts.
        begin: Called when all is loaded that is asked.

    Raises:
        QueryError: It is no query that reads.
        InputError: It selects a column that means nothing here.
    """
    if store is not None:
        columns, rows = rows_saved(store, sparql, begin)
        _check_columns(columns, "the query")
        return [(f"row {number} of the query", _named(row)) for number, row in enumerate(rows, 1)]
    twins = {kitchen: load_twin(kitchen, robots) for kitchen in kitchens}
    begin()
    found: list[tuple[str, Row]] = []
    for kitchen, twin in twins.items():
        columns, rows = twin.query(sparql)
        _check_columns(columns, "the query")
        for number, row in enumerate(rows, 1):
            found.append((f"row {number} of the query over {kitchen}", {"kitchen": kitchen, **_named(row)}))
    return found


def _check_columns(columns: Sequence[str], where: str) -> None:
    for column in columns:
        if column not in COLUMNS:
            raise UnknownEntityError("column", column, COLUMNS, f"{where} may have: {', '.join(COLUMNS)}")
        if columns.count(column) > 1:
            raise InputError(f"{where} has the column '{column}' twice", allowed="each column once")


def _filled(row: Mapping[str, str | None]) -> Row:
    return {name: value.strip() for name, value in row.items() if value and value.strip()}


def _named(row: Mapping[str, object]) -> Row:
    """Values as text; of an IRI the last part, which is the name of a model, container or term."""
    texts = {name: str(value) for name, value in row.items() if value is not None}
    return {name: local_name(text) if "://" in text else text for name, text in texts.items()}


def _models(row: Row, kind: str, given: Sequence[str]) -> Sequence[str]:
    """The model that the row names, as it was given, else as a bundled name or path; or each given."""
    if kind not in row:
        if not given:
            raise InputError(f"the row names no {kind}", remedy=f"a column '{kind}', or --{kind}s")
        return given
    return [next((each for each in given if model_name(each) == row[kind]), row[kind])]


def _states(row: Row, axes: Axes) -> Sequence[tuple[str, ...]]:
    if "state" not in row:
        return axes.states
    return [tuple(text.strip() for text in row["state"].split(STATE_SEPARATOR) if text.strip())]


def _policy(row: Row, policy: Policy) -> Policy:
    """The policy with what the row says otherwise."""
    if "drive" in row:
        allowed = ", ".join(each.value for each in Drive)
        policy = replace(policy, drive=_read(row, "drive", Drive, allowed))
    if "budget" in row:
        policy = replace(policy, budget=_read(row, "budget", number_in, "seconds"))
    if "seed" in row:
        policy = replace(policy, seed=_read(row, "seed", whole_in, "a whole number"))
    if "friction" in row:
        policy = replace(policy, friction=_read(row, "friction", number_in, "a number"))
    if not 0 < policy.budget < math.inf:
        raise InputError(f"a budget of {policy.budget:g} s", allowed="more than 0, and finite")
    return replace(policy, base=parse_base(_comma_separated(row["base"]))) if "base" in row else policy


def _classes(row: Row, axes: Axes) -> Sequence[Relative]:
    """The class that the row names, with the forces of the options for it; or each of the options."""
    tee = tee_of(row["tee"]) if "tee" in row else None
    found = [each for each in axes.classes if tee in {None, each.tee}] or [Relative(tee or "d_artic")]
    if "handle_force" not in row:
        return found
    force = _read(row, "handle_force", number_in, "a number [N]")
    return [replace(each, handle_force=force) for each in found]


def _comma_separated(base: str) -> str:
    """A base pose with commas between its numbers; spaces do, too, as commas are between cells."""
    return base if "," in base else ",".join(base.split())


def _read(row: Row, name: str, read: Callable[[str], Value], allowed: str) -> Value:
    """What a cell says.

    Raises:
        InputError: It says no such thing.
    """
    try:
        return read(row[name])
    except ValueError:
        raise InputError(f"{name} is '{row[name]}'", allowed=allowed) from None
