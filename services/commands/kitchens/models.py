"""`sdt containers`, `sdt graph`, `sdt scope`: what a kitchen is, before any question of motion."""

from pathlib import Path

import click

from predicates.learn.frames import world_T_of
from predicates.meant import counted, unit_of
from predicates.oracle import tee_class_of
from sdt_kg.annotating.panels import corners
from sdt_kg.iri import local_name
from sdt_kg.load import load_twin
from sdt_kg.numbers import so_many
from sdt_kg.scope import violations
from sdt_kg.twin import Container, Twin
from services.app import load
from services.commands.completion.types import ROBOT
from services.commands.exits import Exit
from services.commands.kitchens.explain import explain
from services.commands.options import (
    ROBOT_HELP,
    OutFile,
    annotation_option,
    csv_flag,
    forces_option,
    handle_force_option,
    json_flag,
    kitchen_argument,
    tee_option,
)
from services.commands.show import csv_is_asked, note_lengths, print_json, print_rows
from services.commands.terminal import console
from services.relative import in_class
from services.scoping import report_turtle
from services.store.output import write_file

COLUMNS = (
    "name",
    "kind",
    "joint",
    "handle",
    "handle_height",
    "unit",
    "lower",
    "upper",
    "open_from",
    "closed_to",
    "velocity",
    "acceleration",
)
GRAPH_FORMATS = {".ttl": "turtle", ".trig": "trig", ".nq": "nquads"}


@click.command()
@kitchen_argument
@click.option("--all", "show_all", is_flag=True, help="Also the joints that are left out, with the reason.")
@csv_flag
@json_flag
def containers(kitchen: str, show_all: bool, as_json: bool) -> None:
    """The counted containers of KITCHEN, their joints, handles and limits.

    Positions are in the unit that is told (rad or m), velocities and accelerations in that a second and a
    second squared. handle_height is how high the middle of the handle is at the start [m], from z = 0 of the
    kitchen's root frame.

    What is called a drawer or door counts if a joint of its own moves it and a link that is called a handle
    is fixed to it; a hinged panel with a bar at its free edge is a door whatever the names. What to do about
    others, kitchens/README.md says.
    """
    twin = load_twin(kitchen)
    rows = [container_row(twin, container) for container in twin.containers()]
    left_out = [
        {
            "joint": local_name(each.joint),
            "name": local_name(each.body),
            "reason": each.reason,
            "left_out": True,
        }
        for each in (twin.left_out() if show_all else ())
    ]
    if as_json:
        print_json(rows + left_out)
        return
    if csv_is_asked():
        print_rows(rows + left_out, (*COLUMNS, *(("left_out", "reason") if show_all else ())))
        return
    print_rows(rows, COLUMNS)
    if show_all and left_out:
        console().print()
        print_rows(left_out, ("name", "joint", "reason"))
    elif show_all:
        click.echo("\nno joint that moves is left out")
    if not rows and not show_all:
        click.echo("note: no door or drawer counts; --all says what is left out, and why", err=True)
    for note in twin.notes:
        click.echo(f"note: {note}", err=True)


def container_row(twin: Twin, container: Container) -> dict[str, object]:
    """One counted container with local names; positions in rad or m."""
    row: dict[str, object] = {
        column: getattr(container, column) for column in COLUMNS if column not in {"unit", "handle_height"}
    }
    joint, active = local_name(container.joint), local_name(container.active_joint)
    return row | {
        "unit": unit_of(twin, container),
        "joint": joint,
        "active_joint": active,
        "handle": local_name(container.handle),
        "handle_height": round(_height(twin, local_name(container.handle)), 4),
        "iri": container.iri,
    }


def _height(twin: Twin, handle: str) -> float:
    """[m] Of the middle of a handle's shapes, of its origin where it has none, in the root frame."""
    kitchen = twin.mechanism(twin.environment)
    world_T_handle = world_T_of(kitchen, handle, twin.state)
    points = corners(next(body.collision for body in kitchen.bodies if body.name == handle))
    if not len(points):
        return float(world_T_handle[2, 3])
    heights = points @ world_T_handle[2, :3] + world_T_handle[2, 3]
    return float((heights.min() + heights.max()) / 2)


@click.command()
@kitchen_argument
@click.option("--robot", "robots", multiple=True, type=ROBOT, help=ROBOT_HELP + " Repeatable.")
@annotation_option
@click.option(
    "-o",
    "--output",
    type=OutFile(*GRAPH_FORMATS),
    required=True,
    metavar="FILE.ttl|.trig|.nq",
    help="Where to; the suffix says the format. .trig and .nq are taken wherever a kitchen is.",
)
@click.option(
    "--portable",
    is_flag=True,
    help="For another machine: meshes are named package://NAME/…, not by folders of this one. Send their"
    " files along; there they are looked for beside FILE and in the folder that SDT_MODELS names.",
)
def graph(
    kitchen: str, robots: tuple[str, ...], annotation: str | None, output: Path, portable: bool
) -> None:
    """Write the twin of KITCHEN (and robots) as RDF."""
    twin = load_twin(kitchen, robots, annotation=annotation)
    form = GRAPH_FORMATS[output.suffix]
    folders = [Path(each).parent for each in (kitchen, *robots) if Path(each).is_file()]
    write_file(output, twin.portable(form, *folders) if portable else twin.serialize(form))
    click.echo(f"{output}: {twin.triple_count()} triples")


@click.command()
@kitchen_argument
@click.option("--robot", type=ROBOT, help=ROBOT_HELP)
@annotation_option
@tee_option
@forces_option
@handle_force_option
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "turtle"]),
    default="text",
    show_default=True,
    help="A table, or the SHACL report itself.",
)
@click.option(
    "--explain",
    "explained",
    is_flag=True,
    help="Every class: who is in which, what would bring the others in, where intervals end. Exit 0 if every "
    "container is in some class.",
)
@csv_flag
@json_flag
def scope(
    *,
    kitchen: str,
    robot: str | None,
    annotation: str | None,
    tee: str,
    forces: Path | None,
    handle_force: float | None,
    form: str,
    explained: bool,
    as_json: bool,
) -> None:
    """SHACL report: does KITCHEN (with a robot) lie inside the class? Exit 0 in scope, 3 not."""
    if explained:
        raise SystemExit(explain(kitchen, robot, annotation, (forces, handle_force), as_json=as_json))
    service = in_class(
        load(kitchen, [robot] if robot else [], annotation=annotation), tee, forces, handle_force
    )
    twin, asked = service.twin, tee_class_of(service.physics)
    note_lengths(twin)
    rows: list[dict[str, object]] = []
    for container in counted(twin):
        for each in violations(twin, container, twin.robots[0] if robot else None, tee=asked):
            row = {"focus": local_name(each.focus), "path": local_name(each.path or ""), "value": each.value}
            rows.append({"container": container.name, **row, "bound": each.bound, "message": each.message})
    if as_json:
        print_json({"class": asked.iri, "in_scope": not rows, "violations": rows})
    elif form == "turtle":
        click.echo(report_turtle(twin, twin.robots[0] if robot else None, asked))
    elif rows or csv_is_asked():
        print_rows(rows, ("container", "focus", "path", "value", "bound", "message"))
    else:
        of = so_many(len(twin.containers()), "container", "containers")
        click.echo(f"in scope of {asked.name}: {of}" + (f", robot {robot}" if robot else ""))
    if rows:
        raise SystemExit(Exit.ABSTAINED)
