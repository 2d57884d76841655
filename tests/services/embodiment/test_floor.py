"""Robots stand on z = 0 of the kitchen's root frame: a kitchen with another floor is no input."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import local_name
from sdt_kg.load import load_twin
from sdt_kg.state import Interval, Region
from sdt_kg.task import Task, Verb
from services.embodiment.certify import Certified, Refused
from services.embodiment.oracle import WholeBody
from services.physics.model import Scene
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import FOLDER, gantry_twin, opening
from tests.services.embodiment.judging import judge

pytestmark = pytest.mark.oracle

SUNK = """<link name="room"/>
<joint name="room_joint" type="fixed"><parent link="room"/><child link="world"/>{}</joint>"""


@pytest.mark.parametrize(("down", "judged"), [(0.3, True), (2.0, False)])
def test_no_robot_is_asked_about_a_handle_below_the_floor(tmp_path: Path, down: float, judged: bool) -> None:
    # As it stands, a kitchen whose root frame is at its worktop: proved to be out of reach before.
    room = SUNK.format(f'<origin xyz="0 0 {-down}"/>')
    cell = (FOLDER / "cell.urdf").read_text()
    (tmp_path / "cell.urdf").write_text(cell.replace("<!-- more -->", room))
    twin = load_twin(tmp_path / "cell.urdf", [FOLDER / "gantry.urdf"])
    (drawer,), (robot,) = twin.containers(), twin.robots
    goal = Region(((drawer.joint, Interval(drawer.open_from, drawer.upper)),))
    case = Case(twin, robot, Task(Verb.OPEN, drawer.iri), next(Kinematics().generate(twin, goal)))
    body = WholeBody(Drive.OMNI, budget=1.0)
    if judged:
        body.perform(case)
        return
    with pytest.raises(InputError, match=r"below z = 0 of the kitchen's root frame, on which robots stand"):
        body.perform(case)


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
