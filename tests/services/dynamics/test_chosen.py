"""What proves nothing of other motions: one that the robot chose, and the force at one handle of several."""

from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case, Kind, Outcome, Verdict
from predicates.law import law
from sdt_kg.load import load_twin
from sdt_kg.motion import Motion
from sdt_kg.task import UNKNOWN, Task, Unknown, Verb
from sdt_kg.twin import Twin
from services.dynamics.data import with_forces
from services.dynamics.oracle import Dynamics
from services.dynamics.robot.bearing import Bearing
from tests.services.dynamics.forced import RUNNERS, edited, forced_twin
from tests.small.lift import Lift


def opened(twin: Twin, motion: Motion | Unknown = UNKNOWN) -> Verdict:
    task = Task(Verb.OPEN, twin.container("top_drawer").iri)
    case = Case(twin, robot=twin.robots[0], task=task, motion=motion)
    (verdict,) = law(case, Dynamics(), Bearing(Lift()))
    return verdict


def pulled(twin: Twin, end: float, seconds: float) -> Motion:
    share = np.linspace(0.0, 1.0, 41)
    way = end * share**2 * (3 - 2 * share)
    return Motion(twin.container("top_drawer").joint, share * seconds, way[:, None])


@pytest.mark.parametrize(
    ("forces", "end", "seconds", "why"),
    [
        ({"softCloserForce": (15.0, 20.0), "softCloserRange": 0.47}, 0.48, 8.0, "does not stay"),
        ({"viscousFriction": (2000.0, 2000.0)}, 0.455, 80.0, "but needs"),
    ],
)
def test_a_refusal_of_what_the_robot_chose_is_no_proof_since_another_motion_does_it(
    forces: dict[str, tuple[float, float] | float], end: float, seconds: float, why: str
) -> None:
    twin = edited(RUNNERS, forced_twin(("pr2",)), **forces)
    found = opened(twin)
    assert found.outcome is Outcome.NOT_CERTIFIED
    (diagnosis,) = found.diagnoses
    assert (diagnosis.kind, diagnosis.proof) == (Kind.CAUSAL, False)
    assert why in diagnosis.reason
    assert opened(twin, pulled(twin, end, seconds)).outcome is Outcome.CERTIFIED


def test_what_leaving_rest_needs_stays_proved() -> None:
    twin = edited(RUNNERS, forced_twin(("pr2",)), breakAwayFriction=(70.0, 80.0))
    (diagnosis,) = opened(twin).diagnoses
    assert diagnosis.proof
    assert "but needs 70.0 N" in diagnosis.reason


@pytest.mark.parametrize(
    ("lever", "handles", "proved"), [("0.3", 2, False), ("0.45", 2, None), ("0.3", 1, True)]
)
def test_the_force_at_a_handle_near_the_hinge_proves_nothing_where_another_handle_opens_both(
    tmp_path: Path, lever: str, handles: int, proved: bool | None
) -> None:
    here = Path(__file__).parent
    handle = '<collision><geometry><box size="0.02 0.02 0.12"/></geometry></collision></link>'
    text = (here / "pair.urdf").read_text().replace('xyz="-0.05 -0.45 0"', f'xyz="-0.05 -{lever} 0"')
    if handles == 2:
        other = f"""<link name="right_leaf_handle">{handle}<joint name="right_leaf_handle_joint" type="fixed">
          <parent link="right_leaf"/><child link="right_leaf_handle"/><origin xyz="-0.05 0.45 0"/></joint>"""
        text = text.replace("</robot>", other + "</robot>")
    (tmp_path / "pair.urdf").write_text(text)
    twin = with_forces(load_twin(tmp_path / "pair.urdf"), here / "pair_forces.ttl")
    hinge = "https://example.org/id/pair/force_model/hinge"
    twin = edited(hinge, twin, breakAwayFriction=(10.0, 10.0), coulombFriction=(9.0, 10.0))
    (found,) = law(Case(twin, task=Task(Verb.OPEN, twin.container("left_leaf").iri)), Dynamics())
    assert found.causes is not None
    assert [each.proof for each in found.causes.diagnoses] == ([] if proved is None else [proved])
    if handles == 2:
        right = Case(twin, task=Task(Verb.OPEN, twin.container("right_leaf").iri))
        (found,) = law(right, Dynamics())
        assert found.causes is not None
        assert found.causes.holds, "by a handle that is far from its hinge"
