"""The `sdt` command."""

import atexit
import contextlib
import errno
import gc
import io
import logging
import os
import sys
import traceback
from pathlib import Path

import click

from sdt_kg.errors import InputError, SdtError
from services.commands.completion.shells import register, words
from services.commands.exits import MEANING, Exit
from services.commands.lazy import LazyGroup, Listed
from services.configuration.read import settings
from services.configuration.settle import default_map
from services.stopping import Terminated, repeat_if_lost

COMPLETE = "_SDT_COMPLETE"
"""Variable by which a shell asks for completion, as click names it."""

MADE = 10_000
"""[1] Objects after which garbage is looked for; with Python's 700 it takes a twentieth of a table."""

SELDOM = 100
"""[1] Times that garbage is looked for among what is new before it is looked for among what was left, once:
of what a command loads nothing becomes garbage."""

HERE = "services.commands"
SECTIONS = {
    "Kitchens and robots": {
        "containers": Listed(f"{HERE}.kitchens.models:containers", "What counts as a container, its limits."),
        "scope": Listed(f"{HERE}.kitchens.models:scope", "Is it inside the class D_artic? (SHACL)"),
        "graph": Listed(f"{HERE}.kitchens.models:graph", "Write the twin as RDF."),
        "robot": Listed(f"{HERE}.kitchens.robot:robot", "A first annotation for a robot of your own."),
        "query": Listed(f"{HERE}.graphs.query:query", "SPARQL over a twin or over saved verdicts."),
        "reason": Listed(f"{HERE}.graphs.reason:reason", "Is it consistent, and what follows from it?"),
        "ontology": Listed(f"{HERE}.graphs.ontology:ontology_command", "The ontology as one page."),
    },
    "The Law": {
        "achieve": Listed(f"{HERE}.law.achieve:achieve", "Can this robot do that task? Makes or verifies τ."),
        "satisfies": Listed(f"{HERE}.law.predicates:satisfies", "Which requests does a state meet?"),
        "causes": Listed(f"{HERE}.law.predicates:causes", "Which motions would cause a task? No robot."),
        "place": Listed(f"{HERE}.law.place:place", "Where may the base stand for a task?"),
        "table": Listed(f"{HERE}.law.table:table", "Every container of some kitchens for some robots."),
        "sweep": Listed(
            f"{HERE}.law.sweep:sweep", "Many cases: a grid, a CSV or a query; resumed if stopped."
        ),
        "task": Listed(f"{HERE}.law.task:task_command", "Steps, rules on the way, the best motion by J."),
        "learn": Listed(f"{HERE}.law.learn:learn_command", "Which joint moves what was seen?"),
        "whatif": Listed(f"{HERE}.worlds.whatif:whatif", "The same question in another world."),
        "codesign": Listed(f"{HERE}.worlds.codesign:codesign", "Which robot for which kitchen?"),
    },
    "Saved verdicts and branches": {
        "why": Listed(f"{HERE}.saved.why:why_command", "A stored verdict in plain words."),
        "open": Listed(f"{HERE}.saved.open:open_command", "What a store holds, and how to go on from there."),
        "recheck": Listed(f"{HERE}.saved.recheck:recheck", "Verify certificates and proofs again."),
        "branch": Listed(f"{HERE}.graphs.branch:branch", "Edit a kitchen; every edit is a branch."),
        "report": Listed("services.reports.command:report", "Figures, tables, a 3D scene: one HTML file."),
        "diff": Listed(f"{HERE}.graphs.branch:diff", "How two twins differ, in sentences."),
        "patch": Listed(f"{HERE}.graphs.branch:patch", "Apply or undo a difference."),
    },
    "This program": {
        "tour": Listed("services.tour.command:tour", "A walk through the four usage modes on kitchen B."),
        "doctor": Listed("services.doctor.command:doctor", "Is all well here, and what is to be done?"),
        "completion": Listed(f"{HERE}.completion.command:completion", "Completion for bash, zsh and fish."),
        "config": Listed("services.configuration.command:config", "Settings, and where each comes from."),
    },
    "Services": {
        "serve": Listed("services.serving.command:serve", "SPARQL, graphs, JSON and pages over HTTP; Zenoh."),
        "view": Listed("services.viewer.command:view", "The 3D page: kitchens, motions, verdicts."),
        "ask": Listed(f"{HERE}.network.bus:ask", "Ask a server over Zenoh."),
        "oracle": Listed(f"{HERE}.network.bus:oracle", "Answer for Causes or CanPerform on the bus."),
        "router": Listed(f"{HERE}.network.bus:router", "Route between servers, oracles and askers."),
        "mcp": Listed(f"{HERE}.network.mcp:mcp_command", "Tools for agents (MCP)."),
    },
}
"""Each subcommand once, where the help lists it; imported when it is run."""

CLOSING = "Exit codes:\n" + "\n".join(f"  {code.value:<11}{text}" for code, text in MEANING.items())


@click.group(
    cls=LazyGroup,
    sections=SECTIONS,
    closing=CLOSING,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
)
@click.option(
    "--config",
    type=click.Path(path_type=Path),
    metavar="FILE.toml",
    help="Settings; else SDT_CONFIG, ./sdt.toml, ~/.config/sdt/config.toml (sdt config --help).",
)
@click.version_option(package_name="sdt-kg", prog_name="sdt")
@click.pass_context
def sdt(context: click.Context, config: Path | None) -> None:
    """Certify that a robot's body motion will achieve a task.

    A verdict is certified when three predicates hold: SatisfiesRequest (the final state meets the request),
    Causes (physics under the motion ends there) and CanPerform (the robot can do it inside its limits and
    without collision). Everything is relative to the class D_artic: outside it the answer is 'abstained'.
    """
    context.obj = said = settings(tuple(sdt.commands), config)
    name = context.invoked_subcommand
    if name is not None and name in sdt.commands:
        context.default_map = {name: default_map(name, sdt.commands[name], said)}


def main() -> None:
    """Run `sdt` as a program."""
    repeat_if_lost()
    ended: list[int] = []
    atexit.register(_end, ended)  # the first of ours, so called after what else is to be done at the end
    code = program()
    ended.append(code)
    sys.exit(code)


def _end(ended: list[int]) -> None:
    """The process ends as it is: to give back what is left, piece by piece, takes a tenth of a second."""
    if ended:
        logging.shutdown()
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError, ValueError):  # nobody reads it, or it is closed
                stream.flush()
        os._exit(ended[0])
    gc.freeze()  # to look for garbage in it takes half a second


def program() -> int:
    """Run `sdt` with the words and streams of the process, and tell its exit code."""
    gc.set_threshold(MADE, SELDOM)
    os.environ["PYTHONSAFEPATH"] = "1"  # processes that this one starts import nothing from where it is run
    # Arrays here are small: a library's second thread takes a tenth more CPU, and gains nothing.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    _open_streams()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # what a terminal has no letter for is no bug
    code = run()
    try:
        sys.stdout.flush()
    except OSError as error:
        code = Exit.BROKEN_PIPE if isinstance(error, BrokenPipeError) else _told(error)
        # What nobody reads is written nowhere, or Python would complain of it at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return code


def _open_streams() -> None:
    """A stream that the shell has closed (`>&-`) is one where nothing comes from or goes to."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open(mode, encoding="utf-8"))  # noqa: SIM115 - for good


def run(words: list[str] | None = None) -> int:
    """Run `sdt` with these words, or those of the process, and tell its exit code.

    A typed error becomes one line on standard error.
    """
    try:
        sdt.main(words, prog_name="sdt", standalone_mode=False, obj=_completing())
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else Exit.DONE
    except (Exception, KeyboardInterrupt) as error:  # noqa: BLE001 - the edge: each is told, none swallowed
        return _told(error)
    return Exit.DONE


def _told(error: BaseException) -> int:
    """Say what went wrong on standard error; the exit code, which tells it where nothing can be said."""
    line, code = "", Exit.BAD_INPUT
    unsaid = contextlib.suppress(OSError)  # standard error is a file on a full disk, or nobody reads it
    match error:
        case click.ClickException():
            with unsaid:
                error.show()
        # Python wraps what comes while a class is made.
        case click.Abort() | KeyboardInterrupt() | RuntimeError(__cause__=KeyboardInterrupt()):
            stopped = error.__cause__ or error  # click raises an error of its own for what stopped it
            notes = getattr(stopped, "__notes__", ())  # of what was kept, by who keeps it
            code = Exit.TERMINATED if isinstance(stopped, Terminated) else Exit.INTERRUPTED
            line = ": ".join((code.name.lower(), *notes))
        case InputError():
            line = f"error: {error}"
        case SdtError():
            line, code = f"error: {error}", Exit.NO_ORACLE
        case OSError(filename=str(path), strerror=str(what)):
            line = f"error: {path}: {what.lower()}"
        case OSError(errno=errno.ENOSPC | errno.EDQUOT | errno.EFBIG | errno.EIO, strerror=str(what)):
            line = f"error: what was to be written cannot be: {what.lower()}"
        case _:
            with unsaid:
                traceback.print_exception(error)
            line, code = "this is a bug of sdt, and no verdict; please report the lines above", Exit.BUG
    if line:
        with unsaid:
            click.echo(line, err=True)
    return code


def _completing() -> dict[str, object] | None:
    """What completion in a shell needs to know; nothing where no shell asks."""
    if COMPLETE not in os.environ:
        return None
    register()
    kitchen = None
    with contextlib.suppress(InputError):  # nobody asked for an error
        said = settings(tuple(sdt.commands))
        kitchen = said.environment.get("SDT_KITCHEN") or said.shared.get("kitchen")
    return {"kitchen": kitchen, "words": words()[1:]}


if __name__ == "__main__":
    main()
