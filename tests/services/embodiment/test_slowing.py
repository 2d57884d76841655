"""Joints that a safety controller slows near their limits: what it would slow is not certified."""

from dataclasses import asdict

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Refused, Tolerances
from services.embodiment.oracle import WholeBody
from services.physics.spline import Cubic
from tests.services.embodiment.gantry import gantry_twin, opening
from tests.services.embodiment.judging import judge
from tests.services.embodiment.test_whole_body import DRAWER, ask, certified, performed

pytestmark = pytest.mark.oracle

ARM = joint_iri("gantry", "arm_joint")


@pytest.fixture(scope="module")
def twin(tmp_path_factory: pytest.TempPathFactory) -> Twin:
    return gantry_twin(tmp_path_factory.mktemp("gantry"))


def lag(body: BodyMotion, lower: np.ndarray, upper: np.ndarray, gain: float) -> np.ndarray:
    """How far each joint is behind the motion at most where a controller lets it move only so fast."""
    wanted = np.linspace(body.times[0], body.times[-1], 30_001)
    way = Cubic(body.times, body.q, body.v).at(wanted)[0]
    step, now, most = float(wanted[1] - wanted[0]) * gain, way[0].copy(), np.zeros(len(body.joints))
    for each in way:
        now += np.minimum(np.maximum(each - now, step * (lower - now)), step * (upper - now))
        most = np.maximum(most, np.abs(each - now))
    return most


def test_what_would_lag_behind_is_refused_and_what_is_certified_does_not(twin: Twin) -> None:
    body, allowed, outcomes = opening(), Tolerances().lag, []
    far = body.q[:, body.joints.index("arm_joint")]
    for room in (0.0, 1e-3, 0.01, 0.1):
        for gain in (0.5, 10.0, 1000.0):
            ends = -10.0, float(far.max()) + room
            verdict = judge(
                twin.with_edit(ARM, lowerLimit=ends[0], upperLimit=ends[1], softLimitGain=gain), body
            )
            behind = float(lag(body, *np.array(ends), gain)[body.joints.index("arm_joint")])
            outcomes.append((isinstance(verdict, Certified), behind))
            assert behind <= allowed or isinstance(verdict, Refused), (room, gain, behind)
    assert any(is_certified and behind > 0 for is_certified, behind in outcomes)
    assert {is_certified for is_certified, _ in outcomes} == {True, False}
    assert all(behind > allowed / 10 for is_certified, behind in outcomes if not is_certified)


def test_a_refusal_says_which_joint_would_be_slowed_and_where(twin: Twin) -> None:
    far = float(opening().q[:, opening().joints.index("arm_joint")].max())
    verdict = judge(twin.with_edit(ARM, lowerLimit=-10.0, upperLimit=far, softLimitGain=0.5), opening())
    assert isinstance(verdict, Refused)
    assert {each.evidence.entity for each in verdict.diagnoses if each.evidence} == {ARM}
    assert all(
        "arm_joint moves at" in each.reason and "where its safety controller lets it move" in each.reason
        for each in verdict.diagnoses
    )


def test_a_joint_that_rests_beyond_its_limit_is_told_to_be_there_and_not_to_be_too_fast(twin: Twin) -> None:
    low = float(opening().q[0, opening().joints.index("arm_joint")]) + 0.01
    verdict = judge(twin.with_edit(ARM, lowerLimit=low, upperLimit=10.0, softLimitGain=2.0), opening())
    assert isinstance(verdict, Refused)
    reasons = [each.reason for each in verdict.diagnoses]
    assert any("arm_joint reaches position" in each for each in reasons)
    assert not any("moves at" in each for each in reasons)


def test_a_gain_of_0_is_none(twin: Twin) -> None:
    assert isinstance(judge(twin.with_edit(ARM, softLimitGain=0.0), opening()), Certified)


@pytest.mark.parametrize("gain", [1.0, 20.0])
def test_a_robot_comes_slowly_near_its_limits(gain: float) -> None:
    twin = load_twin("b", ["pr2"])
    for name in performed(ask(WholeBody(), twin, DRAWER)).joints:
        twin = twin.with_edit(joint_iri("pr2", name), softLimitGain=gain)
    answer = ask(WholeBody(), twin, DRAWER)
    body = performed(answer)
    assert certified(answer, DRAWER, Drive.OMNI)
    limits = [twin.mechanism(twin.robots[0]).joint(name).limits for name in body.joints]
    lower, upper = np.array([[each.lower, each.upper] for each in limits]).T
    assert (lag(body, lower, upper, gain) <= Tolerances().lag).all()


def test_tolerances_of_older_artefacts_are_read_and_damaged_ones_are_not() -> None:
    told = asdict(Tolerances())
    older = {name: value for name, value in told.items() if name != "lag"}
    assert Tolerances.told(told) == Tolerances.told(older) == Tolerances()
    for wrong in ({**told, "lags": 1.0}, {name: value for name, value in told.items() if name != "rate"}):
        with pytest.raises(ValueError, match="missing or unknown"):
            Tolerances.told(wrong)
