"""Task specifications by name, file or text."""

from pathlib import Path

import ontology
from predicates.specification.model import Specification
from predicates.specification.read import read_specification
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.twin import Twin


def ready() -> dict[str, Path]:
    """Name → file of each task that comes with the project."""
    return {path.stem: path for path in sorted(ontology.path("tasks").glob("*.ttl"))}


def specification_of(twin: Twin, source: str) -> Specification:
    """The specification in a file, or the ready one of that name.

    Raises:
        UnknownEntityError: No such file, and no ready task of that name.
        InputError: See `read_specification`.
    """
    path = ready().get(source, Path(source))
    if not path.is_file():
        raise UnknownEntityError("task", source, ready(), "or give the path of a .ttl file")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{source} cannot be read: {error}") from None
    return read_specification(twin, text, path.name)


def specification_from(twin: Twin, text: str) -> Specification:
    """The ready task of that name, or the one that the text writes in Turtle: no file is read for a stranger.

    Raises:
        InputError: It is neither; see `read_specification`.
    """
    if text in ready():
        return specification_of(twin, text)
    if not any(mark in text for mark in " \n\t<"):
        raise UnknownEntityError("task", text, ready(), "or write one in Turtle")
    return read_specification(twin, text, "the task")
