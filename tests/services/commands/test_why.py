"""`sdt why` on saved verdicts."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.services.conftest import Done

SMALL = Path(__file__).resolve().parents[2] / "small"


@pytest.fixture
def saved(sdt: Callable[..., Done], tmp_path: Path) -> Path:
    """An abstention and a table of nothing else."""
    file = tmp_path / "saved.trig"
    done = sdt(
        "achieve",
        "--kitchen",
        str(SMALL / "a.urdf"),
        "--robot",
        str(SMALL / "stretch.urdf"),
        "--task",
        "open:swing_door",
        "--save",
        str(file),
    )
    assert done.code == 3
    return file


def test_one_saved_verdict_is_told(sdt: Callable[..., Done], saved: Path) -> None:
    done = sdt("why", str(saved))
    assert done.code == 0
    assert done.out.startswith("Can stretch open swing_door in kitchen a? ABSTAINED")
    iri = done.out.strip().splitlines()[-1]
    assert sdt("why", iri, "--store", str(saved)).out == done.out
    assert "--store STORE" not in done.out
    assert [part["title"] for part in sdt("why", str(saved), "--json").json][1:3] == ["Asked", "Answers"]


def test_several_are_listed(sdt: Callable[..., Done], saved: Path) -> None:
    small = [str(SMALL / name) for name in ("a.urdf", "stretch.urdf")]
    sdt(
        "achieve",
        "--kitchen",
        small[0],
        "--robot",
        small[1],
        "--task",
        "close:swing_door",
        "--save",
        str(saved),
    )
    rows = sdt("why", str(saved), "--json").json
    assert {row["question"] for row in rows} == {
        "Can stretch open swing_door in kitchen a?",
        "Can stretch close swing_door in kitchen a?",
    }
    assert sdt("why", rows[0]["verdict"], "--store", str(saved)).code == 0


def test_the_same_question_in_two_worlds_is_told_apart(sdt: Callable[..., Done], saved: Path) -> None:
    robot = ("--robot", str(SMALL / "stretch.urdf"))
    asked = ("achieve", "--kitchen", str(SMALL / "a.urdf"), *robot, "--task", "open:swing_door")
    sdt(*asked, "--state", "low_drawer=0.2", "--drive", "fixed", "--save", str(saved))
    rows = sdt("why", str(saved), "--json").json
    assert {row["question"] for row in rows} == {"Can stretch open swing_door in kitchen a?"}
    assert sorted((row["drive"], row["state"]) for row in rows) == [
        ("fixed", "low_drawer_joint at 0.2"),
        ("omni", ""),
    ]


def test_of_one_question_what_else_it_was_asked_with_tells_verdicts_apart(
    sdt: Callable[..., Done], saved: Path
) -> None:
    models = ("--kitchen", str(SMALL / "a.urdf"), "--robot", str(SMALL / "stretch.urdf"))
    again = (*models, "--task", "open:swing_door", "--save", str(saved))
    sdt("achieve", *again, "--friction", "0.4")
    motion = saved.parent / "swing.json"
    motion.write_text('{"joint": "swing_door_joint", "times": [0, 4, 8], "values": [0, 0.5, 1]}')
    assert sdt("achieve", *again, "--motion", str(motion)).code == 3
    bare, friction, given = sorted(row["options"] for row in sdt("why", str(saved), "--json").json)
    assert (bare, friction) == ("", "--friction 0.4")
    assert re.fullmatch(r"--motion FILE \([0-9a-f]{12}\)", given)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("b",), "no file or store of verdicts"),
        (("{folder}/none.trig",), "no file or store at"),
        (("{folder}/broken.trig",), "not valid RDF"),
        (("{folder}/empty.trig",), "no verdict in it"),
        (("0000", "--store", "{folder}/saved.trig"), "no verdict named"),
    ],
)
def test_nonsense_is_refused(
    sdt: Callable[..., Done], saved: Path, arguments: tuple[str, ...], said: str
) -> None:
    folder = saved.parent
    (folder / "broken.trig").write_text("{")
    (folder / "empty.trig").write_text("")
    done = sdt("why", *(each.format(folder=folder) for each in arguments))
    assert done.code == 2
    assert said in done.err
    assert "Traceback" not in done.err
