"""`sdt ask`, `sdt oracle` and `sdt router`: the Law over Zenoh."""

import signal
import threading
from pathlib import Path
from typing import Any

import click

from sdt_kg.errors import InputError
from services.commands.exits import Exit
from services.commands.options import FiniteRange, csv_flag, json_flag, states_option, tee_option
from services.commands.show import print_json, print_rows
from services.commands.verdicts import told

ENDPOINT = "tcp/127.0.0.1:7447"

CASE = ("robot", "state", "drive", "tee", "handle-force")
TAKES = {
    "satisfies": ("state",),
    "causes": ("state", "tee", "handle-force"),
    "achieve": CASE,
    "task": CASE,
    "place": ("robot", "state"),
}
"""Verb → the options that it takes of those that decide what is asked; other verbs take none."""

connect_option = click.option(
    "--connect",
    default=ENDPOINT,
    show_default=True,
    metavar="PROTOCOL/HOST:PORT",
    help="Endpoint of the server or router.",
)
config_option = click.option(
    "--config",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE.json5",
    help="Zenoh configuration with TLS, user or access control; see services/bus/config.",
)


@click.command()
@click.argument("twin")
@click.argument(
    "verb",
    type=click.Choice(
        ["select", "ask", "construct", "satisfies", "causes", "achieve", "task", "place", "why", "health"]
    ),
)
@click.argument("text", required=False, default="")
@connect_option
@config_option
@click.option("--robot", help="Robot of an achieve; may be left out where the server has one.")
@states_option
@click.option(
    "--drive", type=click.Choice(["omni", "differential", "fixed"]), help="How the base moves, for achieve."
)
@tee_option
@click.option(
    "--handle-force",
    type=FiniteRange(min=0, min_open=True),
    metavar="NEWTON",
    help="Allowed at the handle, for d_artic_dyn; without it, what the kitchen's force data say.",
)
@click.option("--budget", type=FiniteRange(min=0, min_open=True), default=20.0, show_default=True)
@click.option(
    "--deadline",
    type=FiniteRange(min=0, min_open=True),
    default=60.0,
    show_default=True,
    help="Seconds after which nobody waits any more.",
)
@csv_flag
@json_flag
def ask(
    *,
    twin: str,
    verb: str,
    text: str,
    connect: str,
    config: Path | None,
    robot: str | None,
    states: tuple[str, ...],
    drive: str | None,
    tee: str,
    handle_force: float | None,
    budget: float,
    deadline: float,
    as_json: bool,
) -> None:
    """Ask a server on the bus about TWIN: TEXT is the query, the task, or a verdict's IRI.

    For task, TEXT is the name of a ready task (sdt task --list), or one in Turtle.

    Exit as `sdt achieve`; 4 if nobody answers.
    """
    said = (robot, states, drive, tee != "d_artic", handle_force)
    for option, given in zip(CASE, said, strict=True):
        if given and option not in TAKES.get(verb, ()):
            taking = ", ".join(each for each, options in TAKES.items() if option in options)
            raise InputError(f"--{option} says nothing to {verb}", allowed=f"with {taking}")
    from services.bus.client import Connection  # noqa: PLC0415 - other commands need no bus
    from services.bus.client import connect as connected  # noqa: PLC0415 - see above

    relative: dict[str, Any] = {"tee": tee, "handle_force": handle_force}

    def asked(to: Connection) -> int:
        if verb in {"select", "ask", "construct"}:
            return _query(to, verb, text, as_json=as_json)
        if verb == "why":
            click.echo(to.why(text))
            return 0
        if verb == "achieve":
            found = to.achieve(text, robot, *states, drive=drive, budget=budget, **relative)
            return told(found.objects, as_json=as_json)
        if verb == "task":
            return _task(
                to.task(text, robot, *states, drive=drive, budget=budget, **relative), as_json=as_json
            )
        rows = {"satisfies": lambda: [each.model_dump() for each in to.satisfies(*states)]}
        rows["causes"] = lambda: [
            to.causes(text, *states, **relative).model_dump(mode="json", exclude={"motions"})
        ]
        rows["place"] = lambda: to.place(text, robot, *states, budget=budget)["spots"]
        rows["health"] = to.health
        return _rows(rows[verb](), as_json=as_json)

    with connected(twin, connect, deadline=deadline, config=config) as to:
        raise SystemExit(asked(to))


def _task(said: dict[str, Any], *, as_json: bool) -> int:
    """Outcome, steps and rules; the exit code is that of `sdt task`."""
    if as_json:
        print_json(said)
    else:
        click.echo(f"{said['outcome']}  {said['task']}\n{said['result']}\n")
        steps = [{"part": "step", "what": each["step"], "outcome": each["outcome"]} for each in said["steps"]]
        rules = [
            {"part": "rule", "what": each["rule"], "outcome": each["standing"]} for each in said["rules"]
        ]
        print_rows([*steps, *rules], ("part", "outcome", "what"))
    return {"certified": Exit.DONE, "abstained": Exit.ABSTAINED}.get(said["outcome"], Exit.NO)


def _query(to: object, verb: str, text: str, *, as_json: bool) -> int:
    from services.bus.client import Connection  # noqa: PLC0415 - other commands need no bus

    assert isinstance(to, Connection)
    if verb == "select":
        columns, rows = to.select(text)
        return _rows(rows, as_json=as_json, columns=tuple(columns))
    if verb == "ask":
        return _rows([{"answer": to.ask(text)}], as_json=as_json)
    for triple in to.construct(text):
        click.echo(f"{triple} .")
    return 0


def _rows(rows: list[dict[str, object]], *, as_json: bool, columns: tuple[str, ...] = ()) -> int:
    if as_json:
        print_json(rows)
    else:
        print_rows(rows, columns or tuple(rows[0] if rows else ()))
    return 0


@click.command()
@click.argument("kind", type=click.Choice(["causes", "canperform"]))
@connect_option
@config_option
@click.option("--workers", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
def oracle(*, kind: str, connect: str, config: Path | None, workers: int) -> None:
    """Answer for KIND on the bus until interrupted; a server with --oracles shares its work among all."""
    from services.bus.keys import Oracle  # noqa: PLC0415 - other commands need no bus
    from services.bus.oracles.server import oracle as answering  # noqa: PLC0415 - see above
    from services.bus.sessions import open_session  # noqa: PLC0415 - see above

    session = open_session(connect=connect, mode="client", config=config)
    try:
        with answering(session, Oracle(kind), workers) as instance:
            click.echo(f"oracle {kind} {instance} at {connect}", err=True)
            _until_stopped()
    finally:
        session.close()


@click.command()
@click.option(
    "--listen", default=ENDPOINT, show_default=True, metavar="PROTOCOL/HOST:PORT", help="Where to listen."
)
@config_option
def router(*, listen: str, config: Path | None) -> None:
    """Route between servers, oracles and askers until interrupted."""
    from services.bus.sessions import open_session  # noqa: PLC0415 - other commands need no bus

    session = open_session(listen=listen, mode="router", config=config)
    click.echo(f"router at {listen}", err=True)
    try:
        _until_stopped()
    finally:
        session.close()


def _until_stopped() -> None:
    """Wait for an interrupt or a termination."""
    stopped = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stopped.set())
    stopped.wait()
