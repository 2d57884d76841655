"""Everything with a side effect; `load` and `connect` are the public Python API.

`load(kitchen, robots)` is the Law in this process, `connect(twin, endpoint)` the same over the bus.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from services.app import load
    from services.bus.client import connect

__all__ = ["connect", "load"]

_PLACES = {"load": "services.app", "connect": "services.bus.client"}


def __getattr__(name: str) -> object:
    """`load` and `connect` on first use, so that importing one service does not import all."""
    if name not in _PLACES:
        raise AttributeError(f"module 'services' has no attribute '{name}'")
    return getattr(import_module(_PLACES[name]), name)
