"""`sdt whatif`: the same question in another world, and the smallest change that turns the answer."""

from collections.abc import Callable
from pathlib import Path

import click

from predicates.case import Verdict
from predicates.counterfactual import Contrast, Turn, smallest_turn, widest_gap
from predicates.record import diagnosis_json, to_json
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from services.app import Policy, load
from services.codesign.command.grid import asked_of, ends_with, judged, told
from services.codesign.command.turn import print_contrast, print_turned, turned_json
from services.codesign.smallest.sought import Question
from services.codesign.smallest.turning import turned
from services.commands.completion.types import KITCHEN, ROBOT, TASK
from services.commands.exits import Exit
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
    json_flag,
    seed_option,
    states_option,
    tee_option,
)
from services.commands.show import print_json
from services.commands.verdicts import Json
from services.relative import in_class
from services.requests import parse_base
from services.whatif import GRADUAL, KINDS, Change, World, changed, parse_change

SCAN = 8
"""Shares of the change that are tried first."""
TOLERANCE = 0.01
"""[1] Of the share of the change, to which the smallest one is told."""


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
    default=30.0,
    show_default=True,
    help="Seconds of CPU for each process of --turn without --edit.",
)
@states_option
@click.option("--base", metavar="X,Y,YAW", help="Start pose of the base [m, m, rad].")
@drive_option
@tee_option
@forces_option
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
    within: float,
    states: tuple[str, ...],
    base: str | None,
    drive: str | None,
    tee: str,
    forces: Path | None,
    friction: float | None,
    budget: float,
    seed: int,
    as_json: bool,
) -> None:
    """Would ROBOT achieve TASK if things were otherwise? Says what differs and which predicate turns.

    Exit 0 if the other world's verdict is certified (with --turn: if a turn was found; with --grid: if
    every case has one, else 4), else 1.
    """
    if "help" in edits:
        click.echo("\n".join(KINDS.values()))
        return
    _check_together(grid=grid, turn=turn, csv_file=csv_file)
    if kitchen is None or robot is None or task is None or not (edits or turn):
        raise InputError("--kitchen, --robot, --task and --edit are needed", remedy="--edit help lists edits")
    policy = Policy(Drive(drive) if drive else None, parse_base(base), budget, seed, friction=friction)
    if grid:
        asked = asked_of(kitchen, robot, task, edits, states, policy, tee, forces)
        found = judged(asked, jobs)
        told(found, csv_file, as_json=as_json)
        raise SystemExit(ends_with(found))
    if not edits:
        smallest = turned(Question(kitchen, robot, task, states, policy, tee, forces), within, jobs)
        print_json(turned_json(smallest)) if as_json else print_turned(smallest)
        raise SystemExit(0 if any(each.turn is not None for each in smallest.sought) else Exit.NO)
    world = World(in_class(load(kitchen, [robot], state=states, policy=policy), tee, forces), robot)
    changes = tuple(parse_change(text) for text in edits)
    if turn:
        raise SystemExit(_turned(world, task, changes, as_json=as_json))
    other = changed(world, changes)  # what cannot be made is said before anything is judged
    found = Contrast(_judged(world, task), _judged(other, task))
    said = _contrast_json(found, edits)
    if as_json:
        print_json(said)
    else:
        _print_contrast(said)
    raise SystemExit(0 if found.counterfactual.outcome.value == "certified" else Exit.NO)


def _check_together(*, grid: bool, turn: bool, csv_file: Path | None) -> None:
    """Options that make one question."""
    if grid and turn:
        raise InputError("--grid and --turn are two questions", allowed="one of them")
    if csv_file and not grid:
        raise InputError("--csv is of a grid", remedy="--grid, or --json")


def _judged(world: World, task: str) -> Verdict:
    verdicts = list(world.service.achieve(task, world.robot_iri))
    if len(verdicts) != 1:
        raise InputError(
            f"'{task}' is {len(verdicts)} questions", allowed="one container, open:CONTAINER say"
        )
    return verdicts[0]


def _turned(world: World, task: str, changes: tuple[Change, ...], *, as_json: bool) -> int:
    """Search the smallest share of the changes; those that are whole are made from the beginning of it."""
    gradual = [each for each in changes if each.amount is not None]
    if not gradual:
        raise InputError(
            "--turn needs an edit of which there is less",
            allowed=", ".join(GRADUAL),
            remedy="--edit help",
        )
    whole = tuple(each for each in changes if each.amount is None)
    ground = changed(world, whole)
    found = smallest_turn(
        lambda share: _judged(changed(ground, tuple(gradual), share), task), SCAN, TOLERANCE
    )
    said = _turn_json(found, lambda share: [_amount(each, ground, share) for each in gradual])
    if as_json:
        print_json(said)
    else:
        _print_turn(said)
    return 0 if found.after is not None else Exit.NO


def _amount(change: Change, world: World, share: float) -> str:
    assert change.amount is not None
    return change.amount(world, share)


def _contrast_json(found: Contrast, edits: tuple[str, ...]) -> Json:
    return {
        "edits": list(edits),
        "turned": found.turned,
        **_differences(found),
        "actual": to_json(found.actual),
        "counterfactual": to_json(found.counterfactual),
    }


def _differences(found: Contrast) -> Json:
    """Predicates that answer otherwise, and the reasons that are gone or new."""
    return {
        "predicates": [
            {"predicate": name, "actual": before, "counterfactual": after}
            for name, before, after in found.turned_predicates()
        ],
        "no_longer": [diagnosis_json(each) for each in found.gone()],
        "now": [diagnosis_json(each) for each in found.new()],
    }


def _print_contrast(said: Json) -> None:
    actual, other = said["actual"], said["counterfactual"]
    click.echo(f"as it is   {_headline(actual)}")
    click.echo(f"otherwise  {_headline(other)}   ({'; '.join(said['edits'])})")
    click.echo("the outcome turns" if said["turned"] else "the outcome stays")
    print_contrast(said)


def _headline(verdict: Json) -> str:
    return "{outcome}  {task}({container})  {robot} in kitchen {kitchen}".format_map(verdict)


def _turn_json(found: Turn, amounts: Callable[[float], list[str]]) -> Json:
    after = found.after
    return {
        "found": after is not None,
        "actual": to_json(found.tried[0].verdict),
        "share": None if after is None else after.share,
        "edits": None if after is None else amounts(after.share),
        "not_yet": amounts(found.before.share),
        "tolerance": found.gap,
        "apart_at_most": widest_gap([each.share for each in found.tried], after.share if after else 1.0),
        "counterfactual": None if after is None else to_json(after.verdict),
        **({} if after is None else _differences(Contrast(found.tried[0].verdict, after.verdict))),
        "tried": [
            {"share": each.share, "edits": amounts(each.share), "outcome": each.verdict.outcome.value}
            for each in found.tried
        ],
        "searched": {"from": 0.0, "to": 1.0, "first_steps": SCAN, "tolerance": TOLERANCE},
    }


def _print_turn(said: Json) -> None:
    click.echo(f"as it is   {_headline(said['actual'])}")
    if said["found"]:
        click.echo(f"turns at   {'; '.join(said['edits'])}   {_headline(said['counterfactual'])}")
        print_contrast(said)
        click.echo(f"not yet at {'; '.join(said['not_yet'])}")
        click.echo(
            f"smallest of {len(said['tried'])} tried, to {100 * said['tolerance']:.2g} % of the whole "
            f"change; those below it are at most {100 * said['apart_at_most']:.2g} % apart"
        )
    else:
        click.echo(f"no turn up to {'; '.join(said['tried'][-1]['edits'])}: searched, not proved")
    for each in said["tried"]:
        click.echo(f"  {100 * each['share']:5.1f} %  {each['outcome']:13}  {'; '.join(each['edits'])}")
