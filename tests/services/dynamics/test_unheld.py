"""Containers that a motion leaves alone: no verdict rests on their staying where no value holds them."""

from pathlib import Path

import pytest

from predicates.case import Case, Outcome, Verdict
from predicates.law import law
from sdt_kg.load import load_twin
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.dynamics.data import with_forces
from services.dynamics.oracle import Dynamics
from services.dynamics.rest import at_rest
from services.dynamics.robot.bearing import Bearing
from tests.services.dynamics.forced import HINGE, edited, forced_twin
from tests.small.lift import Lift

HERE = Path(__file__).parent
OVEN = "https://example.org/id/b/joint/oven_door_joint"


def opened(twin: Twin, container: str) -> Verdict:
    case = Case(twin, robot=twin.robots[0], task=Task(Verb.OPEN, twin.container(container).iri))
    (verdict,) = law(case, Dynamics(), Bearing(Lift()))
    return verdict


def test_nothing_is_claimed_where_another_door_falls() -> None:
    twin = forced_twin(("pr2",))
    found = opened(twin.at({OVEN: 1.2}), "top_drawer")
    assert found.outcome is Outcome.ABSTAINED
    (diagnosis,) = found.diagnoses
    assert "oven_door, which nobody holds, does not stay where it begins" in diagnosis.reason
    assert not diagnosis.proof
    assert opened(twin.at({OVEN: 1.5}), "top_drawer").outcome is Outcome.CERTIFIED, "its stop bears it"


def test_a_door_that_only_some_values_move_is_told_of() -> None:
    twin = edited(HINGE, forced_twin(("pr2",)), breakAwayFriction=(2.0, 60.0))
    found = opened(twin.at({OVEN: 1.2}), "top_drawer")
    assert found.outcome is Outcome.CERTIFIED
    assert found.causes is not None
    assert any("though it may move: oven_door" in each for each in found.causes.notes)
    closed = opened(forced_twin(("pr2",)), "top_drawer").causes
    assert closed is not None
    assert not any("may move" in each for each in closed.notes)


KNOB = (
    '<link name="knob"><collision><geometry><box size="0.03 0.03 0.03"/></geometry></collision></link>'
    '<joint name="knob_joint" type="revolute"><parent link="left_leaf"/><child link="knob"/>'
    '<origin xyz="-0.03 -0.2 0"/><axis xyz="1 0 0"/>'
    '<limit lower="0" upper="1" velocity="1" effort="1"/></joint></robot>'
)


def test_joints_that_are_taken_to_be_rigid_with_what_moves_or_not_to_move_under_it_are_told(
    tmp_path: Path,
) -> None:
    text = (HERE / "pair.urdf").read_text().replace("</robot>", KNOB)
    (tmp_path / "pair.urdf").write_text(
        text.replace(
            '<joint name="wall_joint" type="fixed">', '<joint name="wall_joint" type="prismatic">'
        ).replace('<origin xyz="2 0 0"/></joint>', '<origin xyz="2 0 0"/>' + SLIDES + "</joint>", 1)
    )
    twin = with_forces(load_twin(tmp_path / "pair.urdf"), HERE / "pair_forces.ttl")
    notes = dict[str, str]()
    for name in ("left_leaf", "upper_drawer"):
        (verdict,) = law(Case(twin, task=Task(Verb.OPEN, twin.container(name).iri)), Dynamics())
        assert verdict.causes is not None
        notes[name] = "\n".join(verdict.causes.notes)
    assert "taken to be rigid with left_leaf" in notes["left_leaf"]
    assert "as it moves: knob_joint" in notes["left_leaf"]
    assert (
        "taken not to move under the force on left_leaf, which hangs on them: wall_joint"
        in notes["left_leaf"]
    )
    assert "taken to be rigid" not in notes["upper_drawer"]


SLIDES = '<axis xyz="1 0 0"/><limit lower="0" upper="0.1" velocity="1" effort="1"/>'


@pytest.fixture
def tilting(tmp_path: Path) -> Twin:
    """A leaf that folds down, and on it a drawer with a friction of 4 to 8 N."""
    text = (HERE / "pair.urdf").read_text()
    for before, after in (
        ('"wall"/><child link="upper_drawer"/><origin xyz="0 -1.5 0.8"/>',
         '"left_leaf"/><child link="upper_drawer"/><origin xyz="0 -0.25 0"/>'),
        ('<child link="left_leaf"/><origin xyz="0 0.5 1"/>',
         '<child link="left_leaf"/><origin xyz="0 0.5 1" rpy="-1.5708 0 0"/>'),
    ):  # fmt: skip
        assert before in text
        text = text.replace(before, after)
    (tmp_path / "pair.urdf").write_text(text)
    twin = with_forces(load_twin(tmp_path / "pair.urdf"), HERE / "pair_forces.ttl")
    hinge = "https://example.org/id/pair/force_model/hinge"
    return edited(hinge, twin, breakAwayFriction=(300.0, 300.0), allowedHandleForce=1e4)


def test_what_hangs_on_a_leaf_that_tilts_is_not_claimed_to_stay(tilting: Twin) -> None:
    twin = tilting
    (verdict,) = law(Case(twin, task=Task(Verb.OPEN, twin.container("left_leaf").iri)), Dynamics())
    assert verdict.outcome is Outcome.ABSTAINED
    assert "hangs on left_leaf" in verdict.diagnoses[0].reason
    tilted = twin.at({twin.container("left_leaf").joint: 1.4})
    drawer = Dynamics().mechanics(tilted, tilted.container("upper_drawer"))
    assert at_rest(drawer, 0.0).surely, "it slides out"
