"""A body motion that comes with a τ without required times goes its way, in whatever time."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Case, Outcome, Verdict
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.errors import MotionError
from sdt_kg.iri import joint_iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify.certificate import read_certificate
from services.embodiment.oracle import WholeBody
from services.physics.chain import of_own_joint
from services.physics.model import Scene
from services.physics.oracle import Kinematics
from tests.services.embodiment.gantry import DRAWER, LETTING_GO, RESTS, START, gantry_twin, opening

pytestmark = pytest.mark.oracle

BACK_AND_FORTH = np.vstack([RESTS[:4], RESTS[4], RESTS[3], RESTS[4]])
BACK_AND_FORTH[5:, 0] = 25.0, 32.0


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return gantry_twin(tmp_path_factory.mktemp("way"))


def way(*values: float, seconds: float = 1.0) -> Motion:
    """Of the drawer, from value to value [m] in so many seconds each, which need not be kept."""
    times = np.array([seconds * k for k in range(len(values))])
    return Motion(
        DRAWER, times, np.array(values)[:, None], timed=False, velocities=np.zeros((len(values), 1))
    )


def judged(twin: Twin, motion: Motion, body: BodyMotion) -> Verdict:
    task = Task(Verb.OPEN, twin.container("drawer_main").iri)
    case = Case(twin, twin.robots[0], task, motion, body_motion=body)
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    return verdict


@pytest.mark.parametrize("seconds", [0.2, 9.0])
@pytest.mark.parametrize(
    ("values", "rests"),
    [
        ((0.0, 0.46), RESTS),
        ((0.0, 0.2, 0.46), LETTING_GO),
        ((0.0, 0.46, 0.0, 0.46), BACK_AND_FORTH),
    ],
    ids=["there", "rests in between", "back and forth"],
)
def test_a_body_motion_may_take_its_time(
    twin: Twin, values: tuple[float, ...], rests: np.ndarray, seconds: float
) -> None:
    verdict = judged(twin, way(*values, seconds=seconds), opening(rests=rests))
    assert verdict.outcome is Outcome.CERTIFIED, [each.reason for each in verdict.diagnoses]
    assert verdict.causes is not None
    assert isinstance(verdict.causes.case.motion, Motion)
    assert verdict.causes.case.motion.times[-1] == rests[-1, 0]
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is not None
    asked = read_certificate(verdict.can_perform.artefact.content).asked
    assert asked is not None
    assert not asked.timed


@pytest.mark.parametrize(
    "values",
    [(0.0, 0.46, 0.0), (0.0, 0.6, 0.46), (0.0, 0.2, 0.1, 0.46), (0.0, 0.49), (0.0, 0.455)],
    ids=["ends closed", "beyond its stop", "turns back", "goes farther", "goes less far"],
)
def test_one_that_goes_another_way_is_not_certified(twin: Twin, values: tuple[float, ...]) -> None:
    verdict = judged(twin, way(*values, seconds=5.0), opening())
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert verdict.can_perform is not None
    assert any("off the motion that was asked for" in each.reason for each in verdict.can_perform.diagnoses)


def test_one_that_turns_back_where_the_motion_does_not_is_not_certified(twin: Twin) -> None:
    assert judged(twin, way(0.0, 0.46), opening(rests=BACK_AND_FORTH)).outcome is Outcome.NOT_CERTIFIED


FOLLOWER = """<link name="flap"/><joint name="flap_joint" type="prismatic"><parent link="world"/>
<child link="flap"/><axis xyz="1 0 0"/><limit lower="0" upper="1" velocity="1" effort="1"/>
<mimic joint="drawer_main_joint" multiplier="2"/></joint>"""


def test_a_motion_of_what_follows_is_one_of_the_container_unless_it_stands_still(tmp_path: Path) -> None:
    twin = gantry_twin(tmp_path, FOLLOWER)
    container, flap = twin.container("drawer_main"), joint_iri("cell", "flap_joint")
    motion = replace(way(0.0, 0.46), of=flap)
    own = of_own_joint(Scene(twin, twin.robots[0]), container, motion)
    assert own.values[:, 0].tolist() == [0.0, 0.23]
    still = twin.with_edit(flap, mimicMultiplier=0.0)
    with pytest.raises(
        MotionError, match=r"flap_joint, which does not move drawer_main; allowed: .*main_joint"
    ):
        of_own_joint(Scene(still, still.robots[0]), container, motion)


def test_what_was_generated_is_certified_again(twin: Twin) -> None:
    case = Case(twin, twin.robots[0], Task(Verb.OPEN, twin.container("drawer_main").iri))
    (first,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    assert first.outcome is Outcome.CERTIFIED
    again = replace(case, motion=first.case.motion, body_motion=first.case.body_motion)
    (second,) = law(again, Kinematics(), WholeBody(Drive.OMNI, START))
    assert second.outcome is Outcome.CERTIFIED, [each.reason for each in second.diagnoses]
