"""What `sdt ask` shows of each verb's answer, and how it ends."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click
import numpy as np

from sdt_kg.errors import InputError
from services.commands.exits import Exit
from services.commands.show import csv_is_asked, print_json, print_rows
from services.commands.verdicts import hint_of_start, hint_of_velocities, told

if TYPE_CHECKING:
    from services.bus.client import Connection, Verdicts


@dataclass(frozen=True, slots=True)
class Asked:
    """What a verb is told.

    Attributes:
        text: A query, a task or an IRI.
        how: What else the verb takes that was said: fields of its request.
        edits: What is otherwise, for whatif.
        motion: Arrays of a motion to be verified; None: make one.
        motion_out: Where the certified body motion goes.
    """

    text: str
    robot: str | None
    states: tuple[str, ...]
    how: Mapping[str, Any]
    edits: tuple[str, ...]
    motion: Mapping[str, object] | None
    motion_out: Path | None


def _select(to: "Connection", asked: Asked, as_json: bool) -> int:
    columns, rows = to.select(asked.text)
    return _rows(rows, as_json, tuple(columns))


def _ask(to: "Connection", asked: Asked, as_json: bool) -> int:
    return _rows([{"answer": to.ask(asked.text)}], as_json)


def _construct(to: "Connection", asked: Asked, as_json: bool) -> int:
    for triple in to.construct(asked.text):
        click.echo(f"{triple} .")
    return Exit.DONE


def _satisfies(to: "Connection", asked: Asked, as_json: bool) -> int:
    met = to.satisfies(*asked.states)
    rows: list[dict[str, object]] = [{"task": each.verb, "container": each.container} for each in met]
    return _rows(rows, as_json, ("task", "container"))


def _causes(to: "Connection", asked: Asked, as_json: bool) -> int:
    """A row for each motion, and the exit code, as `sdt causes` has them."""
    from services.commands.law.predicates import exit_of, say  # noqa: PLC0415 - other verbs need it not

    said = to.causes(asked.text, *asked.states, motion=asked.motion, **asked.how)
    say(said.answers, as_json=as_json)
    return exit_of(said.answers)


def _achieve(to: "Connection", asked: Asked, as_json: bool) -> int:
    written = asked.motion_out is not None
    about = asked.text, asked.robot, *asked.states
    found = to.achieve(*about, motion=asked.motion, motions=written, single=written, **asked.how)
    if asked.motion_out is not None:
        _write_motion(asked.motion_out, found)
    code = told(found.objects, as_json=as_json, given=asked.motion is not None)
    if asked.motion and "base" in asked.motion and not as_json:
        hint_of_start(found.objects, np.asarray(asked.motion["base"], dtype=np.float64)[0])
        hint_of_velocities(found.objects, lambda: asked.motion or ())
    return code


def _write_motion(path: Path, found: "Verdicts") -> None:
    """The one motion that was certified is in the file; where there is none, that is said."""
    from services.motions import write_arrays  # noqa: PLC0415 - seldom asked

    if len(found.objects) > 1:
        what = f"--motion-out takes one verdict, and there are {len(found.objects)}"
        raise InputError(what, allowed="open:CONTAINER or close:CONTAINER, and --robot")
    certified = [each for each in found.motions if each is not None]
    if certified:
        write_arrays(path, certified[0])
    else:
        click.echo(f"{path} is not written: no certified motion", err=True)


def _task(to: "Connection", asked: Asked, as_json: bool) -> int:
    """Outcome, steps and rules, and the exit code, as `sdt task` has them."""
    from services.commands.law.task import exit_of, say  # noqa: PLC0415 - other verbs need it not

    said = to.task(asked.text, asked.robot, *asked.states, **asked.how)
    say(said, as_json=as_json)
    return exit_of(said)


def _place(to: "Connection", asked: Asked, as_json: bool) -> int:
    """Poses and map, and the exit code, as `sdt place` has them."""
    from services.commands.law.place import exit_of, say  # noqa: PLC0415 - other verbs need it not

    said = to.place(asked.text, asked.robot, *asked.states, **asked.how)
    say(said, asked.text, asked.how["friction"], as_json=as_json)
    return exit_of(said)


def _whatif(to: "Connection", asked: Asked, as_json: bool) -> int:
    """What `sdt whatif` tells of the same, and its exit code."""
    from services.commands.worlds import answer, turn  # noqa: PLC0415 - other verbs need them not

    said = to.whatif(asked.text, asked.edits, asked.robot, *asked.states, **asked.how)
    if asked.how["grid"]:
        from services.commands.worlds import grid  # noqa: PLC0415 - slow to import

        grid.told(said, as_json=as_json)
        return grid.ends_with(said)
    if as_json:
        print_json(said)
    elif asked.edits:
        answer.print_answer(said)
    else:
        turn.print_turned(said)
    return answer.exit_of(said) if asked.edits else turn.ends_with(said)


def _why(to: "Connection", asked: Asked, as_json: bool) -> int:
    """The story; as JSON and CSV its parts, as `sdt why` has them."""
    story = to.story(asked.text)
    if csv_is_asked():
        rows = [{"section": each.title, "line": line} for each in story.sections for line in each.lines]
        print_rows(rows, ("section", "line"))
    elif as_json:
        print_json([each.model_dump() for each in story.sections])
    else:
        click.echo(story.text)
    return Exit.DONE


def _health(to: "Connection", asked: Asked, as_json: bool) -> int:
    """A row for each server; none is no answer."""
    found = to.health()
    if not found:
        from services.judging.problems import BusUnavailableError, ProblemType, problem  # noqa: PLC0415 - where needed

        said = f"no server of '{to.twin}' is on the bus"
        raise BusUnavailableError(problem(ProblemType.UNAVAILABLE, said))
    return _rows(found, as_json)


def _rows(rows: list[dict[str, object]], as_json: bool, columns: tuple[str, ...] = ()) -> int:
    if as_json:
        print_json(rows)
    else:
        print_rows(rows, columns or tuple(rows[0] if rows else ()))
    return Exit.DONE


ANSWERS: Final[Mapping[str, Callable[["Connection", Asked, bool], int]]] = {
    "select": _select,
    "ask": _ask,
    "construct": _construct,
    "satisfies": _satisfies,
    "causes": _causes,
    "achieve": _achieve,
    "task": _task,
    "place": _place,
    "whatif": _whatif,
    "why": _why,
    "health": _health,
}
