r"""Where a frame of the kitchen is, as a function of the one joint that moves it.

A frame's pose is a product of Pinocchio's joint placements and joint motions; those joints which
follow the same actuated joint move together (a folding door has two), all others stay where the
state has them. Evaluated for all samples of a motion at once, which Pinocchio's own kinematics
cannot do.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import DisconnectedFrameError, MotionError, UnknownEntityError
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.mechanism import JointType
from sdt_kg.motion import Motion
from sdt_kg.twin import Container
from services.physics.tree import Model

if TYPE_CHECKING:
    from services.physics.model import Scene

Array = NDArray[np.float64]

LEVER = 0.115
"""[m] Turns an angle into a length when poses are fitted: 2 mm and 1° then weigh the same."""

SEEDS = 32
"""[1] Positions tried first when a pose is fitted; Newton's steps converge from the nearest."""

STEPS = 4
"""[1] Gauss-Newton steps; the error after a seed is squared by each."""


@dataclass(frozen=True, slots=True)
class _Moving:
    """before · X(k · a + c), X a rotation about, or a translation along, `axis`."""

    before: Array
    axis: Array
    prismatic: bool
    k: float
    c: float

    def motion(self, active: Array) -> tuple[Array, Array]:
        """X and dX/da, shape (T, 4, 4) each."""
        q = self.k * active + self.c
        X, dX = np.zeros((2, len(q), 4, 4))
        X[:, 3, 3] = 1
        if self.prismatic:
            X[:, :3, :3] = np.eye(3)
            X[:, :3, 3] = q[:, None] * self.axis
            dX[:, :3, 3] = self.k * self.axis
            return X, dX
        x, y, z = self.axis
        skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        sine, cosine = np.sin(q)[:, None, None], np.cos(q)[:, None, None]
        X[:, :3, :3] = np.eye(3) + sine * skew + (1 - cosine) * (skew @ skew)
        dX[:, :3, :3] = self.k * (cosine * skew + sine * (skew @ skew))
        return X, dX


@dataclass(frozen=True, slots=True)
class Follower:
    """A joint and the actuated joint that it follows: own = multiplier · active + offset."""

    own: Iri
    active: Iri
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class Chain:
    """world_T_frame as a function of the actuated joint's position a.

    Attributes:
        follower: The nearest joint that moves the frame.
        moving: The joints on the way that move with a, root first.
        tail: From the last of them to the frame.
    """

    follower: Follower
    moving: tuple[_Moving, ...]
    tail: Array

    def poses(self, active: Array) -> tuple[Array, Array]:
        """world_T_frame and its derivative by a, shape (T, 4, 4) each."""
        pose = np.broadcast_to(np.eye(4), (len(active), 4, 4))
        rate = np.zeros((len(active), 4, 4))
        for each in self.moving:
            X, dX = each.motion(active)
            pose, rate = pose @ each.before, rate @ each.before
            pose, rate = pose @ X, rate @ X + pose @ dX
        return pose @ self.tail, rate @ self.tail

    def fit(self, observed: Array, lower: float, upper: float) -> Array:
        """Positions a at which the frame is nearest to the observed poses, shape (T,).

        Least squares over the position and the rotation matrix times LEVER / √2, whose Frobenius
        norm is √2 times the angle for small angles.

        Args:
            observed: Shape (T, 4, 4).
            lower: The joint's range in which seeds are laid; a may end outside.
            upper: See lower.
        """
        seeds = np.linspace(lower, upper, SEEDS)
        target = _stacked(observed)
        gaps = target[:, None, :] - _stacked(self.poses(seeds)[0])[None]
        active = seeds[np.argmin(np.einsum("tsk,tsk->ts", gaps, gaps), axis=1)]
        for _ in range(STEPS):
            pose, rate = self.poses(active)
            gap, slope = target - _stacked(pose), _stacked(rate)
            active = active + np.einsum("tk,tk->t", gap, slope) / np.einsum("tk,tk->t", slope, slope)
        return active


def _stacked(poses: Array) -> Array:
    """Position and scaled rotation of each pose, shape (T, 12)."""
    scaled = poses[:, :3, :].copy()
    scaled[:, :, :3] *= LEVER / np.sqrt(2)
    return scaled.reshape(len(poses), 12)


def follower(model: Model, joint: Iri) -> Follower:
    """The actuated joint that moves this joint.

    Raises:
        UnknownEntityError: The kitchen has no such joint.
        DisconnectedFrameError: The joint is fixed, or mimics a fixed one.
    """
    mechanism = model.part.mechanism
    if joint not in model.coordinate:
        names = {joint_iri(mechanism.name, each.name) for each in mechanism.joints}
        if joint not in names:
            raise UnknownEntityError("joint", local_name(joint), map(local_name, names))
        raise DisconnectedFrameError(f"joint '{local_name(joint)}' is fixed", allowed="a joint that moves")
    k = model.coordinate[joint]
    multiplier = float(model.coupling.multiplier[k])
    if multiplier == 0:
        raise DisconnectedFrameError(
            f"joint '{local_name(joint)}' mimics a fixed joint", allowed="a joint that moves"
        )
    source = model.part.joints[int(model.coupling.source[k]) - model.part.first]
    return Follower(
        joint, joint_iri(mechanism.name, source.name), multiplier, float(model.coupling.offset[k])
    )


def of_own_joint(model: "Model | Scene", container: Container, motion: Motion) -> Motion:
    """The motion as values of the container's own joint, if it is given as those of one that moves with it.

    Raises:
        MotionError: It is of a joint that does not.
    """
    found = of_joint(model, container.joint, motion)
    if found is None:
        raise MotionError(
            f"the motion is of {local_name(motion.of)}, which does not move {container.name}",
            allowed=f"one of {local_name(container.joint)}",
        )
    return found


def of_joint(model: "Model | Scene", joint: Iri, motion: Motion) -> Motion | None:
    """The motion as values of a joint that moves with the one whose values it has; None if that does not."""
    own, given = model.coordinate[joint], model.coordinate.get(motion.of)
    if given == own:
        return motion
    source, multiplier, offset = model.coupling.source, model.coupling.multiplier, model.coupling.offset
    if given is None or source[given] != source[own] or multiplier[given] == 0:
        return None
    scale = multiplier[own] / multiplier[given]
    values = offset[own] + scale * (motion.values - offset[given])
    velocities = None if motion.velocities is None else np.asarray(scale * motion.velocities)
    return replace(motion, of=joint, values=values, velocities=velocities)


def chain(model: Model, body: Iri, state: Mapping[Iri, float]) -> Chain:
    """How the body's frame moves, all joints but its own staying in the state.

    Raises:
        UnknownEntityError: The kitchen has no such body.
        DisconnectedFrameError: No joint moves the body.
    """
    part, pinocchio = model.part, model.model
    name = local_name(body)
    if name not in part.attached:
        raise UnknownEntityError("frame", name, part.attached)
    index, joint_T_body = part.attached[name]
    if index == 0:
        raise DisconnectedFrameError(
            f"no joint moves '{name}'", allowed="a frame that moves with a container, such as its handle"
        )
    joints = {c: joint_iri(part.mechanism.name, each.name) for c, each in enumerate(part.joints, part.first)}
    own = follower(model, joints[pinocchio.idx_qs[index]])
    positions = np.array(
        [state.get(joints[c], 0.0) for c in range(part.first, part.first + len(part.joints))]
    )
    before, moving = np.eye(4), list[_Moving]()
    for each in [i for i in pinocchio.supports[index] if i > 0]:
        coordinate = pinocchio.idx_qs[each]
        joint, source = part.joints[coordinate - part.first], int(model.coupling.source[coordinate])
        step = _Moving(
            before @ pinocchio.jointPlacements[each].homogeneous,
            np.array(joint.axis),
            joint.type is JointType.PRISMATIC,
            float(model.coupling.multiplier[coordinate]),
            float(model.coupling.offset[coordinate]),
        )
        if joints[source] == own.active:
            moving.append(step)
            before = np.eye(4)
        else:
            before = step.before @ step.motion(positions[[source - part.first]])[0][0]
    return Chain(own, tuple(moving), before @ joint_T_body.homogeneous)
