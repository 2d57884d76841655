"""`sdt query`: a twin or saved verdicts, asked in SPARQL."""

from pathlib import Path
from typing import Any

import click

from sdt_kg.errors import InputError
from services.app import load
from services.commands.graphs.computing import Asked, compute_options, print_computed, refuse_without_compute
from services.commands.options import csv_flag, json_flag
from services.commands.show import print_rows
from services.store.files import is_saved_graph, query_saved


@click.command()
@click.argument("source", metavar="KITCHEN|STORE")
@click.argument("sparql", required=False)
@click.option(
    "-f",
    "--file",
    "query_file",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE.rq",
)
@click.option(
    "--format", "form", type=click.Choice(["table", "csv", "json"]), default="table", show_default=True
)
@compute_options
@csv_flag
@json_flag
def query(
    *,
    source: str,
    sparql: str | None,
    query_file: Path | None,
    form: str,
    as_json: bool,
    computes: bool,
    **options: Any,  # noqa: ANN401 - those of --compute, as click gives them
) -> None:
    """Ask the twin of a KITCHEN, or saved verdicts, in SPARQL; the usual prefixes are known.

    STORE is a .trig, .nq or .ttl file, a store directory, or the address of a SPARQL server. With --compute
    the cases that the query can touch and that STORE does not hold yet are run first, and kept there.
    """
    if (sparql is None) == (query_file is None):
        raise InputError("there is no query, or there are two", allowed="'SPARQL' or -f FILE.rq")
    text = query_file.read_text() if query_file else str(sparql)
    if computes:
        print_computed(source, text, Asked(**options), "json" if as_json else form)
        return
    refuse_without_compute(Asked(**options))
    columns, rows = query_saved(source, text) if is_saved_graph(source) else load(source).query(text)
    print_rows(rows, columns, "json" if as_json else form)
