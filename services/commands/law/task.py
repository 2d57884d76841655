"""`sdt task`: a task written in Turtle: steps, rules that hold along the way, the best motion by J."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import click

from predicates.case import Outcome
from predicates.margins import AT_LEAST
from predicates.record.report import told_evidence
from predicates.specification.model import Specification
from predicates.specification.results.record import task_record
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.load import model_name
from services.app import Policy, Service, load
from services.commands.completion.types import KITCHEN, ROBOT
from services.commands.exits import Exit
from services.commands.options import (
    KITCHEN_HELP,
    ROBOT_HELP,
    annotation_option,
    budget_option,
    csv_flag,
    drive_option,
    forces_option,
    friction_option,
    handle_force_option,
    json_flag,
    save_option,
    seed_option,
    states_option,
    tee_option,
)
from services.commands.show import csv_is_asked, print_json, print_rows, progress
from services.commands.verdicts import Json, diagnosis_text
from services.relative import in_class
from services.requests import parse_base
from services.specifications import (
    StepResult,
    TaskResult,
    achieve_task,
    ready,
    result_json,
    specification_of,
)
from services.store.files import SavedVerdicts
from services.why.words import not_reached

COLUMNS = (
    *("task", "task_outcome", "part", "number", "what", "outcome", "why"),
    *("in_step", "time", "value", "seed", "searches", "compared", "iri"),
)
"""Of a step or rule on one line."""


@click.command(
    "task", epilog="Ready tasks: sdt task --list. How to write one: predicates/specification/README.md."
)
@click.argument("source", metavar="FILE.ttl|NAME", required=False)
@click.option("--kitchen", type=KITCHEN, help=KITCHEN_HELP)
@click.option("--robot", type=ROBOT, help=ROBOT_HELP)
@click.option("--list", "lists", is_flag=True, help="Ready tasks, and nothing else.")
@states_option
@click.option("--base", metavar="X,Y,YAW", help="Start pose of the base [m, m, rad], for every step.")
@drive_option
@tee_option
@forces_option
@handle_force_option
@annotation_option
@friction_option
@budget_option
@seed_option
@save_option
@csv_flag
@json_flag
def task_command(
    *,
    source: str | None,
    kitchen: str | None,
    robot: str | None,
    lists: bool,
    tee: str,
    forces: Path | None,
    handle_force: float | None,
    save: str | None,
    as_json: bool,
    **policy: Any,  # noqa: ANN401 - those of the policy, as click gives them
) -> None:
    """Can ROBOT do a sequence of steps in KITCHEN, and keep the rules on the way?

    Each step is judged from the state in which the step before ended. Where the task names a quality J,
    several motions are made for each step and the best certified one is kept. With --save, the result and
    the verdict of each step are kept: sdt why tells them.

    Exit 0 certified, 1 not certified, 3 abstained: nothing is claimed, 2 bad input.
    """
    if lists:
        _print_ready(as_json=as_json)
        return
    if source is None or kitchen is None or robot is None:
        raise InputError("a task, --kitchen and --robot are needed", remedy="sdt task --list has ready tasks")
    drive = Drive(policy["drive"]) if policy["drive"] else None
    how = Policy(
        drive, parse_base(policy["base"]), policy["budget"], policy["seed"], friction=policy["friction"]
    )
    service = load(kitchen, [robot], annotation=policy["annotation"], state=policy["states"], policy=how)
    service = in_class(service, tee, forces, handle_force)
    specification = specification_of(service.twin, source)
    with SavedVerdicts(save) if save is not None else nullcontext() as saved:
        result = _judged(service, specification, model_name(robot), saved)
        if saved is not None:
            saved.add_record(task_record(result))  # twin and steps were kept as they were done
        said = result_json(result)
        say(said, as_json=as_json)  # before the store is closed, which may not fit
    raise SystemExit(exit_of(said))


def _print_ready(*, as_json: bool) -> None:
    rows = [{"task": name, "file": str(path)} for name, path in ready().items()]
    if as_json:
        print_json(rows)
    elif csv_is_asked():
        print_rows(rows, ("task", "file"))
    else:
        click.echo("\n".join(f"{each['task']:32} {each['file']}" for each in rows))


def exit_of(said: Json) -> Exit:
    """What the command ends with, of its JSON object."""
    exits = {Outcome.CERTIFIED.value: Exit.DONE, Outcome.ABSTAINED.value: Exit.ABSTAINED}
    return exits.get(said["outcome"], Exit.NO)


def say(said: Json, *, as_json: bool) -> None:
    """The result is told, of its JSON object."""
    if as_json:
        print_json(said)
    elif csv_is_asked():
        print_rows(_rows(said), COLUMNS)
    else:
        _print(said)


def _judged(
    service: Service, specification: Specification, robot: str, saved: SavedVerdicts | None
) -> TaskResult:
    """The result, with a bar on the way; how many steps there are is known when they are reached.

    The verdict of each step is kept as it is done: whoever interrupts loses the others alone.
    """
    if saved is not None:
        saved.add_twin(service.twin)
    with progress(specification.label, len(specification.steps), "steps") as bar:

        def told(step: StepResult, of: int) -> None:
            if saved is not None:
                saved.add(step.verdict)
            if bar:
                now = step.verdict.outcome.value
                bar.update(bar.task_ids[0], advance=1, total=of, now=now)

        return achieve_task(service, specification, robot, told=told)


def _rows(said: Json) -> list[Json]:
    """A row for each step and each rule."""
    steps = [
        {
            **each,
            "part": "step",
            "number": number,
            "what": each["step"],
            "why": "; ".join(diagnosis_text(one) for one in each["verdict"]["diagnoses"]),
            "iri": each["verdict"]["iri"],
        }
        for number, each in enumerate(said["steps"], 1)
    ]
    rules = [
        {
            "part": "rule",
            "number": number,
            "what": each["rule"],
            "outcome": each["standing"],
            "why": "" if each["diagnosis"] is None else diagnosis_text(each["diagnosis"]),
            "in_step": each["step"],
            "time": each["time"],
        }
        for number, each in enumerate(said["rules"], 1)
    ]
    return [{**each, "task": said["task"], "task_outcome": said["outcome"]} for each in [*steps, *rules]]


def _print(said: Json) -> None:
    click.echo(f"{said['outcome']}  {said['task']}")
    for number, step in enumerate(said["steps"], 1):
        click.echo(
            f"  step {number} of {said['steps_of']}: {step['outcome']}  {step['step']}{_chosen(step, said)}"
        )
        click.echo(f"    {step['verdict']['iri']}")
    for rule in said["rules"]:
        click.echo(f"  rule {rule['standing']}: {rule['rule']}  ({rule['how']})")
    for line in not_reached(said["rules_not_judged"]):
        click.echo(f"  {line}")
    _print_broken(said["first_broken"])
    for diagnosis in said["diagnoses"]:
        click.echo(f"  {diagnosis_text(diagnosis)}")
        if diagnosis["evidence"]:
            click.echo(f"    {_evidence(diagnosis['evidence'])}")
    _print_quality(said["quality"])
    for note in said["notes"]:
        click.echo(f"  note: {note}")
    click.echo(f"  {said['seconds']:.2f} s")
    click.echo(f"  {said['result']}")


def _print_broken(broken: Json | None) -> None:
    if broken is None:
        return
    joints = ", ".join(f"{name} {at:.4g}" for name, at in broken["state"].items()) or "all at 0"
    click.echo(f"  first broken: {broken['rule']}, in step {broken['step']} at {broken['time']:.3f} s")
    click.echo(f"    state: {joints}")


def _print_quality(quality: Json | None) -> None:
    if quality is None:
        return
    value = "no value" if quality["value"] is None else f"{_at(quality)} {quality['unit']}"
    click.echo(
        f"  J = {quality['name']}: {value}" + ("" if quality["value"] is None else ", best of those found")
    )


def _at(said: Json) -> str:
    """A value of J; of a clearance that is a bound, that it is one."""
    return f"{AT_LEAST if said['at_least'] else ''}{said['value']:.4g}"


def _evidence(said: Json) -> str:
    when = "" if said["time"] is None else f" at {said['time']:g} s"
    return f"{said['quantity']}: {told_evidence(said, 'unknown')}{when}"


def _chosen(step: Json, said: Json) -> str:
    if said["quality"] is None or step["value"] is None:
        return ""
    unit = said["quality"]["unit"]
    return (
        f"  (seed {step['seed']}, {_at(step)} {unit}: best of {step['compared']} certified "
        f"that break no rule, {step['searches']} searched)"
    )
