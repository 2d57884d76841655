"""How the service listens, and to whom."""

import ipaddress
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Self

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError
from services.store.workers import Limits
from services.telemetry.told import Telemetry

LOOPBACK_NAMES: Final = ("localhost", "127.0.0.1", "[::1]")
SHORTEST_TOKEN: Final = 16
"""[characters] A shorter one can be guessed."""
TOKEN_VARIABLE: Final = "SDT_TOKEN"  # noqa: S105 - the name of the variable


@dataclass(frozen=True, slots=True)
class Address:
    """Where the service listens."""

    host: str = "127.0.0.1"
    port: int = 8080

    @classmethod
    def of(cls, text: str) -> Self:
        """Address of `HOST:PORT`, `[IPv6]:PORT` or `PORT`.

        Raises:
            InputError: It is none of these.
        """
        host, _, port = text.rpartition(":")
        if not port.isdecimal() or int(port) > 65535 or (":" in host and not host.startswith("[")):
            raise InputError(f"'{text}' is no address", allowed="HOST:PORT, for example 127.0.0.1:8080")
        return cls(host or "127.0.0.1", int(port))

    @property
    def bare_host(self) -> str:
        """The host without the brackets of an IPv6 address."""
        return self.host.strip("[]")

    @property
    def is_loopback(self) -> bool:
        """Whether nobody outside this machine can reach it."""
        if self.host == "localhost":
            return True
        try:
            return ipaddress.ip_address(self.bare_host).is_loopback
        except ValueError:
            return False


@dataclass(frozen=True, slots=True)
class Settings:
    """What is allowed.

    Attributes:
        hosts: Names that a Host header may have, without port; another is DNS rebinding.
        origins: Origins of other sites whose pages may ask, `https://example.org`; none by default.
        token: What a request that writes or computes must carry; None only on loopback.
        body: Of an ordinary request [bytes].
        upload: Of a request with a motion [bytes].
        limits: Of one query.
        workers: Processes that evaluate queries.
        judges: Processes that judge cases.
        warm: Whether they are started at once, rather than with the first case.
        telemetry: What is counted and traced.
        viewer: Address of the 3D page, `http://127.0.0.1:8090` say, to which pages link; None without one.
    """

    hosts: frozenset[str] = frozenset(LOOPBACK_NAMES)
    origins: frozenset[str] = frozenset()
    token: str | None = field(default=None, repr=False)
    body: int = 256 * 1024
    upload: int = 32 * 2**20
    limits: Limits = field(default_factory=Limits)
    workers: int = 2
    judges: int = 1
    warm: bool = False
    telemetry: Telemetry = field(default_factory=Telemetry, repr=False)
    viewer: str | None = None


def host_names(address: Address, others: Iterable[str] = ()) -> frozenset[str]:
    """Names under which a service at an address may be asked."""
    own = () if address.host in {"0.0.0.0", "[::]"} else (address.host.lower(),)  # noqa: S104 - compared
    return frozenset((*LOOPBACK_NAMES, *own, *(name.lower() for name in others)))


def host_name(host: str) -> str:
    """The name in a Host header: without port, lower case; an IPv6 address keeps its brackets."""
    end = host.rfind("]") + 1
    colon = host.find(":", end)
    return (host if colon < 0 else host[:colon]).lower().rstrip(".")


def token_for(address: Address, file: Path | None = None) -> str | None:
    """The token of a service at an address: in the file, else in the environment.

    Raises:
        InputError: It is reachable from outside and there is no token, or the token is too short.
    """
    token = _token(file)
    if token is None and not address.is_loopback:
        raise InputError(
            f"{address.host} can be reached from other machines, and there is no token",
            allowed=f"{TOKEN_VARIABLE} or --token-file, or a loopback address",
            remedy=f"put {SHORTEST_TOKEN} or more random characters into a file and pass --token-file",
        )
    return token


def _token(file: Path | None) -> str | None:
    if file is not None:
        check_ends(file)
    text = (
        file.read_text(encoding="utf-8-sig").strip() if file else os.environ.get(TOKEN_VARIABLE, "").strip()
    )
    if not text and file is None:
        return None
    if len(text) < SHORTEST_TOKEN:
        where = str(file) if file else TOKEN_VARIABLE
        raise InputError(
            f"the token in {where} has {len(text)} characters", allowed=f"{SHORTEST_TOKEN} or more"
        )
    return text
