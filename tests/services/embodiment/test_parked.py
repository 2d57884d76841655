"""A parked robot that drives: free exactly where the whole scene is, pose by pose and along a drive."""

import numpy as np
import pytest

from sdt_kg.load import load_twin
from services.embodiment.body.limb import Margins
from services.embodiment.body.parked import Parked
from services.embodiment.body.world import World
from services.embodiment.hold.kit import Kits
from services.physics.model import Scene

pytestmark = pytest.mark.oracle


@pytest.mark.parametrize("robot", ["pr2", "stretch"])
def test_a_parked_robot_stands_and_drives_where_no_pair_of_the_scene_is_too_near(robot: str) -> None:
    twin = load_twin("b", [robot])
    world = World(Scene(twin, twin.robots[0]))
    outside = Kits(world, Margins()).outside()
    parked = Parked(world, world.scene.q((0.0, 0.0, 0.0), {}), outside)
    rng, drives = np.random.default_rng(2), {True: 0, False: 0}
    for _ in range(40):
        start = rng.uniform((-2.0, -2.0, -3.0), (1.5, 2.5, 3.0))
        poses = np.linspace(start, start + rng.normal(0.0, 0.2, 3), 16)
        stands = parked.stands(poses)
        configurations = (world.scene.q(pose, {}) for pose in poses)
        assert stands.tolist() == [world.contact(q[None], outside) is None for q in configurations]
        assert parked.drives(poses) == stands.all()
        drives[parked.drives(poses)] += 1
    assert min(drives.values()) > 3
