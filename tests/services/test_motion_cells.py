"""Cells of a motion's file are what they are written as: no text, truth value or record becomes a number."""

import io
import json
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.errors import MotionError
from services.motions import motion_of, read_motion
from services.motions.archive import arrays_in
from services.motions.columns import read_csv
from services.motions.given import LONGEST, MOST_ARRAYS, MOST_NAMES
from tests.small import small_twin

TWIN = small_twin("a", ("pr2",))
TAU = {"joint": "low_drawer_joint", "times": [0, 1, 2], "values": [0, 0.1, 0.1]}


def said_of(path: Path) -> str:
    with pytest.raises(MotionError) as told:
        read_motion(path, TWIN)
    return str(told.value)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"times": [0, True, 2]}, "'times' is 'True' at sample 1; allowed: real numbers"),
        ({"values": [[0], [0.1], [False]]}, "'values' is 'False' at sample 2; allowed: real numbers"),
        (
            {"times": [0, 1, "2_000"]},
            "'times' is '2_000' at sample 2; allowed: real numbers; write .* quotes",
        ),
        ({"times": ["0", "1", "2"]}, "'times' is '0' at sample 0; allowed: real numbers; write .* quotes"),
        ({"times": [0, 1, "２"]}, "'times' is '２' at sample 2"),
        ({"times": [0, 1, "2\0"]}, r"'times' is '2\\x00' at sample 2"),
        ({"times": [0, [1]]}, "'times' at sample 1 is a list; allowed: a value, as at sample 0"),
        ({"times": [[0], 1]}, "'times' at sample 1 is a value; allowed: a list, as at sample 0"),
        ({"joint": ["low_drawer_joint", True]}, "'joint' holds object"),
        ({"names": ["a", ["b"]]}, "'names' at index 1 is a list; allowed: a value, as at index 0"),
    ],
)
def test_cells_of_json_are_not_turned_into_numbers(
    tmp_path: Path, changed: dict[str, object], message: str
) -> None:
    path = tmp_path / "motion.json"
    path.write_text(json.dumps(TAU | changed), encoding="utf-8")
    assert re.search(message, said_of(path))


@pytest.mark.parametrize(
    ("times", "message"),
    [
        (np.array(["0", "1", "0_2"]), "'times' is '0' at sample 0; allowed: real numbers"),
        (np.array([b"0", b"1", b"2"]), "'times' is \"b'0'\" at sample 0; allowed: real numbers"),
        (np.zeros(3, dtype=[("t", "f8")]), "'times.npy' holds .*'t'.*, and arrays of numbers or texts"),
        (np.zeros(0, dtype=[("t", "f8")]), "'times.npy' holds"),
        (np.array([0, 1, np.finfo(np.longdouble).max]), "'times' is not a number at sample 2"),
    ],
)  # fmt: skip
def test_cells_of_npz_are_not_turned_into_numbers(tmp_path: Path, times: np.ndarray, message: str) -> None:
    path = tmp_path / "motion.npz"
    np.savez(path, **{name: np.asarray(value) for name, value in TAU.items()} | {"times": times})  # type: ignore[arg-type]
    assert re.search(message, said_of(path))


def packed(path: Path, members: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in members.items():
            file.writestr(name, content)
    return path


def header(kind: str, shape: tuple[int, ...]) -> bytes:
    out = io.BytesIO()
    np.lib.format.write_array_header_1_0(out, {"descr": kind, "fortran_order": False, "shape": shape})
    return out.getvalue()


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({"times.npy": b"", "times": b""}, "'times' is there twice"),
        ({"times": header("<f8", (0,))}, r"'times' is in it, whose name does not end in \.npy"),
        ({"times.npy": header("<U0", (10**9,))}, "'times.npy' has 1000000000 texts of no width"),
        ({"times.npy": header("|i1", (2**26 + 1,))}, "as numbers they would have 536870920 bytes, and"),
        ({f"{name}.npy": header("|S1", (2**25 + 1,)) for name in "ab"}, "as numbers they would have"),
        ({"a\nb.npy": b""}, r"there is the name 'a\\nb.npy'; allowed: names without control"),
    ],
)
def test_archives_are_refused_by_what_their_heads_say(
    tmp_path: Path, members: dict[str, bytes], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        arrays_in(packed(tmp_path / "a.npz", members))


LONG = "a" * (LONGEST + 1)
TOO_LONG = f"'{'a' * 40}…', of {LONGEST + 1} characters; allowed: names of up to {LONGEST}"


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"a\ncertified": [1]}, r"there is the name 'a\\ncertified'; allowed: names without control"),
        ({LONG: [1]}, TOO_LONG),
        ({"joint": LONG}, f"'joint' holds {TOO_LONG}"),
    ],
)
def test_names_are_told_in_one_line_and_shortened(
    tmp_path: Path, changed: dict[str, object], message: str
) -> None:
    (tmp_path / "motion.json").write_text(json.dumps(TAU | changed))
    assert re.search(message, said_of(tmp_path / "motion.json"))


def test_an_array_has_as_many_names_as_a_robot_may_have() -> None:
    names = np.arange(MOST_NAMES + 1).astype(np.str_)
    with pytest.raises(MotionError, match="'robot_joint_names' has 10001 names; allowed: up to 10000"):
        motion_of({"times": np.arange(3), "base": np.zeros((3, 3)), "robot_joint_names": names,
                   "robot_positions": np.zeros((3, 1))}, TWIN, TWIN.robots[0])  # fmt: skip


def test_a_motion_has_no_more_arrays_than_can_be_looked_through() -> None:
    arrays = {f"a{each}": np.zeros(1) for each in range(MOST_ARRAYS + 1)}
    with pytest.raises(MotionError, match="there are 1001 arrays; allowed: up to 1000"):
        motion_of(arrays, TWIN)


def test_many_names_are_looked_through_once(tmp_path: Path) -> None:
    many = [str(each) for each in range(100_000)]  # to look for each among all takes minutes
    (tmp_path / "motion.csv").write_text("time," + ",".join(f"j{each}" for each in many) + "\n")
    assert "it has no samples" in said_of(tmp_path / "motion.csv")
    (tmp_path / "motion.json").write_text(json.dumps({"times": [0, 1], "of": dict.fromkeys(many, 0)}))
    assert "the motion has times, of" in said_of(tmp_path / "motion.json")


@pytest.mark.parametrize(
    ("cell", "message"),
    [
        ('"0.1"5', "line 3 is no CSV: ',' expected after '\"'"),
        ('"0.1', "line 3 is no CSV: unexpected end of data"),
        ("1" * 200_000, "line 3 is no CSV: field larger than field limit"),
    ],
)
def test_a_line_that_is_no_csv_is_named(tmp_path: Path, cell: str, message: str) -> None:
    (tmp_path / "motion.csv").write_text(f"# joint: a\ntime,value\n0,{cell}\n")
    with pytest.raises(MotionError, match=message):
        read_csv(tmp_path / "motion.csv")
