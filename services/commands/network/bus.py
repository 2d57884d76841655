"""`sdt ask`, `sdt oracle` and `sdt router`: the Law over Zenoh."""

import threading
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import click

from sdt_kg.errors import InputError
from services.commands.network.answers import ANSWERS, Asked
from services.commands.options import (
    BODY_MOTION_FILE,
    FiniteRange,
    WholeRange,
    any_start_option,
    base_option,
    budget_option,
    contact_option,
    csv_flag,
    drive_option,
    friction_option,
    json_flag,
    seed_option,
    state_option,
    tee_option,
)
from services.commands.show import csv_is_asked
from services.stopping import terminable

ENDPOINT = "tcp/127.0.0.1:7447"

CASE = ("robot", "state", "base", "drive", "friction", "tee", "handle-force")
TAKES = {
    "satisfies": ("state",),
    "causes": ("state", "tee", "handle-force", "motion"),
    "achieve": (*CASE, "motion", "motion-out", "any-start", "contact-tolerance"),
    "task": CASE,
    "place": ("robot", "state", "friction"),
    "whatif": (*CASE, "edit", "turn", "grid", "within"),
}
"""Verb → the options that it takes of those that decide what is asked; other verbs take none."""

FIELDS = {
    "base": "base",
    "drive": "drive",
    "friction": "friction",
    "tee": "tee",
    "handle-force": "handle_force",
    "any-start": "any_start",
    "contact-tolerance": "contact",
    "turn": "turn",
    "grid": "grid",
    "within": "within",
}
"""Option → the field of a request that it fills."""

SEARCHING = ("achieve", "task", "place", "whatif")
"""Verbs that take a budget and a seed."""

TEXTS = {
    "select": "a query",
    "ask": "a query",
    "construct": "a query",
    "causes": "a task",
    "achieve": "a task",
    "task": "the name of a ready task, or one in Turtle",
    "place": "a task",
    "whatif": "a task",
    "why": "the IRI of a verdict, or the beginning of its hash",
}
"""Verb → the text that it needs; other verbs take none."""

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
    metavar="VERB",
    type=click.Choice(list(ANSWERS)),
)
@click.argument("text", required=False, default="")
@connect_option
@config_option
@click.option("--robot", help="Robot of the question; may be left out where the server has one.")
@click.option(
    "--motion",
    type=click.Path(exists=True, path_type=Path),
    metavar="FILE",
    help="Verify this motion instead of making one, for achieve and causes: .npz, .json, .csv or a ROS 2 bag "
    "(.mcap).",
)
@click.option(
    "--motion-out",
    type=BODY_MOTION_FILE,
    metavar="FILE",
    help="Write the certified body motion of an achieve: .npz, .json, .csv or a ROS 2 bag (.mcap).",
)
@click.option(
    "--edit",
    "edits",
    multiple=True,
    metavar="SPEC",
    help="What is otherwise, for whatif; 'help' lists the kinds. Repeatable.",
)
@click.option(
    "--turn",
    is_flag=True,
    help="Have whatif search the smallest share of the edits at which the outcome turns; without --edit, the "
    "smallest change of every kind that is looked at.",
)
@click.option(
    "--grid",
    is_flag=True,
    help="Have whatif judge every combination: each --edit is an axis of alternatives with ' | ' between "
    "them; TEXT may be open or close without a container; without --robot it is about every robot.",
)
@click.option(
    "--within",
    type=FiniteRange(min=1),
    metavar="SECONDS",
    help="Of CPU for --turn without --edit; without it 30.",
)
@any_start_option
@contact_option
@state_option(without="the server's present state holds")
@base_option
@drive_option
@friction_option
@tee_option
@click.option(
    "--handle-force",
    "handle_force",
    type=FiniteRange(min=0, min_open=True),
    metavar="NEWTON",
    help="Allowed at the handle, for d_artic_dyn; without it, what the kitchen's force data say.",
)
@budget_option
@seed_option
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
    motion: Path | None,
    motion_out: Path | None,
    edits: tuple[str, ...],
    states: tuple[str, ...],
    deadline: float,
    as_json: bool,
    **how: Any,  # noqa: ANN401 - fields of requests, as click gives them
) -> None:
    """Ask a server on the bus about TWIN, the name of its kitchen.

    VERB is select, ask, construct, satisfies, causes, achieve, task, place, whatif, why or health.

    TEXT is a SPARQL query for select, ask and construct; a task (open, open:CONTAINER …) for causes, achieve,
    place and whatif; for task the name of a ready one (sdt task --list), or one in Turtle; for why the IRI of
    a verdict, or the beginning of its hash. satisfies and health take none.

    Exit as the command of that name without a bus; 4 if nobody answers.
    """
    if "help" in edits:
        from services.whatif import HERE  # noqa: PLC0415 - seldom asked

        click.echo("\n".join(HERE.values()))
        return
    said = {"robot": robot, "state": states, "motion": motion, "motion-out": motion_out, "edit": edits}
    said |= {option: how[field] for option, field in FIELDS.items()}
    _check(twin, verb, text, said | {"tee": how["tee"] != "d_artic"})
    from services.bus.client import connect as connected  # noqa: PLC0415 - other commands need no bus
    from services.judging.messages import MOTION  # noqa: PLC0415 - see above
    from services.motions import check_format, read_arrays  # noqa: PLC0415 - see above
    from services.requests import parse_base  # noqa: PLC0415 - see above

    if motion_out:
        check_format(motion_out)
    how["base"] = parse_base(how["base"])
    taken = {field for option, field in FIELDS.items() if option in TAKES.get(verb, ())}
    taken |= {"budget", "seed"} if verb in SEARCHING else set()
    fields = {field: value for field, value in how.items() if field in taken}
    given = read_arrays(motion) if motion else None
    asked = Asked(text, robot, states, fields, edits, given, motion_out)
    with connected(twin, connect, deadline=deadline, config=config) as to:
        try:
            code = ANSWERS[verb](to, asked, as_json)
        except InputError as error:
            about, _, what = error.what.partition(": ")
            if motion is None or about != MOTION:
                raise
            raise InputError(f"{motion.name}: {what}", allowed=error.allowed, remedy=error.remedy) from None
        raise SystemExit(code)


def _check(twin: str, verb: str, text: str, said: Mapping[str, object]) -> None:
    """The verb is told what it needs, and nothing that it does not hear.

    Raises:
        InputError: Otherwise.
    """
    if verb in TEXTS and not text.strip():
        raise InputError(f"{verb} asks about nothing", allowed=f"{TEXTS[verb]}: sdt ask {twin} {verb} TEXT")
    if verb not in TEXTS and text:
        raise InputError(f"'{text}' says nothing to {verb}", allowed=f"sdt ask {twin} {verb}, without a TEXT")
    if verb == "whatif" and not (said["edit"] or said["turn"]):
        raise InputError(
            "whatif asks about no other world",
            allowed="--edit SPEC; --edit help lists edits",
            remedy="--turn without --edit looks at the smallest change of every kind",
        )
    if csv_is_asked() and (verb == "construct" or (verb == "whatif" and not said["grid"])):
        raise InputError(f"--csv says nothing to {verb}", allowed="where there are rows", remedy="--json")
    for option, given in said.items():
        if given not in {None, False, ()} and option not in TAKES.get(verb, ()):
            taking = ", ".join(each for each, options in TAKES.items() if option in options)
            raise InputError(f"--{option} says nothing to {verb}", allowed=f"with {taking}")


@click.command()
@click.argument("kind", type=click.Choice(["causes", "canperform"]))
@connect_option
@config_option
@click.option("--workers", type=WholeRange(min=1), default=1, show_default=True, help="Processes.")
def oracle(*, kind: str, connect: str, config: Path | None, workers: int) -> None:
    """Answer for KIND on the bus until interrupted; a server with --oracles shares its work among all."""
    from services.bus.keys import Oracle  # noqa: PLC0415 - other commands need no bus
    from services.bus.oracles.server import oracle as answering  # noqa: PLC0415 - see above
    from services.bus.sessions import open_session  # noqa: PLC0415 - see above

    with (
        terminable(),
        closing(open_session(connect=connect, mode="client", config=config)) as session,
        answering(session, Oracle(kind), workers) as instance,
    ):
        click.echo(f"oracle {kind} {instance} at {connect}", err=True)
        threading.Event().wait()


@click.command()
@click.option(
    "--listen", default=ENDPOINT, show_default=True, metavar="PROTOCOL/HOST:PORT", help="Where to listen."
)
@config_option
def router(*, listen: str, config: Path | None) -> None:
    """Route between servers, oracles and askers until interrupted."""
    from services.bus.sessions import open_session  # noqa: PLC0415 - other commands need no bus

    with terminable(), closing(open_session(listen=listen, mode="router", config=config)):
        click.echo(f"router at {listen}", err=True)
        threading.Event().wait()
