"""Changes that somebody elsewhere asks for: they read no file but those that a service was started with."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.load import bundled_names
from services.whatif.change import KINDS, Change, parse_change

READS_FILE: Final = "mesh"
"""The kind of edit that names a file by itself."""
HERE: Final = {kind: said for kind, said in KINDS.items() if kind != READS_FILE}
"""Kind → how it is written, of those that read none."""


def named_change(text: str, models: Mapping[str, Mapping[str, str]]) -> Change:
    """The change that a text means, if it reads no file that only the text names.

    Args:
        text: As `sdt whatif --edit` takes it.
        models: Of `kitchen` and `robot` each: name → bundled name or path that is loaded under it.

    Raises:
        InputError: It is none, or names a file, or another model than those loaded and the bundled ones.
    """
    kind, _, rest = text.partition(":")
    if kind == READS_FILE:
        raise InputError(
            f"'{text}' names a file: edits that are asked from elsewhere read none",
            allowed="obstacles that are boxes (box:), models that are loaded or bundled",
            remedy="sdt whatif, on the machine that has the file, takes meshes",
        )
    if kind not in models:
        return parse_change(text)
    names = {**{each: each for each in bundled_names(kind)}, **models[kind]}
    if rest not in names:
        remedy = f"one of these; what the service is started with (--{kind} PATH) is loaded"
        raise UnknownEntityError(kind, rest, names, remedy)
    return replace(parse_change(f"{kind}:{names[rest]}"), text=text)
