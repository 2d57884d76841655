"""`sdt config`: the settings that hold here, and where each comes from."""

from pathlib import Path

import click

from sdt_kg.errors import InputError, UnknownEntityError
from services.commands.options import OutFile, csv_flag, json_flag
from services.commands.show import print_json, print_rows
from services.configuration.read import LOCAL, Settings, places
from services.configuration.schema import schema
from services.configuration.settle import Settled, Source, misspelled, settled
from services.configuration.shared import SHARED
from services.store.output import write_file

COLUMNS = ("command", "setting", "value", "from")
ORDER = (
    "Flags win over the environment, the environment over the file, the file over defaults.\n"
    "Variables are SDT_SETTING for the settings that commands share, SDT_COMMAND_OPTION for one command;\n"
    "one that is misspelled is refused.\n"
    "The file is that of --config, else of SDT_CONFIG, else ./sdt.toml, else config.toml in sdt/ of\n"
    "XDG_CONFIG_HOME (~/.config); one file is read. Paths in it are meant from where sdt runs.\n"
    "SDT_CONFIG=/dev/null: no settings."
)


@click.group(epilog=f"\b\n{ORDER}")
def config() -> None:
    """Settings that are not typed each time: one TOML file, and variables of the environment."""


def commands_of(context: click.Context) -> dict[str, click.Command]:
    """Every command that can have a table, imported."""
    root = context.find_root().command
    assert isinstance(root, click.Group)
    return {name: each for name, each in root.commands.items() if not isinstance(each, click.Group)}


@config.command()
@click.argument("command", required=False)
@csv_flag
@json_flag
@click.pass_context
def show(context: click.Context, command: str | None, *, as_json: bool) -> None:
    """What is set, and by whom; with COMMAND, every option of it. The whole file is checked."""
    said, commands = context.find_object(Settings), commands_of(context)
    assert said is not None
    if command is not None and command not in commands:
        raise UnknownEntityError("command", command, commands)
    found = {name: settled(name, each, said) for name, each in commands.items()}
    chosen = [command] if command else list(found)
    rows = [
        _row(name, each)
        for name in chosen
        for each in found[name]
        if command or each.source is not Source.DEFAULT
    ]
    print_rows(rows, COLUMNS, as_json=as_json)
    for name in misspelled(commands, said):
        click.echo(f"note: {name} is no variable of a setting", err=True)
    if not rows:
        click.echo("nothing is set; sdt config init writes an example", err=True)


def _row(command: str, each: Settled) -> dict[str, object]:
    value = ", ".join(map(str, each.value)) if isinstance(each.value, list) else each.value
    return {"command": command, "setting": each.option, "value": value, "from": each.where}


@config.command("schema")
@click.pass_context
def schema_command(context: click.Context) -> None:
    """Print the JSON Schema of the file, for editors that complete and check TOML."""
    print_json(schema(commands_of(context)))


@config.command()
@csv_flag
@json_flag
@click.pass_context
def path(context: click.Context, *, as_json: bool) -> None:
    """Where settings are looked for, and which file is read."""
    said = context.find_object(Settings)
    assert said is not None
    looked = [said.path] if said.path else places(None, said.environment)
    rows = [
        {"path": str(each), "there": each.exists(), "read": each == said.path}
        for each in dict.fromkeys((*looked, *places(None, said.environment)))
    ]
    print_rows(rows, ("path", "there", "read"), as_json=as_json)


@config.command()
@click.option("-o", "--output", type=OutFile(), default=LOCAL, show_default=True, help="Where to.")
@click.option("--force", is_flag=True, help="Overwrite the file if it is there.")
def init(output: Path, *, force: bool) -> None:
    """Write a file to start from: every setting that commands share, commented out."""
    if output.exists() and not force:
        raise InputError(f"{output} exists", allowed="a file that is not there yet", remedy="--force")
    write_file(output, template())
    click.echo(f"{output}: take the # from what you want; sdt config show says what holds")


def template() -> str:
    """The file to start from."""
    lines = ["# Settings of sdt. Flags win over variables (SDT_...), variables over this file.", ""]
    for each in SHARED.values():
        lines += [
            f"# {each.comment}; for sdt {', '.join(each.commands)}",
            f"# {each.name} = {each.example}",
            "",
        ]
    lines += [
        "# One command's own settings, by the long names of its options (sdt COMMAND --help):",
        "# [serve]",
        '# http = "127.0.0.1:8080"',
        '# kitchen = ["a", "b"]',
    ]
    return "\n".join(lines) + "\n"
