"""`sdt open`: what a store of verdicts holds, and how to go on from there."""

import shlex
from collections import Counter
from collections.abc import Iterator, Sequence

import click

from predicates.case import ArtefactKind
from predicates.record.stored import StoredVerdict
from sdt_kg.errors import InputError
from sdt_kg.iri import local_name
from sdt_kg.numbers import so_many
from services.commands.options import csv_flag, json_flag
from services.commands.saved.mixed import mixed
from services.commands.saved.why import without_twins
from services.commands.show import csv_is_asked, print_json, print_rows
from services.store.files import is_saved_graph
from services.store.records import all_recalled
from services.versions import outdated
from services.why import results_of

COLUMNS = (
    "kitchen",
    "robot",
    "task",
    "certified",
    "not_certified",
    "abstained",
    "outdated",
    "certificates",
    "proofs",
)
QUERY = "SELECT ?container {{ ?v law:outcome law:{} ; law:container ?container }}"

Row = dict[str, object]


@click.command(name="open")
@click.argument("store", metavar="FILE|STORE")
@click.option(
    "--pages", is_flag=True, help="Go on in the browser: sdt serve --store STORE, until interrupted."
)
@csv_flag
@json_flag
@click.pass_context
def open_command(context: click.Context, *, store: str, pages: bool, as_json: bool) -> None:
    """Open saved verdicts: what is there, by kitchen, robot and task, and how to go on.

    STORE is a .trig or .nq file, a store directory, or the address of a SPARQL server, as --save takes it.
    A verdict that another version of sdt judged counts as outdated, whatever it was.
    What is asked again with the same options and --save STORE is answered from there; only what is missing
    is judged.
    """
    if not is_saved_graph(store):
        raise InputError(
            f"'{store}' is no file or store of verdicts",
            allowed="FILE.trig, FILE.nq, a store directory or the address of a server",
            remedy="sdt achieve … --save FILE keeps a verdict",
        )
    saved = without_twins(store)
    verdicts, damaged = all_recalled(saved)
    results = sum(each not in damaged for each in results_of(saved))
    rows, notes = _rows(verdicts), [*_of_then(shlex.quote(store), verdicts), *mixed(verdicts)]
    following = _following(store, rows)
    if as_json:
        found = {"store": store, "verdicts": len(verdicts), "task_results": results, "cases": rows}
        print_json(found | {"mixed": notes, "next": following, "damaged": damaged})
    else:
        print_rows(rows, COLUMNS)
        for line in notes:
            click.echo(f"note: {line}", err=True)
        for why in damaged.values():
            click.echo(
                f"note: not counted: {why}; asked again with --save {store}, it is judged anew", err=True
            )
        if not csv_is_asked():
            _say(verdicts, results, following)
    if pages:
        root = context.find_root().command
        assert isinstance(root, click.Group)
        context.invoke(root.commands["serve"], store=store)


def _rows(verdicts: Sequence[StoredVerdict]) -> list[Row]:
    """A row for each kitchen, robot and verb, sorted."""
    counts: dict[tuple[str, str, str], Counter[str]] = {}
    for each in verdicts:
        verb = "" if each.verb is None else each.verb.value
        case = (local_name(each.environment), local_name(each.robot or ""), verb)
        counts.setdefault(case, Counter()).update(_marks(each))
    names = COLUMNS[3:]
    return [
        dict(zip(COLUMNS, (*case, *(count[name] for name in names)), strict=True))
        for case, count in sorted(counts.items())
    ]


def _of_then(store: str, verdicts: Sequence[StoredVerdict]) -> Iterator[str]:
    """Which verdicts another version judged, and what to do."""
    found = Counter(told for each in verdicts if (told := ", ".join(outdated(dict(each.inputs)))))
    for others, count in found.most_common():
        yield (
            f"{count} outdated, judged by {others}: not the answer to what is asked now; asked again with "
            f"--save {store}, judged anew; sdt recheck tells which certificates and proofs hold"
        )


def _marks(verdict: StoredVerdict) -> list[str]:
    """What a verdict counts as."""
    is_outdated, artefact = bool(outdated(dict(verdict.inputs))), verdict.artefact
    shown = ["outdated" if is_outdated else verdict.outcome.value]
    if artefact is not None and artefact.kind is ArtefactKind.CERTIFICATE:
        shown.append("certificates")
    elif artefact is not None and any(each.proof for each in verdict.diagnoses):
        shown.append("proofs")  # not those of some holds alone: they deny nothing
    return shown


def _following(store: str, rows: Sequence[Row]) -> list[str]:
    """Commands with which to go on, as they are typed."""
    if not rows:
        return []
    place, last = shlex.quote(store), rows[-1]
    kitchens, robots = (
        shlex.quote(",".join(dict.fromkeys(str(row[name]) for row in rows))) for name in COLUMNS[:2]
    )
    of = {str(row["task"]) for row in rows} - {""}
    tables = [
        f"sdt table --kitchens {kitchens} --robots {robots} --task {verb} --save {place}"
        for verb in sorted(of)
    ]
    return [
        f"sdt why {place}",
        f"sdt recheck {place}",
        f"sdt query {place} '{QUERY.format(_class(last))}'",
        *(tables if robots and kitchens else []),
        f"sdt serve --store {place}",
    ]


def _class(row: Row) -> str:
    return "NotCertified" if row["not_certified"] else "Certified"


def _say(verdicts: Sequence[StoredVerdict], results: int, following: Sequence[str]) -> None:
    tasks = f", and {so_many(results, 'result', 'results')} of tasks" if results else ""
    click.echo(f"\n{so_many(len(verdicts), 'verdict', 'verdicts')}{tasks}")
    if not verdicts:
        click.echo("none: sdt achieve … --save keeps one there")
        return
    click.echo("go on with (models by the names that they were loaded with):")
    for line in following:
        click.echo(f"  {line}")
