r"""What the robot feels at each moment of a body motion while its hand moves a container.

The hand bears -F t, F the force at the handle and t the unit vector along the handle's path. Joint forces are
Pinocchio's inverse dynamics of the robot with it, :math:`\tau = M \dot v + h + J^T F t`, linear in F.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.iri import local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Container
from services.dynamics.cells import cells
from services.dynamics.model import Array, Mechanics
from services.dynamics.need import joint_force
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.sweep.pieces import Pieces
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene

PARTS = 2
"""[1] Cells of a piece of the body motion: its ends and its middle are looked at."""

NEAR_AXIS = 0.02
"""[m] A tool nearer to the hinge than this turns no door."""


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """What loads the robot at one moment.

    Attributes:
        time: [s].
        q: Coordinates of the scene, shape (nq,).
        without: Joint forces without the handle's, shape (nq,), mimicking joints at their source.
        each: Joint forces for each newton at the handle, shape (nq,).
        weight: Joint forces that weight alone asks for, shape (nq,).
        force: Least and largest force along the path, over all values of the parameters [N].
        along: Unit vector of the handle's path in the world, shape (3,).
        floor: Force of the floor on the robot without the handle's, in the world, shape (3,) [N].
        tool: Where the tool is, shape (3,) [m], and its orientation, shape (3, 3).
    """

    time: float
    q: Array
    without: Array
    each: Array
    weight: Array
    force: tuple[float, float]
    along: Array
    floor: Array
    tool: tuple[Array, Array]


def moments(
    scene: Scene, body: BodyMotion, container: Container, carried: Motion, mechanics: Mechanics
) -> Iterator[Moment]:
    """Moments at which the container moves: at each sample of the body motion and halfway between.

    Args:
        scene: Kitchen and robot, in the state in which the motion begins.
        body: The certified body motion.
        container: What it moves.
        carried: The container's motion under it, of the same samples.
        mechanics: Of the container.
    """
    pieces, _ = whole_motion(scene, body, Tolerances())
    spans = cells(carried, PARTS)
    forces = joint_force(mechanics, spans)
    for k in np.flatnonzero(~spans.rests):
        piece = int(k) // PARTS
        bounds = float(forces.lo[k]), float(forces.hi[k])
        for time in (float(spans.begin[k]), float(spans.end[k])):
            yield _moment(scene, pieces, (piece, time), body.gripper, container, mechanics, bounds)


def _moment(  # noqa: PLR0913, PLR0917 - a moment of one motion of one container
    scene: Scene,
    pieces: Pieces,
    at: tuple[int, float],
    gripper: str,
    container: Container,
    mechanics: Mechanics,
    joint_forces: tuple[float, float],
) -> Moment:
    piece, time = at
    s = np.array([time - pieces.start[piece]])
    q, v, a = (each[0] for each in pieces.at(np.array([piece]), s))
    model, data = scene.model, scene.data
    still = np.zeros(model.nv)
    weight = pin.rnea(model, data, q, still, still).copy()
    without = pin.rnea(model, data, q, v, a).copy()
    first = int(scene.model.getJointId(scene.names[int(scene.base[0])]))
    floor = data.oMi[first].rotation @ data.f[first].linear
    frame = model.getFrameId(scene.tool_frame(gripper))
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacement(model, data, frame)
    jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3].copy()
    tool = data.oMf[frame]
    along, lever = _path(scene, container, mechanics, tool.translation)
    low, high = (each / lever for each in joint_forces)
    each = jacobian.T @ along
    k = scene.coordinate[container.joint]
    for found in (weight, without, each):
        found[k] = 0.0
    return Moment(
        time,
        q.copy(),
        _at_sources(scene, without),
        _at_sources(scene, each),
        _at_sources(scene, weight),
        (low, high),
        along,
        floor,
        (tool.translation.copy(), tool.rotation.copy()),
    )


def _at_sources(scene: Scene, forces: Array) -> Array:
    """Virtual work: what a mimicking joint needs is asked of the joint that it follows."""
    coupling = scene.coupling
    found = np.zeros_like(forces)
    np.add.at(found, coupling.source, forces * coupling.multiplier)
    return found


def _path(scene: Scene, container: Container, mechanics: Mechanics, tool: Array) -> tuple[Array, float]:
    """Unit vector along which opening moves the tool's point, and its distance from the axis [m]."""
    index = int(scene.model.getJointId(container.joint))
    name = local_name(container.joint)
    joint = next(each for each in scene.kitchen.joints if each.name == name)
    placement = scene.data.oMi[index]
    axis = placement.rotation @ np.array(joint.axis)
    axis /= np.linalg.norm(axis)
    if mechanics.load.prismatic:
        return axis, 1.0
    across = np.cross(axis, tool - placement.translation)
    lever = float(np.linalg.norm(across))
    return across / max(lever, NEAR_AXIS), max(lever, NEAR_AXIS)
