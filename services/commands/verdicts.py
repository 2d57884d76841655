"""A verdict's JSON object in words."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final

import click

from predicates.case import Code, Quantity, Search
from predicates.margins import told_figures
from predicates.record.report import evidence_line
from sdt_kg.iri import local_name
from sdt_kg.motion import BASE_JOINTS
from sdt_kg.task import Verb
from services.commands.exits import Exit
from services.commands.show import csv_is_asked, print_json, print_rows

Json = dict[str, Any]  # what `predicates.record.to_json` gives

PREDICATES = ("satisfies_request", "causes", "can_perform")

OTHERWISE: Final = {Verb.OPEN.value: "closed", Verb.CLOSE.value: "open"}
"""Task → the state in which there is something to do."""

COLUMNS = (
    "kitchen",
    "robot",
    "task",
    "container",
    "outcome",
    *PREDICATES,
    "gripper",
    "why",
    "proof",
    "seconds",
    "iri",
)
"""Of a verdict on one line."""


def verdict_row(verdict: Json, *, given: bool = False) -> Json:
    """A verdict's JSON object on one line; as `print_verdict`."""
    diagnoses = verdict["diagnoses"]
    why = "; ".join(diagnosis_text(each, given=given) for each in diagnoses)
    return verdict | {"why": why, "proof": any(each["proof"] for each in diagnoses)}


def told(objects: Sequence[Json], *, as_json: bool, given: bool = False) -> int:
    """Print the verdicts; the exit code: 0 all certified, 1 some not, 3 all abstained.

    Args:
        objects: Of the verdicts.
        as_json: As they are.
        given: They are about a motion that was given: what is proved is proved of that one.
    """
    if as_json:
        print_json(list(objects))
    elif csv_is_asked():
        print_rows([verdict_row(each, given=given) for each in objects], COLUMNS)
    else:
        for each in objects:
            print_verdict(each, given=given)
        hint_of_state(objects)
        hint_of_kitchen(objects)
    outcomes = {each["outcome"] for each in objects}
    if outcomes == {"certified"}:
        return Exit.DONE
    return Exit.ABSTAINED if outcomes == {"abstained"} else Exit.NO


def hint_of_state(objects: Sequence[Json]) -> None:
    """Say on standard error how to ask about another state, if a task is met before anything moves.

    Args:
        objects: With `task` and `diagnoses`, of verdicts, answers of Causes or placements; servers and stores
            of before give a diagnosis no code.
    """
    met = {
        each["task"]
        for each in objects
        if any(one.get("code") == Code.NOTHING_TO_CAUSE.value for one in each["diagnoses"])
    }
    for task in sorted(met & OTHERWISE.keys()):
        click.echo(
            f"hint: --state CONTAINER={OTHERWISE[task]} begins where there is something to {task}", err=True
        )


def hint_of_velocities(objects: Sequence[Json], arrays: Callable[[], Iterable[str]]) -> None:
    """Say on standard error that too much speed may be that of the curve through a motion's points alone.

    Args:
        objects: Of verdicts about a robot's motion that was given.
        arrays: Gives the names of its arrays.
    """
    rates = {Quantity.VELOCITY.value, Quantity.ACCELERATION.value}
    measured = (each["evidence"] for verdict in objects for each in verdict["diagnoses"])
    if not any(each and each["quantity"] in rates for each in measured):
        return
    if not any(name.endswith("velocities") for name in arrays()):
        click.echo(
            "hint: the motion has no velocities, so they are of the smoothest curve through its points, "
            "which may swing beyond a limit: give the velocities that the robot is commanded",
            err=True,
        )


def hint_of_start(objects: Sequence[Json], base: Sequence[float]) -> None:
    """Say on standard error how to ask about a motion that begins elsewhere than the robot stands.

    Args:
        objects: Of verdicts about a robot's motion that was given.
        base: Where the motion has the base at first, x, y [m] and yaw [rad].
    """
    if robot := _elsewhere(objects, Code.ROBOT_ELSEWHERE):
        pose = ",".join(f"{at:.6g}" for at in base)
        parked = "" if robot.keys() - set(BASE_JOINTS) else f"--base {pose} or "
        click.echo(
            f"hint: {parked}--any-start has the robot begin where the motion does; else the motion has to "
            "begin where the robot stands, parked",
            err=True,
        )


def hint_of_kitchen(objects: Sequence[Json]) -> None:
    """Say on standard error how to ask about a motion that begins elsewhere than the kitchen's joints are.

    Args:
        objects: Of verdicts, or of answers of Causes.
    """
    if kitchen := _elsewhere(objects, Code.KITCHEN_ELSEWHERE):
        options = " ".join(f"--state {joint}={at:.6g}" for joint, at in sorted(kitchen.items()))
        click.echo(f"hint: {options} has the kitchen begin as the motion does", err=True)


def _elsewhere(objects: Sequence[Json], code: Code) -> dict[str, float]:
    """Joint (name) → where the motion begins with it [rad or m], of reasons with that code."""
    return {
        local_name(one["evidence"]["entity"]): one["evidence"]["value"]
        for each in objects
        for one in each["diagnoses"]
        if one.get("code") == code.value
    }


def print_verdict(verdict: Json, *, given: bool = False) -> None:
    """Outcome, the three predicates, every reason with its evidence, the figures, the notes."""
    click.echo("{outcome}  {task}({container})  {robot} in kitchen {kitchen}".format_map(verdict))
    _line("state", ", ".join(f"{joint} at {at:g}" for joint, at in verdict["state"].items()) or None)
    for name in PREDICATES:
        _line(name, {True: "yes", False: "no", None: "not asked"}[verdict[name]])
    for diagnosis in verdict["diagnoses"]:
        click.echo(f"  {diagnosis_text(diagnosis, given=given)}")
        measured = diagnosis["evidence"] if not _of_search(diagnosis) else None
        if measured and (line := evidence_line(measured, "none")):
            click.echo(f"    {line}")
    _line("gripper", verdict["gripper"])
    _line("drive", verdict["drive"])
    _line("class", verdict.get("tee_class"))
    for name, value in told_figures(verdict["figures"]):
        _line(name, value)
    for note in verdict["notes"]:
        click.echo(f"  note: {note}")
    times = ", ".join(f"{name} {seconds:.2f}" for name, seconds in verdict["times"].items())
    stored = "; judged before, and answered from the store" if verdict["stored"] else ""
    click.echo(
        f"  {verdict['seconds']:.2f} s ({times}){stored}"
        if times
        else f"  {verdict['seconds']:.2f} s{stored}"
    )
    click.echo(f"  {verdict['iri']}")


def diagnosis_text(diagnosis: Json, *, given: bool = False) -> str:
    """Kind, reason, and whether it is proved (only of a motion that was given), or what was searched."""
    text = f"{diagnosis['kind']}: {diagnosis['reason']}"
    if diagnosis["proof"]:
        return f"{text} (proved of the motion that was given)" if given else f"{text} (proved)"
    search = diagnosis["search"]
    if search is None:
        return text
    tried = Search(*(search[name] for name in ("seeds", "branches", "placements", "seconds")))
    return f"{text} (not proved; {tried})"


def _of_search(diagnosis: Json) -> bool:
    """Whether what is measured is how long was searched: of the search, which the line before it tells."""
    return diagnosis["search"] is not None and diagnosis["evidence"]["quantity"] == Quantity.TIME.value


def _line(name: str, value: object) -> None:
    if value is not None:
        click.echo(f"  {name:32} {value}")
