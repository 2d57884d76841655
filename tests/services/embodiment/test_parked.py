"""A parked robot that drives: free exactly where the whole scene is, pose by pose and along a drive."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sdt_kg.iri import joint_iri
from sdt_kg.load import bundled, load_twin
from services.embodiment.body.demands import Margins, beside
from services.embodiment.body.limb import make_limb
from services.embodiment.body.parked import Parked
from services.embodiment.body.world import World
from services.embodiment.hold.kit import Kits
from services.physics.model import Scene
from tests.services.embodiment.front import front

pytestmark = pytest.mark.oracle

BESIDE = 25
"""A front whose handle is 1.4 mm beside a gripper of the TIAGo++, parked at its start pose."""


@pytest.mark.parametrize(("robot", "nothing"), [("pr2", False), ("stretch", False), ("stretch", True)])
def test_a_parked_robot_stands_and_drives_where_no_pair_of_the_scene_is_too_near(
    robot: str, nothing: bool
) -> None:
    """Of a described robot nothing is demanded but no contact: its shapes do not fall short."""
    twin = load_twin("b", [robot])
    world = World(Scene(twin, twin.robots[0]))
    outside = Kits(world, Margins()).outside()
    if nothing:
        outside = replace(outside, environment=np.minimum(outside.environment, 0.0))
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


def test_distances_to_what_a_robot_is_parked_beside_are_halved_and_no_others(tmp_path: Path) -> None:
    one = front(tmp_path, BESIDE, "tiago_dual", 2, gripper=1)
    demands, q = one.kit.opened, one.world.scene.q((0.0, 0.0, 0.0), {})
    contact = one.world.contact(q[None], demands)
    assert contact is not None
    there = one.world.distance(contact.shapes, *one.world.frames(q))
    assert 0.0 < there < 0.002
    eased = beside(one.world, demands, q)
    assert one.world.free(q, eased)
    changed = np.flatnonzero(eased.environment != demands.environment)
    assert 0 < len(changed) < 10
    assert (eased.environment.flat[changed] < demands.environment.flat[changed]).all()
    assert (eased.environment.flat[changed] > one.world.scene.annotation.overhang).all()
    away = one.world.scene.q((-1.0, 0.0, 0.0), {})
    np.testing.assert_array_equal(beside(one.world, demands, away).environment, demands.environment)


def test_distances_to_what_a_robot_touches_are_kept(tmp_path: Path) -> None:
    one = front(tmp_path, BESIDE, "tiago_dual", 2, gripper=1)
    inside = one.world.scene.q((0.1, 0.0, 0.0), {})
    assert not one.world.free(inside, beside(one.world, one.kit.opened, inside))


@pytest.mark.parametrize(
    ("lower", "said", "at"),
    [("0.0", "", 0.0), ("0.02", "", 0.02), ("-0.1", "", 0.0), ("0.02", "0.05", 0.05), ("0", "0.05", 0.05)],
)
def test_joints_that_share_a_motor_are_parked_alike(tmp_path: Path, lower: str, said: str, at: float) -> None:
    joint = "joint_arm_l1"
    for name in ("stretch.urdf", "stretch.ttl"):
        text = bundled("robot", "stretch").with_name(name).read_text(encoding="utf-8")
        text = re.sub(rf'(joint name="{joint}"[^§]*?lower=)"0"', rf'\1"{lower}"', text, count=1)
        more = f"<{joint_iri('stretch', joint)}> sdt:parkedPosition {said} ." if said else ""
        (tmp_path / name).write_text(text + (more if name.endswith("ttl") else ""), encoding="utf-8")
    twin = load_twin("b", [tmp_path / "stretch.urdf"])
    scene = Scene(twin, twin.robots[0])
    q = scene.q((0.0, 0.0, 0.0), {})
    (telescope,) = scene.annotation.coupled
    own = [scene.coordinate[joint_iri("stretch", name)] for name in telescope]
    assert q[own].tolist() == [at] * 4
    limb = make_limb(World(scene), scene.annotation.grippers[0])
    k = next(k for k, variable in enumerate(limb.variables) if variable in own)
    assert (limb.lower[k], limb.upper[k]) == pytest.approx((max(0.0, float(lower)), 0.13))
