"""Everything with a side effect. `from services import load` is the public Python API."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from services.app import load

__all__ = ["load"]


def __getattr__(name: str) -> object:
    """`load` on first use, so that importing one service does not import all."""
    if name == "load":
        from services.app import load  # noqa: PLC0415 - the reason for this function

        return load
    raise AttributeError(f"module 'services' has no attribute '{name}'")
