"""`sdt query`: a twin or saved verdicts, asked in SPARQL."""

from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

import click
import pyoxigraph as ox

from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.iri import LAW, PREFIXES
from sdt_kg.load import bundled_names
from sdt_kg.store import Row, checked_query, rows_of
from services.app import load
from services.commands.graphs.bounding import bound_options, bounded
from services.commands.graphs.bundled import QueryFile, print_bundled
from services.commands.graphs.computing import Asked, compute_options, print_computed, refuse_without_compute
from services.commands.options import csv_flag, json_flag, query_text
from services.commands.saved.mixed import mixed_models
from services.commands.show import print_rows
from services.ontology_page.spelling import matching_nothing
from services.store.files import is_saved_graph, readable
from services.store.known import restricted
from services.store.workers import Begin


@click.command()
@click.argument("source", metavar="KITCHEN|STORE", required=False)
@click.argument("sparql", required=False)
@click.option(
    "-f",
    "--file",
    "query_file",
    type=QueryFile(),
    metavar="FILE.rq|NAME",
    help="The query, in place of SPARQL; by NAME, or how only it begins (cq01), one that --list names.",
)
@click.option("--list", "lists", is_flag=True, help="Queries that come with sdt, and nothing else.")
@click.option(
    "--known",
    multiple=True,
    metavar="NAME=VALUE",
    help="Ask about this only: ?NAME is id:VALUE, PREFIX:VALUE or <IRI>. Repeatable.",
)
@compute_options
@bound_options
@csv_flag
@json_flag
def query(
    *,
    source: str | None,
    sparql: str | None,
    query_file: Path | None,
    lists: bool,
    known: tuple[str, ...],
    as_json: bool,
    computes: bool,
    timeout: float,
    memory: float,
    **options: Any,  # noqa: ANN401 - those of --compute, as click gives them
) -> None:
    """Ask the twin of a KITCHEN, or saved verdicts, in SPARQL; the usual prefixes are known.

    STORE is a .trig, .nq or .ttl file, a store directory, or the address of a SPARQL server. With --compute
    the cases that the query can touch and that STORE does not hold yet are run first, and kept there.
    A query that takes longer, or more memory, than it may is an error, never a cut answer.
    """
    if lists:
        print_bundled(as_json=as_json)
        return
    if source is None or (sparql is None) == (query_file is None):
        raise InputError(
            "there is no query, or there are two" if source else "there is nothing to ask",
            allowed="KITCHEN or STORE, and 'SPARQL' or -f FILE.rq",
            remedy="sdt query --list has ready queries",
        )
    text = restricted(query_text(query_file) if query_file else str(sparql), dict(map(_known, known)))
    if computes:
        with bounded(timeout, memory) as ask:
            print_computed(source, text, Asked(**options), ask, as_json=as_json)
        return
    refuse_without_compute(Asked(**options))
    with bounded(timeout, memory) as ask:
        (columns, rows), notes = ask(partial(_saved if is_saved_graph(source) else _of_twin, source, text))
    print_rows(rows, columns, as_json=as_json)
    for note in notes:
        click.echo(f"note: {note}", err=True)


Told = tuple[tuple[list[str], list[Row]], list[str]]
"""Columns and rows, and notes on them."""


def _of_twin(source: str, sparql: str, begin: Begin) -> Told:
    try:
        kitchen = load(source)
    except UnknownEntityError as error:
        remedy = f"{error.remedy}, or a store that is there (a directory, .trig, .nq)"
        raise UnknownEntityError("kitchen or store", source, bundled_names("kitchen"), remedy) from None
    kitchen.query("ASK {}")  # the twin is in the store
    begin()
    found = kitchen.query(sparql)
    return found, list(matching_nothing(sparql, lambda ask: kitchen.query(ask)[1][0]["answer"]))


def _saved(place: str, sparql: str, begin: Begin) -> Told:
    """Also what of the verdicts that a query counts together is about different models."""
    text = checked_query(sparql)
    with closing(readable(place)) as store:
        begin()
        rows = rows_of(store.query(text))
        notes = matching_nothing(sparql, lambda ask: bool(store.query(checked_query(ask))))
        about_verdicts = "law:" in text or LAW in text
        return rows, [*notes, *(mixed_models(store) if about_verdicts else ())]


def _known(text: str) -> tuple[str, ox.NamedNode]:
    """`environment=b`, `container=<https://…>` or `outcome=law:Certified` as a variable and an IRI."""
    name, equals, value = text.partition("=")
    prefix, colon, local = value.partition(":")
    if value.startswith("<") and value.endswith(">"):
        iri = value[1:-1]
    else:
        iri = PREFIXES.get(prefix, "") + local if colon else PREFIXES["id"] + value
    try:
        if name and equals and value:
            return name.removeprefix("?"), ox.NamedNode(iri)
    except ValueError:
        pass
    raise InputError(f"'{text}' is nothing known", allowed="NAME=VALUE, NAME=PREFIX:VALUE or NAME=<IRI>")
