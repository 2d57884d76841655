"""The whole body follows tool poses while a differential base drives and turns at once.

From one tool pose to the next the base follows an exact arc, the exponential of SE(2) of its way
along the heading and its turn, so that it never slips sideways. Way, turn and arm steps come from a
few quadratic programs (PIQP): least tool error first, then the least motion, within joint limits and
speeds.
"""

import numpy as np
import piqp
from numpy.typing import NDArray

from services.embodiment.body import ik
from services.embodiment.body.kernels import REVOLUTE
from services.embodiment.body.limb import BASE, Limb

Array = NDArray[np.float64]

ITERATIONS = 12  # programs from one tool pose to the next
EXACT = 1e-7  # [m, and rad · ik.ARM] tool error of a solution
BASE_COST = 4.0  # [1] of base steps against equally willing arm steps: the base stands where it can
LEAST_MOTION = 1e-8  # [m²] weight of the steps against the squared tool error
LONGEST = 1.5  # [s] that the way from one tool pose to the next may take
JUMP = 0.35  # [rad or m] largest step, however fast the variable
STRAIGHT = 1e-4  # [rad] turns below which an arc's chord is taken from its series
LEVEL = 0.1  # [1] vertical part of an axis that counts as level
ROLLED = 2  # steps of the base: way along the heading, turn


def arc(pose: Array, way: float, turn: float) -> Array:
    """Base pose (3,) after an arc of that length [m] and turn [rad]."""
    ahead = pose[2] + turn / 2
    chord = way * _chord(turn)[0]
    return pose + np.array([chord * np.cos(ahead), chord * np.sin(ahead), turn])


def arc_jacobian(pose: Array, way: float, turn: float) -> Array:
    """Derivative of `arc` by way and turn, shape (3, 2)."""
    ahead = pose[2] + turn / 2
    along, across = np.array([np.cos(ahead), np.sin(ahead)]), np.array([-np.sin(ahead), np.cos(ahead)])
    chord, slope = _chord(turn)
    out = np.zeros((3, ROLLED))
    out[:2, 0] = chord * along
    out[:2, 1] = way * (slope * along + chord / 2 * across)
    out[2, 1] = 1.0
    return out


def _chord(turn: float) -> tuple[float, float]:
    """Chord of an arc of length 1, and its derivative by the turn."""
    half = turn / 2
    if abs(turn) < STRAIGHT:
        return 1.0 - half * half / 6, -turn / 12
    chord = float(np.sin(half) / half)
    return chord, (float(np.cos(half)) - chord) / turn


class Roller:
    """Steps of one limb on a differential base: z = [way, turn, arm …].

    Args:
        weight: How willingly each variable of the limb moves, shape (n,).
        limits: Lower and upper joint positions to keep, shape (n,) each.
    """

    def __init__(self, limb: Limb, weight: Array, limits: tuple[Array, Array]) -> None:
        self.limb = limb
        self.lower, self.upper = limits[0][3:], limits[1][3:]
        columns = np.r_[0, 2 : len(weight)]
        cost = 1.0 / weight[columns]
        cost[:ROLLED] *= BASE_COST
        self.cost = LEAST_MOTION * cost
        self.most = np.minimum(LONGEST * limb.velocity[columns], JUMP)
        self.solver = piqp.DenseSolver()
        self.solver.settings.eps_abs = self.solver.settings.eps_rel = 1e-12
        self.solver.settings.max_iter = 60
        self._ready = False

    def moved(self, x: Array, z: Array) -> Array:
        """Variables after the step z from x, shape (n,)."""
        return np.concatenate([arc(x[BASE], z[0], z[1]), x[3:] + z[ROLLED:]])

    def step(self, x: Array, target_r: Array, target_p: Array) -> Array | None:
        """Variables (n,) with the tool at the target, one step from x; None where no step leads there."""
        z = np.zeros(len(self.most))
        error = np.empty(6)
        at = x
        for _ in range(ITERATIONS):
            r, p = self.limb.tool(at)
            ik.pose_error(r, p, target_r, target_p, error)
            error[3:] *= ik.ARM
            if float(error @ error) < EXACT * EXACT:
                return at
            change = self._program(x, z, self._jacobian(x, z, at), error)
            if change is None:
                return None
            z = np.clip(z + change, -self.most, self.most)
            at = self.moved(x, z)
            at[3:] = np.clip(at[3:], self.lower, self.upper)
        return None

    def _jacobian(self, x: Array, z: Array, at: Array) -> Array:
        """Derivative of the tool by z, rotations scaled by `ik.ARM`, shape (6, n − 1)."""
        jacobian = self.limb.tool_jacobian(at)
        base = jacobian[:, BASE] @ arc_jacobian(x[BASE], z[0], z[1])
        out = np.hstack([base, jacobian[:, 3:]])
        out[3:] *= ik.ARM
        return out

    def _program(self, x: Array, z: Array, jacobian: Array, error: Array) -> Array | None:
        """Change d of z: least ½|J d − e|² + ½ Σ cost (z + d)² within limits and speeds."""
        quadratic = np.asfortranarray(jacobian.T @ jacobian + np.diag(self.cost))
        linear = self.cost * z - jacobian.T @ error
        low, high = -self.most - z, self.most - z
        arm = x[3:] + z[ROLLED:]
        low[ROLLED:] = np.maximum(low[ROLLED:], self.lower - arm)
        high[ROLLED:] = np.minimum(high[ROLLED:], self.upper - arm)
        # Rounding leaves a variable at its limit a bound on the wrong side of 0.
        low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
        if self._ready:
            self.solver.update(P=quadratic, c=linear, x_l=low, x_u=high)
        else:
            self.solver.setup(quadratic, linear, x_l=low, x_u=high)
            self._ready = True
        status = self.solver.solve()
        usable = (piqp.PIQP_SOLVED, piqp.PIQP_MAX_ITER_REACHED)
        return self.solver.result.x.copy() if status in usable else None


def telescope(limb: Limb) -> float | None:
    """Direction of the parked arm's first level prismatic axis from the base's heading [rad], if any."""
    joints = len(limb.chain[3])
    axes = np.empty((joints, 3))
    ik.tool_pose(limb.parked, limb.chain, np.empty((3, 3)), np.empty(3), axes, np.empty((joints, 3)))
    for axis, kind, variable in zip(axes, limb.chain[3], limb.chain[4], strict=True):
        if kind != REVOLUTE and variable >= BASE.stop and abs(axis[2]) < LEVEL:
            return float(np.arctan2(axis[1], axis[0]))
    return None


def roll(
    limb: Limb, x: Array, target: tuple[Array, Array], weight: Array, limits: tuple[Array, Array]
) -> Array | None:
    """Variables at each of the tool poses (K, 3, 3), (K, 3), from x near the first, shape (K, n).

    None where the tool cannot be kept on them.
    """
    path = rolled(limb, x, target, weight, limits)
    return path if len(path) == len(target[0]) else None


def rolled(
    limb: Limb, x: Array, target: tuple[Array, Array], weight: Array, limits: tuple[Array, Array]
) -> Array:
    """The same, up to the last of the tool poses at which the tool can be kept on them."""
    roller = Roller(limb, weight, limits)
    path = np.empty((len(target[0]), len(x)))
    for k, (rotation, translation) in enumerate(zip(*target, strict=True)):
        following = roller.step(x, np.ascontiguousarray(rotation), np.ascontiguousarray(translation))
        if following is None:
            return path[:k]
        path[k] = x = following
    return path
