"""`sdt mcp`: the Law as tools for agents that speak the Model Context Protocol."""

import asyncio
import sys

import click

from sdt_kg.errors import InputError
from services.commands.completion.types import KITCHEN, ROBOT
from services.commands.options import KITCHEN_HELP, ROBOT_HELP


@click.command("mcp")
@click.option(
    "--kitchen", "kitchens", multiple=True, required=True, type=KITCHEN, help=KITCHEN_HELP + " Repeatable."
)
@click.option("--robot", "robots", multiple=True, required=True, type=ROBOT, help=ROBOT_HELP + " Repeatable.")
@click.option(
    "--connect",
    metavar="PROTOCOL/HOST:PORT",
    help="Have oracles on the bus (sdt oracle) answer for Causes and CanPerform; else a process here does.",
)
def mcp_command(*, kitchens: tuple[str, ...], robots: tuple[str, ...], connect: str | None) -> None:
    """Serve tools for agents over standard input and output (MCP), until the input ends.

    An agent's host starts this command: lookup, schema, examples, select, list_scopes, verify_motion,
    diagnose, what_if, place. Nothing is written; verdicts are kept until the session ends.
    """
    try:
        from services.mcp_server.desk import Setup  # noqa: PLC0415 - the library is an extra
        from services.mcp_server.server import serve  # noqa: PLC0415 - see above
    except ModuleNotFoundError as error:
        if error.name not in {"mcp", "mcp_types"}:
            raise
        raise InputError(
            "the MCP library is not installed",
            allowed="sdt-kg with its extra",
            remedy="pip install 'sdt-kg[mcp]'",
        ) from None
    if connect is not None:
        from services.bus.sessions import Reach  # noqa: PLC0415 - most need no bus

        Reach(connect)().close()
    setup = Setup(kitchens, robots, connect)
    services = setup.services()
    if sys.stdin.isatty():
        click.echo("waiting for an agent's host on standard input (JSON-RPC); Ctrl-D ends", err=True)
    asyncio.run(serve(setup, services))
