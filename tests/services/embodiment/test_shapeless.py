"""Arms and doors without any shape are told with a verdict: nothing can collide with them."""

import re
from pathlib import Path

import pytest

from predicates.case import Answer, Case
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.task import Task, Verb
from services.embodiment.oracle import WholeBody
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import FOLDER, START, opening

pytestmark = pytest.mark.oracle

ARM = "the arm of gripper 'hand' has no shape at all, which nothing can collide with"
PANEL = "'drawer_main' has no shape but that of its handle, which nothing can collide with"


def without(name: str, *links: str) -> str:
    """The model of that name with these links bare."""
    text = (FOLDER / name).read_text()
    for link in links:
        text, found = re.subn(rf'<link name="{link}">.*?</link>', f'<link name="{link}"/>', text, flags=re.S)
        assert found == 1
    return text


def answered(folder: Path, robot: tuple[str, ...], kitchen: tuple[str, ...]) -> Answer:
    (folder / "cell.urdf").write_text(without("cell.urdf", *kitchen))
    (folder / "gantry.urdf").write_text(without("gantry.urdf", *robot))
    annotation = (FOLDER / "gantry.ttl").read_text()
    one_hand = annotation.replace(", <https://example.org/id/gantry/gripper/other> ;", " ;")
    one_hand = re.sub(r"<\S*/other> a sdt:Gripper.*? \.\n", "", one_hand, flags=re.S)
    (folder / "gantry.ttl").write_text(one_hand)
    twin = load_twin(folder / "cell.urdf", [folder / "gantry.urdf"])
    (drawer,), (machine,) = twin.containers(), twin.robots
    motion = Kinematics().carried(twin, opening(), drawer)
    case = Case(twin, machine, Task(Verb.OPEN, drawer.iri), motion, body_motion=opening())
    return WholeBody(Drive.OMNI, start=START).perform(case)


@pytest.mark.parametrize(
    ("robot", "kitchen", "told"),
    [
        ((), (), set()),
        (("arm",), (), set()),  # the lift has one
        (("lift", "arm"), (), {ARM}),
        (("lift", "arm", "palm"), (), {ARM}),
        ((), ("cabinet",), set()),
        ((), ("drawer_main",), {PANEL}),
    ],
)
def test_what_has_no_shape_is_told(
    tmp_path: Path, robot: tuple[str, ...], kitchen: tuple[str, ...], told: set[str]
) -> None:
    answer = answered(tmp_path, robot, kitchen)
    assert answer.holds
    assert {note for note in answer.notes if note.endswith("which nothing can collide with")} == told
