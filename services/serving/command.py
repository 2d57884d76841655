"""`sdt serve`: kitchens, verdicts and the Law over HTTP."""

from contextlib import closing, nullcontext
from dataclasses import replace
from pathlib import Path

import click

from sdt_kg.errors import InputError
from services.commands.completion.types import KITCHEN, ROBOT
from services.commands.importing import importing
from services.commands.network.bus import ENDPOINT
from services.commands.options import KITCHEN_HELP, ROBOT_HELP, FiniteRange, OutFile, WholeRange
from services.stopping import terminable


@click.command()
@click.option(
    "--http",
    "address",
    default="127.0.0.1:8080",
    show_default=True,
    metavar="HOST:PORT",
    help="Where to listen.",
)
@click.option(
    "--store",
    metavar="STORE",
    help="Serve what is saved there and keep what is written: a directory, FILE.trig, FILE.nq (kept when the "
    "service ends), http://HOST of an Oxigraph, or http://HOST/QUERY,http://HOST/UPDATE.",
)
@click.option("--kitchen", "kitchens", multiple=True, type=KITCHEN, help=KITCHEN_HELP + " Repeatable.")
@click.option("--robot", "robots", multiple=True, type=ROBOT, help=ROBOT_HELP + " Repeatable.")
@click.option(
    "--token-file",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE",
    help="The token that requests need which write or compute; else SDT_TOKEN. Required beyond loopback.",
)
@click.option(
    "--allow-host", "hosts", multiple=True, metavar="NAME", help="Another name of this service. Repeatable."
)
@click.option(
    "--allow-origin",
    "origins",
    multiple=True,
    metavar="ORIGIN",
    help="A site whose pages may ask (CORS), https://example.org say. Repeatable.",
)
@click.option(
    "--timeout",
    type=FiniteRange(min=0, min_open=True),
    default=10.0,
    show_default=True,
    help="Seconds for a query.",
)
@click.option(
    "--bus",
    metavar="PROTOCOL/HOST:PORT",
    help="Listen for Zenoh too, at tcp/127.0.0.1:7447 say; a twin's name in keys is its kitchen's.",
)
@click.option(
    "--oracles",
    is_flag=True,
    help="On the bus, share the work among the oracles there: both of 'sdt oracle causes' and 'sdt oracle "
    "canperform' have to be.",
)
@click.option(
    "--bus-config",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE.json5",
    help="Zenoh configuration with TLS, users or access control; see services/bus/config.",
)
@click.option(
    "--view",
    "view_address",
    metavar="HOST:PORT",
    help="The 3D page too, 127.0.0.1:8090 say, for the same kitchens and robots; pages link to it.",
)
@click.option(
    "--judges", type=WholeRange(min=1), default=1, show_default=True, help="Processes that judge cases."
)
@click.option(
    "--log",
    "log_form",
    type=click.Choice(["text", "json"]),
    default="text",
    show_default=True,
    help="Standard error: warnings as lines, or every request as a JSON object with its id.",
)
@click.option(
    "--spans",
    "spans_file",
    type=OutFile(),
    metavar="FILE.jsonl",
    help="Append OpenTelemetry spans; a request's traceparent is taken up. Nothing leaves the machine.",
)
def serve(
    *,
    address: str,
    store: str | None,
    kitchens: tuple[str, ...],
    robots: tuple[str, ...],
    token_file: Path | None,
    hosts: tuple[str, ...],
    origins: tuple[str, ...],
    timeout: float,
    bus: str | None,
    oracles: bool,
    bus_config: Path | None,
    view_address: str | None,
    judges: int,
    log_form: str,
    spans_file: Path | None,
) -> None:
    """Serve kitchens and verdicts: SPARQL at /sparql, graphs at /graphs, JSON at /api/v1, pages at /."""
    if bus is None and (oracles or bus_config):
        raise InputError("--oracles and --bus-config say nothing without --bus", remedy=f"--bus {ENDPOINT}")
    with importing():
        from services.http.kitchens import open_kitchens  # noqa: PLC0415 - other commands need no web framework
        from services.http.run import bound, run  # noqa: PLC0415 - see above
        from services.http.settings import Address, Settings, host_names, token_for  # noqa: PLC0415 - see above
        from services.http.world import World  # noqa: PLC0415 - see above
        from services.store.files import opened  # noqa: PLC0415 - see above
        from services.store.histories import samples_beside  # noqa: PLC0415 - see above
        from services.store.workers import Limits, Workers  # noqa: PLC0415 - see above
        from services.telemetry import logs  # noqa: PLC0415 - see above
        from services.telemetry.spans import SpansInFile  # noqa: PLC0415 - see above
        from services.telemetry.told import Telemetry  # noqa: PLC0415 - see above
        from services.viewer.beside import page_beside  # noqa: PLC0415 - see above

    logs.configure(logs.Form(log_form))
    where = Address.of(address)
    limits = Limits(seconds=timeout)
    settings = Settings(
        hosts=host_names(where, hosts),
        origins=frozenset(origins),
        token=token_for(where, token_file),
        limits=limits,
        judges=judges,
        warm=bool(kitchens),
        telemetry=Telemetry(spans=SpansInFile(spans_file)) if spans_file else Telemetry(),
    )
    with (
        terminable(),  # the server shuts down at SIGTERM, then raises it again
        closing(bound(where)) as listening,
        closing(opened(store)) if store is not None else nullcontext() as archive,
        page_beside(view_address, kitchens, robots) as viewer,
    ):
        settings = replace(settings, viewer=viewer)
        samples = samples_beside(store) if store else {}
        world = World(open_kitchens(kitchens, robots), Workers(settings.workers, limits), archive, samples)
        beside = None
        if bus is not None:
            from services.bus.serving import BesideHttp  # noqa: PLC0415 - see above

            beside = BesideHttp(bus, bus_config, oracles)

        def ready() -> None:
            names = ", ".join(world.kitchens) or "none"
            port = listening.getsockname()[1]
            click.echo(f"http://{where.host}:{port}  kitchens: {names}; {_writing(settings.token)}", err=True)
            if bus is not None:
                click.echo(f"bus at {bus}; {_on_bus(bus_config)}", err=True)
            if viewer is not None:
                click.echo(f"3D page at {viewer}", err=True)

        run(world, settings, listening, beside, ready)


def _writing(token: str | None) -> str:
    return "writing needs the token" if token else "whoever can reach it may write (no token is set)"


def _on_bus(config: Path | None) -> str:
    """Who may ask there: the token is HTTP's."""
    return (
        f"who may ask says {config.name}" if config else "whoever can reach it may ask, and verdicts are kept"
    )
