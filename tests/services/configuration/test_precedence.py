"""Of every option of every command: a flag wins over the environment, the environment over the file."""

from itertools import cycle, islice
from pathlib import Path

import click
import pytest

from services.cli import sdt as root
from services.configuration.read import settings
from services.configuration.settle import default_map, options, variable

COMMANDS = [name for name, each in root.commands.items() if not isinstance(each, click.Group)]
NAMES = ("one", "two", "three")
NUMBERS = {"integer": int, "integer range": int, "float": float, "float range": float}


def three(option: click.Option, folder: Path) -> list[str]:
    """Values that the option takes, of which one follows the other: of the file, the environment, a flag."""
    kind = option.type
    if isinstance(kind, click.Choice):
        return list(islice(cycle(kind.choices), 3))
    if kind.name in NUMBERS:
        least = getattr(kind, "min", None) or 0
        most = getattr(kind, "max", None)
        step = min(0.01, (most or 1.0) / 4) if NUMBERS[kind.name] is float else 1
        return [str(least + k * step) for k in (1, 2, 3)]
    if isinstance(kind, click.Path):
        suffix = next(iter(getattr(kind, "suffixes", ())), "")
        return [
            str(folder / "files" / (name + suffix) if kind.file_okay else folder / name) for name in NAMES
        ]
    return [*NAMES]


def toml(option: click.Option, value: str) -> str:
    return value if option.type.name in NUMBERS else f'"{value}"'


def got(command: click.Command, option: click.Option, words: list[str], known: dict[str, object]) -> object:
    """What the command gets of that option."""
    seen: list[object] = []
    alone = click.Command(
        command.name, params=[option], callback=lambda **given: seen.append(given[str(option.name)])
    )
    alone.main(words, standalone_mode=False, default_map=known)
    return seen[0]


@pytest.mark.parametrize("name", COMMANDS)
def test_flag_over_environment_over_file(name: str, tmp_path: Path) -> None:
    for each in NAMES:
        (tmp_path / each).mkdir()
        (tmp_path / "files").mkdir(exist_ok=True)
        (tmp_path / "files" / each).touch()
    command, file = root.commands[name], tmp_path / "sdt.toml"
    for long, option in options(command):
        if option.is_flag or not option.expose_value:
            continue
        first, second, third = three(option, tmp_path)
        file.write_text(f"[{name}]\n{long} = {toml(option, first)}\n")
        environment = {variable(name, long): second}
        from_file = default_map(name, command, settings((name,), file, {}))
        from_both = default_map(name, command, settings((name,), file, environment))
        found = [
            got(command, option, words, known)
            for known in (from_file, from_both)
            for words in ([], [f"--{long}", third])
        ]
        asked = [got(command, option, [f"--{long}", each], {}) for each in (first, third, second, third)]
        assert found == asked, f"--{long}"


@pytest.mark.parametrize("name", COMMANDS)
def test_a_switch_is_set_by_the_file_and_taken_back_by_the_environment(name: str, tmp_path: Path) -> None:
    command, file = root.commands[name], tmp_path / "sdt.toml"
    for long, option in options(command):
        if not option.is_flag or not option.expose_value or option.secondary_opts:
            continue
        file.write_text(f"[{name}]\n{long} = true\n")
        off = {variable(name, long): "0"}
        assert got(command, option, [], default_map(name, command, settings((name,), file, {}))) is True, long
        known = default_map(name, command, settings((name,), file, off))
        assert got(command, option, [], known) is False, long
        assert got(command, option, [f"--{long}"], known) is True, long
