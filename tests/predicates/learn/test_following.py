"""Two containers seen together: the twin in which one follows the other replays both tracks."""

import numpy as np
import pytest

from predicates.learn import Learned, learn
from predicates.learn.following import following_triples, key_of
from sdt_kg.errors import InputError
from sdt_kg.twin import Twin
from services.learning import SeenTogether, together_in, together_triples
from services.physics.oracle import Kinematics
from tests.predicates.learn.observed import seen as noisy
from tests.predicates.learn.observed import stopping
from tests.predicates.learn.test_proposal import handle
from tests.small import small_twin

PHYSICS = Kinematics()
TWIN = small_twin("a")
OUT = np.array([-1.0, 0.0, 0.0])


def slid(name: str, positions: np.ndarray, seed: int, twin: Twin = TWIN) -> Learned:
    return learn(noisy(handle(twin, name) + positions[:, None] * OUT, seed))


def together(positions: np.ndarray, *, seed: int = 0) -> SeenTogether:
    first, second = slid("low_drawer", stopping(0.46), seed), slid("high_drawer", positions, seed + 50)
    return together_in(TWIN, (first, second), PHYSICS, ("low_drawer", "high_drawer"))


@pytest.mark.parametrize("ratio", [0.5, 0.98])
def test_a_drawer_that_follows_has_its_ratio_and_both_tracks_are_replayed(ratio: float) -> None:
    found = together(ratio * stopping(0.46))
    made = found.following
    assert made.found.multiplier == pytest.approx(ratio, abs=max(0.01, 3 * made.found.multiplier_deviation))
    assert made.after.mimic is not None
    assert made.after.mimic.joint == "low_drawer_joint"
    assert found.replayed
    high = made.twin.container("high_drawer")
    moved = made.twin.at({high.active_joint: 0.4})
    assert moved.state[high.joint] == pytest.approx(ratio * 0.4, abs=0.005)
    assert TWIN.mechanism(TWIN.environment).joint("high_drawer_joint").mimic is None


def test_a_drawer_that_goes_its_own_way_is_not_coupled() -> None:
    later = np.concatenate([np.zeros(150), np.linspace(0, 0.4, 100)])
    with pytest.raises(InputError, match="high_drawer goes its own way"):
        together(later)


def test_a_joint_that_the_twin_has_wrong_is_learned_before_the_coupling() -> None:
    tracks = slid("low_drawer", stopping(0.46), 0), askew(0.5 * stopping(0.46))
    found = together_in(TWIN, tracks, PHYSICS, ("low_drawer", "high_drawer"))
    (proposal,) = found.proposals
    assert proposal.after.name == "high_drawer_joint"
    assert found.following.found.multiplier == pytest.approx(0.5, abs=0.01)
    assert found.replayed
    high = found.following.twin.container("high_drawer")
    assert high.active_joint == found.following.twin.container("low_drawer").joint
    _, triples = together_triples(TWIN, tracks, found)
    learned = {subject for subject, name, _ in triples if name.endswith("#replacedJointType")}
    assert len(learned) == 1, "the branch says of each joint what it rests on"


def test_a_leader_that_the_twin_has_wrong_is_learned_too() -> None:
    tracks = askew(stopping(0.4)), slid("low_drawer", 0.5 * stopping(0.4), 0)
    found = together_in(TWIN, tracks, PHYSICS, ("high_drawer", "low_drawer"))
    assert [each.container.name for each in found.proposals] == ["high_drawer"]
    assert found.following.found.multiplier == pytest.approx(0.5, abs=0.01)
    assert found.replayed


def askew(positions: np.ndarray) -> Learned:
    """The high drawer comes out sideways."""
    return learn(noisy(handle(TWIN, "high_drawer") + positions[:, None] * np.array([-0.8, 0.6, 0.0]), 3))


def test_two_tracks_of_one_drawer_couple_nothing() -> None:
    one, other = slid("low_drawer", stopping(0.46), 0), slid("low_drawer", stopping(0.46), 1)
    with pytest.raises(InputError, match="both tracks are of low_drawer"):
        together_in(TWIN, (one, other), PHYSICS, ("low_drawer", "low_drawer"))


def test_the_coupling_is_told_as_triples_with_its_deviation() -> None:
    tracks = slid("low_drawer", stopping(0.46), 0), slid("high_drawer", 0.5 * stopping(0.46), 50)
    made = together_in(TWIN, tracks, PHYSICS, ("low_drawer", "high_drawer")).following
    told = {name.rsplit("#", 1)[-1]: value.value for _, name, value in following_triples(TWIN, tracks, made)}
    assert float(told["ratio"]) == made.found.multiplier
    assert float(told["ratioDeviation"]) == made.found.multiplier_deviation > 0
    assert told["followsJoint"] == made.leader.joint
    assert key_of(TWIN, tracks, made) == key_of(TWIN, tracks, made)
