"""Where joints are: as Pinocchio has them to the last bit, in memory that grows as their number."""

import numpy as np
import pinocchio as pin
import pytest

from services.physics.placements import TOGETHER, Placements, part_of


def random_model(seed: int, joints: int, on_the_world: float) -> pin.Model:
    """Slides and hinges along random axes, of which that share hangs on the world, the rest on one before."""
    rng, model = np.random.default_rng(seed), pin.Model()
    pin.seed(seed)
    for k in range(joints):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        parent = 0 if rng.random() < on_the_world else int(rng.integers(k + 1))
        kind = pin.JointModelPrismaticUnaligned if rng.random() < 0.5 else pin.JointModelRevoluteUnaligned
        index = model.addJoint(parent, kind(axis), pin.SE3.Random(), f"joint{k}")
        model.appendBodyToJoint(index, pin.Inertia.Random(), pin.SE3.Random())
    return model


@pytest.mark.parametrize("on_the_world", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("joints", [1, TOGETHER, 3 * TOGETHER])
def test_joints_are_where_pinocchio_has_them_to_the_last_bit(joints: int, on_the_world: float) -> None:
    model = random_model(joints, joints, on_the_world)
    placements, data, rng = Placements(model), pin.Data(model), np.random.default_rng(joints)
    for _ in range(5):
        q = rng.normal(size=model.nq)
        pin.forwardKinematics(model, data, q)
        found = placements.move(q)
        assert found is placements.world_T_joint
        for ours, theirs in zip(found, data.oMi, strict=True):
            np.testing.assert_array_equal(ours.homogeneous, theirs.homogeneous)


def test_a_model_without_joints_has_the_world() -> None:
    (world,) = Placements(pin.Model()).move(np.zeros(0))
    np.testing.assert_array_equal(world.homogeneous, np.eye(4))


def test_tensors_of_many_drawers_grow_as_their_number() -> None:
    parts = Placements(random_model(0, 600, 1.0))._parts
    assert sum(len(coordinates) for _, _, coordinates in parts) == 600
    assert max(part.nv for part, _, _ in parts) <= TOGETHER
    assert len(parts) == 19  # 600 / 32, rounded up


def test_a_part_has_the_efforts_that_its_joints_have_in_the_whole() -> None:
    model, rng = random_model(3, 20, 0.3), np.random.default_rng(3)
    roots = [joint for joint in range(1, model.njoints) if model.parents[joint] == 0]
    joints = sorted(model.subtrees[roots[0]])
    part, own = part_of(model, joints), np.array(joints) - 1
    q, v, a = rng.normal(size=(3, model.nq))
    whole = pin.rnea(model, model.createData(), q, v, a)
    np.testing.assert_array_equal(pin.rnea(part, part.createData(), q[own], v[own], a[own]), whole[own])
