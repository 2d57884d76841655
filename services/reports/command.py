"""`sdt report`: a notebook run and written as one HTML file."""

import importlib.util
from pathlib import Path

import click

from sdt_kg.errors import InputError
from services.commands.options import OutFolder, json_flag
from services.commands.show import print_json, print_rows

NEEDED = ("jupytext", "papermill", "nbconvert", "ipykernel", "matplotlib")
"""Packages of the extra `notebook`."""

STORE = "store"
"""Parameter that --store fills."""


@click.command()
@click.argument("name", required=False)
@click.option(
    "-p", "--parameter", "parameters", multiple=True, metavar="NAME=VALUE", help="Repeatable; see --list."
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="FILE.html, or FILE.ipynb; NAME.html if not said.",
)
@click.option(
    "--store",
    metavar="STORE",
    help="Read verdicts from there, and keep there what is judged; as --save of sdt table.",
)
@click.option(
    "--assets",
    type=OutFolder(),
    metavar="DIR",
    help="Also write figures as SVG and PDF, tables as CSV and LaTeX.",
)
@click.option("--list", "listed", is_flag=True, help="Which reports there are, and their parameters.")
@json_flag
def report(
    *,
    name: str | None,
    parameters: tuple[str, ...],
    output: Path | None,
    store: str | None,
    assets: Path | None,
    listed: bool,
    as_json: bool,
) -> None:
    """Write the report NAME: figures, tables and a 3D scene with playback in one HTML file.

    The file opens without a network. Exit 0 written, 2 bad input, 4 an oracle or a store is unavailable.
    """
    _check_installed()
    from services.reports.run.catalogue import notebook  # noqa: PLC0415 - an extra

    if listed:
        _list(as_json=as_json)
        return
    if name is None:
        raise InputError("no report is named", remedy="sdt report --list names all")
    if store == "":
        raise InputError("'' is no place for verdicts", remedy="leave --store out to keep none")
    chosen = notebook(name)
    given = [*parameters, *([f"{STORE}={store}"] if store is not None else [])]
    values = chosen.values(given)
    from services.reports.run.export import checked, write, write_assets  # noqa: PLC0415 - an extra

    path = checked(output or Path(f"{name}.html"))
    from services.reports.run.build import executed  # noqa: PLC0415 - an extra, and slow to import

    node = executed(chosen, values)
    write(path, chosen, node, values)
    written = [path, *(write_assets(assets, node) if assets else [])]
    if as_json:
        print_json([str(each) for each in written])
    else:
        click.echo("\n".join(f"{each}  {_size(each)}" for each in written))


def _size(file: Path) -> str:
    """Of a file, for people."""
    size = file.stat().st_size
    return f"{size / 1e6:.2f} MB" if size >= 100_000 else f"{size / 1e3:.1f} kB"


def _list(*, as_json: bool) -> None:
    from services.reports.run.catalogue import notebooks  # noqa: PLC0415 - an extra

    rows = [
        {
            "report": each.name,
            "question": each.question,
            "parameter": one.name,
            "default": one.default,
            "meaning": one.meaning,
        }
        for each in notebooks()
        for one in each.parameters
    ]
    if as_json:
        print_rows(rows, tuple(rows[0]), as_json=True)
        return
    for each in notebooks():
        click.echo(f"{each.name}: {each.question}")
        for one in each.parameters:
            click.echo(f"  {one.name}={one.default}".ljust(48) + f"  {one.meaning}")


def _check_installed() -> None:
    missing = [each for each in NEEDED if importlib.util.find_spec(each) is None]
    if missing:
        raise InputError(
            f"reports need {', '.join(missing)}, not installed here", remedy="pip install 'sdt-kg[notebook]'"
        )
