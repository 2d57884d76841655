"""Every numbered example runs, and says what its page promises."""

import re
import runpy
from pathlib import Path

import pytest

import services

FOLDER = Path(str(services.__file__)).parent / "examples"
SCRIPTS = sorted(FOLDER.glob("*.py"))
LONGEST = 60
"""[lines] Of an example, so that it is read."""
LONGER = {"12_verify_and_repair"}
"""The loop of an agent, with its three repairs."""

SAYS = {
    "01_hello_world": [r"^certified$", r"can_perform: True", r"tool slip: \S+ m", r"verdict/[0-9a-f]{64}"],
    "02_read_a_refusal": [
        r"^not_certified$",
        r"  proved",
        r"causal: nothing to cause",
        r"runs into cabinet7",
    ],
    "03_verify_a_motion": [r"as it is: certified", r"twice as fast: not_certified", r"reaches velocity"],
    "04_ask_the_graph": [
        r"ajar meets \[\]",
        r"wide meets \['open:iai_fridge_door'\]",
        r"open from 1\.4137 rad",
    ],
    "05_learn_from_a_track": [r"revolute axis", r"radius 0\.400 m", r"drawer_main \['sink_area_left_middle"],
    "06_what_if": [
        r"shorter drawer: certified stays",
        r"from elsewhere: \w+ turned",
        r"canPerform: True -> False",
    ],
    "07_keep_and_recheck": [r"stored before: True", r"holds open sink_area_left_middle_drawer_main"],
    "08_over_the_bus": [r"17 requests are met", r"\['door'\] 3", r"causes: \[True\]"],
    "09_an_oracle_of_your_own": [r"0\.3 m: not_certified .* above 0\.3 m", r"2\.0 m: certified"],
    "10_a_physics_of_your_own": [r"0\.20 rad, closed: False", r"falls shut .* 0\.00 rad, closed: True"],
    "11_a_class_of_your_own": [
        r"fridge_door: abstain .* > 0\.5",
        r"trash_drawer_main: inside",
        r"nothing to look at",
    ],
}


SLOWER = ("03_verify_a_motion", "06_what_if", "08_over_the_bus")
"""Run by tests/soak, since what they use is tested elsewhere at length."""


@pytest.mark.oracle
@pytest.mark.parametrize("name", [name for name in SAYS if name not in SLOWER])
def test_an_example_runs_and_says_what_it_promises(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    keeps_its_promise(name, capsys)


def keeps_its_promise(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The example runs, and everything that it promises is in what it says."""
    runpy.run_path(str(FOLDER / f"{name}.py"), run_name="__main__")
    out = capsys.readouterr().out
    assert [each for each in SAYS[name] if not re.search(each, out, re.MULTILINE)] == [], out


def test_examples_are_numbered_without_gap_short_and_all_run() -> None:
    assert [int(each.name[:2]) for each in SCRIPTS] == list(range(1, len(SCRIPTS) + 1))
    assert {each.stem for each in SCRIPTS} == {*SAYS, *LONGER}
    lines = {each.stem: len(each.read_text(encoding="utf-8").splitlines()) for each in SCRIPTS}
    assert {name for name, count in lines.items() if count > LONGEST} == LONGER
