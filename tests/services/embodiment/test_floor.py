"""Robots stand on z = 0 of the kitchen's root frame: a kitchen with another floor is no input."""

from pathlib import Path

import pytest

from predicates.case import Case
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.load import load_twin
from sdt_kg.state import Interval, Region
from sdt_kg.task import Task, Verb
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import FOLDER

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
