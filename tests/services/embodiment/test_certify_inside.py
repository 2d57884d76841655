"""What is wholly inside a closed mesh touches none of its triangles, and is refused all the same."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from predicates.case import Quantity
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified
from tests.services.embodiment.gantry import FOLDER, gantry_twin, opening
from tests.services.embodiment.judging import judge, refusal
from tests.services.embodiment.mutations import before_it_moves, closed, resting

pytestmark = pytest.mark.oracle

HALL = """<link name="hall"><collision><geometry><mesh filename="{file}"/></geometry></collision></link>
<joint name="hall_joint" type="fixed"><parent link="world"/><child link="hall"/>
<origin xyz="{xyz}"/></joint>"""
AROUND = (6.0, 6.0, 6.0)  # [m] about the gantry and all its way
Faces = NDArray[np.int64]


def hall(folder: Path, *solids: trimesh.Trimesh, xyz: str = "0 0 0") -> Twin:
    file = folder / "hall.stl"
    trimesh.util.concatenate(solids).export(file)
    return gantry_twin(folder, HALL.format(file=file, xyz=xyz))


def box(
    faces: slice | Faces = slice(None), *, turned: slice = slice(0), size: float = 1.0
) -> trimesh.Trimesh:
    """A box about the origin: some of its twelve faces, some of these looking the other way."""
    whole = trimesh.creation.box(np.array(AROUND) * size)
    chosen = whole.faces[faces].copy()
    chosen[turned] = chosen[turned][:, ::-1]
    return trimesh.Trimesh(whole.vertices, chosen, process=False)


@pytest.mark.parametrize(
    "solids",
    [
        (box(),),
        (box(turned=slice(None)),),
        (box(turned=slice(0, 5)),),
        (box(), box(turned=slice(None))),
        (box(), box(size=1.1)),
    ],
    ids=["outwards", "inwards", "at random", "from both sides", "in each other"],
)
def test_who_begins_inside_a_closed_mesh_is_refused(
    tmp_path: Path, solids: tuple[trimesh.Trimesh, ...]
) -> None:
    found = refusal(hall(tmp_path, *solids), opening(), Quantity.DISTANCE)
    assert len(found) > 0
    assert all("begins wholly inside hall, a closed mesh" in one.reason for one in found)
    assert found[0].evidence is not None
    assert found[0].evidence.time == 0


def test_a_mesh_that_is_not_closed_has_no_inside_and_the_verdict_says_so(tmp_path: Path) -> None:
    verdict = judge(hall(tmp_path, box(slice(0, 11))), opening())
    assert isinstance(verdict, Certified)
    assert [note for note in verdict.nearest if "not closed" in note and note.endswith("hall")]


def test_a_room_whose_walls_have_a_thickness_is_a_cavity(tmp_path: Path) -> None:
    verdict = judge(hall(tmp_path, box(size=1.1), box(turned=slice(None))), opening())
    assert isinstance(verdict, Certified)
    assert [note for note in verdict.nearest if "cavity" in note and note.endswith("hall")]


def test_a_mesh_elsewhere_changes_nothing(tmp_path: Path) -> None:
    away = judge(hall(tmp_path, box(), xyz="-5 0 0"), opening())
    (tmp_path / "plain").mkdir()
    plain = judge(gantry_twin(tmp_path / "plain"), opening())
    assert isinstance(away, Certified)
    assert isinstance(plain, Certified)
    assert away.nearest == plain.nearest


def meshed(folder: Path, bar: trimesh.Trimesh) -> Twin:
    """The cell whose drawer has this bar, which lies along y."""
    bar.export(folder / "bar.stl")
    cell, solid = (FOLDER / "cell.urdf").read_text(), '<box size="0.01 0.2 0.01"/>'
    (folder / "cell.urdf").write_text(cell.replace(solid, f'<mesh filename="{folder / "bar.stl"}"/>', 1))
    return load_twin(folder / "cell.urdf", [FOLDER / "gantry.urdf"])


def fine_bar() -> trimesh.Trimesh:
    """A bar of small triangles, 10 mm thick."""
    bar = trimesh.creation.box((0.01, 0.2, 0.01))
    return trimesh.Trimesh(*trimesh.remesh.subdivide_to_size(bar.vertices, bar.faces, 0.004))


def round_bar(hollow: bool) -> trimesh.Trimesh:
    """A bar of long faces, 10 mm thick: no corner nor middle of a triangle is where a hand holds it."""
    made = (
        trimesh.creation.annulus(0.003, 0.005, 0.2, 4)
        if hollow
        else trimesh.creation.cylinder(0.005, 0.2, 16)
    )
    made.apply_transform(trimesh.transformations.euler_matrix(np.pi / 2, 0.3, 0.0))
    return made


def test_fingers_in_a_handle_of_many_small_triangles_are_as_deep_as_in_a_solid_one(tmp_path: Path) -> None:
    twin = meshed(tmp_path, fine_bar())
    assert isinstance(judge(twin, closed(opening(), 0.0035)), Certified)  # 1.5 mm deep in a bar of 10 mm
    found = refusal(twin, closed(opening(), 0.0005), Quantity.DISTANCE)
    assert min(one.evidence.value for one in found if one.evidence) == pytest.approx(-0.0045, abs=1e-5)


@pytest.mark.parametrize("hollow", [False, True])
def test_fingers_in_a_handle_of_long_triangles_are_as_deep_as_in_a_solid_one(
    tmp_path: Path, hollow: bool
) -> None:
    bar = round_bar(hollow)
    twin, half = meshed(tmp_path, bar), float(np.ptp(bar.vertices, axis=0)[0] / 2)
    assert isinstance(judge(twin, closed(opening(), half - 0.0015)), Certified)
    found = refusal(twin, closed(opening(), half - 0.003), Quantity.DISTANCE)
    assert min(one.evidence.value for one in found if one.evidence) == pytest.approx(-0.003, abs=2e-5)


def test_fingers_that_press_into_such_a_handle_between_samples_are_refused(tmp_path: Path) -> None:
    """Before the drawer moves: at four samples, and halfway, the fingers are open or touch."""
    twin, at = meshed(tmp_path, fine_bar()), before_it_moves(opening())
    motion = resting(opening(), at, np.array([0.5, 4.5, 5.0]))
    motion.q[at + 1 : at + 3, 3] += 0.004
    assert isinstance(judge(twin, motion), Certified)
    motion.v[at + 1 : at + 3, 3] -= 0.021  # [m/s] 8 mm less a quarter of the way on, as much more after three
    found = refusal(twin, motion, Quantity.DISTANCE)
    assert min(one.evidence.value for one in found if one.evidence) == pytest.approx(-0.0041, abs=5e-4)
