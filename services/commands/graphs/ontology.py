"""`sdt ontology`: the ontology as one page."""

from pathlib import Path

import click

from services.commands.options import OutFile
from services.ontology_page.page import page
from services.store.output import write_file


@click.command(name="ontology")
@click.option(
    "-o",
    "--output",
    type=OutFile(),
    metavar="FILE.html",
    help="Else printed.",
)
def ontology_command(output: Path | None) -> None:
    """Document the ontology as one HTML page: terms, shapes, rules, questions, checks, alignments.

    It needs no network, neither to be made nor to be read.
    """
    text = page()
    if output is None:
        click.echo(text)
        return
    write_file(output, text)
    click.echo(f"{output}: {len(text.encode()) // 1024} KiB")
