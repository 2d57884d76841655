"""What is told of the same question in other worlds, of the object that `sdt whatif --json` prints."""

from collections.abc import Mapping, Sequence
from typing import Any

import click

from predicates.case import Outcome
from predicates.record.report import WORDS
from services.commands.exits import Exit
from services.commands.verdicts import Json, diagnosis_text


def exit_of(said: Json) -> Exit:
    """What the command ends with about named edits, of its JSON object.

    Where a turn was sought, whether one was found is the answer, unless nothing is claimed of what that is
    about: the world at the turn, or the world as it is where nothing turns.
    """
    other = said["counterfactual"] or said["actual"]
    if other["outcome"] == Outcome.ABSTAINED.value:
        return Exit.ABSTAINED
    return Exit.DONE if said.get("found", other["outcome"] == Outcome.CERTIFIED.value) else Exit.NO


def print_answer(said: Json) -> None:
    """What the command tells about named edits, of its JSON object."""
    _print_turn(said) if "found" in said else _print_contrast(said)


def _print_contrast(said: Json) -> None:
    actual, other = said["actual"], said["counterfactual"]
    click.echo(f"as it is   {_headline(actual)}")
    click.echo(f"otherwise  {_headline(other)}   ({'; '.join(said['edits'])})")
    click.echo("the outcome turns" if said["turned"] else "the outcome stays")
    _why_abstained("as it is", actual)
    _why_abstained("otherwise", other)
    print_contrast(said)


def _why_abstained(name: str, verdict: Json) -> None:
    for each in verdict["diagnoses"] if verdict["outcome"] == Outcome.ABSTAINED.value else ():
        click.echo(f"  {name}: {diagnosis_text(each)}")


def _headline(verdict: Json) -> str:
    return "{outcome}  {task}({container})  {robot} in kitchen {kitchen}".format_map(verdict)


def _print_turn(said: Json) -> None:
    click.echo(f"as it is   {_headline(said['actual'])}")
    _why_abstained("as it is", said["actual"])
    if said["found"]:
        click.echo(f"turns at   {'; '.join(said['edits'])}   {_headline(said['counterfactual'])}")
        print_contrast(said)
        click.echo(f"not yet at {'; '.join(said['not_yet'])}")
        click.echo(
            f"smallest of {len(said['tried'])} tried, to {100 * said['tolerance']:.2g} % of the whole "
            f"change; those below it are at most {100 * said['apart_at_most']:.2g} % apart"
        )
    else:
        click.echo(f"no turn up to {'; '.join(said['tried'][-1]['edits'])}: searched, not proved")
    for each in said["tried"]:
        click.echo(f"  {100 * each['share']:5.1f} %  {each['outcome']:13}  {'; '.join(each['edits'])}")


def print_contrast(said: Mapping[str, Any], lists: Sequence[str] = ("no_longer", "now")) -> None:
    """Predicates that answer otherwise, and of the reasons those lists that are named."""
    for each in said["predicates"]:
        before, after = WORDS[each["actual"]], WORDS[each["counterfactual"]]
        click.echo(f"  {each['predicate']}: {before}, otherwise {after}")
    for name in lists:
        for each in said[name]:
            click.echo(f"  {name.replace('_', ' ')}: {diagnosis_text(each)}")
