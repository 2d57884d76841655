"""`sdt codesign`: which robot for which kitchen, and what would have to be otherwise."""

from pathlib import Path

import click

from sdt_kg.annotation import Drive
from services.app import Policy
from services.codesign.asked import Asked
from services.codesign.design import Design, Plan, Step, designed, to_json
from services.commands.options import (
    FiniteRange,
    OutFile,
    budget_option,
    drive_option,
    forces_option,
    friction_option,
    handle_force_option,
    jobs_option,
    json_flag,
    kitchens_option,
    robots_option,
    seed_option,
    states_option,
    tee_option,
    verb_option,
)
from services.commands.show import csv_text, print_json, print_rows
from services.commands.worlds.grid import on_a_bar
from services.policy import DEFAULT_WITHIN
from services.relative import Relative, tee_of
from services.store.output import write_file

COVER_COLUMNS = ("kitchen", "robot", "certified", "of", "missing")


@click.command()
@kitchens_option
@robots_option
@verb_option
@click.option(
    "--edit",
    "edits",
    multiple=True,
    metavar="SPEC",
    help="An edit that a plan may take (sdt whatif --edit help), or two that are made at once, 'A & B'; "
    "without it they are looked for. Repeatable.",
)
@click.option("--no-plan", is_flag=True, help="Only what is certified as things are.")
@click.option(
    "--within",
    type=FiniteRange(min=1),
    default=DEFAULT_WITHIN,
    show_default=True,
    help="Seconds of CPU for each process to look for edits, for each refusal.",
)
@drive_option
@tee_option
@forces_option
@handle_force_option
@states_option
@friction_option
@budget_option
@seed_option
@jobs_option
@click.option("--csv", "csv_file", type=OutFile(), metavar="FILE", help="Write the covers as CSV.")
@json_flag
def codesign(
    *,
    kitchens: str,
    robots: str,
    verb: str,
    edits: tuple[str, ...],
    no_plan: bool,
    within: float,
    drive: str | None,
    tee: str,
    forces: Path | None,
    handle_force: float | None,
    states: tuple[str, ...],
    friction: float | None,
    budget: float,
    seed: int,
    jobs: int,
    csv_file: Path | None,
    as_json: bool,
) -> None:
    """Which robot opens most of a kitchen, which robots together, and which few edits the rest needs.

    Everything counted is certified; covers are greedy, so a smaller one may exist. Exit 0.
    """
    policy = Policy(Drive(drive) if drive else None, None, budget, seed, friction=friction)
    models = tuple(kitchens.split(",")), tuple(robots.split(","))
    asked = Asked(*models, verb, (), policy, states, relative=Relative(tee_of(tee), forces, handle_force))
    with on_a_bar(verb) as report:
        found = designed(asked, jobs, edits, within, not no_plan, report)
    if csv_file:
        write_file(csv_file, csv_text(_rows(found), COVER_COLUMNS))
    if as_json:
        print_json(to_json(found))
    else:
        _print(found)


def _rows(found: Design) -> list[dict[str, object]]:
    return [
        {
            "kitchen": each.kitchen,
            "robot": each.robot,
            "certified": len(each.certified),
            "of": each.of,
            "missing": ", ".join(name for name, _ in each.missing),
        }
        for each in found.covers
    ]


def _print(found: Design) -> None:
    print_rows(_rows(found), COVER_COLUMNS)
    for kitchen, steps in found.together:
        said = ", then ".join(f"{each.what} ({_more(each)})" for each in steps)
        covered = steps[-1].covered if steps else 0
        of = next(each.of for each in found.covers if each.kitchen == kitchen)
        click.echo(f"\nkitchen {kitchen}, robots together: {covered} of {of}: {said or 'none'}")
    for plan in found.plans:
        _print_plan(plan)
    click.echo("\ngreedy over certified verdicts: a smaller cover may exist")


def _more(step: Step) -> str:
    return f"{len(step.gained)} more" + (f", {len(step.lost)} less" if step.lost else "")


def _no_step(plan: Plan) -> str:
    """Why nothing is edited."""
    if not plan.candidates:
        return "nothing to gain" if not plan.missing else "no candidate was found"
    return f"none of {len(plan.candidates)} candidates gains more than it loses"


def _print_plan(plan: Plan) -> None:
    click.echo(f"\nkitchen {plan.kitchen} for {plan.robot}, edits one after the other:")
    for step in plan.steps:
        lost = f"; no longer {', '.join(step.lost)}" if step.lost else ""
        click.echo(f"  {step.what}: {', '.join(step.gained)}{lost}  → {step.covered} of {plan.of}")
    if not plan.steps:
        click.echo(f"  {_no_step(plan)}")
    for step in plan.even:
        click.echo(f"  not taken: {step.what}: {', '.join(step.gained)}; no longer {', '.join(step.lost)}")
    for name, reason in plan.missing:
        click.echo(f"  still not certified: {name}: {reason}")
