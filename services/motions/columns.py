"""Motions as CSV: a line for each sample, a column for each coordinate."""

import csv
import io
import re
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path

import numpy as np

from sdt_kg.errors import MotionError, meant
from sdt_kg.motion import BASE_JOINTS
from sdt_kg.numbers import number_in
from services.motions.given import Given, check_name, twice
from services.store.output import write_file

POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
KITCHEN, VELOCITY = "kitchen/", "velocity/"
HEADS = ("robot", "gripper", "base_frame", "joint", "frame", "timed", "phases")
TRUTHS = ("true", "false")
ALLOWED = (
    f"time, {', '.join(BASE_JOINTS)}, the robot's joints, {KITCHEN}JOINT, {VELOCITY}… (a robot's motion); "
    "or '# joint: NAME' and time, value; or '# frame: NAME' and time, " + ", ".join(POSE)
)


def read_csv(path: Path) -> Given:
    """The arrays in the file; samples are at lines.

    Raises:
        MotionError: No head, a line of another length, or a cell that is no number: with the line.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise MotionError(f"it is no text: {error}", allowed=ALLOWED) from None
    heads, columns, lines, rows = _parsed(text)
    if not rows:
        raise MotionError("it has no samples", allowed=ALLOWED)
    values = dict(zip(columns, np.array(rows).T, strict=True))
    return Given(_arrays(heads, columns, values), lambda sample: f"line {lines[min(sample, len(lines) - 1)]}")


def _parsed(text: str) -> tuple[dict[str, str], list[str], list[int], list[list[float]]]:
    """Heads, names of the columns, and for each sample its line and values."""
    heads: dict[str, str] = {}
    columns: list[str] = []
    lines: list[int] = []
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("#"):
            name, value = _head(line, number)
            if name in HEADS and heads.setdefault(name, value) != value:
                raise MotionError(f"line {number} gives another '{name}'", allowed="one")
        elif line.strip():
            cells = _cells(line, number)
            if not columns:
                columns = _names(cells, number)
            else:
                lines.append(number)
                rows.append(_row(cells, columns, number))
    return heads, columns, lines, rows


def _head(line: str, number: int) -> tuple[str, str]:
    """Name and value of a head; what has no such name is a comment, unless that is a name misspelled."""
    parts = [part.strip() for part in re.split("([:=])", line[1:], maxsplit=1)]
    name, sign, value = parts if len(parts) > 1 else ("", "", "")
    # A file that tells its time, or its unit, tells nothing of whether times are to be kept.
    is_time = name.lower() in {"time", "times"} and value.lower() not in TRUTHS
    near = None if is_time else meant(name.lower(), HEADS)
    if near and (name not in HEADS or sign != ":"):
        said = f"line {number} begins with '# {name[:40]}{sign}', which means nothing"
        raise MotionError(said, allowed=f"did you mean '# {near}:'?", remedy="rename it, or leave it out")
    return name, value


def _cells(line: str, number: int) -> list[str]:
    try:
        (cells,) = csv.reader([line], strict=True)
    except csv.Error as error:
        raise MotionError(
            f"line {number} is no CSV: {error}", allowed="cells parted by commas", remedy="leave quotes out"
        ) from None
    return [cell.strip() for cell in cells]


def _names(cells: list[str], number: int) -> list[str]:
    if len(cells) == 1:
        raise MotionError(
            f"line {number} names one column, '{cells[0][:40]}'",
            allowed=ALLOWED,
            remedy="part columns by commas",
        )
    for column, cell in enumerate(cells, 1):
        check_name(cell, f"line {number} has the name")
        if cell in {"", VELOCITY, KITCHEN}:
            raise MotionError(
                f"line {number} has no name for column {column}, '{cell}'",
                allowed=ALLOWED,
                remedy="name it, or leave the column out, as pandas does with index=False",
            )
        if _is_number(cell):
            raise MotionError(
                f"line {number} has the number {cell} for the name of a column", allowed=ALLOWED
            )
    repeated = twice(cells)
    if repeated is not None:
        raise MotionError(f"line {number} names '{repeated}' twice", allowed="every column once")
    if "time" not in cells:
        said = f"there is no column 'time' in line {number}: it has the columns {', '.join(cells[:8])}"
        raise MotionError(said, allowed=ALLOWED)
    return cells


def _is_number(cell: str) -> bool:
    try:
        number_in(cell)
    except ValueError:
        return False
    return True


def _row(cells: list[str], columns: list[str], number: int) -> list[float]:
    if len(cells) != len(columns):
        raise MotionError(f"line {number} has {len(cells)} values", allowed=f"{len(columns)}, one a column")
    row: list[float] = []
    for cell, column in zip(cells, columns, strict=True):
        try:
            row.append(number_in(cell))
        except ValueError:
            raise MotionError(
                f"'{cell[:40]}' in the column {column} of line {number} is no number", allowed="numbers"
            ) from None
    return row


def _arrays(
    heads: dict[str, str], columns: list[str], values: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    arrays = {name: np.array(value) for name, value in heads.items() if name not in {"timed", "phases"}}
    arrays["times"] = values["time"]
    if "joint" in heads or "frame" in heads:
        return arrays | _of_container(heads, columns, values)
    if "phases" in heads:
        phases = [each.rpartition(" ") for each in heads["phases"].split(", ")]
        arrays["phase_names"] = np.array([name for name, _, _ in phases], dtype=np.str_)
        arrays["phase_starts"] = np.array([_start(start) for _, _, start in phases])
    own = [
        name
        for name in columns
        if name != "time" and not name.startswith((VELOCITY, KITCHEN)) and name not in BASE_JOINTS
    ]
    kitchen = [name for name in columns if name.startswith(KITCHEN)]
    for group, names in (("base", BASE_JOINTS), ("robot", own), ("kitchen", kitchen)):
        arrays |= dict(_group(group, names, values))
    for name in columns:
        if name.startswith(VELOCITY) and name.removeprefix(VELOCITY) not in columns:
            said = f"there is a column '{name}', and none '{name.removeprefix(VELOCITY)}'"
            raise MotionError(said, allowed="velocities of columns that there are")
    return arrays


def _start(said: str) -> float:
    try:
        return number_in(said)
    except ValueError:
        raise MotionError(f"'phase_starts' is {said[:40]!r}", allowed="real numbers") from None


def _of_container(
    heads: dict[str, str], columns: list[str], values: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """τ; no column is left out: a misspelled one would make it another."""
    known = ("value", VELOCITY + "value") if "joint" in heads else POSE
    for name in columns:
        if name != "time" and name not in known:
            said = f"there is a column '{name}', which means nothing"
            raise MotionError(said, allowed=", ".join(("time", *known)), remedy="rename it, or leave it out")
    timed = heads.get("timed", "true").lower()
    if timed not in TRUTHS:
        raise MotionError(f"'timed' is '{timed[:40]}'", allowed="true or false")
    arrays = {"timed": np.array(timed == "true")}
    if "frame" in heads:
        return arrays | {"poses": _columns(values, POSE)}
    names = (("values", "value"), ("velocities", VELOCITY + "value"))
    return arrays | {array: values[column] for array, column in names if column in values}


def _group(
    group: str, names: Sequence[str], values: dict[str, np.ndarray]
) -> Iterator[tuple[str, np.ndarray]]:
    """Names, positions and velocities of the base, the robot's joints or the kitchen's."""
    positions, velocities = (
        ("base", "base_velocities")
        if group == "base"
        else (
            f"{group}_positions",
            f"{group}_velocities",
        )
    )
    if not names and group == "kitchen":
        return
    if group != "base":
        yield f"{group}_joint_names", np.array([name.removeprefix(KITCHEN) for name in names], dtype=np.str_)
    yield positions, _columns(values, names)
    speeds = [VELOCITY + name for name in names]
    missing = [name for name in speeds if name not in values]
    if len(missing) < len(speeds):
        if missing:
            said = f"there is no column '{missing[0]}', but velocities of others of the {group}"
            raise MotionError(said, allowed="velocities of all of base, robot or kitchen, or of none of it")
        yield velocities, _columns(values, speeds)


def _columns(values: dict[str, np.ndarray], names: Sequence[str]) -> np.ndarray:
    for name in names:
        if name not in values:
            raise MotionError(f"there is no column '{name}'", allowed=ALLOWED)
    return np.array([values[name] for name in names]).T.reshape(len(values["time"]), len(names))


def write_csv(path: Path, arrays: dict[str, np.ndarray]) -> None:
    """The arrays are in the file, with as many digits as give them back exactly."""
    if "values" in arrays:
        table: dict[str, np.ndarray] = {"value": arrays["values"]}
        table |= {VELOCITY + "value": arrays["velocities"]} if "velocities" in arrays else {}
    elif "poses" in arrays:
        table = dict(zip(POSE, arrays["poses"].T, strict=True))
    else:
        table = _body_table(arrays)
    table = {"time": arrays["times"], **table}
    out = io.StringIO()
    for name in HEADS:
        if name in arrays:
            out.write(f"# {name}: {str(arrays[name]).lower() if name == 'timed' else arrays[name]}\n")
    if arrays.get("phase_names", np.zeros(0)).size:
        phases = zip(arrays["phase_names"], arrays["phase_starts"], strict=True)
        out.write("# phases: " + ", ".join(f"{name} {start}" for name, start in phases) + "\n")
    rows = ([repr(float(cell)) for cell in row] for row in zip(*table.values(), strict=True))
    csv.writer(out, lineterminator="\n").writerows(chain([table.keys()], rows))
    write_file(path, out.getvalue())


def _body_table(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Columns of a body motion: all positions, then all velocities."""
    groups = {"base": list(BASE_JOINTS), "robot": arrays["robot_joint_names"].tolist()}
    if "kitchen_joint_names" in arrays:
        groups["kitchen"] = [KITCHEN + name for name in arrays["kitchen_joint_names"].tolist()]
    table: dict[str, np.ndarray] = {}
    for group, names in groups.items():
        positions = arrays["base" if group == "base" else f"{group}_positions"]
        table |= dict(zip(names, positions.T, strict=True))
    for group, names in groups.items():
        speeds = arrays[f"{group}_velocities"]
        table |= dict(zip([VELOCITY + name for name in names], speeds.T, strict=True))
    return table
