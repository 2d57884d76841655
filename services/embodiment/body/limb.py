"""A limb: base, torso, one arm and its fingers as the vector x that planning moves.

x = [base x, y, yaw, arm …]; a configuration of the scene is q = rest + expansion · x, linear, so
that coupled joints (a telescope) and mimic joints follow. Fingers are set apart by `with_fingers`.
What hangs beside the arm, a head or another arm, may be of it too: it does not move the tool, but out of
its way.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file
from numpy.typing import NDArray

from sdt_kg.annotation import Gripper
from sdt_kg.errors import AnnotationError
from sdt_kg.iri import Iri, body_iri, joint_iri, local_name
from services.embodiment.body import ik
from services.embodiment.body.world import World
from services.physics.model import Scene

Array = NDArray[np.float64]

BASE = slice(0, 3)
ASIDE = 0.5  # [1] of random postures in which what hangs beside the arm is aside
ROUNDING = 1e-9  # [rad or m] of limits that joints which move together have in common


@dataclass(frozen=True, slots=True, eq=False)
class Limb:
    """Variables, limits and tool of one gripper.

    Attributes:
        variables: Scene coordinate of each variable (of the first of a coupled group), shape (n,).
        expansion: Shape (nq, n).
        rest: Scene configuration at x = 0, everything else parked, fingers open, shape (nq,).
        lower, upper, velocity, acceleration, gain: Shape (n,); the base's positions are unbounded.
        parked: x when parked, its base at 0, shape (n,).
        aside: Where what hangs beside the arm is out of the way; not a number for all else, shape (n,).
        carries: How far a point of that moves at most for a unit [m/rad or m/m]; 0 for all else, shape (n,).
        chain: What `ik` takes.
        palm: Bodies of the gripper that move with the tool, fingers left out.
        fingers: Bodies that may touch a handle.
    """

    gripper: Gripper
    variables: NDArray[np.intp]
    expansion: Array
    rest: Array
    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    gain: Array
    parked: Array
    aside: Array
    carries: Array
    chain: tuple
    palm: tuple[str, ...]
    fingers: tuple[str, ...]

    def q(self, x: Array, rest: Array | None = None) -> Array:
        """Scene configurations of x, shape (…, n); `rest` replaces the limb's own."""
        return (self.rest if rest is None else rest) + x @ self.expansion.T

    def drawn(self, rng: np.random.Generator, count: int, lower: Array, upper: Array) -> Array:
        """Random x between limits, of hinges without any within half a turn, shape (count, n).

        What hangs beside the arm is aside in some of them.
        """
        xs = rng.uniform(*ends(lower, upper), (count, len(lower)))
        if (beside := np.isfinite(self.aside)).any():
            xs[np.ix_(rng.random(count) < ASIDE, beside)] = self.aside[beside]
        return xs

    def tool(self, x: Array) -> tuple[Array, Array]:
        """World pose of the tool: rotation (3, 3), translation (3,)."""
        joints = len(self.chain[3])
        r, p = np.empty((3, 3)), np.empty(3)
        ik.tool_pose(x, self.chain, r, p, np.empty((joints, 3)), np.empty((joints, 3)))
        return r, p

    def tool_jacobian(self, x: Array) -> Array:
        """World Jacobian of the tool, linear over angular, shape (6, n)."""
        joints = len(self.chain[3])
        r, p = np.empty((3, 3)), np.empty(3)
        z, o = np.empty((joints, 3)), np.empty((joints, 3))
        out = np.empty((6, len(x)))
        ik.tool_pose(x, self.chain, r, p, z, o)
        ik.jacobian(self.chain, p, z, o, out)
        return out


def ends(lower: Array, upper: Array) -> tuple[Array, Array]:
    """Between which random positions are drawn: limits, or half a turn where there are none, (n,) each."""
    low, high = np.isfinite(lower), np.isfinite(upper)
    return np.where(low, lower, -np.pi), np.where(high, upper, np.pi)


def make_limb(world: World, gripper: Gripper, beside: Mapping[Iri, float] | None = None) -> Limb:
    """The limb that carries a gripper.

    Args:
        world: Of which robot.
        gripper: Which.
        beside: Joints that are of it besides its own, as `hanging` has them, and where they are aside.

    Raises:
        AnnotationError: Joints that move together have no position in common within their limits.
    """
    scene = world.scene
    frame, support = _tool(scene, gripper)
    given = {scene.coordinate[joint]: at for joint, at in (beside or {}).items()}
    aside = {k: at for k, at in given.items() if k + 1 not in support}
    variables, expansion = _expansion(scene, gripper, [*support, *(k + 1 for k in aside)])
    rest = _rest(scene, gripper)
    parked = rest[variables].copy()
    parked[BASE] = 0.0
    rest = rest - expansion @ parked
    bounds = scene.bounds
    lower, upper = bounds.lower[variables], bounds.upper[variables]
    lower[BASE], upper[BASE] = -np.inf, np.inf
    for k in range(3, len(variables)):
        lower[k], upper[k] = _coupled_limits(scene, expansion[:, k], rest, lower[k], upper[k])
        if lower[k] > upper[k] + ROUNDING:
            names = ", ".join(local_name(scene.names[each]) for each in np.flatnonzero(expansion[:, k]))
            raise AnnotationError(
                f"joints that move together have no position in common within their limits: {names}",
                allowed="limits, multipliers and offsets that leave them one",
                remedy="correct the robot's limits, <mimic> or sdt:couples",
            )
        upper[k] = max(lower[k], upper[k])
    palm = _palm(scene, gripper, frame.parentJoint)
    fingers = tuple(body_iri(scene.robot.mechanism.name, body) for body in gripper.fingers)
    chain = _chain(world, frame, support, rest, expansion)
    return Limb(
        gripper,
        variables,
        expansion,
        rest,
        lower,
        upper,
        *rate_limits(scene, expansion),
        parked,
        np.array([aside.get(k, np.nan) for k in variables.tolist()]),
        np.array([_carries(world, k) if k in aside else 0.0 for k in variables.tolist()]),
        chain,
        palm,
        fingers,
    )


def hanging(scene: Scene, *, arms: bool) -> tuple[Iri, ...]:
    """Joints that planning may move and that no gripper is on, as a head's; or those of each arm too."""
    robot, annotation = scene.robot.mechanism.name, scene.annotation
    supports = [{*_tool(scene, gripper)[1]} for gripper in annotation.grippers]
    of_arms = set.intersection(*supports or [set[int]()]) if arms else set[int]().union(*supports)
    kept = (joint_iri(robot, name) for name in (*annotation.held, *annotation.finger_joints))
    still = {*kept, *(scene.names[k - 1] for k in of_arms)}
    every = (joint_iri(robot, joint.name) for joint in scene.robot.joints if joint.mimic is None)
    return tuple(joint for joint in every if joint not in still)


def _carries(world: World, k: int) -> float:
    """How far a point of what a coordinate carries moves at most for a unit of it [m/rad or m/m]."""
    parents, _, places, _, kinds = world.tree
    if not kinds[k + 1]:
        return 1.0
    joints, _, middles = world.boxes
    away = np.full(len(parents), -np.inf)
    away[k + 1] = 0.0
    for j in range(k + 2, len(parents)):
        away[j] = away[parents[j]] + np.linalg.norm(places[j])
    reach = away[joints] + np.linalg.norm(middles, axis=1) + world.radius
    return float(reach.max(initial=0.0))


def _tool(scene: Scene, gripper: Gripper) -> tuple[pin.Frame, list[int]]:
    """The frame of a gripper's tool, and the model's joints from the base to the one that carries it."""
    frame = scene.model.frames[scene.model.getFrameId(scene.tool_frame(gripper.name))]
    chain, joint = list[int](), frame.parentJoint
    while joint > 0:
        chain.append(joint)
        joint = scene.model.parents[joint]
    return frame, chain[::-1]


def _expansion(scene: Scene, gripper: Gripper, support: list[int]) -> tuple[NDArray[np.intp], Array]:
    name = scene.robot.mechanism.name
    own = {joint_iri(name, finger.joint) for finger in gripper.finger_joints}
    held = {joint_iri(name, joint) for joint in scene.annotation.held}
    groups = {
        joint_iri(name, joint): [scene.coordinate[joint_iri(name, other)] for other in group]
        for group in scene.annotation.coupled
        for joint in group
    }
    taken: set[int] = set()
    variables, columns = [], []
    for joint in support:
        k = int(scene.coupling.source[joint - 1])
        iri = scene.names[k]
        if k in taken or iri in own or iri in held:
            continue
        members = groups.get(iri, [k])
        taken.update(members)
        column = scene.coupling.rates(np.isin(np.arange(scene.model.nq), members).astype(np.float64))
        if min(float(most[0]) for most in rate_limits(scene, column[:, None])) > 0:  # else it may not move
            variables.append(k)
            columns.append(column)
    return np.array(variables, dtype=np.intp), np.stack(columns, axis=1)


def _rest(scene: Scene, gripper: Gripper) -> Array:
    return scene.q((0.0, 0.0, 0.0), {finger.joint: finger.open for finger in gripper.finger_joints})


def _coupled_limits(
    scene: Scene, column: Array, rest: Array, lower: float, upper: float
) -> tuple[float, float]:
    """Limits of a variable such that all joints that follow it keep theirs."""
    for k in np.flatnonzero(column):
        ends = sorted(
            ((scene.bounds.lower[k] - rest[k]) / column[k], (scene.bounds.upper[k] - rest[k]) / column[k])
        )
        lower, upper = max(lower, ends[0]), min(upper, ends[1])
    return lower, upper


def rate_limits(scene: Scene, expansion: Array) -> tuple[Array, Array, Array]:
    """Limits of velocity and acceleration, and gains, of variables with an expansion, shape (n,) each."""
    share, bounds = np.abs(expansion), scene.bounds
    with np.errstate(divide="ignore", invalid="ignore"):
        velocity, acceleration = (
            np.where(share > 0, most[:, None] / share, np.inf).min(axis=0)
            for most in (bounds.velocity, bounds.acceleration)
        )
    return velocity, acceleration, np.where(share > 0, bounds.gain[:, None], np.inf).min(axis=0)


def _palm(scene: Scene, gripper: Gripper, joint: int) -> tuple[str, ...]:
    """Bodies that move with the tool's joint or hang on it, fingers left out."""
    below = {joint}
    for other in range(joint + 1, scene.model.njoints):
        if scene.model.parents[other] in below:
            below.add(other)
    fingers = set(gripper.fingers)
    name = scene.robot.mechanism.name
    return tuple(
        body_iri(name, body)
        for body, (carrier, _) in scene.robot.attached.items()
        if carrier in below and body not in fingers
    )


def _chain(world: World, frame: object, support: list[int], rest: Array, expansion: Array) -> tuple:
    _, place_r, place_p, axis, kind = world.tree
    index = np.array(support)
    coordinate = index - 1
    moving = np.abs(expansion[coordinate]) > 0
    variable = np.where(moving.any(axis=1), moving.argmax(axis=1), -1).astype(np.int64)
    share = np.where(variable >= 0, expansion[coordinate, variable], 0.0)
    end = frame.placement  # pyright: ignore[reportAttributeAccessIssue]  # a pin.Frame
    return (
        np.ascontiguousarray(place_r[index]),
        np.ascontiguousarray(place_p[index]),
        np.ascontiguousarray(axis[index]),
        np.ascontiguousarray(kind[index]),
        variable,
        share,
        rest[coordinate],
        np.ascontiguousarray(end.rotation),
        np.ascontiguousarray(end.translation),
    )
