"""`sdt doctor`: is everything there, and what to do where it is not."""

import os
from collections.abc import Iterator
from pathlib import Path

import click

from services.commands.exits import Exit
from services.commands.options import KITCHEN_HELP, ROBOT_HELP, csv_flag, json_flag
from services.commands.show import csv_is_asked, print_json, print_rows
from services.commands.terminal import console
from services.configuration.read import Settings
from services.doctor.finding import Finding, Standing, well
from services.doctor.machine import machine
from services.doctor.packages import packages
from services.doctor.places import bus, models, stores

COLUMNS = ("about", "standing", "says", "remedy", "notes")


@click.command()
@click.option("--kitchen", "kitchens", multiple=True, help=KITCHEN_HELP + " Repeatable.")
@click.option("--robot", "robots", multiple=True, help=ROBOT_HELP + " Repeatable.")
@click.option(
    "--store",
    "places",
    multiple=True,
    metavar="STORE",
    help="Can it be read? FILE.trig, FILE.nq, a directory, or the address of a server. Repeatable.",
)
@click.option("--connect", metavar="PROTOCOL/HOST:PORT", help="Who answers on the bus there?")
@click.option(
    "--bus-config",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE.json5",
    help="Zenoh configuration with TLS, user or access control.",
)
@csv_flag
@json_flag
@click.pass_context
def doctor(
    context: click.Context,
    *,
    kitchens: tuple[str, ...],
    robots: tuple[str, ...],
    places: tuple[str, ...],
    connect: str | None,
    bus_config: Path | None,
    as_json: bool,
) -> None:
    """Look whether all is well here: packages, extras, Java, models, settings, stores, bus, memory, disk.

    The kitchen, robot, store and bus of the settings are looked at, too. Exit 0 if all is well, extras
    that are not there included; 1 if something is to be done.
    """
    said = context.find_object(Settings) or Settings(environment=os.environ)

    def found() -> Iterator[Finding]:
        yield _settings(said)
        yield from packages()
        yield from machine()
        yield from models(kitchens, robots)
        yield from stores(places)
        if connect is not None:
            yield from bus(connect, bus_config, kitchens or ("a", "b"))

    findings = list(found())
    to_do = [each for each in findings if each.standing is Standing.TO_DO]
    rows = [
        {"about": each.about, "standing": each.standing.value, "says": each.says, "remedy": each.remedy}
        | {"notes": list(each.notes)}
        for each in findings
    ]
    if as_json:
        print_json({"well": not to_do, "findings": rows})
    elif csv_is_asked():
        joined = ["; ".join(each.notes) for each in findings]
        print_rows([row | {"notes": notes} for row, notes in zip(rows, joined, strict=True)], COLUMNS)
    else:
        _print(findings)
    raise SystemExit(Exit.NO if to_do else Exit.DONE)


def _settings(said: Settings) -> Finding:
    variables = sorted(name for name in said.environment if name.startswith("SDT_"))
    by = [str(said.path)] if said.path else []
    return well("settings", ", ".join([*by, *variables]) or "none (sdt config init writes a file)")


def _print(findings: list[Finding]) -> None:
    marks = {Standing.WELL: "  ", Standing.OPTIONAL: "- ", Standing.TO_DO: "! "}
    width = max(len(each.about) for each in findings)
    out = console()
    for each in findings:
        out.print(f"{marks[each.standing]}{each.about:<{width}}  {each.says}", highlight=False, markup=False)
        if each.remedy:
            out.print(f"  {'':<{width}}  → {each.remedy}", highlight=False, markup=False)
        for note in each.notes:
            out.print(f"  {'':<{width}}  note: {note}", highlight=False, markup=False)
    to_do = sum(each.standing is Standing.TO_DO for each in findings)
    missing = sum(each.standing is Standing.OPTIONAL for each in findings)
    click.echo(
        f"\n{f'! {to_do} to do' if to_do else 'all is well'}"
        + (f"; - {missing} that some commands can use, and others do without" if missing else "")
    )
