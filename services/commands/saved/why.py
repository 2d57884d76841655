"""`sdt why`: a stored verdict in plain words."""

import shlex
from collections.abc import Sequence

import click
import pyoxigraph as ox

from predicates.record import StoredVerdict
from predicates.record.facts import Facts
from predicates.record.seal import RECORD_HASH
from predicates.record.stored import read_inputs
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, Iri, local_name
from sdt_kg.store import rows_of
from services.commands.options import csv_flag, json_flag
from services.commands.saved.mixed import mixed
from services.commands.show import csv_is_asked, print_json, print_rows
from services.store.files import is_saved_graph, readable
from services.store.records import all_recalled
from services.store.server.remote import is_url
from services.why import SHORT_KEY, options, outcome, question, results_of, sections, task, verdicts_of, why
from services.why.words import STORE, moved, standing


@click.command(name="why")
@click.argument("verdict", metavar="IRI|FILE|STORE")
@click.option("--store", metavar="FILE|STORE", help="Where the verdict of that IRI is saved.")
@csv_flag
@json_flag
def why_command(verdict: str, store: str | None, as_json: bool) -> None:
    """Tell a stored verdict in plain words: what was asked, each answer, the reasons, how to check again.

    IRI may be the beginning of the verdict's hash, or that of the result of a task specification. A FILE
    (.trig, .nq) or STORE with one verdict tells it; with several it lists them.
    """
    source, iri = (verdict, None) if store is None else (store, verdict)
    if not is_saved_graph(source):
        raise InputError(
            f"'{source}' is no file or store of verdicts",
            allowed="FILE.trig, FILE.nq or a store directory, as --save writes them",
            remedy="for one verdict of a store: sdt why IRI --store STORE",
        )
    saved = without_twins(source)
    known = [*verdicts_of(saved), *results_of(saved)]
    if iri is None and len(known) != 1:
        _list(saved, as_json)
        return
    iri = known[0] if iri is None else iri
    place = STORE if is_url(source) else shlex.quote(source)  # an address may have a password in it
    if csv_is_asked():
        rows = [
            {"section": each.title, "line": line}
            for each in sections(saved, iri, place)
            for line in each.lines
        ]
        print_rows(rows, ("section", "line"))
    elif as_json:
        print_json([{"title": each.title, "lines": list(each.lines)} for each in sections(saved, iri, place)])
    else:
        click.echo(why(saved, iri, place))


def _list(saved: ox.Store, as_json: bool) -> None:
    """Every result of a task specification and every verdict of the store, a row each."""
    verdicts, damaged = all_recalled(saved)
    facts = Facts(saved)
    rows = [
        {
            "verdict": each,
            "question": task.question(each, facts),
            "outcome": standing(task.outcome_of(each, facts), read_inputs(facts, each)),
        }
        for each in results_of(saved)
        if each not in damaged
    ]
    apart = _apart(verdicts, facts)
    rows += [
        {
            "verdict": each.iri,
            "question": question(each),
            "drive": facts.text(each.iri, LAW + "drive") or "",
            "state": ", ".join(moved(each.iri, facts)),
            "options": apart[each.iri],
            "outcome": outcome(each),
        }
        for each in verdicts
    ]
    rows += [{"verdict": iri, "question": why, "outcome": "DAMAGED"} for iri, why in damaged.items()]
    rows = [{**each, "verdict": local_name(each["verdict"])[:SHORT_KEY]} for each in rows]
    if not rows:
        raise InputError("there is no verdict in it", remedy="sdt achieve … --save FILE keeps one")
    print_rows(rows, ("verdict", "question", "drive", "state", "options", "outcome"), as_json=as_json)
    for note in mixed(verdicts):
        click.echo(f"note: {note}", err=True)


def _apart(verdicts: Sequence[StoredVerdict], facts: Facts) -> dict[Iri, str]:
    """Verdict → the options that not all verdicts on the same question were asked with."""
    asked = {each.iri: options(each, facts) for each in verdicts}
    alike: dict[str, list[set[str]]] = {}
    for each in verdicts:
        alike.setdefault(question(each), []).append(set(asked[each.iri]))
    shared = {each: set[str].intersection(*said) for each, said in alike.items()}
    return {
        each.iri: " ".join(one for one in asked[each.iri] if one not in shared[question(each)])
        for each in verdicts
    }


def without_twins(source: str) -> ox.Store:
    """The verdicts and results of tasks of a store, without the twins.

    A record is known by its hash too: one that says to be something else was changed, and is told.
    """
    kinds = f"VALUES ?kind {{ <{LAW}Verdict> <{LAW}TaskResult> }} GRAPH ?graph {{ ?of a ?kind }}"
    hashed = f"GRAPH ?graph {{ ?of <{RECORD_HASH}> ?hash }}"
    store = readable(source)
    try:
        kept = rows_of(store.query(f"SELECT DISTINCT ?graph WHERE {{ {{ {kinds} }} UNION {{ {hashed} }} }}"))
        return store.dump([str(row["graph"]) for row in kept[1]])
    finally:
        store.close()
