"""An observed track as motion of a container: it begins where it is and ends where it was last seen."""

from pathlib import Path

import numpy as np
import pytest

from predicates.learn import Track, learn
from sdt_kg.load import load_twin
from services.learning import Seen, seen_in
from services.physics.chain import chain
from services.physics.oracle import Kinematics
from services.physics.tree import build
from tests.predicates.learn import observed
from tests.small import small_twin

CONTAINERS = "sink_area_left_middle_drawer_main", "iai_fridge_door"


def seen(name: str, shares: np.ndarray, noise: float) -> tuple[Seen, float]:
    """What a track at these shares of the upper limit is in kitchen b, and that limit [m or rad]."""
    twin = load_twin("b")
    container = twin.container(name)
    handle = chain(build(twin.mechanism(twin.environment)), container.handle, twin.state)
    points = handle.poses(shares * container.upper)[0][:, :3, 3]
    points += np.random.default_rng(1).normal(0, noise, points.shape)
    track = Track(points, np.arange(len(shares)) / 20, timed=True)
    return seen_in(twin, learn(track), Kinematics()), container.upper


@pytest.mark.parametrize("name", CONTAINERS)
@pytest.mark.parametrize("samples", [60, 200, 1000])
@pytest.mark.parametrize("noise", [0.0, 0.001])
def test_a_track_that_never_rests_keeps_its_begin_and_end(name: str, samples: int, noise: float) -> None:
    found, upper = seen(name, np.linspace(0.0, 0.93, samples), noise)
    assert float(found.motion.values[-1, 0]) == pytest.approx(0.93 * upper, abs=0.002 + 5 * noise)
    twin = load_twin("b")
    assert [each.container for each in found.explanation.tasks] == [twin.container(name).iri]


@pytest.mark.parametrize("name", CONTAINERS)
@pytest.mark.parametrize("noise", [0.0, 0.001])
def test_a_track_that_ends_moving_is_not_taken_further_than_it_was_seen(name: str, noise: float) -> None:
    found, upper = seen(name, np.linspace(0.0, 0.87, 60), noise)
    assert float(found.motion.values[-1, 0]) <= 0.87 * upper + 5 * noise
    assert found.explanation.tasks == ()


@pytest.mark.parametrize("name", CONTAINERS)
def test_where_a_track_rests_noise_does_not_count(name: str) -> None:
    shares = np.concatenate((np.zeros(40), np.linspace(0.0, 0.93, 60), np.full(40, 0.93)))
    found, upper = seen(name, shares, 0.002)
    assert float(found.motion.values[-1, 0]) == pytest.approx(0.93 * upper, abs=0.002)


def test_a_folding_doors_noisy_track_is_its_own_where_the_handle_hardly_moves() -> None:
    """Beside its path a sample was as near to a stretch of it, which was taken for two places."""
    twin = small_twin("a")
    door = twin.container("folding_door")
    handle = chain(build(twin.mechanism(twin.environment)), door.handle, twin.state)
    track = observed.seen(handle.poses(observed.stopping(0.95))[0][:, :3, 3], 2, 0.003)
    found = seen_in(twin, learn(track), Kinematics())
    assert found.followed.container.iri == door.iri
    assert float(found.motion.values[-1, 0]) == pytest.approx(1.9, abs=0.02)


def test_the_track_of_another_handle_is_the_motion_of_its_door(tmp_path: Path) -> None:
    box = '<collision><geometry><box size="{}"/></geometry></collision>'
    handles = "".join(
        f"""<link name="{name}_handle">{box.format("0.01 0.01 0.1")}</link>
<joint name="{name}_joint" type="fixed"><parent link="door"/><child link="{name}_handle"/>
<origin xyz="-0.05 0.5 {height}"/></joint>"""
        for name, height in (("high", 0.6), ("low", -0.6))
    )
    (tmp_path / "tall.urdf").write_text(
        f"""<robot name="tall"><link name="wall"/><link name="door">{box.format("0.02 0.5 1.4")}</link>
<joint name="door_joint" type="revolute"><parent link="wall"/><child link="door"/>
<origin xyz="1 0 1"/><axis xyz="0 0 1"/><limit lower="0" upper="1.5" velocity="1" effort="1"/></joint>
{handles}</robot>"""
    )
    twin = load_twin(tmp_path / "tall.urdf")
    door = twin.container("door")
    model = build(twin.mechanism(twin.environment))
    for handle in (door.handle, *door.more_handles):
        poses = chain(model, handle, twin.state).poses(np.linspace(0.0, 1.4, 80))[0]
        found = seen_in(twin, learn(Track(poses[:, :3, 3], np.arange(80) / 20, timed=True)), Kinematics())
        assert found.explanation.tasks[0].container == door.iri, handle
        assert float(found.motion.values[-1, 0]) == pytest.approx(1.4, abs=0.005)
