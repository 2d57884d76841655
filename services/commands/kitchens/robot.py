"""`sdt robot describe`: a first annotation for a robot of one's own."""

from pathlib import Path

import click

from sdt_kg.errors import InputError
from sdt_kg.urdf import model_stem
from services.commands.options import OutFile
from services.store.output import check_file, write_file


@click.group()
def robot() -> None:
    """Bring your own robot."""


@robot.command(short_help="Write a first annotation of a URDF.")
@click.argument("urdf", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option(
    "-o",
    "--output",
    type=OutFile(".ttl"),
    metavar="FILE.ttl",
    help="Default: NAME.ttl beside the URDF.",
)
@click.option("--force", is_flag=True, help="Overwrite the file if it is there.")
def describe(urdf: Path, output: Path | None, force: bool) -> None:
    """Write a first annotation of URDF and say what was guessed: drive, grippers, parked arms, pairs.

    It is written beside the URDF, as NAME.ttl, where every command looks for it; -o writes it elsewhere, for
    --annotation. A file that is there is kept unless --force is given; of a kitchen nothing is written.
    """
    from services.describing.describe import describe as described  # noqa: PLC0415 - the only physics here

    path = output or urdf.with_name(f"{model_stem(urdf)}.ttl")
    if path.exists() and not force:
        raise InputError(
            f"{path} exists", allowed="a file which is not there yet", remedy="--force overwrites it"
        )
    check_file(path)
    found = described(urdf)
    write_file(path, found.text)
    for note in found.notes:
        click.echo(note)
    click.echo(f"{path}: check every line that says 'check'")
