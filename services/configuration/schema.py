"""The schema of the file, made from the commands themselves, so that it cannot fall behind them."""

from collections.abc import Mapping

import click

from services.configuration.settle import options
from services.configuration.shared import SHARED

DIALECT = "https://json-schema.org/draft/2020-12/schema"

Json = dict[str, object]


def schema(commands: Mapping[str, click.Command]) -> Json:
    """JSON Schema of the file as editors and validators of TOML read it.

    Args:
        commands: Those that can have a table, by name.
    """
    properties: Json = {}
    for each in SHARED.values():
        of = next(commands[name] for name in each.commands if name in commands)
        comment = f"{each.comment}; for sdt {', '.join(each.commands)}"
        properties[each.name] = {**_option(dict(options(of))[each.option]), "description": comment}
    for name, command in commands.items():
        keys = {option: _option(parameter) for option, parameter in options(command)}
        properties[name] = {"type": "object", "additionalProperties": False, "properties": keys}
    return {
        "$schema": DIALECT,
        "title": "Settings of sdt",
        "type": "object",
        "additionalProperties": False,
        "properties": properties,
    }


def _option(parameter: click.Option) -> Json:
    """What one option takes."""
    single = _type(parameter)
    kind = {"anyOf": [single, {"type": "array", "items": single}]} if parameter.multiple else single
    return {**kind, **({"description": parameter.help} if parameter.help else {})}


def _type(parameter: click.Option) -> Json:
    kind = parameter.type
    if parameter.is_flag:
        return {"type": "boolean"}
    if isinstance(kind, click.Choice):
        return {"enum": list(kind.choices)}
    if isinstance(kind, click.IntRange | click.FloatRange):
        lower = {"exclusiveMinimum" if kind.min_open else "minimum": kind.min} if kind.min is not None else {}
        upper = {"exclusiveMaximum" if kind.max_open else "maximum": kind.max} if kind.max is not None else {}
        return {"type": "integer" if isinstance(kind, click.IntRange) else "number", **lower, **upper}
    return {"type": {"integer": "integer", "float": "number"}.get(kind.name, "string")}
