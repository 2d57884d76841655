"""What is told of the smallest change of each family, of the JSON object of `sdt whatif --turn`."""

import click

from predicates.case import Outcome
from services.commands.exits import Exit
from services.commands.verdicts import Json, diagnosis_text
from services.commands.worlds.answer import print_contrast


def print_turned(said: Json) -> None:
    """The verdict as it is, then each family."""
    actual, families = said["actual"], said["families"]
    click.echo(f"as it is   {actual['outcome']}  {said['task']}  {said['robot']} in {said['kitchen']}")
    for each in actual["diagnoses"]:
        click.echo(f"  {diagnosis_text(each)}")
    for one in families:
        _print_sought(one)
    click.echo(
        f"{sum(each['found'] for each in families)} of {len(families)} kinds of change turn the outcome; "
        f"{sum(len(each['tried']) for each in families)} worlds were judged in {said['seconds']:.0f} s"
    )


def ends_with(said: Json) -> Exit:
    """What the command ends with: as that about named edits, of all families together."""
    turns = {each["verdict"]["outcome"] for each in said["families"] if each["found"]}
    about = turns or {said["actual"]["outcome"]}
    if about == {Outcome.ABSTAINED.value}:
        return Exit.ABSTAINED
    return Exit.DONE if turns else Exit.NO


def _print_sought(one: Json) -> None:
    click.echo(f"{one['family']}?")
    if not one["found"]:
        click.echo(f"  none found ({one['sure']})")
    else:
        click.echo(f"  {one['edit']}  →  {one['verdict']['outcome']} ({one['sure']})")
        if one["not_yet"] is not None:
            click.echo(f"  not yet at {one['not_yet']}")
        print_contrast(one["differs"], ("now",))
    click.echo(f"  looked at: {one['range']}; {one['resolution']}")
