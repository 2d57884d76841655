"""`sdt place`: where the base may stand for a task."""

import click

from predicates.case import Kind
from sdt_kg.load import model_name
from services.app import load
from services.commands.completion.types import KITCHEN, ROBOT, TASK
from services.commands.exits import Exit
from services.commands.options import (
    KITCHEN_HELP,
    ROBOT_HELP,
    annotation_option,
    budget_option,
    csv_flag,
    friction_option,
    json_flag,
    seed_option,
    states_option,
)
from services.commands.show import countdown, csv_is_asked, note_lengths, print_json, print_rows
from services.commands.verdicts import Json, hint_of_state


@click.command()
@click.option("--kitchen", required=True, type=KITCHEN, help=KITCHEN_HELP)
@click.option("--robot", required=True, type=ROBOT, help=ROBOT_HELP)
@click.option("--task", required=True, type=TASK, metavar="TASK", help="open:CONTAINER or close:CONTAINER.")
@states_option
@annotation_option
@friction_option
@budget_option
@seed_option
@csv_flag
@json_flag
def place(
    *,
    kitchen: str,
    robot: str,
    task: str,
    states: tuple[str, ...],
    annotation: str | None,
    friction: float | None,
    budget: float,
    seed: int,
    as_json: bool,
) -> None:
    """Base poses from which ROBOT can do TASK in KITCHEN without moving its base.

    Every pose that is given is certified, and can be asked again: sdt achieve --base X,Y,YAW --drive fixed.
    The map says of each square of base positions: certified, proved impossible, blocked by furniture, or
    unknown. --csv prints the poses, the best first.

    Exit 0 there is such a pose, 1 none was found, 3 out of scope, 2 bad input.
    """
    from services.embodiment.place.asked import placed  # noqa: PLC0415 - loads the oracle

    service = load(kitchen, [robot], annotation=annotation, state=states)
    note_lengths(service.twin)
    with countdown(task, budget):
        asked = service.robot(model_name(robot))
        said = placed(service.twin, asked, task, budget=budget, seed=seed, friction=friction)
    say(said, task, friction, as_json=as_json)
    raise SystemExit(exit_of(said))


def say(said: Json, task: str, friction: float | None, *, as_json: bool) -> None:
    """The placement is told, of its JSON object; it was asked for that task, with that friction."""
    from services.embodiment.place import answer  # noqa: PLC0415 - loads the oracle

    if as_json:
        print_json(said)
    elif csv_is_asked():
        print_rows(said["spots"], answer.COLUMNS)
    else:
        for line in answer.lines(said, friction):
            click.echo(line)
        verb = task.partition(":")[0].strip().lower()
        hint_of_state([{"task": verb, "diagnoses": said["diagnoses"]}])


def exit_of(said: Json) -> Exit:
    """What the command ends with, of its JSON object."""
    if said["spots"]:
        return Exit.DONE
    kinds = {each["kind"] for each in said["diagnoses"]}
    return Exit.ABSTAINED if kinds == {Kind.OUT_OF_SCOPE.value} else Exit.NO
