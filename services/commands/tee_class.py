"""The class D that a question is about, as `--tee` and `--forces` say."""

from pathlib import Path

from services.app import Service
from services.relative import Relative, tee_of


def in_class(service: Service, tee: str, forces: Path | None) -> Service:
    """The service, asked relative to that class.

    Raises:
        InputError: Force data for a class without forces.
    """
    return Relative(tee_of(tee), forces).of(service)
