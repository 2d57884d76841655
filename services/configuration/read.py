"""Which file holds the settings, and what it says."""

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError, UnknownEntityError
from services.configuration.shared import SHARED

VARIABLE: Final = "SDT_CONFIG"
LOCAL: Final = Path("sdt.toml")

Value = str | int | float | bool | list[str | int | float]
Table = Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Settings:
    """What a file says, and what the environment says over it.

    Attributes:
        path: The file; None where there is none.
        shared: Its keys at the top.
        tables: Its tables, by command.
        environment: Variables of the process.
        commands: Names that a table, and variables, may have.
    """

    path: Path | None = None
    shared: Table = field(default_factory=dict)
    tables: Mapping[str, Table] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)
    commands: tuple[str, ...] = ()


def places(given: Path | None, environment: Mapping[str, str]) -> list[Path]:
    """Where settings are looked for; the first file that is there is the only one that is read."""
    if given is not None:
        return [given]
    if environment.get(VARIABLE):
        return [Path(environment[VARIABLE])]
    home = environment.get("XDG_CONFIG_HOME") or Path(environment.get("HOME") or "~").expanduser() / ".config"
    return [LOCAL, Path(home) / "sdt" / "config.toml"]


def settings(
    commands: tuple[str, ...], given: Path | None = None, environment: Mapping[str, str] | None = None
) -> Settings:
    """The settings of this process.

    Args:
        commands: Names that a table, and variables, may have.
        given: The file of `--config`.
        environment: Variables; by default those of the process.

    Raises:
        InputError: The file is not there, is not TOML, or holds what is no setting.
        UnknownEntityError: A key or table that there is not.
    """
    environment = os.environ if environment is None else environment
    found = places(given, environment)
    named = len(found) == 1
    for path in found:
        if named or path.is_file():
            return _parsed(path, commands, environment)
    return Settings(environment=environment, commands=commands)


def _parsed(path: Path, commands: tuple[str, ...], environment: Mapping[str, str]) -> Settings:
    check_ends(path)
    try:
        said = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise InputError(
            f"cannot read the settings in {path}: {error.strerror}", allowed="a TOML file"
        ) from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{path} is not TOML: {error}", remedy="sdt config init writes an example") from None
    shared = {key: value for key, value in said.items() if not isinstance(value, dict)}
    tables = {key: value for key, value in said.items() if isinstance(value, dict)}
    for key in shared:
        if key not in SHARED:
            raise UnknownEntityError("setting", key, (*SHARED, *commands), f"in {path}; sdt config schema")
    for name in tables:
        if name not in commands:
            raise UnknownEntityError("command", name, commands, f"in {path}, as [{name}]; sdt config schema")
    return Settings(path, shared, tables, environment, commands)
