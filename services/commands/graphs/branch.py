"""`sdt branch`, `sdt diff`, `sdt patch`: what was changed, and how two twins differ."""

import shlex
from collections.abc import Sequence
from pathlib import Path

import click
import pyoxigraph as ox

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError
from sdt_kg.history import Branch, History
from sdt_kg.history.diff import difference, quads_of_twin
from sdt_kg.history.patch import patch_of, read_patch
from sdt_kg.history.records import record_graph
from sdt_kg.iri import local_name
from services.commands.completion.types import ROBOT
from services.commands.graphs.saved_graphs import checked_format, graph_of, write_graph
from services.commands.options import (
    ROBOT_HELP,
    OutFile,
    annotation_option,
    csv_flag,
    json_flag,
    kitchen_argument,
)
from services.commands.show import csv_is_asked, print_json, print_rows
from services.edits import parse_edit, twin_of
from services.kinds_of_edit import EDITS
from services.store.files import is_saved_graph
from services.store.histories import check_before, keep_history, kept_history
from services.store.output import write_file

SHORT_KEY = 12
"""[characters] Of a hash, as it is shown."""

robots_option = click.option("--robot", "robots", multiple=True, type=ROBOT, help=ROBOT_HELP + " Repeatable.")


@click.command(epilog="EDIT is " + "; ".join(EDITS.values()) + ".")
@kitchen_argument
@click.argument("edits", nargs=-1, metavar="EDIT...")
@robots_option
@annotation_option
@click.option(
    "--from",
    "parent",
    metavar="BRANCH",
    help="Of a kept history, the branch to start from: its key, or how it begins.",
)
@click.option("-o", "--output", type=OutFile(), metavar="FILE.trig|.nq", help="Write the last twin.")
@click.option(
    "--history", "place", metavar="STORE", help="Keep all branches: FILE.trig, FILE.nq or a directory."
)
@csv_flag
@json_flag
def branch(
    *,
    kitchen: str,
    edits: tuple[str, ...],
    robots: tuple[str, ...],
    annotation: str | None,
    parent: str | None,
    output: Path | None,
    place: str | None,
    as_json: bool,
) -> None:
    """Branch KITCHEN (a name, a model, or a saved graph) by each EDIT in turn, and say what happened.

    STORE keeps every branch. It is a KITCHEN again, whose branches go on from the latest, or from another one
    (--from), and whose past can be asked about. FILE gets the last twin alone, and what is recorded of the
    branches. The samples of each trajectory are kept beside either as NAME.HASH.npz.
    """
    if output is not None:
        checked_format(output)
    if place is not None:
        check_before(place)
    history, last = _begun(kitchen, robots, annotation, parent)
    for text in edits:
        history, last = history.derived(last, parse_edit(last.twin, text))
    past = list(last.past())[::-1]
    rows = [_row(each) for each in past]
    if as_json:
        print_json(rows)
    else:
        for row in rows:
            row["events"] = "; ".join(str(each["text"]) for each in _events(row))
        print_rows(rows, ("branch", "edit", "content_hash", "events"))
    if output is not None:
        _save(history, past, output)
    if place is not None or output is None:
        _keep(history, place, kitchen if edits else "")


def _keep(history: History, place: str | None, begun: str) -> None:
    """All branches are in the place; without one, that what went on from a kept history is lost is said."""
    if place is not None:
        beside = keep_history(history, place)
        click.echo(f"{place}: {len(history.branches)} branches, {len(beside)} files of samples", err=True)
    elif is_saved_graph(begun):
        click.echo(f"note: nothing is kept; --history {shlex.quote(begun)} keeps it there", err=True)


def _begun(
    kitchen: str, robots: tuple[str, ...], annotation: str | None, parent: str | None
) -> tuple[History, Branch]:
    """The history to go on with, and the branch from which it does."""
    history = kept_history(kitchen) if is_saved_graph(kitchen) else None
    if history is None:
        history = History.of(twin_of(kitchen, robots, annotation))
    if parent is None:
        return history, history.latest
    found = [each for each in history.branches.values() if local_name(each.iri).startswith(parent)]
    if len(found) != 1:
        known = ", ".join(local_name(iri)[:SHORT_KEY] for iri in history.branches)
        raise InputError(f"{len(found)} branches begin with '{parent}'", allowed=known)
    return history, found[0]


def _events(row: dict[str, object]) -> Sequence[dict[str, object]]:
    events = row["events"]
    return events if isinstance(events, list) else []


def _row(each: Branch) -> dict[str, object]:
    events = [
        {
            "type": event.type.value,
            "about": local_name(event.about),
            "time": event.time,
            "sample": event.sample,
            "text": f"{local_name(event.about)} {event.type.value}"
            + ("" if event.time is None else f" at {event.time:.3f} s"),
        }
        for event in each.events
    ]
    return {
        "branch": local_name(each.iri)[:SHORT_KEY],
        "iri": each.iri,
        "edit": "the first branch" if each.edit is None else each.edit.sentence,
        "content_hash": each.content_hash[:SHORT_KEY],
        "events": events,
    }


def _save(history: History, past: Sequence[Branch], output: Path) -> None:
    store = ox.Store()
    store.extend(quads_of_twin(past[-1].twin))
    store.extend(history.store.dump([record_graph(each.iri) for each in past]))
    write_graph(output, store)
    click.echo(f"{output}: {len(store)} quads", err=True)
    for each in past:
        if each.trajectory is not None:
            beside = output.with_name(f"{output.stem}.{local_name(each.trajectory.iri)[:SHORT_KEY]}.npz")
            write_file(beside, each.trajectory.to_bytes())
            click.echo(f"{beside}: {len(each.trajectory.times)} samples", err=True)


@click.command()
@click.argument("before", metavar="A")
@click.argument("after", metavar="B")
@robots_option
@annotation_option
@click.option(
    "--patch",
    "patch_file",
    type=OutFile(),
    metavar="FILE",
    help="Write it as RDF Patch too.",
)
@csv_flag
@json_flag
def diff(
    *,
    before: str,
    after: str,
    robots: tuple[str, ...],
    annotation: str | None,
    patch_file: Path | None,
    as_json: bool,
) -> None:
    """How B differs from A, in sentences; each is a saved graph, a kitchen, or KITCHEN@JOINT=VALUE."""
    first, second = (list(graph_of(source, robots, annotation)) for source in (before, after))
    found = difference(first, second)
    sentences = found.sentences()
    if as_json:
        counts = {"removed": len(found.removed), "added": len(found.added)}
        print_json({**counts, "sentences": sentences})
    elif csv_is_asked():
        print_rows([{"sentence": each} for each in sentences], ("sentence",))
    else:
        click.echo("\n".join(sentences) if sentences else "nothing differs")
        click.echo(f"{len(found.removed)} triples removed, {len(found.added)} added", err=True)
    if patch_file is not None:
        write_file(patch_file, patch_of(found, first, second).to_text())
        click.echo(f"{patch_file}: {len(found.removed) + len(found.added)} changes", err=True)


@click.command()
@click.argument("patch_file", type=click.Path(exists=True, dir_okay=False, path_type=Path), metavar="PATCH")
@click.argument("source", metavar="A")
@click.option(
    "-o", "--output", type=OutFile(), required=True, metavar="FILE.trig|.nq", help="Where what is made goes."
)
@click.option("--reverse", is_flag=True, help="Undo it: A is what it makes.")
def patch(patch_file: Path, source: str, output: Path, reverse: bool) -> None:
    """Apply an RDF Patch that sdt diff wrote to A, a saved graph or kitchen, and write what that makes."""
    checked_format(output)
    check_ends(patch_file)
    try:
        made = read_patch(patch_file.read_text(encoding="utf-8-sig"))
    except UnicodeDecodeError as error:
        raise InputError(f"{patch_file} is not text: {error}", allowed="RDF Patch in UTF-8") from None
    store = ox.Store()
    store.extend((made.reverse() if reverse else made).applied(graph_of(source)))
    write_graph(output, store)
    click.echo(f"{output}: {len(store)} quads")
