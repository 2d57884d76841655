"""Numbers are plain: what Python alone reads as one, 0_1 as 1, is refused in what is typed and in files."""

from pathlib import Path

import click
import pytest

from predicates.specification.read import read_specification
from sdt_kg.errors import InputError
from sdt_kg.load import load_twin
from sdt_kg.numbers import number_in
from services.cli import sdt as cli
from services.configuration.settle import options
from services.edits import numbers_of
from services.motions.columns import read_csv
from services.requests import parse_base, parse_state
from services.tracks.text import read_text

PYTHONS = ("0_1", "０.１", "0.١")
TASK = """@prefix law: <https://example.org/law#> .
<a:task> a law:TaskSpecification ; law:hasStep <a:step> .
<a:step> a law:Task ; law:index 1 ; law:verb law:Open ;
  law:containerName "iai_fridge_door" ; law:goalPosition "{}" ."""


@pytest.mark.parametrize("text", PYTHONS)
def test_what_python_alone_reads_as_a_number_is_none(text: str, tmp_path: Path) -> None:
    twin, table = load_twin("b"), tmp_path / "table.csv"
    with pytest.raises(InputError):
        parse_base(f"{text},0,0")
    with pytest.raises(InputError):
        parse_state(twin, [f"iai_fridge_door={text}"])
    with pytest.raises(InputError):
        numbers_of(text, (1,), "mass")
    with pytest.raises(InputError):
        read_specification(twin, TASK.format(text), "task")
    table.write_text(f"t,x,y,z\n1,{text},0,0\n", encoding="utf-8")
    with pytest.raises(InputError, match="no number"):
        read_text(table)
    table.write_text(f"# joint: a\ntime,value\n0,0\n1,{text}\n", encoding="utf-8")
    with pytest.raises(InputError, match="no number"):
        read_csv(table)


def test_plain_numbers_are_read() -> None:
    assert [number_in(text) for text in ("0.1", " -1e-3 ", "+2")] == [0.1, -1e-3, 2.0]


@pytest.mark.parametrize("option", ["--seed", "--budget", "--jobs"])
def test_options_too_take_plain_numbers_only(sdt, option: str) -> None:
    done = sdt("table", "--kitchens", "b", "--robots", "pr2", option, "1_0")
    assert (done.code, done.out) == (2, "")
    assert "'1_0' is no number" in done.err


def test_seeds_of_a_sweep_are_plain_numbers(sdt) -> None:
    assert (
        "'1_0' is no seed"
        in sdt("sweep", "--kitchens", "b", "--robots", "pr2", "--seeds", "1_0", "--plan").err
    )


def test_more_seeds_than_a_sweep_can_plan_are_refused(sdt) -> None:
    asked = ("sweep", "--kitchens", "b", "--robots", "pr2", "--plan", "--seeds")
    assert "the seeds 0..99999999999 are too many; allowed: up to" in sdt(*asked, "0..99999999999").err
    assert sdt(*asked, "0..9").out == "170 cases, 0 of them stored\n"


def test_every_option_that_takes_a_number_takes_plain_ones() -> None:
    kinds = {type(each.type) for name in cli.commands for _, each in options(cli.commands[name])}
    assert not kinds & {click.IntRange, click.FloatRange, type(click.INT), type(click.FLOAT)}
