"""Two fingers hold a handle: not two bodies of one finger, and none that has passed the handle."""

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh

from sdt_kg.errors import AnnotationError
from sdt_kg.iri import local_name
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Refused
from tests.services.embodiment.gantry import FOLDER, JOINTS, RESTS, opening
from tests.services.embodiment.judging import judge

pytestmark = pytest.mark.oracle

WIDE = 0.006  # [m] of each finger from the middle: 1 mm from the bar, which certification allows
HOOK = (
    '<joint name="down_joint" type="fixed"><parent link="up_finger"/><child link="down_finger"/>'
    '<origin xyz="0 0 -0.012"/>'
)
GROOVE = 0.012, 0.028  # [m] along a finger, which reaches from -0.03 to 0.03; the bar fits into it
BAR = 0.015  # [m] along a finger, where the bar begins
THIN = 0.0008  # [m] fingers, and the plate that they should hold


def twin_of(folder: Path, robot: str, cell: str, turtle: str | None = None) -> Twin:
    """Of a changed gantry and cell."""
    (folder / "gantry.urdf").write_text(robot)
    (folder / "gantry.ttl").write_text(turtle or (FOLDER / "gantry.ttl").read_text())
    (folder / "cell.urdf").write_text(cell)
    return load_twin(folder / "cell.urdf", [folder / "gantry.urdf"])


def texts() -> tuple[str, str]:
    """URDF of the gantry and of the cell."""
    return (FOLDER / "gantry.urdf").read_text(), (FOLDER / "cell.urdf").read_text()


def with_fingers(robot: str, thick: float) -> str:
    """The gantry with fingers so thick [m], on the same side of each finger's origin."""
    for side in ("0.04 0 0.005", "0.04 0 -0.005"):
        at = side.replace("0.005", str(thick / 2))
        robot = robot.replace(
            f'<origin xyz="{side}"/><geometry><box size="0.06 0.02 0.01"/>',
            f'<origin xyz="{at}"/><geometry><box size="0.06 0.02 {thick}"/>',
        )
    return robot


def with_handle(cell: str, shape: str) -> str:
    """The cell with one shape in place of the handle's."""
    start = cell.index('<link name="drawer_handle">')
    handle = f'<link name="drawer_handle"><collision><geometry>{shape}</geometry></collision>'
    return cell[:start] + handle + cell[cell.index("</link>", start) :]


def closing(finger: float, aside: float = 0.0) -> np.ndarray:
    """Rests of the good motion with the fingers always like that, the hand moved up or down."""
    rests = RESTS.copy()
    rests[:, 7] = finger
    rests[1:, 4] += aside
    return rests


@pytest.mark.parametrize("hook", [False, True])
def test_two_ends_of_a_hook_hold_nothing_between_them(tmp_path: Path, hook: bool) -> None:
    robot, cell = texts()
    start = robot.index('<joint name="down_joint"')
    end = robot.index("</joint>", start)
    robot = robot[:start] + HOOK + robot[end:] if hook else robot
    verdict = judge(twin_of(tmp_path, robot, cell), opening(rests=closing(WIDE)))
    if not hook:
        assert isinstance(verdict, Certified), verdict.diagnoses
        return
    assert isinstance(verdict, Refused)
    assert any("not between the fingers" in each.reason for each in verdict.diagnoses)


@pytest.mark.parametrize(("aside", "holds"), [(0.0, True), (-0.0022, False), (0.0022, False)])
def test_thin_fingers_on_one_side_of_a_thin_plate_do_not_hold_it(
    tmp_path: Path, aside: float, holds: bool
) -> None:
    robot, cell = texts()
    cell = with_handle(cell, f'<box size="0.01 0.2 {THIN}"/>')
    finger = THIN / 2 + 0.0005 if holds else 0.0
    verdict = judge(twin_of(tmp_path, with_fingers(robot, THIN), cell), opening(rests=closing(finger, aside)))
    if holds:
        assert isinstance(verdict, Certified), verdict.diagnoses
        return
    assert isinstance(verdict, Refused)
    assert any("before it is held" in each.reason for each in verdict.diagnoses)


def with_plate(cell: str, shape: str) -> str:
    """The cell with a shape more of the handle, 20 mm above the bar."""
    end = cell.index("</link>", cell.index('<link name="drawer_handle">'))
    plate = f'<collision><origin xyz="0 0 0.02"/><geometry>{shape}</geometry></collision>'
    return cell[:end] + plate + cell[end:]


@pytest.mark.parametrize(("finger", "plate"), [(0.001, 0.002), (0.0025, 0.001), (0.0032, 0.0002)])
@pytest.mark.parametrize("meshed", [False, True])
@pytest.mark.parametrize("through", [False, True])
def test_no_finger_is_so_thin_that_it_comes_through_the_handle(
    tmp_path: Path, finger: float, plate: float, meshed: bool, through: bool
) -> None:
    # Halfway through the plate the upper finger is less than the 2 mm in it that are tolerated.
    robot, cell = texts()
    shape = f'<box size="0.01 0.2 {plate}"/>'
    if meshed:
        trimesh.creation.box((0.01, 0.2, plate)).export(tmp_path / "plate.stl")
        shape = '<mesh filename="plate.stl"/>'
    twin = twin_of(tmp_path, with_fingers(robot, finger), with_plate(cell, shape))
    verdict = judge(twin, opening(rests=RESTS if through else closing(WIDE)))
    if not through:
        assert isinstance(verdict, Certified), verdict.diagnoses
        return
    assert isinstance(verdict, Refused)
    assert any("up_finger and drawer_handle are" in each.reason for each in verdict.diagnoses)


@pytest.mark.parametrize(("apart", "holds"), [(0.0018, True), (0.0032, False)])
def test_fingers_that_one_motor_drives_differ_by_no_more_than_their_springs_give(
    tmp_path: Path, apart: float, holds: bool
) -> None:
    robot, cell = texts()
    robot = robot.replace('<mimic joint="up_joint"/>', "")
    turtle = (FOLDER / "gantry.ttl").read_text()
    driven = "sdt:hasFingerJoint j:up_joint, j:down_joint ; sdt:fingerDifference 0.001 ; sdt:opening"
    turtle = turtle.replace("sdt:hasFingerJoint j:up_joint ; sdt:opening", driven, 1)
    turtle += "j:down_joint sdt:openPosition 0.04 ; sdt:closedPosition 0.0 .\n"
    rests = np.column_stack((RESTS[:, :8], RESTS[:, 7], RESTS[:, 8:]))
    rests[3:, 7], rests[3:, 8] = 0.005, 0.005 + apart
    twin = twin_of(tmp_path, robot, cell, turtle)
    verdict = judge(twin, opening(rests=rests, joints=(*JOINTS, "down_joint")))
    if holds:
        assert isinstance(verdict, Certified), verdict.diagnoses
        return
    assert isinstance(verdict, Refused)
    assert any("share one motor" in each.reason for each in verdict.diagnoses)


@pytest.mark.parametrize("said", ["-0.1", '"much"', "true", "0.1, 0.2"])
def test_what_fingers_may_differ_by_is_a_number(tmp_path: Path, said: str) -> None:
    turtle = (FOLDER / "gantry.ttl").read_text()
    turtle = turtle.replace("sdt:opening", f"sdt:fingerDifference {said} ; sdt:opening", 1)
    with pytest.raises(AnnotationError, match="fingerDifference"):
        judge(twin_of(tmp_path, *texts(), turtle), opening())


def grooved(folder: Path, deep: float, groove: tuple[float, float] = GROOVE) -> str:
    """URDF of the gantry, both fingers meshes of three boxes: 10 mm thick, less by `deep` in a groove."""
    robot = texts()[0]
    for name, inner in (("up", -1), ("down", 1)):
        boxes = [((-0.03, groove[0]), 0.01), (groove, 0.01 - deep), ((groove[1], 0.03), 0.01)]
        parts = [
            trimesh.creation.box(bounds=[(low, -0.01, -0.005), (high, 0.01, thick - 0.005)])
            for (low, high), thick in boxes
        ]
        mesh = trimesh.util.concatenate(parts)
        mesh.apply_transform(np.diag((1, inner, inner, 1)))  # turned about x: thinner from inside
        mesh.export(folder / f"{name}.stl")
        start = robot.index(f'<link name="{name}_finger">')
        end = robot.index("</link>", start)
        shape = f'<geometry><mesh filename="{name}.stl"/></geometry>'
        robot = robot[:start] + re.sub("<geometry>.*?</geometry>", shape, robot[start:end]) + robot[end:]
    return robot


@pytest.mark.parametrize(("deep", "holds"), [(0.0, True), (0.0009, True), (0.0011, False), (0.006, False)])
def test_fingers_hold_nothing_in_a_groove_that_is_deeper_than_they_may_be_away(
    tmp_path: Path, deep: float, holds: bool
) -> None:
    # A convex piece of either finger lies across its groove, 1 mm from the bar; certification allows 2 mm.
    twin = twin_of(tmp_path, grooved(tmp_path, deep), texts()[1])
    verdict = judge(twin, opening(rests=closing(WIDE)))
    if holds:
        assert isinstance(verdict, Certified), verdict.diagnoses
        assert verdict.figures["finger to handle"][0] == pytest.approx(0.001 + deep, abs=2e-5)
        assert (verdict.figures["handle error tolerated"][0] > 0) == (deep == 0)
        return
    assert isinstance(verdict, Refused)
    assert any("mm away from drawer_handle" in each.reason for each in verdict.diagnoses)


@pytest.mark.parametrize(("over", "holds"), [(0.0032, True), (0.0028, False), (0.001, False)])
def test_what_of_a_finger_does_not_reach_over_the_bar_holds_nothing_though_a_piece_does(
    tmp_path: Path, over: float, holds: bool
) -> None:
    # In front of the bar's back edge the finger touches it; farther on it is too thin to.
    groove = BAR + over, 0.0295
    twin = twin_of(tmp_path, grooved(tmp_path, 0.006, groove), texts()[1])
    verdict = judge(twin, opening(rests=closing(WIDE)))
    if holds:
        assert isinstance(verdict, Certified), verdict.diagnoses
        return
    assert isinstance(verdict, Refused)
    assert any(f"reaches {1000 * over:.1f} mm over" in each.reason for each in verdict.diagnoses), (
        verdict.diagnoses
    )


BRACKET = (-0.005, -0.1), (0.045, -0.1), (0.045, -0.09), (0.005, -0.09)
"""[m] Half of its outline, seen from above: as the bar and the posts of the cell's handle."""
SPLIT = (0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 7), (4, 5, 6), (4, 6, 7)


def bent(high: float) -> trimesh.Trimesh:
    """Bar and posts as one mesh that is not convex, so high [m]."""
    outline = np.array((*BRACKET, *((x, -y) for x, y in BRACKET[::-1])))
    bracket = trimesh.creation.extrude_triangulation(outline, SPLIT, high)
    bracket.apply_translation((0.0, 0.0, -high / 2))
    return bracket


def bracketed(folder: Path, thick: float, ended: bool = True) -> Twin:
    """The bar and its posts as one mesh that is not convex, and fingers so thick; or posts without ends."""
    robot, cell = texts()
    bracket = bent(0.01)
    if not ended:
        bracket.update_faces((bracket.triangles[:, :, 0] < 0.044).any(axis=1))
    bracket.export(folder / "bracket.stl")
    return twin_of(folder, with_fingers(robot, thick), with_handle(cell, '<mesh filename="bracket.stl"/>'))


HELD_BY = ((True, 0.002), (False, 0.01))
HELD_BY_OTHERS = ((False, 0.002), (True, 0.01))
"""Whether posts have ends, and how thick fingers are [m]; those of the second line are in `tests/soak`."""
CUT = ((0.0007, True), (0.0022, False), (0.004, False))
"""[m] how deep, and whether it is held so."""


@pytest.mark.parametrize(("ended", "thick"), HELD_BY)
@pytest.mark.parametrize(("deep", "holds"), CUT)
def test_fingers_that_cut_into_a_bent_handle_do_not_hold_it_however_thin_they_are(
    tmp_path: Path, ended: bool, thick: float, deep: float, holds: bool
) -> None:
    check_cut(tmp_path, ended, thick, deep, holds=holds)


def check_cut(tmp_path: Path, ended: bool, thick: float, deep: float, *, holds: bool) -> None:
    """A bent handle that fingers so thick cut into so deep is held or not."""
    # They reach beyond the bar to both sides, so that no corner of either is in it.
    rests = RESTS.copy()
    rests[3:, 7] = 0.005 - deep
    verdict = judge(bracketed(tmp_path, thick, ended), opening(rests=rests))
    if holds:
        assert isinstance(verdict, Certified), verdict.diagnoses
        assert verdict.figures["smallest distance, handle"][0] == pytest.approx(-deep, abs=2e-4)
        return
    assert isinstance(verdict, Refused)
    assert any("mm in each other" in each.reason for each in verdict.diagnoses)


@pytest.mark.parametrize(("before", "deep"), [(0.0002, 0.0017), (0.0012, 0.0007), (0.0002, 0.0)])
def test_the_smallest_distance_to_the_handle_is_the_smallest_and_not_the_most_of_what_is_allowed(
    tmp_path: Path, before: float, deep: float
) -> None:
    """Fingers that come with little room and then press: in the handle they may be, on the way not."""
    rests = RESTS.copy()
    rests[1:3, 7], rests[3:, 7] = 0.005 + before, 0.005 - deep
    verdict = judge(twin_of(tmp_path, *texts()), opening(rests=rests))
    assert isinstance(verdict, Certified), verdict.diagnoses
    assert verdict.figures["smallest distance, handle"][0] == pytest.approx(-deep, abs=1e-4)
    (said,) = (each for each in verdict.nearest if each.startswith("nearest (handle)"))
    bodies, at = said.split(", ")
    assert bodies.endswith("_finger and drawer_handle")
    assert float(at.split()[0]) == pytest.approx(-1000 * deep, abs=0.1)
    pair = verdict.nearest_pairs["smallest distance, handle"]
    assert {local_name(link) for link in pair.links} == set(
        bodies.removeprefix("nearest (handle): ").split(" and ")
    )
    assert pair.time == pytest.approx(float(at.split()[3]), abs=0.006)


@pytest.mark.parametrize("through", [False, True])
def test_no_finger_is_so_thin_that_it_comes_through_a_bent_part_of_the_handle(
    tmp_path: Path, through: bool
) -> None:
    robot, cell = texts()
    bent(0.001).export(tmp_path / "bent.stl")
    cell = with_plate(cell, '<mesh filename="bent.stl"/>')
    verdict = judge(
        twin_of(tmp_path, with_fingers(robot, 0.001), cell),
        opening(rests=RESTS if through else closing(WIDE)),
    )
    assert isinstance(verdict, Refused) is through
