"""A certificate whose hash is right, and which is none all the same, is refused in words."""

import zlib
from collections.abc import Callable
from pathlib import Path

import pytest

from predicates.case import Case
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify.certificate import said_in, sealed
from services.embodiment.oracle import WholeBody
from services.embodiment.recheck import Rechecked, recheck_artefact
from services.physics.oracle import Kinematics
from tests.services.conftest import Done
from tests.services.embodiment.gantry import START, gantry_twin, opening

pytestmark = pytest.mark.oracle

Kept = tuple[Twin, bytes]


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    """A twin, and a certificate about it."""
    twin = gantry_twin(tmp_path_factory.mktemp("damaged"))
    task = Task(Verb.OPEN, twin.container("drawer_main").iri)
    case = Case(twin, twin.robots[0], task, body_motion=opening())
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is not None
    return twin, verdict.can_perform.artefact.content


def with_part(kept: Kept, place: tuple[str | int, ...], value: object) -> Rechecked:
    """Recheck of the certificate with another value at a place of its JSON."""
    twin, content = kept
    said = whole = said_in(content)
    for key in place[:-1]:
        said = said[key]
    said[place[-1]] = value
    return recheck_artefact("damaged", sealed(whole), lambda *_: (twin, "given"))


@pytest.mark.parametrize("part", ["state", "tolerances", "figures"])
@pytest.mark.parametrize("value", [None, [], 5])
def test_a_part_that_is_no_object_is_told(kept: Kept, part: str, value: object) -> None:
    found = with_part(kept, (part,), value)
    assert "the certificate lacks a part, or has one of the wrong kind" in found.reasons[0]


@pytest.mark.parametrize("value", ["nan", "0.5", float("1e400"), True])
@pytest.mark.parametrize("place", [("start", 0), ("start", 2), ("figures", "distance queries, self", 0)])
def test_what_is_no_number_is_no_start_that_any_motion_would_have(
    kept: Kept, place: tuple[str | int, ...], value: object
) -> None:
    assert not with_part(kept, place, value).holds


@pytest.mark.parametrize(
    ("part", "shape"), [("kitchen_q", 1), ("kitchen_v", 1), ("q", 1), ("base", 1), ("times", 0)]
)
def test_arrays_that_do_not_fit_each_other_are_told(kept: Kept, part: str, shape: int) -> None:
    motion = said_in(kept[1])["motion"]
    rows = motion["times"]["shape"][0]
    size = motion[part]["shape"][-1] if shape else 1
    found = with_part(kept, ("motion", part, "shape"), [rows * size] if shape else [1, rows])
    assert len(found.reasons) == 1
    assert "motion" in found.reasons[0]


def test_a_joint_of_the_kitchen_without_a_column_is_told(kept: Kept) -> None:
    joints = said_in(kept[1])["motion"]["kitchen_joints"]
    found = with_part(kept, ("motion", "kitchen_joints"), ["another", *joints])
    assert "kitchen_q of a body motion has shape" in found.reasons[0]


@pytest.mark.parametrize("name", ["\ud800", "left\x1b[2J", 5, None])
@pytest.mark.parametrize(
    "place", [("container",), ("robot", 0), ("motion", "gripper"), ("motion", "joints", 0)]
)
def test_what_no_model_is_called_is_no_name(kept: Kept, place: tuple[str | int, ...], name: object) -> None:
    found = with_part(kept, place, name)
    assert found.reasons[0].startswith("the certificate lacks a part, or has one of the wrong kind")
    assert found.reasons[0].isprintable()


@pytest.mark.parametrize("start", [-1, 10**6])
def test_a_phase_that_begins_at_no_sample_of_the_motion_is_told(kept: Kept, start: int) -> None:
    found = with_part(kept, ("motion", "phases"), [["drive", 0], ["follow", start]])
    assert "phases start at" in found.reasons[0]


def test_a_number_that_is_written_as_one_is_taken(kept: Kept) -> None:
    assert with_part(kept, ("start", 0), START[0]).reasons == ()


@pytest.mark.parametrize(
    "content", [b"", b"x,y\n1,2\n", b"PK\x03\x04\x80\x81", b"<robot name='r'/>", b"\n\n"]
)
def test_a_file_that_is_no_artefact_is_bad_input(
    sdt: Callable[..., Done], tmp_path: Path, content: bytes
) -> None:
    (file := tmp_path / "fridge.npz").write_bytes(content)
    done = sdt("recheck", str(file))
    assert (done.code, done.out) == (2, "")
    assert f"{file} is no certificate or proof" in done.err
    assert (
        "allowed: what sdt achieve --certificate wrote, a .trig or .nq file, or a store directory" in done.err
    )


def test_of_an_artefact_no_damage_makes_bad_input(
    kept: Kept, sdt: Callable[..., Done], tmp_path: Path
) -> None:
    file, content = tmp_path / "one.cert", kept[1]
    proof = zlib.compress(b"{}" * 40, 9)
    flipped = [
        bytes([*whole[:k], whole[k] ^ 4, *whole[k + 1 :]]) for whole in (content, proof) for k in (0, 1, 9)
    ]
    for damaged in (*flipped, content[:5], content[:40], proof[:-1]):
        file.write_bytes(damaged)
        done = sdt("recheck", str(file))
        assert (done.code, "DOES NOT HOLD" in done.out) == (1, True), damaged[:40]
