"""`sdt recheck`: are stored verdicts what their certificates and proofs show?"""

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import click

from predicates.case import Artefact
from predicates.oracle import Physics
from predicates.record import StoredVerdict
from predicates.record.inputs import Inputs
from predicates.scope import tee_class_of_hash
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from sdt_kg.load import load_twin
from sdt_kg.numbers import so_many
from sdt_kg.scope import D_ARTIC_DYN
from sdt_kg.twin import Twin
from services.commands.exits import Exit
from services.commands.options import csv_flag, json_flag
from services.commands.show import csv_is_asked, print_json, print_rows
from services.embodiment.recheck import Rechecked, Saved, is_artefact, recheck_artefact, recheck_verdict
from services.embodiment.recheck.models import Models, TwinOf
from services.embodiment.recheck.saved import Entry, by_name
from services.physics.oracle import Kinematics
from services.store.files import is_saved_graph
from services.why import named_among

TWINS_KEPT = 8
"""Kitchens with a robot that are kept: a store has its verdicts in the order of their hashes."""


@click.command()
@click.argument("source", metavar="IRI|FILE|STORE")
@click.option(
    "--store",
    metavar="FILE|STORE",
    help="Where the verdict of that IRI is saved: a .trig or .nq file, a store directory, the address of a "
    "SPARQL server.",
)
@click.option(
    "--kitchen", help="Take the kitchen from here, not from the saved graphs; its content must agree."
)
@click.option(
    "--robot",
    "robots",
    multiple=True,
    help="Take the robot of that name from here; its content must agree. Repeatable.",
)
@click.option(
    "--annotation", type=click.Path(exists=True, dir_okay=False), help="Annotation of one of these."
)
@csv_flag
@json_flag
def recheck(
    *,
    source: str,
    store: str | None,
    kitchen: str | None,
    robots: tuple[str, ...],
    annotation: str | None,
    as_json: bool,
) -> None:
    """Re-verify stored verdicts without the code that planned or proved them.

    IRI is a verdict or the result of a task in --store, or the beginning of its hash; FILE is a .trig or .nq
    file, and STORE a store directory or the address of a SPARQL server, all of which is meant; or FILE is a
    certificate that `sdt achieve --certificate` wrote. A verdict without certificate or proof is only
    counted: what it calls proved is a calculation, which judging again repeats.
    Of a task's result, its steps' verdicts, where each step begins, the rules and J are checked. What is
    about other models of these names than those at hand, or relative to a class D of another version, is
    not checked.

    Exit 0 everything holds, 1 something does not or was not checked, 2 bad input.
    """
    given = _given(kitchen, robots, annotation)
    results, without = _results(source, store, given)
    if not results and not without:
        raise InputError(f"no verdict in {source}", remedy="sdt open tells what is there")
    if not results:
        raise InputError(
            f"nothing to recheck: {_bare(without)}",
            allowed="a verdict with its certificate or proof, or the result of a task with its specification",
            remedy="judge again: what is called proved without a proof is a calculation, which that repeats",
        )
    if as_json:
        print_json([_json(each) for each in results])
    elif csv_is_asked():
        rows = [{**_json(each), "reasons": "; ".join(each.reasons)} for each in results]
        print_rows(rows, ("of", "about", "kind", "holds", "about_other_models", "reasons", "seconds"))
    else:
        _print(results, without)
    raise SystemExit(0 if all(each.holds for each in results) else Exit.NO)


def _given(kitchen: str | None, robots: Sequence[str], annotation: str | None) -> TwinOf | None:
    """The twin of the models on the command line, if there are any: with all the robots."""
    if kitchen is None and not robots:
        return None
    if kitchen is None or not robots:
        raise InputError("one model alone", allowed="--kitchen and --robot together")
    twin = load_twin(kitchen, robots, annotation=annotation)
    return lambda _: (twin, f"models {', '.join((kitchen, *robots))}")


def as_meant(twin_of: TwinOf) -> TwinOf:
    """The same twins; with the bundled force data, where what is asked for has these."""
    from services.dynamics.data import with_forces  # noqa: PLC0415 - only what is checked needs them

    def meant(models: Models) -> tuple[Twin, str]:
        twin, source = twin_of(models)
        if _are(twin, models):
            return twin, source
        forced = with_forces(twin)
        return (forced, f"{source}, with bundled force data") if _are(forced, models) else (twin, source)

    return meant


def _are(twin: Twin, models: Models) -> bool:
    here = {twin.environment, *twin.robots}
    return all(model in here and twin.content_hash(model) == content for model, content in models)


def _results(source: str, store: str | None, given: TwinOf | None) -> tuple[list[Rechecked], int]:
    """What each recheck found, and how many verdicts have nothing to check."""
    path = Path(source)
    if store is None and source and not is_saved_graph(source) and not path.is_dir():
        if path.is_file():
            return [recheck_artefact(path.name, _artefact(path), as_meant(given or by_name))], 0
        raise InputError(
            f"no file or store at {source}",
            allowed="a file, a store, or the IRI of a verdict with --store FILE|STORE",
        )
    saved = Saved(source if store is None else store)
    if saved.left_out:
        click.echo(f"note: {saved.left_out}", err=True)
    again = _Again(saved, as_meant(given or saved.twin))
    if store is not None:
        of = named_among([*saved.verdicts(), *saved.results()], source)
        found = again.result(of) if of in saved.results() else again.entry(saved.entry(of))
        return ([], 1) if found is None else ([found], 0)
    verdicts = [again.entry(each) for each in saved.entries()]
    tasks = [again.result(each) for each in saved.results()]
    if bare := tasks.count(None):
        told = so_many(bare, "result of a task was", "results of tasks were")
        click.echo(
            f"note: {told} kept without specification: there the steps' verdicts alone are rechecked",
            err=True,
        )
    return [each for each in (*verdicts, *tasks) if each is not None], verdicts.count(None)


def _artefact(path: Path) -> bytes:
    content = path.read_bytes()
    if not is_artefact(content):
        raise InputError(
            f"{path} is no certificate or proof, and no file or directory of verdicts",
            allowed="what sdt achieve --certificate wrote, a .trig or .nq file, or a store directory",
        )
    return content


class _Again:
    """Rechecks of what a store has; a verdict on which several things rest is checked once.

    Models are put together once for all that is about them: that takes longer than to certify a motion.
    """

    def __init__(self, saved: Saved, twin_of: TwinOf) -> None:
        self._saved, self._twin_of = saved, lru_cache(maxsize=TWINS_KEPT)(twin_of)
        self._known: dict[Iri, Rechecked | None] = {}

    def entry(self, entry: Entry) -> Rechecked | None:
        """What the recheck of a verdict found; None where it has nothing to check."""
        if entry.iri not in self._known:
            self._known[entry.iri] = self._checked(entry)
        return self._known[entry.iri]

    def result(self, iri: Iri) -> Rechecked | None:
        """What the recheck of a task's result found; None where its specification was not kept."""
        from services.embodiment.recheck.tasks import recheck_result  # noqa: PLC0415 - few stores have some

        try:
            stored = self._saved.result(iri)
        except InputError as error:
            return Rechecked(iri, "", None, (str(error),), (), 0.0)
        if not stored.written:
            return None
        return recheck_result(stored, self._found, self._twin_of, _physics(stored.inputs) or Kinematics())

    def _checked(self, entry: Entry) -> Rechecked | None:
        if entry.stored is None:
            return Rechecked(entry.iri, "", None, (entry.damage,), (), 0.0)
        if entry.artefact is None:
            return None
        return recheck_verdict(entry.stored, entry.artefact, self._twin_of, _physics(entry.stored.inputs))

    def _found(self, verdict: Iri) -> tuple[StoredVerdict, Artefact | None, Rechecked | None]:
        entry = self._saved.entry(verdict)
        if entry.stored is None:
            raise InputError(entry.damage)
        return entry.stored, entry.artefact, self.entry(entry)


def _physics(inputs: Inputs) -> Physics | None:
    """Φ of the class that a verdict or result is relative to, where that is another than D_artic's."""
    if tee_class_of_hash(dict(inputs).get("tee_class", "")) != D_ARTIC_DYN:
        return None
    from services.dynamics.oracle import Dynamics  # noqa: PLC0415 - only where forces are asked about

    return Dynamics()


def _print(results: Sequence[Rechecked], without: int) -> None:
    for each in results:
        kind = each.kind or "unreadable"
        verdict = "holds" if each.holds else "NOT CHECKED" if each.about_others else "DOES NOT HOLD"
        click.echo(f"{verdict}: {kind}, {each.about or 'verdict'} ({each.seconds:.1f} s)")
        click.echo(f"  {each.of}")
        for line in (*each.reasons, *each.notes):
            click.echo(f"  {line}")
    held, others = sum(each.holds for each in results), sum(each.about_others for each in results)
    unchecked = f"{others} about other models or classes, not checked; " if others else ""
    click.echo(f"{held} of {len(results)} hold; {unchecked}{_bare(without)}")


def _bare(without: int) -> str:
    return f"{so_many(without, 'verdict', 'verdicts')} without certificate or proof"


def _json(each: Rechecked) -> dict[str, object]:
    return {
        "of": each.of,
        "about": each.about,
        "kind": each.kind,
        "holds": None if each.about_others else each.holds,
        "about_other_models": each.about_others,
        "reasons": list(each.reasons),
        "notes": list(each.notes),
        "seconds": round(each.seconds, 3),
    }
