"""`sdt tour`: a walk through the four usage modes."""

import contextlib
import os
import shlex
import shutil
import sys
import tempfile
from pathlib import Path

import click

from services.cli import run
from services.commands.exits import Exit
from services.commands.options import OutFolder
from services.tour.steps import STEPS, Step

INTRODUCTION = (
    "The Law of Task-Achieving Body Motion says when a body motion achieves a task: when its final state "
    "meets the request (SatisfiesRequest), when the physics leads there (Causes), and when the body can "
    "do it (CanPerform). One relation over robot, environment, task, world and motion; what is unknown of"
    " them is the usage mode. Every command below is run here and now."
)


WIDEST = 100
"""[characters] Longer lines are hard to read."""


@click.command()
@click.option(
    "--keep",
    type=OutFolder(),
    metavar="DIR",
    help="Keep motion, track and verdicts there; else they are gone when the tour ends.",
)
@click.option("--list", "lists", is_flag=True, help="Show the commands, and run nothing.")
def tour(*, keep: Path | None, lists: bool) -> None:
    """Walk through the four usage modes on kitchen B, with what to look at.

    On a terminal it waits for Enter before each command (q ends); on a pipe it runs through. It takes half a
    minute. Exit 0 if every command ended as the tour says, else 1.
    """
    if lists:
        for step in STEPS:
            click.echo(f"{step.title}\n    {shown(step)}")
        return
    click.echo(click.wrap_text(INTRODUCTION, width()))
    with tempfile.TemporaryDirectory(prefix="sdt-tour-") as temporary:
        folder = keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        surprises = _walk(folder.resolve())
    if keep:
        click.echo(f"\nkept in {keep}: {', '.join(sorted(each.name for each in keep.iterdir()))}")
    for title in surprises:
        click.echo(f"'{title}' did not end as it should; sdt doctor may say why", err=True)
    raise SystemExit(Exit.NO if surprises else Exit.DONE)


def shown(step: Step) -> str:
    """The command as it is typed."""
    return shlex.join(("sdt", *step.words))


def width() -> int:
    """[characters] Of running text."""
    return min(WIDEST, shutil.get_terminal_size((WIDEST, 24)).columns)


def _walk(folder: Path) -> list[str]:
    """Titles of steps that did not end as they should."""
    surprises: list[str] = []
    for number, step in enumerate(STEPS, 1):
        click.secho(f"\n{number} of {len(STEPS)}  {step.title}\n", bold=True)
        click.echo(click.wrap_text(step.says, width()))
        click.echo(f"\n$ {shown(step)}")
        if not _goes_on():
            break
        with contextlib.chdir(folder):
            code = _ran(step, folder)
        click.echo(f"\n→ exit code {int(code)}")
        click.echo(click.wrap_text(f"Look: {step.look}", width()))
        if code != step.ends:
            surprises.append(step.title)
    return surprises


def _goes_on() -> bool:
    """Whether the reader wants the command run; on a pipe nobody is asked."""
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        return True
    return click.prompt("  Enter runs it, q ends", default="", show_default=False, prompt_suffix=" ") != "q"


def _ran(step: Step, folder: Path) -> int:
    """The exit code of the command, run without the reader's own settings, which it does not mention."""
    if step.prepares:
        from services.tour.seen import write_track  # noqa: PLC0415 - loads the physics

        write_track(folder)
    before = os.environ.get("SDT_CONFIG")
    os.environ["SDT_CONFIG"] = os.devnull
    try:
        return run(list(step.words))
    finally:
        if before is None:
            del os.environ["SDT_CONFIG"]
        else:
            os.environ["SDT_CONFIG"] = before
