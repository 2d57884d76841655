"""A kitchen's joint with limits like [-1.5, 0] counts the other way here: who gives or gets one is told."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.load import bundled
from tests.services.conftest import Done

DOOR = "iai_fridge_door_joint"
SMOOTH = 1.45 * (1 - np.cos(np.linspace(0, np.pi, 41))) / 2
TOLD = r"limits \[-1.5708, 0\]: axis turned, so that positions are \[0, 1.5708\] and count the other way"


@pytest.fixture
def kitchen(tmp_path: Path) -> str:
    """Kitchen b with the fridge's joint the other way round: the same door, its positions negative."""
    text = bundled("kitchen", "b").read_text(encoding="utf-8")
    head, joint, rest = re.split(f'(<joint name="{DOOR}".*?</joint>)', text, maxsplit=1, flags=re.DOTALL)
    joint = joint.replace('xyz="0 0 1"', 'xyz="0 0 -1"')
    joint = joint.replace('lower="0" upper="1.57079632679"', 'lower="-1.57079632679" upper="0"')
    path = tmp_path / "flip.urdf"
    path.write_text(head + joint + rest, encoding="utf-8")
    return str(path)


def tau(folder: Path, sign: float, name: str = "tau.json") -> str:
    path, times = folder / name, np.linspace(0.0, 6.0, 41).tolist()
    if path.suffix == ".csv":
        rows = "\n".join(f"{t},{sign * q}" for t, q in zip(times, SMOOTH.tolist(), strict=True))
        path.write_text(f"# joint: {DOOR}\ntime,value\n{rows}\n", encoding="utf-8")
    else:
        arrays = {"joint": DOOR, "times": times, "values": (sign * SMOOTH).tolist()}
        path.write_text(json.dumps(arrays), encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("name", ["tau.json", "tau.csv"])
def test_a_motion_in_the_signs_of_the_file_is_told_so(
    kitchen: str, tmp_path: Path, sdt: Callable[..., Done], name: str
) -> None:
    done = sdt("causes", kitchen, "--task", "open:iai_fridge_door", "--motion", tau(tmp_path, -1.0, name))
    assert done.code == 2
    assert re.search(rf"'values' of {DOOR} at \w+ \d+ is -1.45, as its file counts: {TOLD}", done.err)
    assert "give its positions and velocities the other sign" in done.err


def test_a_motion_in_our_signs_opens_and_the_answer_says_how_they_count(
    kitchen: str, tmp_path: Path, sdt: Callable[..., Done]
) -> None:
    words = "--task", "open:iai_fridge_door", "--motion", tau(tmp_path, 1.0), "--json"
    (row,) = sdt("causes", kitchen, *words).json
    assert row["outcome"] == "causes"
    assert any(re.fullmatch(f"{DOOR} has in its file {TOLD}", note) for note in row["notes"])
    (row,) = sdt("causes", "b", *words).json
    assert not any("turned" in note for note in row["notes"])


@pytest.mark.parametrize(
    "words",
    [
        ("satisfies", "KITCHEN", "--state", "iai_fridge_door=-1.2"),
        ("branch", "KITCHEN", f"move:{DOOR}=-1.2"),
    ],
)
def test_a_state_in_the_signs_of_the_file_is_told_so(
    kitchen: str, sdt: Callable[..., Done], words: tuple[str, ...]
) -> None:
    done = sdt(*(kitchen if word == "KITCHEN" else word for word in words))
    assert done.code == 2
    assert re.search(
        rf"-1.2 rad is outside its limits; allowed: 0 to 1.5708 rad; in its file it has {TOLD}", done.err
    )


def test_how_it_counts_is_in_the_twin(kitchen: str, sdt: Callable[..., Done]) -> None:
    asked = f'SELECT ?note {{ ?j rdfs:label "{DOOR}" ; sdt:hasNote/rdfs:comment ?note }}'
    done = sdt("query", kitchen, asked)
    assert re.search(TOLD, done.out)
