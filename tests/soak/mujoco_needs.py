"""What a mechanism needs, by MuJoCo: nothing of ours computes it.

MuJoCo reads the URDF itself, spreads mass over the shapes itself, and its inverse dynamics give inertia and
weight; springs, latches, soft closers and friction are added as services/dynamics/README.md writes them.
"""

import mujoco
import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from sdt_kg.motion import Motion
from tests.soak.mechanisms import Array, Drawn, Values

WAYS = 201
"""[1] Moments at which a motion is looked at."""


class Mujoco:
    """MuJoCo's model of a mechanism, and what it needs."""

    def __init__(self, drawn: Drawn) -> None:
        # u and w of their own make masses that no body has: inverse dynamics need no inverse of theirs
        mujoco.set_mju_user_warning(lambda text: None)
        self.drawn = drawn
        self.model = mujoco.MjModel.from_xml_string(drawn.urdf)
        self.model.body_simple[:] = 0  # masses change: nothing of what was compiled of them is kept
        self.model.dof_simplenum[:] = 0
        self.data = mujoco.MjData(self.model)
        find = lambda name: mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name)  # noqa: E731
        self.joints = [find(each) for each in drawn.joints]
        self.bodies = [int(self.model.jnt_bodyid[each]) for each in self.joints]
        self.dofs = [int(self.model.jnt_dofadr[each]) for each in self.joints]
        self.ratios = np.zeros(self.model.nv)
        self.ratios[self.dofs] = drawn.ratios
        self.given = [
            (self.model.body_ipos[k].copy(), self._about(k, j))
            for k, j in zip(self.bodies, self.joints, strict=True)
        ]

    def _about(self, body: int, joint: int) -> float:
        """Inertia about the joint's axis of one kilogram [m²]."""
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, self.model.body_iquat[body])
        axis = turn.reshape(3, 3).T @ self.model.jnt_axis[joint]
        place = self.model.body_ipos[body]
        across = place - (place @ self.model.jnt_axis[joint]) * self.model.jnt_axis[joint]
        own = float(axis**2 @ self.model.body_inertia[body]) / float(self.model.body_mass[body])
        return own + float(across @ across)

    def set(self, values: list[Values]) -> None:
        """Masses, the centre w times as far from the axis, u times the inertia about it."""
        for body, joint, one, (place, about) in zip(
            self.bodies, self.joints, values, self.given, strict=True
        ):
            axis = self.model.jnt_axis[joint]
            along = (place @ axis) * axis
            mass = one.figures["movedMass"] + one.figures["contentsMass"]
            across = one.w * (place - along)
            own = mass * (one.u * about - float(across @ across))
            self.model.body_mass[body] = mass
            self.model.body_ipos[body] = along + across
            self.model.body_iquat[body] = (1, 0, 0, 0)
            self.model.body_inertia[body] = own
            self.model.body_sameframe[body] = 0

    def heavy(self, q: float, v: float, a: float) -> float:
        """Inertia and weight, felt at the container's joint."""
        self.data.qpos[:], self.data.qvel[:], self.data.qacc[:] = (self.ratios * each for each in (q, v, a))
        mujoco.mj_inverse(self.model, self.data)
        passive = self.data.qfrc_constraint + self.data.qfrc_passive
        return float(self.ratios @ (self.data.qfrc_inverse + passive))

    def way(self, q: float, point: Array) -> float:
        """How far a point of the handle goes for each rad or m."""
        self.data.qpos[:] = self.ratios * q
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        body, jacobian = self.bodies[0], np.zeros((3, self.model.nv))
        world = self.data.xpos[body] + self.data.xmat[body].reshape(3, 3) @ point
        mujoco.mj_jac(self.model, self.data, jacobian, None, world, body)
        return float(np.linalg.norm(jacobian @ self.ratios))


def resisting(drawn: Drawn, values: list[Values], q: float) -> float:
    """Springs, latches and soft closers, felt at the container's joint."""
    total = 0.0
    for ratio, forces, one in zip(map(abs, drawn.ratios), drawn.forces, values, strict=True):
        at, figures = ratio * q, one.figures
        total += ratio * figures["springStiffness"] * (at - forces.rest)
        total += ratio * figures["latchForce"] * max(0.0, 1 - at / forces.latch_width)
        total += ratio * figures["softCloserForce"] * (at < forces.closer_range)
    return total


def sliding(drawn: Drawn, values: list[Values], q: float, v: float) -> float:
    """Friction, damping and the closer's damping while it moves, felt at the container's joint."""
    total = 0.0
    for ratio, forces, one in zip(map(abs, drawn.ratios), drawn.forces, values, strict=True):
        figures, speed = one.figures, ratio * v
        total += ratio * (figures["coulombFriction"] * np.sign(v) + figures["viscousFriction"] * speed)
        total += ratio * figures["softCloserDamping"] * min(speed, 0.0) * (ratio * q < forces.closer_range)
    return total


def held(drawn: Drawn, values: list[Values]) -> float:
    """Friction that rest can bear, felt at the container's joint."""
    return sum(
        abs(ratio) * one.figures["breakAwayFriction"] for ratio, one in zip(drawn.ratios, values, strict=True)
    )


def along(motion: Motion) -> tuple[Array, Array, Array, Array]:
    """Times, positions, speeds and accelerations of a motion, by scipy's splines."""
    spline = CubicSpline(motion.times, motion.values[:, 0], bc_type="clamped")
    if motion.velocities is not None:
        spline = CubicHermiteSpline(motion.times, motion.values[:, 0], motion.velocities[:, 0])
    times = np.linspace(motion.times[0], motion.times[-1], WAYS)
    return times, spline(times), spline(times, 1), spline(times, 2)


def needed(theirs: Mujoco, values: list[Values], motion: Motion) -> Array:
    """Size of the joint's force at each moment at which it moves, and first the one that leaves rest."""
    drawn = theirs.drawn
    theirs.set(values)
    _, q, v, a = along(motion)
    way = np.sign(motion.values[-1, 0] - motion.values[0, 0])
    start = theirs.heavy(q[0], 0.0, 0.0) + resisting(drawn, values, q[0])
    found = [max(0.0, way * start + held(drawn, values))]
    for at, speed, rate in zip(q, v, a, strict=True):
        if abs(speed) > 1e-6:
            force = theirs.heavy(at, speed, rate) + resisting(drawn, values, at)
            found.append(abs(force + sliding(drawn, values, at, speed)))
        else:
            found.append(0.0)
    return np.array(found)
