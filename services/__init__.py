"""Everything with a side effect; `load` and `connect` are the public Python API.

`load(kitchen, robots)` is the Law in this process, `connect(twin, endpoint)` the same over the bus, and
`connect_async` the same for event loops.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from services.app import load
    from services.bus.aio import connect_async
    from services.bus.client import connect

__all__ = ["connect", "connect_async", "load"]

_PLACES = {
    "load": "services.app",
    "connect": "services.bus.client",
    "connect_async": "services.bus.aio",
}


def __getattr__(name: str) -> object:
    """Each on first use, so that importing one service does not import all."""
    if name not in _PLACES:
        raise AttributeError(f"module 'services' has no attribute '{name}'")
    return getattr(import_module(_PLACES[name]), name)
