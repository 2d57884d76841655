"""Flags over environment over file, and every word in the file checked."""

import json
from collections.abc import Callable
from pathlib import Path

import click
import pytest

from sdt_kg.errors import InputError, UnknownEntityError
from services.cli import sdt as root
from services.commands.law.table import table
from services.configuration.read import places, settings
from services.configuration.schema import schema
from services.configuration.settle import Settled, default_map, options, settled
from services.configuration.shared import SHARED
from tests.services.conftest import Done

COMMANDS = ("achieve", "table", "serve")
FILE = 'seed = 1\ndrive = "omni"\n[table]\nseed = 2\nrobots = "pr2"\n[serve]\nkitchen = ["a", "b"]\n'


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "sdt.toml"
    path.write_text(FILE)
    return path


def of_table(file: Path, **environment: str) -> dict[str, Settled]:
    return {each.option: each for each in settled("table", table, settings(COMMANDS, file, environment))}


def test_the_table_of_a_command_wins_over_the_top_of_the_file(file: Path) -> None:
    found = of_table(file)
    assert (found["seed"].value, found["seed"].where) == (2, f"{file} [table] seed")
    assert (found["drive"].value, found["drive"].where) == ("omni", f"{file} drive")
    assert found["task"].where == "default"


def test_the_environment_wins_over_the_file_and_a_command_s_own_over_the_shared(file: Path) -> None:
    assert of_table(file, SDT_SEED="7")["seed"].where == "SDT_SEED"
    assert of_table(file, SDT_SEED="7", SDT_TABLE_SEED="8")["seed"].value == "8"
    assert of_table(file, SDT_SEED="")["seed"].value == 2


def test_a_flag_wins_over_all(file: Path) -> None:
    said = settings(COMMANDS, file, {"SDT_SEED": "7"})
    seen: list[int] = []
    command = click.Command("table", params=table.params, callback=lambda **given: seen.append(given["seed"]))
    for arguments in ([], ["--seed", "9"]):
        command.main(arguments, standalone_mode=False, default_map=default_map("table", table, said))
    assert seen == [7, 9]


@pytest.mark.parametrize("name", ["SDT_SED", "SDT_TABLE_SED", "SDT_DRIV", "SDT_TABLE_ROBOT"])
def test_a_variable_that_is_misspelled_is_told(name: str) -> None:
    said = settings(COMMANDS, Path("/dev/null"), {name: "7"})
    with pytest.raises(UnknownEntityError, match=f"no variable of a setting named '{name}'; did you mean"):
        default_map("table", table, said)


@pytest.mark.parametrize("name", ["SDT_SERVE_STATE", "SDT_KITCHEN", "SDT_HOME", "SDT_TOKEN", "SEED"])
def test_a_variable_of_another_command_or_program_is_passed_over(name: str) -> None:
    said = settings(COMMANDS, Path("/dev/null"), {name: "7", "SDT_SEED": "8", "SDT_SED": ""})
    assert default_map("table", table, said) == {"seed": "8"}


BAD = {
    "unknown setting": ("bugdet = 1", UnknownEntityError, "budget"),
    "unknown command": ("[tabel]\nseed = 1", UnknownEntityError, "table"),
    "unknown option": ("[table]\nkitchns = 'a'", UnknownEntityError, "kitchens"),
    "no TOML": ("seed = ", InputError, "sdt config init"),
    "no number": ("seed = 'x'", InputError, "seed"),
    "truth for a number": ("seed = true", InputError, "integer"),
    "fraction for an integer": ("seed = 1.5", InputError, "1.5"),
    "out of range": ("[table]\njobs = 0", InputError, "jobs"),
    "not one of them": ("drive = 'wheels'", InputError, "omni"),
    "list for one": ("[table]\nkitchens = ['a', 'b']", InputError, "one value"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_in_the_file_is_named(tmp_path: Path, name: str) -> None:
    text, error, fragment = BAD[name]
    path = tmp_path / "bad.toml"
    path.write_text(text)
    with pytest.raises(error, match=fragment) as caught:
        settled("table", table, settings(COMMANDS, path, {}))
    assert str(path) in str(caught.value)


def test_one_file_is_read_the_first_that_is_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home = tmp_path / "home" / "sdt" / "config.toml"
    home.parent.mkdir(parents=True)
    home.write_text("seed = 5")
    monkeypatch.chdir(tmp_path)
    environment = {"XDG_CONFIG_HOME": str(tmp_path / "home")}
    assert settings(COMMANDS, None, environment).shared == {"seed": 5}
    (tmp_path / "sdt.toml").write_text("seed = 6")
    assert settings(COMMANDS, None, environment).shared == {"seed": 6}
    assert settings(COMMANDS, None, {**environment, "SDT_CONFIG": str(home)}).shared == {"seed": 5}
    assert places(tmp_path / "x", {**environment, "SDT_CONFIG": "y"}) == [tmp_path / "x"]
    with pytest.raises(InputError, match=r"gone\.toml"):
        settings(COMMANDS, None, {"SDT_CONFIG": "gone.toml"})


@pytest.fixture(scope="module")
def commands() -> dict[str, click.Command]:
    return {name: each for name, each in root.commands.items() if not isinstance(each, click.Group)}


@pytest.mark.parametrize("name", SHARED)
def test_a_shared_setting_is_an_option_of_each_of_its_commands(
    name: str, commands: dict[str, click.Command]
) -> None:
    shared = SHARED[name]
    assert [each for each in shared.commands if shared.option not in dict(options(commands[each]))] == []


def test_the_schema_has_every_option_and_nothing_else(commands: dict[str, click.Command]) -> None:
    properties = json.loads(json.dumps(schema(commands)))["properties"]
    assert set(properties) == set(SHARED) | set(commands)
    assert properties["table"]["properties"]["jobs"]["minimum"] == 1
    assert properties["serve"]["properties"]["kitchen"]["anyOf"][1]["type"] == "array"
    assert properties["drive"]["enum"] == ["omni", "differential", "fixed"]


def test_show_says_where_each_value_comes_from(
    sdt: Callable[..., Done], file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SDT_ACHIEVE_BUDGET", "3")
    done = sdt("--config", str(file), "config", "show", "--json")
    rows = {(each["command"], each["setting"]): each["from"] for each in done.json}
    assert rows["achieve", "budget"] == "SDT_ACHIEVE_BUDGET"
    assert rows["achieve", "seed"] == f"{file} seed"
    assert ("achieve", "json") not in rows


def test_a_file_to_start_from_is_a_file_of_settings(sdt: Callable[..., Done], tmp_path: Path) -> None:
    path = tmp_path / "new.toml"
    assert sdt("config", "init", "-o", str(path)).code == 0
    lines = [
        line.removeprefix("# ") for line in path.read_text().splitlines() if " = " in line or "# [" in line
    ]
    path.write_text("\n".join(lines))
    said = settings(COMMANDS, path, {})
    assert (set(said.shared), set(said.tables)) == (set(SHARED), {"serve"})
    assert sdt("config", "init", "-o", str(path)).code == 2
