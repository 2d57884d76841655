"""Compiled kinematics against Pinocchio, over random chains of turning, sliding, coupled and mimic joints."""

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from services.embodiment.body import ik, kernels

pytestmark = pytest.mark.oracle

Array = NDArray[np.float64]

JOINTS = 12
HELD = -1
SAME = 1e-9


def unit(rng: np.random.Generator) -> Array:
    axis = rng.normal(size=3)
    return axis / np.linalg.norm(axis)


def placement(rng: np.random.Generator) -> pin.SE3:
    return pin.SE3(pin.exp3(2 * rng.normal(size=3)), rng.normal(size=3))


class Chain:
    """A random chain, as Pinocchio has it and as `ik` and `kernels` take it.

    The first variable moves two joints alike, the second one is mimicked with a factor and an offset;
    one joint is held where it is.
    """

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self.model, parent = pin.Model(), 0
        self.kind = rng.integers(0, 2, JOINTS)
        axes = np.array([unit(rng) for _ in range(JOINTS)])
        for k in range(JOINTS):
            joint = (pin.JointModelPrismaticUnaligned, pin.JointModelRevoluteUnaligned)[self.kind[k]](axes[k])
            parent = self.model.addJoint(parent, joint, placement(rng), f"joint{k}")
        tool = placement(rng)
        self.frame = self.model.addFrame(pin.Frame("tool", parent, tool, pin.OP_FRAME))
        self.data = self.model.createData()
        placed = list(self.model.jointPlacements)
        turns, places = (
            np.array([one.rotation for one in placed]),
            np.array([one.translation for one in placed]),
        )
        self.variable = np.array([0, 1, 0, 1, HELD, *range(2, JOINTS - 3)])
        self.share, self.offset = np.ones(JOINTS), np.zeros(JOINTS)
        self.share[3], self.offset[3], self.offset[4] = rng.normal(), rng.normal(), rng.normal()
        ends = np.ascontiguousarray(tool.rotation), np.ascontiguousarray(tool.translation)
        moves = axes, self.kind, self.variable, self.share, self.offset
        self.chain = (turns[1:].copy(), places[1:].copy(), *moves, *ends)
        parents = np.array(list(self.model.parents), dtype=np.int64)
        still = np.zeros((1, 3)), np.zeros(1, np.int64)
        own = np.concatenate([still[0], axes]), np.concatenate([still[1], self.kind])
        self.tree = parents, turns, places, *own
        self.x = rng.uniform(-7.0, 7.0, JOINTS - 3)

    def q(self) -> Array:
        moved = np.where(self.variable == HELD, 0.0, self.share * self.x[self.variable])
        return moved + self.offset

    def rates(self) -> Array:
        """Change of q for a change of x, shape (JOINTS, n)."""
        out = np.zeros((JOINTS, len(self.x)))
        for k in np.flatnonzero(self.variable != HELD):
            out[k, self.variable[k]] = self.share[k]
        return out


@pytest.mark.parametrize("seed", range(20))
def test_tool_and_jacobian_are_those_of_pinocchio(seed: int) -> None:
    one = Chain(seed)
    r, p, out = np.empty((3, 3)), np.empty(3), np.empty((6, len(one.x)))
    z, o = np.empty((JOINTS, 3)), np.empty((JOINTS, 3))
    ik.tool_pose(one.x, one.chain, r, p, z, o)
    ik.jacobian(one.chain, p, z, o, out)
    pin.framesForwardKinematics(one.model, one.data, one.q())
    world_T_tool = one.data.oMf[one.frame]
    np.testing.assert_allclose(r, world_T_tool.rotation, atol=SAME)
    np.testing.assert_allclose(p, world_T_tool.translation, atol=SAME)
    asked = one.model, one.data, one.q(), one.frame, pin.LOCAL_WORLD_ALIGNED
    np.testing.assert_allclose(out, pin.computeFrameJacobian(*asked) @ one.rates(), atol=SAME)


@pytest.mark.parametrize("seed", range(20))
def test_frames_of_all_joints_are_those_of_pinocchio(seed: int) -> None:
    one = Chain(seed)
    r, p = np.empty((JOINTS + 1, 3, 3)), np.empty((JOINTS + 1, 3))
    kernels.forward(one.q(), one.tree, r, p)
    pin.forwardKinematics(one.model, one.data, one.q())
    for j in range(1, JOINTS + 1):
        np.testing.assert_allclose(r[j], one.data.oMi[j].rotation, atol=SAME)
        np.testing.assert_allclose(p[j], one.data.oMi[j].translation, atol=SAME)


@pytest.mark.parametrize("seed", range(20))
def test_frames_of_one_joint_along_a_motion_are_those_of_all_joints(seed: int) -> None:
    one = Chain(seed)
    qs = one.q() + np.linspace(0.0, 0.5, 5)[:, None]
    r, p = np.empty((JOINTS + 1, 3, 3)), np.empty((JOINTS + 1, 3))
    for joint in range(JOINTS + 1):
        along_r, along_p = np.empty((len(qs), 3, 3)), np.empty((len(qs), 3))
        kernels.poses(qs, one.tree, joint, along_r, along_p)
        for k, q in enumerate(qs):
            kernels.forward(q, one.tree, r, p)
            assert (along_r[k] == r[joint]).all()
            assert (along_p[k] == p[joint]).all()
