"""Robots stand on z = 0 of the kitchen's root frame: a kitchen with another floor is no input."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case
from sdt_kg.annotation import Drive
from sdt_kg.errors import AnnotationError, InputError
from sdt_kg.iri import local_name
from sdt_kg.load import load_twin
from sdt_kg.state import Interval, Region
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Refused
from services.embodiment.floor import check_floor
from services.embodiment.oracle import WholeBody
from services.physics.model import Scene
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import FOLDER, gantry_twin, opening
from tests.services.embodiment.judging import judge

pytestmark = pytest.mark.oracle


def _opened(twin: Twin) -> Case:
    """Its only robot is to open its only drawer."""
    (drawer,), (robot,) = twin.containers(), twin.robots
    goal = Region(((drawer.joint, Interval(drawer.open_from, drawer.upper)),))
    return Case(twin, robot, Task(Verb.OPEN, drawer.iri), next(Kinematics().generate(twin, goal)))


SUNK = """<link name="room"/>
<joint name="room_joint" type="fixed"><parent link="room"/><child link="world"/>{}</joint>"""


@pytest.mark.parametrize(("down", "judged"), [(0.3, True), (0.44, True), (0.46, False), (2.0, False)])
def test_no_robot_is_asked_about_a_drawer_in_the_floor(tmp_path: Path, down: float, judged: bool) -> None:
    # A kitchen whose root frame is at its worktop: its handles were proved to be out of reach. The drawer's
    # lowest point is 0.4 m above the root frame, its handle 0.5 m.
    room = SUNK.format(f'<origin xyz="0 0 {-down}"/>')
    cell = (FOLDER / "cell.urdf").read_text()
    (tmp_path / "cell.urdf").write_text(cell.replace("<!-- more -->", room))
    twin = load_twin(tmp_path / "cell.urdf", [FOLDER / "gantry.urdf"])
    body, case = WholeBody(Drive.OMNI, budget=1.0), _opened(twin)
    if judged:
        body.perform(case)
        return
    with pytest.raises(InputError, match=r"below z = 0 of the kitchen's root frame, on which robots stand"):
        body.perform(case)


@pytest.mark.parametrize(("height", "judged"), [(-0.019, True), (-0.021, False), (-0.5, False)])
def test_no_robot_is_asked_that_stands_in_the_floor(tmp_path: Path, height: float, judged: bool) -> None:
    # What stands may touch the floor, so nothing else would notice that its arms are too low.
    text = (FOLDER / "gantry.ttl").read_text().replace("sdt:baseHeight 0.0", f"sdt:baseHeight {height}")
    (tmp_path / "gantry.ttl").write_text(text)
    twin = load_twin(FOLDER / "cell.urdf", [FOLDER / "gantry.urdf"], annotation=tmp_path / "gantry.ttl")
    body, case = WholeBody(Drive.OMNI, budget=1.0), _opened(twin)
    if judged:
        body.perform(case)
        return
    with pytest.raises(AnnotationError, match=rf"'gantry' reaches {-height:g} m into .*; allowed: 0, "):
        body.perform(case)


@pytest.mark.parametrize(
    ("start", "judged"),
    [((50.0, -50.0, 0.0), True), ((50.1, 0.0, 0.0), False), ((0.0, -100.0, 0.0), False)],
)
def test_no_robot_is_searched_for_that_starts_where_there_is_no_floor(
    tmp_path: Path, start: tuple[float, float, float], judged: bool
) -> None:
    twin = gantry_twin(tmp_path)
    body, case = WholeBody(Drive.OMNI, start, budget=0.1), _opened(twin)
    if judged:
        body.perform(case)
        return
    with pytest.raises(
        InputError, match=r"base would start at .*, where there is no floor; allowed: .* 50 m"
    ):
        body.perform(case)


@pytest.mark.parametrize(
    ("beside", "drive", "judged"),
    [
        (0.29, Drive.OMNI, True),
        (0.31, Drive.OMNI, False),
        (3.0, Drive.DIFFERENTIAL, False),
        (3.0, Drive.FIXED, True),
    ],
)
def test_what_drives_has_the_frame_of_its_base_amid_what_it_stands_on(
    tmp_path: Path, beside: float, drive: Drive, judged: bool
) -> None:
    # A base of 0.4 m: turned slowly about a frame 3 m away it would go at 0.6 m/s, of 0.2 that are allowed.
    far = '<link name="far"/><joint name="far_joint" type="fixed"><parent link="base"/><child link="far"/>'
    far += f'<origin xyz="0 {beside} 0"/></joint></robot>'
    urdf = (FOLDER / "gantry.urdf").read_text().replace("</robot>", far)
    (tmp_path / "gantry.urdf").write_text(urdf)
    text = (FOLDER / "gantry.ttl").read_text().replace("sdt:baseBody b:base", "sdt:baseBody b:far")
    (tmp_path / "gantry.ttl").write_text(text)
    twin = load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"])
    body, case = WholeBody(drive, budget=0.1), _opened(twin)
    if judged:
        body.perform(case)
        return
    with pytest.raises(
        AnnotationError, match=rf"'far', .* {beside - 0.2:.3g} m beside what the robot stands"
    ):
        body.perform(case)


@pytest.mark.parametrize(("height", "told"), [(0.1, False), (0.6, True)])
def test_a_robot_in_the_air_is_told_to_be_so(tmp_path: Path, height: float, told: bool) -> None:
    text = (FOLDER / "gantry.ttl").read_text().replace("sdt:baseHeight 0.0", f"sdt:baseHeight {height}")
    (tmp_path / "gantry.ttl").write_text(text)
    twin = load_twin(FOLDER / "cell.urdf", [FOLDER / "gantry.urdf"], annotation=tmp_path / "gantry.ttl")
    notes = WholeBody(Drive.OMNI, budget=1.0).perform(_opened(twin)).notes
    said = "what the robot stands on has no shape below 0.6 m, which nothing can collide with"
    assert (said in notes) == told


@pytest.mark.parametrize("roll", [0.0, 0.4, np.pi / 4])
def test_a_wheel_stands_on_its_rim_however_it_is_spun(tmp_path: Path, roll: float) -> None:
    # A box about it would have its corners in the floor.
    shape = '<collision><geometry><cylinder radius="0.1" length="0.05"/></geometry></collision>'
    wheel = f'<link name="wheel">{shape}</link><joint name="wheel_joint" type="fixed">'
    wheel += '<parent link="base"/><child link="wheel"/>'
    wheel += f'<origin xyz="0 0.2 0.1" rpy="1.5707963 {roll} 0"/></joint>'
    urdf = (FOLDER / "gantry.urdf").read_text().replace("</robot>", wheel + "</robot>")
    (tmp_path / "gantry.urdf").write_text(urdf)
    annotation = FOLDER / "gantry.ttl"
    twin = load_twin(FOLDER / "cell.urdf", [tmp_path / "gantry.urdf"], annotation)
    check_floor(Scene(twin, twin.robots[0]))


@pytest.mark.parametrize(("top", "free"), [(0.0, True), (0.0019, True), (0.0021, False)])
def test_wheels_stand_on_the_floor_that_a_kitchen_models_itself(
    tmp_path: Path, top: float, free: bool
) -> None:
    slab = f'<link name="slab"><collision><origin xyz="0 0 {top - 0.05}"/><geometry><box size="9 9 0.1"/>'
    slab += '</geometry></collision></link><joint name="slab_joint" type="fixed"><parent link="world"/>'
    twin = gantry_twin(tmp_path, f'{slab}<child link="slab"/></joint>')
    verdict = judge(twin, opening(), Drive.OMNI)
    assert isinstance(verdict, Certified if free else Refused)
    scene = Scene(twin, twin.robots[0])
    slabs = [k for k, one in enumerate(scene.solids) if one.body.endswith("/slab")]
    touching = scene.environment_pairs[np.isin(scene.environment_pairs[:, 1], slabs), 0]
    names = {local_name(scene.solids[k].body) for k in touching.tolist()}
    assert ("base" in names, "palm" in names) == (not free, True)
