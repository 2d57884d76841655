"""`sdt whatif`: the same question in another world, and the smallest change that turns the answer."""

from pathlib import Path

import click

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from services.app import Policy, load
from services.codesign.asked import alternatives
from services.codesign.report import to_json
from services.codesign.smallest.sought import Question
from services.codesign.smallest.told import turned_json
from services.codesign.smallest.turning import turned
from services.commands.completion.types import KITCHEN, ROBOT, TASK
from services.commands.options import (
    KITCHEN_HELP,
    ROBOT_HELP,
    FiniteRange,
    OutFile,
    WholeRange,
    budget_option,
    drive_option,
    forces_option,
    friction_option,
    handle_force_option,
    json_flag,
    seed_option,
    states_option,
    tee_option,
)
from services.commands.show import print_json
from services.commands.worlds.answer import exit_of, print_answer
from services.commands.worlds.grid import asked_of, ends_with, judged, told
from services.commands.worlds.turn import ends_with as ends_with_turned
from services.commands.worlds.turn import print_turned
from services.policy import DEFAULT_WITHIN
from services.relative import Relative, tee_of
from services.requests import parse_base
from services.whatif import KINDS, World, answered, parse_change


@click.command(epilog="SPEC is " + "; ".join(KINDS.values()) + ".")
@click.option("--kitchen", type=KITCHEN, help=KITCHEN_HELP)
@click.option("--robot", type=ROBOT, help=ROBOT_HELP)
@click.option("--task", type=TASK, metavar="TASK", help="open:CONTAINER or close:CONTAINER.")
@click.option(
    "--edit",
    "edits",
    multiple=True,
    metavar="SPEC",
    help="What is otherwise; 'help' lists the kinds. Repeatable.",
)
@click.option(
    "--grid",
    is_flag=True,
    help="Every combination: each --edit is an axis of alternatives with ' | ' between them; --kitchen and "
    "--robot may be several with commas, --task may be open or close without a container.",
)
@click.option(
    "--jobs",
    type=WholeRange(min=1),
    default=1,
    show_default=True,
    help="Processes of a grid, or of --turn.",
)
@click.option(
    "--csv",
    "csv_file",
    type=OutFile(),
    metavar="FILE",
    help="Write every case of a grid as CSV.",
)
@click.option(
    "--turn",
    is_flag=True,
    help="Search the smallest share of the edits at which the outcome turns; without --edit, the smallest "
    "change of every kind that is looked at.",
)
@click.option(
    "--within",
    type=FiniteRange(min=1),
    show_default=f"{DEFAULT_WITHIN:g}",
    help="Seconds of CPU for each process of --turn without --edit.",
)
@states_option
@click.option("--base", metavar="X,Y,YAW", help="Start pose of the base [m, m, rad].")
@drive_option
@tee_option
@forces_option
@handle_force_option
@friction_option
@budget_option
@seed_option
@json_flag
def whatif(
    *,
    kitchen: str | None,
    robot: str | None,
    task: str | None,
    edits: tuple[str, ...],
    grid: bool,
    jobs: int,
    csv_file: Path | None,
    turn: bool,
    within: float | None,
    states: tuple[str, ...],
    base: str | None,
    drive: str | None,
    tee: str,
    forces: Path | None,
    handle_force: float | None,
    friction: float | None,
    budget: float,
    seed: int,
    as_json: bool,
) -> None:
    """Would ROBOT achieve TASK if things were otherwise? Says what differs and which predicate turns.

    Exit 0 if the other world's verdict is certified, 3 if it abstained, else 1. With --turn: 0 if a turn was
    found, even to a refusal, else 1; but 3 if the verdict abstained at the turn, or as it is where none was
    found. With --grid: 0 if every case has a verdict, else 4.
    """
    if "help" in edits:
        click.echo("\n".join(KINDS.values()))
        return
    _check_together(grid=grid, turn=turn, csv_file=csv_file)
    if within is not None and (edits or not turn):
        raise InputError("--within is of --turn without --edit", remedy="leave it out")
    if kitchen is None or robot is None or task is None or not (edits or turn):
        raise InputError("--kitchen, --robot, --task and --edit are needed", remedy="--edit help lists edits")
    policy = Policy(Drive(drive) if drive else None, parse_base(base), budget, seed, friction=friction)
    relative = Relative(tee_of(tee), forces, handle_force)
    if grid:
        asked = asked_of(kitchen, robot, task, edits, states, policy, relative)
        cells = to_json(judged(asked, jobs))
        told(cells, csv_file, as_json=as_json)
        raise SystemExit(ends_with(cells))
    if not edits:
        question = Question(kitchen, robot, task, states, policy, relative)
        smallest = turned_json(turned(question, within or DEFAULT_WITHIN, jobs))
        print_json(smallest) if as_json else print_turned(smallest)
        raise SystemExit(ends_with_turned(smallest))
    _check_alternatives(edits)
    world = World(relative.of(load(kitchen, [robot], state=states, policy=policy)), robot)
    changes = tuple(parse_change(text) for text in edits)
    said, _ = answered(world, task, changes, turn=turn)
    print_json(said) if as_json else print_answer(said)
    raise SystemExit(exit_of(said))


def _check_alternatives(edits: tuple[str, ...]) -> None:
    """Without a grid each edit is one."""
    for text in edits:
        _, *others = alternatives(text)
        if any(each.partition(":")[0] in KINDS for each in others):
            raise InputError(
                f"'{text}' has alternatives",
                allowed="one edit, and --edit again for another that is made too",
                remedy="--grid judges each alternative",
            )


def _check_together(*, grid: bool, turn: bool, csv_file: Path | None) -> None:
    """Options that make one question."""
    if grid and turn:
        raise InputError("--grid and --turn are two questions", allowed="one of them")
    if csv_file and not grid:
        raise InputError("--csv is of a grid", remedy="--grid, or --json")
