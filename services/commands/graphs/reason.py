"""`sdt reason`: is a twin or saved graph consistent, and what follows from it?"""

from collections import Counter
from pathlib import Path

import click

from sdt_kg.iri import local_name
from services.commands.completion.types import ROBOT
from services.commands.exits import Exit
from services.commands.graphs.saved_graphs import checked_format, graph_of, write_graph
from services.commands.options import ROBOT_HELP, OutFile, annotation_option, csv_flag, json_flag
from services.commands.show import csv_is_asked, print_json, print_rows
from services.store.reason import Engine, Reasoned, default_engine, reasoned


@click.command()
@click.argument("source", metavar="KITCHEN|STORE")
@click.option("--robot", "robots", multiple=True, type=ROBOT, help=ROBOT_HELP + " Repeatable.")
@annotation_option
@click.option(
    "--engine",
    type=click.Choice([each.value for each in Engine]),
    help="hermit (OWL 2 DL, needs Java) or owlrl (OWL 2 RL, no Java); by default hermit where Java is.",
)
@click.option(
    "-o",
    "--output",
    type=OutFile(),
    metavar="FILE.trig|.nq",
    help="Write the graph with the inferred types in a named graph of their own.",
)
@csv_flag
@json_flag
def reason(
    *,
    source: str,
    robots: tuple[str, ...],
    annotation: str | None,
    engine: str | None,
    output: Path | None,
    as_json: bool,
) -> None:
    """Check a twin or saved graph against the ontology, and infer types.

    Exit 0: consistent (hermit), or no contradiction found (owlrl); 1: inconsistent.
    """
    if output is not None:
        checked_format(output)
    graph = graph_of(source, robots, annotation)
    found = reasoned(graph, default_engine() if engine is None else Engine(engine))
    if as_json:
        print_json(_row(found))
    elif csv_is_asked():
        print_rows([{"individual": a, "type": b} for a, b in found.types], ("individual", "type"))
    else:
        _say(found)
    if not found.consistent:
        raise SystemExit(Exit.NO)
    if output is not None:
        graph.extend(found.quads())
        write_graph(output, graph)
        click.echo(f"{output}: {len(graph)} quads, inferred types in <{found.graph}>", err=True)


def _row(found: Reasoned) -> dict[str, object]:
    types = [{"individual": individual, "type": kind} for individual, kind in found.types]
    return {
        "engine": found.engine.value,
        "consistent": found.consistent,
        "clashes": list(found.clashes),
        "types": types,
    }


def _say(found: Reasoned) -> None:
    if not found.consistent:
        click.echo(f"inconsistent, says {found.engine.value}")
        for clash in found.clashes or ("which triples contradict each other, it does not tell",):
            click.echo(f"  {clash}")
        return
    complete = "consistent" if found.engine is Engine.HERMIT else "no contradiction found"
    click.echo(f"{complete}, says {found.engine.value}; {len(found.types)} types inferred")
    for kind, count in sorted(Counter(local_name(kind) for _, kind in found.types).items()):
        click.echo(f"  {kind}: {count}")
