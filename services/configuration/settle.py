"""What a command's options are without flags, and who says so."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum

import click

from sdt_kg.errors import InputError, UnknownEntityError, meant
from services.configuration.read import VARIABLE, Settings, Value
from services.configuration.shared import SHARED

PREFIX = "SDT_"
OF_ALL = frozenset({VARIABLE, "SDT_TOKEN", "SDT_REFERENCE", "SDT_MODELS"})
"""Variables of no option: which file holds the settings, a secret, where test input and models lie."""


class Source(Enum):
    """Who says a value."""

    ENVIRONMENT = "environment"
    FILE = "file"
    DEFAULT = "default"


@dataclass(frozen=True, slots=True)
class Settled:
    """The value of an option without a flag.

    Attributes:
        option: Its long name.
        parameter: What the command calls it.
        value: As the file or variable says it; the default where neither does.
        source: Who says it.
        where: The variable, or the file with table and key.
    """

    option: str
    parameter: str
    value: object
    source: Source
    where: str


def options(command: click.Command) -> Iterator[tuple[str, click.Option]]:
    """Every long name of the command's options."""
    for parameter in command.params:
        if isinstance(parameter, click.Option):
            for name in parameter.opts:
                if name.startswith("--"):
                    yield name.removeprefix("--"), parameter


def settled(name: str, command: click.Command, said: Settings) -> list[Settled]:
    """Each option of the command, once.

    Raises:
        UnknownEntityError: The file's table for the command has a key that is no option of it.
        InputError: A value that the option does not take.
    """
    known = dict(options(command))
    for key in said.tables.get(name, {}):
        if key not in known:
            raise UnknownEntityError("setting", key, known, f"in {said.path}, [{name}]; sdt {name} --help")
    found: dict[str, Settled] = {}
    for option, parameter in known.items():
        here = _said(name, option, said)
        if here is None or parameter.name is None:
            continue
        value, source, where = here
        _check(value, parameter, where, command)
        before = found.get(parameter.name)
        if before is None or before.source is Source.FILE:
            found[parameter.name] = Settled(option, parameter.name, value, source, where)
    for option, parameter in known.items():
        if parameter.name is not None and parameter.name not in found:
            found[parameter.name] = Settled(
                option, parameter.name, _default(parameter), Source.DEFAULT, "default"
            )
    return list(found.values())


def default_map(name: str, command: click.Command, said: Settings) -> dict[str, object]:
    """What click takes where there is no flag.

    Raises:
        UnknownEntityError: A variable is of no option of the command, or nearly that of one.
        InputError: As `settled`.
    """
    if isinstance(command, click.Group) or not (said.path or _any(said)):
        return {}
    for each in misspelled({name: command}, said):
        known = _variables({name: command})
        raise UnknownEntityError("variable of a setting", each, known, f"sdt {name} --help")
    many = {parameter.name for _, parameter in options(command) if parameter.multiple}
    return {
        each.parameter: _listed(each.value) if each.parameter in many else each.value
        for each in settled(name, command, said)
        if each.source is not Source.DEFAULT
    }


def misspelled(asked: Mapping[str, click.Command], said: Settings) -> list[str]:
    """Variables that were meant for these commands and are of no option of theirs.

    They begin as those of such a command, or are nearly one; without them something else would be asked.
    Those of other commands are theirs, and those that are like none belong to other programs.
    """
    known = _variables(asked)
    own = tuple(f"{variable(name)}_" for name in asked)
    others = tuple(f"{variable(name)}_" for name in said.commands if name not in asked)
    bare = [each.removeprefix(PREFIX) for each in known]
    return sorted(
        name
        for name, value in said.environment.items()
        if name.startswith(PREFIX) and value and name not in known and not name.startswith(others)
        if name.startswith(own) or meant(name.removeprefix(PREFIX), bare)
    )


def _variables(commands: Mapping[str, click.Command]) -> set[str]:
    """Every variable that these commands read, and those that all may have."""
    own = {variable(name, option) for name, each in commands.items() for option, _ in options(each)}
    return own | {variable(name) for name in SHARED} | OF_ALL


def variable(*words: str) -> str:
    """`SDT_ACHIEVE_KITCHEN` of achieve and kitchen."""
    return PREFIX + "_".join(words).replace("-", "_").upper()


def _any(said: Settings) -> bool:
    return any(name.startswith(PREFIX) for name in said.environment)


def _said(name: str, option: str, said: Settings) -> tuple[Value, Source, str] | None:
    """What is said of an option: by the variables, the command's table, the top of the file."""
    shared = next((each for each in SHARED.values() if each.option == option and name in each.commands), None)
    variables = [variable(name, option), *([variable(shared.name)] if shared else [])]
    for each in variables:
        if said.environment.get(each):
            return said.environment[each], Source.ENVIRONMENT, each
    if option in said.tables.get(name, {}):
        return said.tables[name][option], Source.FILE, f"{said.path} [{name}] {option}"
    if shared and shared.name in said.shared:
        return said.shared[shared.name], Source.FILE, f"{said.path} {shared.name}"
    return None


def _check(value: Value, parameter: click.Option, where: str, command: click.Command) -> None:
    """The value is one that the option takes.

    Raises:
        InputError: It is not.
    """
    several = isinstance(value, list)
    if several and not parameter.multiple:
        raise InputError(f"{where}: a list", allowed="one value")
    # Python would take true for 1, and 1.5 for the integer 1.
    whole = parameter.type.name.startswith("integer")
    if (isinstance(value, bool) and not parameter.is_flag) or (isinstance(value, float) and whole):
        raise InputError(f"{where}: {str(value).lower()}", allowed=f"{parameter.type.name}: {parameter.help}")
    context = click.Context(command, info_name=command.name)
    for each in _listed(value):
        try:
            parameter.type.convert(each, parameter, context)
        except click.BadParameter as error:
            raise InputError(f"{where}: {error.message.rstrip('.')}", remedy="sdt config schema") from None


def _listed(value: object) -> list[object]:
    return value if isinstance(value, list) else [value]


def _default(parameter: click.Option) -> object:
    value = parameter.to_info_dict()["default"]
    return None if callable(value) or value == () else value
