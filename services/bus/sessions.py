"""Zenoh sessions as this project opens them: no multicast scouting, no memory shared, loopback by default."""

import json
from dataclasses import dataclass
from pathlib import Path

import zenoh

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
        InputError: The configuration file or an endpoint is wrong.
        BusUnavailableError: Nobody is there to connect to, or the endpoint is taken.
    """
    settings = _settings(config)
    for key, value in _chosen(listen, connect, mode).items():
        settings.insert_json5(key, json.dumps(value))
    try:
        return zenoh.open(settings)
    except zenoh.ZError as error:
        raise BusUnavailableError(problem(ProblemType.UNAVAILABLE, _said(error, listen, connect))) from None


def _said(error: zenoh.ZError, listen: str | None, connect: str | None) -> str:
    """Zenoh's message without the place in its source; it tries a name that is refused until time is up."""
    said = str(error).partition(" at /")[0]
    if listen:
        return f"cannot listen at {listen}: {said}"
    return f"cannot reach {connect}: nobody listens there, or this name or certificate is refused ({said})"


def _settings(config: Path | None) -> zenoh.Config:
    if config is None:
        return zenoh.Config()
    try:
        return zenoh.Config.from_file(str(config))
    except zenoh.ZError as error:
        raise InputError(f"{config} is no Zenoh configuration: {error}") from None


def _chosen(listen: str | None, connect: str | None, mode: str) -> dict[str, object]:
    """Keys of Zenoh's configuration."""
    for endpoint in (listen, connect):
        if endpoint is not None and endpoint.count("/") < 1:
            raise InputError(
                f"'{endpoint}' is no endpoint", allowed="PROTOCOL/HOST:PORT", remedy=DEFAULT_ENDPOINT
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
