"""`sdt satisfies`, `sdt causes`: two predicates, which need no robot."""

from pathlib import Path

import click

from predicates.case import Answer
from predicates.record.caused import caused_json, task_json
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task
from services.app import load
from services.commands.completion.types import TASK
from services.commands.exits import Exit
from services.commands.options import (
    MOTION_FILE,
    csv_flag,
    forces_option,
    handle_force_option,
    json_flag,
    kitchen_argument,
    states_option,
    tee_option,
)
from services.commands.show import csv_is_asked, note_lengths, print_json, print_rows
from services.commands.terminal import console
from services.commands.verdicts import Json, hint_of_kitchen, hint_of_state
from services.motions import read_motion, write_motion
from services.relative import in_class


@click.command()
@kitchen_argument
@states_option
@csv_flag
@json_flag
def satisfies(kitchen: str, states: tuple[str, ...], as_json: bool) -> None:
    """The requests which a state of KITCHEN meets (SatisfiesRequest, backwards)."""
    service = load(kitchen, state=states)
    tasks = (answer.case.task for answer in service.satisfies())
    rows = [task_json(task) for task in tasks if isinstance(task, Task)]
    print_rows(rows, ("task", "container"), as_json=as_json)


@click.command()
@kitchen_argument
@click.option(
    "--task", required=True, type=TASK, metavar="TASK", help="open, close, open:CONTAINER, close:CONTAINER."
)
@states_option
@click.option(
    "--motion",
    type=click.Path(exists=True, path_type=Path),
    metavar="FILE",
    help="Would this container's motion cause the task? .npz, .json or .csv. Without it, motions that would.",
)
@click.option(
    "--motion-out",
    type=MOTION_FILE,
    metavar="FILE",
    help="Write the first motion found: .npz, .json or .csv.",
)
@tee_option
@forces_option
@handle_force_option
@csv_flag
@json_flag
def causes(
    *,
    kitchen: str,
    task: str,
    states: tuple[str, ...],
    motion: Path | None,
    motion_out: Path | None,
    tee: str,
    forces: Path | None,
    handle_force: float | None,
    as_json: bool,
) -> None:
    """Motions that would cause TASK, or whether a given one would; no robot.

    Exit 0 if all would, 1 if some would not, 3 if all are out of scope.
    """
    service = in_class(load(kitchen, state=states), tee, forces, handle_force)
    note_lengths(service.twin)
    given = read_motion(motion, service.twin) if motion else None
    assert not isinstance(given, BodyMotion), "without a robot, reading one is an error"
    answers = list(service.causes(task, given))
    if motion_out:
        _write_first(answers, motion_out)
    rows = [caused_json(answer, tee) for answer in answers]
    say(rows, as_json=as_json)
    raise SystemExit(exit_of(rows))


def say(rows: list[Json], *, as_json: bool) -> None:
    """The answers are told, of their JSON objects."""
    if as_json:
        print_json(rows)
        return
    for row in rows:
        row["why"] = "; ".join(each["reason"] for each in row["diagnoses"])
        row |= {f"{name} [{unit}]": value for name, (value, unit) in row["figures"].items()}
    figures = dict.fromkeys(f"{n} [{u}]" for row in rows for n, (_, u) in row["figures"].items())
    columns = ("task", "container", "outcome", "start", "end", "unit", "duration", *figures, "why")
    print_rows(rows, columns)
    for note in dict.fromkeys(note for row in rows for note in row["notes"]):
        click.echo(f"note: {note}", err=csv_is_asked())
    if not csv_is_asked():
        hint_of_state(rows)
        hint_of_kitchen(rows)


def exit_of(rows: list[Json]) -> Exit:
    """How `sdt causes` ends with these answers."""
    outcomes = {row["outcome"] for row in rows}
    if outcomes == {"out_of_scope"}:
        return Exit.ABSTAINED
    return Exit.DONE if outcomes == {"causes"} else Exit.NO


def _write_first(answers: list[Answer], path: Path) -> None:
    for answer in answers:
        if isinstance(answer.case.motion, Motion):
            write_motion(path, answer.case.motion)
            return
    console().print("no motion to write")
