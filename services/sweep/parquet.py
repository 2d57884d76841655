"""Verdicts of a sweep as a table for data tools: one row for each case."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from sdt_kg.errors import InputError
from sdt_kg.load import model_name
from services.store.output import writing
from services.sweep.cell import CellResult, Found

ROWS_TOGETHER: Final = 10_000
"""Rows that are written at a time, as a row group."""

Row = dict[str, Any]


@dataclass(slots=True)
class Rows:
    """Rows on their way into a file."""

    _file: Path
    _writer: Any  # of pyarrow, which has no types
    _schema: Any
    _held: list[Row] = field(default_factory=list[Row])

    def add(self, found: Found) -> None:
        """One more row."""
        self._held.append(row_of(found))
        if len(self._held) >= ROWS_TOGETHER:
            self.flush()

    def flush(self) -> None:
        """What is held is in the file."""
        import pyarrow as pa  # noqa: PLC0415 - an extra

        if self._held:
            with writing(self._file):
                self._writer.write_table(pa.Table.from_pylist(self._held, self._schema))
            self._held.clear()


@contextmanager
def parquet(file: Path) -> Iterator[Rows]:
    """A file to which rows are added, put in place when all are there; an interrupted sweep leaves none.

    Raises:
        InputError: pyarrow is not installed, or the file cannot be written.
    """
    try:
        from pyarrow.parquet import ParquetWriter  # noqa: PLC0415 - an extra
    except ModuleNotFoundError as error:
        if error.name != "pyarrow":
            raise
        raise InputError(
            "Parquet needs pyarrow", allowed="sdt-kg with its extra", remedy="pip install 'sdt-kg[cluster]'"
        ) from None
    unfinished = file.with_name(f".{file.name}.{os.getpid()}")
    schema = _schema()
    try:
        with writing(file):
            writer = ParquetWriter(unfinished, schema)
        try:
            rows = Rows(file, writer, schema)
            yield rows
            rows.flush()
        finally:
            with writing(file):
                writer.close()
        with writing(file):
            unfinished.replace(file)
    finally:
        with suppress(OSError):
            unfinished.unlink(missing_ok=True)


def row_of(found: Found) -> Row:
    """What was asked, and what became of it; without a verdict the outcome is null and `problem` says why."""
    cell = found.cell
    policy = cell.policy
    row: Row = {
        "kitchen": model_name(cell.kitchen),
        "robot": model_name(cell.robot),
        "task": cell.task.partition(":")[0],
        "container": cell.container,
        "state": list(cell.states),
        "drive": policy.drive.value if policy.drive else None,
        "base": list(policy.base) if policy.base else None,
        "budget": policy.budget,
        "seed": policy.seed,
        "friction": policy.friction,
        "tee": cell.relative.tee,
        "handle_force": cell.relative.handle_force,
    }
    if not isinstance(found, CellResult):
        return row | {"problem": found.reason}
    verdict: Any = found.verdict  # JSON
    reasons = verdict["diagnoses"]
    names = ("outcome", "satisfies_request", "causes", "can_perform", "gripper", "drive", "stored", "iri")
    return (
        row
        | {name: verdict[name] for name in names}
        | {
            "kinds": [each["kind"] for each in reasons],
            "reasons": [each["reason"] for each in reasons],
            "proved": any(each["proof"] for each in reasons),
            "seconds": float(verdict["seconds"]),
        }
    )


def _schema() -> Any:  # noqa: ANN401 - pyarrow has no types
    import pyarrow as pa  # noqa: PLC0415 - an extra

    text, yes, number = pa.string(), pa.bool_(), pa.float64()
    kinds = {
        **dict.fromkeys(("kitchen", "robot", "task", "container"), text),
        "state": pa.list_(text),
        "drive": text,
        "base": pa.list_(number),
        "budget": number,
        "seed": pa.int64(),
        "friction": number,
        "tee": text,
        "handle_force": number,
        "outcome": text,
        **dict.fromkeys(("satisfies_request", "causes", "can_perform"), yes),
        "gripper": text,
        "kinds": pa.list_(text),
        "reasons": pa.list_(text),
        "proved": yes,
        "seconds": number,
        "stored": yes,
        "iri": text,
        "problem": text,
    }
    return pa.schema(list(kinds.items()))
