"""`sdt table`: CanAchieve for every container of some kitchens and some robots."""

from collections import Counter
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import click

from predicates.record.recall import nothing_stored
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin, model_name
from sdt_kg.scope import D_ARTIC
from sdt_kg.task import Verb
from services.app import Policy, Service
from services.commands.exits import Exit
from services.commands.options import (
    OutFile,
    OutFolder,
    budget_option,
    drive_option,
    forces_option,
    friction_option,
    handle_force_option,
    jobs_option,
    json_flag,
    save_option,
    seed_option,
    state_option,
    tee_option,
    verb_option,
)
from services.commands.show import csv_text, print_json, print_rows, progress
from services.commands.verdicts import COLUMNS, Json, verdict_row
from services.relative import Relative, tee_of
from services.requests import ASKED, parse_state, state_joints, state_of_asked
from services.store.output import write_file
from services.sweep.cell import Cell, Unjudged
from services.sweep.worker import reading_ahead
from services.table import CellResult, TableResult, cells, run

if TYPE_CHECKING:
    from services.store.files import SavedVerdicts

STDOUT = Path("-")


@click.command()
@click.option(
    "--kitchens", default="a,b", show_default=True, help="Bundled kitchens or paths, comma-separated."
)
@click.option(
    "--robots",
    default="pr2,tiago_dual,stretch",
    show_default=True,
    help="Bundled robots or paths, comma-separated.",
)
@verb_option
@drive_option
@tee_option
@forces_option
@handle_force_option
@state_option("; asked=VALUE is about the container of each case")
@friction_option
@budget_option
@seed_option
@jobs_option
@save_option
@click.option(
    "--motions",
    type=OutFolder(),
    metavar="DIR",
    help="Write each certified body motion to DIR.",
)
@click.option(
    "--csv",
    "csv_file",
    type=OutFile(dash=True),
    metavar="FILE",
    help="Write every case as CSV; - prints it in place of the table.",
)
@json_flag
def table(
    *,
    kitchens: str,
    robots: str,
    verb: str,
    drive: str | None,
    tee: str,
    forces: Path | None,
    handle_force: float | None,
    states: tuple[str, ...],
    friction: float | None,
    budget: float,
    seed: int,
    jobs: int,
    save: str | None,
    motions: Path | None,
    csv_file: Path | None,
    as_json: bool,
) -> None:
    """Table 1: every container of some kitchens for some robots, each refusal explained.

    With --save, what was judged before is answered from there. Exit 0 whenever every case got a verdict, 4
    where one has none, as its process died twice.
    """
    if as_json and csv_file == STDOUT:
        raise click.UsageError("--json and --csv -: one of them")
    if verb == "close" and not states:
        click.echo(
            f"everything is closed already; --state {ASKED}=open closes each from where it is", err=True
        )
    policy = Policy(Drive(drive) if drive else None, None, budget, seed, friction=friction)
    relative = Relative(tee_of(tee), forces, handle_force)
    ahead = reading_ahead(kitchens.split(","), robots.split(","), Verb(verb)) if jobs > 1 else nullcontext()
    with ahead:
        cases = cells(kitchens.split(","), robots.split(","), verb, states, policy, relative=relative)
        # The table is told before the store is closed: a file is written then, and may not fit.
        with _kept_in(save) if save is not None else nullcontext() as saved:
            if saved:
                _add_twins(saved, kitchens.split(","), robots.split(","), states, relative)
            result = _judged(cases, jobs, motions, saved, verb)
            _say(result, [each.verdict for each in result.results], csv_file, as_json=as_json)
    if save and not as_json and csv_file != STDOUT:
        click.echo(f"verdicts as triples: {save}")
    raise SystemExit(Exit.NO_ORACLE if result.unjudged else Exit.DONE)


def _kept_in(place: str) -> "SavedVerdicts":
    from services.store.files import SavedVerdicts  # noqa: PLC0415 - slow to import, and nothing may be kept

    return SavedVerdicts(place)


def _judged(
    cases: Sequence[Cell], jobs: int, motions: Path | None, saved: "SavedVerdicts | None", title: str
) -> TableResult:
    """All cases, each kept as soon as it is there, with a bar on the way."""
    with progress(title, len(cases), "cases") as bar:

        def advance(cell: Cell) -> None:
            if bar:
                bar.update(bar.task_ids[0], advance=1, now=f"{model_name(cell.robot)} {cell.container}")

        def report(result: CellResult) -> None:
            if saved and not result.stored:
                saved.add_record(result.record)
            advance(result.cell)

        def lost(case: Unjudged) -> None:
            advance(case.cell)

        recall = saved.stored if saved else nothing_stored
        return run(cases, jobs, report, motions, recall, lost, records=saved is not None)


def _say(result: TableResult, objects: Sequence[Json], csv_file: Path | None, *, as_json: bool) -> None:
    """The table, as JSON, as CSV or for people."""
    if csv_file:
        _write_csv(csv_file, objects)
    if as_json:
        print_json(result.to_json())
    elif csv_file != STDOUT:
        _print_table(result, objects)
    else:
        for each in result.unjudged:
            click.echo(f"no verdict: {each.cell}: {each.reason}", err=True)


def _write_csv(path: Path, objects: Sequence[Json]) -> None:
    """Every case, a line each."""
    text = csv_text([verdict_row(each) for each in objects], COLUMNS)
    if path == STDOUT:
        click.echo(text, nl=False)
    else:
        write_file(path, text)


def _add_twins(
    saved: "SavedVerdicts",
    kitchens: Sequence[str],
    robots: Sequence[str],
    states: Sequence[str],
    relative: Relative,
) -> None:
    """The kitchens as they are judged, each in its states."""
    for kitchen in kitchens:
        twin = relative.of(Service(load_twin(kitchen, robots))).twin
        texts = state_joints(twin, states)
        for each in {state_of_asked(texts, container.name) for container in twin.containers()}:
            saved.add_twin(twin.at(parse_state(twin, each)))


def _print_table(result: TableResult, objects: Sequence[dict[str, object]]) -> None:
    counts = result.cells()
    robots = list(dict.fromkeys(robot for row in counts.values() for robot in row))
    rows = [
        {"kitchen": kitchen} | {robot: f"{row[robot][0]} / {row[robot][1]}" for robot in robots}
        for kitchen, row in counts.items()
    ]
    print_rows(rows, ("kitchen", *robots))
    drives = Counter((str(each["robot"]), str(each["drive"])) for each in objects)
    click.echo("\nbase: " + ", ".join(f"{robot} {drive}" for robot, drive in drives))
    if classes := {str(each["tee_class"]) for each in objects} - {D_ARTIC.name}:
        click.echo(f"class: {', '.join(sorted(classes))}")
    missing = [verdict_row(each) for each in objects if each["outcome"] != "certified"]
    if missing:
        click.echo("\nnot certified, and why:\n")
        print_rows(missing, ("kitchen", "robot", "container", "outcome", "why"))
    if result.unjudged:
        click.echo("\nno verdict, and why:\n")
        print_rows(result.without_verdict(), ("kitchen", "robot", "task", "reason"))
    stored = sum(each.stored for each in result.results)
    kept = f", {stored} of them stored before," if stored else ""
    click.echo(
        f"\n{len(objects)} verdicts{kept} in {result.seconds:.0f} s ({result.cpu_seconds:.0f} s of CPU)"
    )
