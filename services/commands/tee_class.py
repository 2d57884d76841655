"""The class D that a question is about, as `--tee` and `--forces` say."""

from pathlib import Path

from sdt_kg.errors import InputError
from sdt_kg.scope import D_ARTIC_DYN
from services.app import Service


def in_class(service: Service, tee: str, forces: Path | None) -> Service:
    """The service, asked relative to that class.

    Raises:
        InputError: Force data for a class without forces.
    """
    if tee.lower() == D_ARTIC_DYN.name.lower():
        return service.with_forces(forces)
    if forces is not None:
        raise InputError(f"--forces {forces} says nothing to {tee}", allowed="--tee d_artic_dyn")
    return service
