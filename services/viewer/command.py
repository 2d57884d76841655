"""`sdt view`: the 3D page."""

import threading

import click

from services.commands.completion.types import KITCHEN, ROBOT
from services.commands.options import KITCHEN_HELP, ROBOT_HELP, FiniteRange, WholeRange, friction_option
from services.stopping import terminable
from services.viewer.beside import check_extra

KITCHENS = ("b", "a")
ROBOTS = ("pr2", "tiago_dual", "stretch")
LOADING = 5.0
"""[s] Before the address is told, for a judge to load; it goes on loading where that is not enough."""


@click.command()
@click.option(
    "--http",
    "address",
    default="127.0.0.1:8090",
    show_default=True,
    metavar="HOST:PORT",
    help="Where to listen.",
)
@click.option(
    "--kitchen",
    "kitchens",
    type=KITCHEN,
    multiple=True,
    help=KITCHEN_HELP + " Repeatable; by default b and a.",
)
@click.option(
    "--robot", "robots", type=ROBOT, multiple=True, help=ROBOT_HELP + " Repeatable; by default all bundled."
)
@click.option(
    "--budget",
    type=FiniteRange(0.5, 600.0),
    default=20.0,
    show_default=True,
    help="Seconds of a search.",
)
@friction_option
@click.option("--judges", type=WholeRange(1, 16), default=1, show_default=True, help="Processes that judge.")
@click.option(
    "--allow-host", "hosts", multiple=True, metavar="NAME", help="Another name of this service. Repeatable."
)
@click.option("--unprotected", is_flag=True, help="Also where other machines reach it: whoever does may ask.")
def view(
    *,
    address: str,
    kitchens: tuple[str, ...],
    robots: tuple[str, ...],
    budget: float,
    friction: float | None,
    judges: int,
    hosts: tuple[str, ...],
    unprotected: bool,
) -> None:
    """Look at kitchens, robots, motions and verdicts in 3D, in a browser.

    Choose a case, press Check, play the motion that was certified, or see what is in its way; drag an
    obstacle, half-open a door, move the base: the verdict follows. Nothing leaves this machine.
    """
    check_extra()
    from services.viewer.running import Offer, running  # noqa: PLC0415 - its library is an extra

    offer = Offer(kitchens or KITCHENS, robots or ROBOTS, budget, friction)
    with (
        terminable(),
        running(address, offer, judges, hosts, unprotected=unprotected, patience=LOADING) as page,
    ):
        click.echo(f"{page.url}  (Ctrl-C ends it)", err=True)
        threading.Event().wait()
