"""`sdt sweep`: many cases, planned from a grid, a CSV file or a query; resumed where it was stopped."""

from collections.abc import Iterable
from contextlib import ExitStack
from functools import partial
from itertools import product
from pathlib import Path

import click

from predicates.record.recall import Recall, nothing_stored
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.load import model_name
from sdt_kg.numbers import so_many
from services.app import DEFAULT_BUDGET
from services.commands.exits import Exit
from services.commands.graphs.bounding import bound_options, bounded
from services.commands.options import (
    FRICTION,
    FRICTION_HELP,
    FiniteRange,
    OutFile,
    forces_option,
    jobs_option,
    json_flag,
    kitchens_option,
    query_text,
    robots_option,
)
from services.commands.show import print_json, print_rows, progress
from services.relative import CLASSES
from services.requests import parse_base, parse_seeds
from services.store.files import FORMATS, SavedVerdicts
from services.store.server.remote import is_url
from services.store.workers import Ask
from services.sweep.executors.engines import Engine, dask, processes
from services.sweep.parquet import Rows, parquet
from services.sweep.plan import Axes, Plan, classes, grid, policies
from services.sweep.run import run
from services.sweep.sources import Listed, Row, csv_rows, query_rows
from services.sweep.summary import OUTCOMES, Kept, Summary
from services.sweep.worker import as_asked, stored, twin_of


@click.command()
@kitchens_option
@robots_option
@click.option(
    "--task",
    "tasks",
    multiple=True,
    default=("open",),
    metavar="VERB[:CONTAINER]",
    help="open or close, of every container or of one. Repeatable: each is a case. [default: open]",
)
@click.option(
    "--start",
    "starts",
    multiple=True,
    metavar="JOINT=VALUE[;…]",
    help="A start state, as for --state of 'sdt table'. Repeatable: each is a case. [default: all closed]",
)
@click.option(
    "--drive",
    "drives",
    multiple=True,
    type=click.Choice([each.value for each in Drive]),
    help="How the base moves. Repeatable: each is a case. [default: as the robot's hardware does]",
)
@click.option(
    "--base",
    "bases",
    multiple=True,
    metavar="X,Y,YAW",
    help="Start pose of the base [m, m, rad]. Repeatable: each is a case. [default: the kitchen's]",
)
@click.option(
    "--tee",
    "tees",
    multiple=True,
    type=click.Choice(list(CLASSES), case_sensitive=False),
    default=("d_artic",),
    help="The class that verdicts are relative to. Repeatable: each is a case. [default: d_artic]",
)
@forces_option
@click.option(
    "--handle-force",
    "handle_forces",
    multiple=True,
    type=FiniteRange(min=0, min_open=True),
    metavar="NEWTON",
    help="Allowed at every handle, for d_artic_dyn. Repeatable: each is a case. [default: what the force "
    "data say]",
)
@click.option(
    "--friction",
    "frictions",
    multiple=True,
    type=FRICTION,
    metavar="MU",
    help=f"{FRICTION_HELP} Repeatable: each is a case. [default: verdicts say what their holds need]",
)
@click.option("--seeds", default="0", show_default=True, metavar="N|N..M", help="Of the search.")
@click.option(
    "--budget",
    type=FiniteRange(min=0, min_open=True),
    default=DEFAULT_BUDGET,
    show_default=True,
    help="Seconds of search for each case before giving up.",
)
@click.option(
    "--cases",
    "file",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE.csv",
    help="A row for each case: kitchen, robot, container, task, state (by ;), drive, base, budget, seed, "
    "friction, tee, handle_force; what a row leaves out is taken from the options.",
)
@click.option(
    "--query",
    metavar="SPARQL|FILE.rq",
    help="A row for each case: a SELECT of ?kitchen ?robot ?container ?task … over the kitchens or --of.",
)
@click.option("--of", metavar="STORE", help="Saved verdicts that --query is asked of.")
@bound_options
@click.option(
    "--save",
    "--store",
    "save",
    metavar="STORE",
    help="A directory or a SPARQL server. Every verdict is kept as soon as it is there, and what is kept is "
    "not judged again: the same command goes on where it was stopped or killed.",
)
@click.option(
    "--parquet",
    "table",
    type=OutFile(),
    metavar="FILE",
    help="A row for each case, stored ones too, written when all are done.",
)
@jobs_option
@click.option("--dask", "address", metavar="tcp://HOST:PORT", help="Have a Dask cluster judge instead.")
@click.option("--plan", "only_plan", is_flag=True, help="Only tell how many cases there are and are stored.")
@json_flag
def sweep(
    *,
    kitchens: str,
    robots: str,
    tasks: tuple[str, ...],
    starts: tuple[str, ...],
    drives: tuple[str, ...],
    bases: tuple[str, ...],
    tees: tuple[str, ...],
    forces: Path | None,
    handle_forces: tuple[float, ...],
    frictions: tuple[float, ...],
    seeds: str,
    budget: float,
    file: Path | None,
    query: str | None,
    of: str | None,
    timeout: float,
    memory: float,
    save: str | None,
    table: Path | None,
    jobs: int,
    address: str | None,
    only_plan: bool,
    as_json: bool,
) -> None:
    """Judge many cases: every combination of the options, the rows of a CSV file, or those of a query.

    Exit 0 whenever every case got a verdict, 4 if some got none.
    """
    axes = Axes(
        tasks=tasks,
        states=tuple(_texts(each) for each in starts) or ((),),
        policies=policies(
            [Drive(each) for each in drives] or [None],
            [parse_base(each) for each in bases] or [None],
            parse_seeds(seeds),
            budget,
            frictions or (None,),
        ),
        classes=classes(tees, forces, handle_forces),
    )
    models = tuple(kitchens.split(",")), tuple(robots.split(","))
    plan = _planned(models, axes, _rows(models, file, query, of, (timeout, memory)))
    place = None if save is None else _place(save)
    with ExitStack() as stack:  # a store is made when somebody can judge
        engine = stack.enter_context(dask(address)) if address and not only_plan else processes(jobs)
        saved = None if place is None else stack.enter_context(SavedVerdicts(place))
        recall = nothing_stored if saved is None else saved.stored
        if only_plan:
            _tell_plan(plan, recall, as_json=as_json)
            return
        rows = stack.enter_context(parquet(table)) if table else None
        found = _swept(plan, engine, recall, saved, rows)
    if as_json:
        print_json(found.to_json())
    else:
        _show(found, save, table)
    raise SystemExit(Exit.NO_ORACLE if found.unjudged else Exit.DONE)


def _rows(
    models: tuple[tuple[str, ...], tuple[str, ...]],
    file: Path | None,
    query: str | None,
    of: str | None,
    bounds: tuple[float, float],
) -> Iterable[tuple[str, Row]] | None:
    """What a CSV file lists, or a query, which is asked within its bounds; None where neither is named."""
    if file is not None and query is not None:
        raise InputError("--cases and --query both say which cases", allowed="one of them")
    if of is not None and query is None:
        raise InputError("--of is what a query is asked of", remedy="--query SPARQL")
    if file is not None:
        return csv_rows(file)
    if query is None:
        return None
    text = query_text(Path(query)) if query.endswith(".rq") else query
    asks: Ask[list[tuple[str, Row]]]
    with bounded(*bounds) as asks:
        return asks(partial(query_rows, text, *models, of))


def _planned(
    models: tuple[tuple[str, ...], tuple[str, ...]], axes: Axes, rows: Iterable[tuple[str, Row]] | None
) -> Plan:
    """The cases of the rows, or of every combination where there are none."""
    if rows is not None:
        return Listed(*models, axes).plan(rows)
    plan = grid(*models, axes)
    for kitchen, robot in product(*models):
        twin_of(kitchen, robot)  # what cannot be loaded is told before anything is judged; workers keep it
    return plan


def _place(save: str) -> str:
    """Where every verdict is kept at once; a file is only written at the end.

    Raises:
        InputError: It is a file.
    """
    if not is_url(save) and Path(save).suffix in FORMATS:
        raise InputError(
            f"a sweep that is killed would lose what is in {save}: it is written at the end",
            allowed="a directory, http://HOST of an Oxigraph, http://HOST/QUERY,http://HOST/UPDATE",
            remedy=f"--save {Path(save).with_suffix('')}/",
        )
    return save


def _texts(start: str) -> tuple[str, ...]:
    return tuple(text.strip() for text in start.split(";") if text.strip())


def _tell_plan(plan: Plan, recall: Recall, *, as_json: bool) -> None:
    known = recall is not nothing_stored
    kept = sum(stored(cell, recall) is not None for cell in plan.cells) if known else 0
    if as_json:
        print_json({"cases": plan.total, "stored": kept})
    else:
        click.echo(f"{so_many(plan.total, 'case', 'cases')}, {kept} of them stored")


def _swept(
    plan: Plan, engine: Engine, recall: Recall, saved: SavedVerdicts | None, rows: Rows | None
) -> Summary:
    """Every case judged or found, each kept before it is counted."""
    summary, kept = Summary(), Kept(saved)
    with progress("sweep", plan.total, "cases") as bar:
        for each in run(plan.cells, engine, recall):
            found = each if engine.copies else as_asked(each)
            kept.add(found)
            if rows is not None:
                rows.add(found)
            summary.add(found)
            if bar:
                cell = found.cell
                bar.update(bar.task_ids[0], advance=1, now=f"{model_name(cell.robot)} {cell.container}")
    return summary


def _show(summary: Summary, save: str | None, table: Path | None) -> None:
    """The counts, what has no verdict, and where the rest is."""
    print_rows(summary.rows(), ("kitchen", "robot", "task", *OUTCOMES, "no_verdict", "cases"))
    if summary.unjudged:
        click.echo("\nno verdict, and why:\n")
        print_rows(summary.unjudged, ("kitchen", "robot", "task", "reason"))
    took = f"{summary.stored} of them stored before, in {summary.seconds:.0f} s"
    click.echo(f"\n{so_many(summary.total, 'case', 'cases')}, {took}")
    for name, place in (("verdicts as triples", save), ("table", table)):
        if place:
            click.echo(f"{name}: {place}")
