"""Zenoh sessions as this project opens them: no multicast scouting, no memory shared, loopback by default."""

import json
from dataclasses import dataclass
from pathlib import Path

import zenoh

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError
from services.judging.problems import BusUnavailableError, ProblemType, problem

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"


@dataclass(frozen=True, slots=True)
class Reach:
    """How a worker process gets on the bus."""

    endpoint: str
    config: Path | None = None

    def __call__(self) -> zenoh.Session:
        """A session of its own."""
        return open_session(connect=self.endpoint, mode="client", config=self.config)


def open_session(
    *, listen: str | None = None, connect: str | None = None, mode: str = "peer", config: Path | None = None
) -> zenoh.Session:
    """A session that listens at an endpoint, or is connected to one.

    Args:
        listen: Endpoint such as `tcp/127.0.0.1:7447`.
        connect: Endpoint of a server or router; not reached at once is an error, not a wait.
        mode: peer, client or router.
        config: A Zenoh configuration (JSON5) with TLS, users, access control; the other arguments
            are set on top of it.

    Raises:
        InputError: The configuration file or an endpoint is wrong, or it is not free to listen at.
        BusUnavailableError: Nobody is there to connect to.
    """
    settings = _settings(config)
    for key, value in _chosen(listen, connect, mode).items():
        settings.insert_json5(key, json.dumps(value))
    try:
        return zenoh.open(settings)
    except zenoh.ZError as error:
        said = str(error).partition(" at /")[0]  # without the place in Zenoh's source
    if listen:
        raise InputError(
            f"cannot listen at {listen}: {said}",
            allowed="PROTOCOL/HOST:PORT, a free port of this machine",
            remedy=f"{DEFAULT_ENDPOINT}, say",
        )
    # Zenoh tries a name that is refused until time is up.
    why = f"nobody listens there, or this name or certificate is refused ({said})"
    raise BusUnavailableError(problem(ProblemType.UNAVAILABLE, f"cannot reach {connect}: {why}"))


def _settings(config: Path | None) -> zenoh.Config:
    if config is None:
        return zenoh.Config()
    check_ends(config)
    try:
        return zenoh.Config.from_file(str(config))
    except zenoh.ZError as error:
        raise InputError(f"{config} is no Zenoh configuration: {error}") from None


def _chosen(listen: str | None, connect: str | None, mode: str) -> dict[str, object]:
    """Keys of Zenoh's configuration."""
    for endpoint in (listen, connect):
        if endpoint is not None and not all(endpoint.partition("/")):
            raise InputError(
                f"'{endpoint}' is no endpoint",
                allowed="PROTOCOL/HOST:PORT",
                remedy=f"{DEFAULT_ENDPOINT}, say",
            )
    return {
        "mode": mode,
        "listen/endpoints": [listen] if listen else [],
        "connect/endpoints": [connect] if connect else [],
        "connect/timeout_ms": 3000,
        "connect/exit_on_failure": True,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        # What a client shares stays mapped here after the client has gone.
        "transport/shared_memory/enabled": False,
    }
