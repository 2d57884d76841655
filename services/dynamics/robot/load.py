r"""What the robot feels over each span of a body motion, its hand on a handle: bounds for all of it.

The hand bears -F t, F the force at the handle and t the unit vector along the handle's path. Joint forces are
:math:`\tau = M \dot v + h + J^T F t`, linear in F, bounded over spans of time by balls (`newton`).
"""

from dataclasses import dataclass

import numpy as np

from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import local_name
from sdt_kg.motion import BodyMotion
from services.dynamics.cells import Cells
from services.dynamics.model import Array, Mechanics, Reach
from services.dynamics.need import joint_force
from services.dynamics.robot.balls import Numbers, Vectors, fixed
from services.dynamics.robot.newton import Along, Placed, Robot
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.sweep.pieces import Pieces
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.geometry.interval import Interval
from services.physics.model import Scene

NEAR_AXIS = 0.02
"""[m] A tool nearer to the hinge than this turns no door."""

CLOSES_ALONG = np.array([0.0, 1.0, 0.0])
"""Direction of the tool's frame along which pads close."""


@dataclass(frozen=True, slots=True, eq=False)
class Loads:
    """What loads the robot, over C spans of the motion; every bound holds at all times of its span.

    Attributes:
        begin, end: Of the spans, shape (C,) [s].
        without: Coordinate → joint forces without the handle's, mimicking joints at their source.
        weightless: The same, without what weight asks for.
        each: Coordinate → joint forces for each newton at the handle; joints that bear none are left out.
        force: Force along the path, over all values of the parameters [N].
        along: Unit vector of the handle's path in the world.
        beside: Share of the force that pulls one pad off, along the direction in which pads close [1].
        floor: Force of the floor on the robot without the handle's [N].
        moment: Its moment about the point of the floor below the base's origin, without the handle's [N m].
        arm: From that point to the tool [m].
        base: Where the base is.
    """

    begin: Array
    end: Array
    without: dict[int, Interval]
    weightless: dict[int, Interval]
    each: dict[int, Interval]
    force: Interval
    along: Vectors
    beside: Interval
    floor: Vectors
    moment: Vectors
    arm: Vectors
    base: Placed


def loads(scene: Scene, body: BodyMotion, mechanics: Mechanics, spans: Cells) -> Loads:
    """Bounds over spans of the body motion.

    Args:
        scene: Kitchen and robot, in the state in which the motion begins.
        body: The certified body motion.
        mechanics: Of the container that it moves.
        spans: Of the container's motion under it, which has the same samples.

    Raises:
        OracleRejectedError: The container hangs on another that moves, too.
    """
    pieces, _ = whole_motion(scene, body, Tolerances())
    along, robot = Along(pieces, spans.piece, spans.begin, spans.end), Robot(scene)
    placed = robot.placed(along)
    wrenches = robot.wrenches(placed)
    frame = scene.model.frames[scene.model.getFrameId(scene.tool_frame(body.gripper))]
    hand = placed[frame.parentJoint - 1]
    tool = hand.origin + hand.carried(frame.placement.translation)
    direction, lever = _path(scene, pieces, mechanics, tool, spans.q)
    up = fixed(np.array([0.0, 0.0, scene.annotation.base_height]), len(along))
    base, whole = placed[robot.yaw], wrenches[int(scene.base[0])]
    weightless = robot.placed(along, gravity=np.zeros(3))
    return Loads(
        begin=spans.begin,
        end=spans.end,
        without=_at_sources(scene, robot.efforts(placed, wrenches)),
        weightless=_at_sources(scene, robot.efforts(weightless, robot.wrenches(weightless))),
        each=_at_sources(scene, robot.pulled(placed, frame.parentJoint - 1, tool, direction)),
        force=_over(joint_force(mechanics, spans), lever),
        along=direction,
        beside=hand.carried(frame.placement.rotation @ CLOSES_ALONG).dot(direction).interval().magnitude(),
        floor=whole.force,
        moment=wrenches[robot.yaw].moment + up.cross(whole.force),
        arm=tool - base.origin + up,
        base=base,
    )


def _at_sources(scene: Scene, forces: dict[int, Numbers]) -> dict[int, Interval]:
    """Virtual work: what a mimicking joint needs is asked of the joint that it follows."""
    found = dict[int, Numbers]()
    for k, force in forces.items():
        source = int(scene.coupling.source[k])
        part = force.scaled(float(scene.coupling.multiplier[k]))
        found[source] = part if source not in found else found[source] + part
    return {k: force.interval() for k, force in found.items()}


def _path(
    scene: Scene, pieces: Pieces, mechanics: Mechanics, tool: Vectors, q: Interval
) -> tuple[Vectors, Interval]:
    """Unit vector along which opening moves the tool's point, and its way for each rad or m of the joint."""
    model, index = scene.model, int(scene.model.getJointId(mechanics.joint))
    if mechanics.reach is not None:
        across = _folding(mechanics.reach, tool, q)
        return across.unit(), across.length()
    above = int(model.parents[index])
    while above:
        if pieces.c[1:, :, above - 1].any():
            what = f"{local_name(mechanics.joint)} hangs on {local_name(model.names[above])}, which moves too"
            raise OracleRejectedError(f"forces are not bounded: {what}")
        above = int(model.parents[above])
    placement, name = scene.placements.move(pieces.c[0, 0])[index], local_name(mechanics.joint)
    joint = next(each for each in scene.kitchen.joints if each.name == name)
    axis = placement.rotation @ np.array(joint.axis)
    along = fixed(axis / np.linalg.norm(axis), len(tool.radius))
    if mechanics.load.prismatic:
        return along, Interval(np.ones_like(tool.radius), np.ones_like(tool.radius))
    across = along.cross(tool - fixed(placement.translation, len(tool.radius)))
    return across.unit(), across.length()


def _folding(reach: Reach, tool: Vectors, q: Interval) -> Vectors:
    """How a point of a folding door's last panel moves for each rad of the container's joint.

    With a the axis, Ω_k the rate of panel k, l_k(q) the arm from its hinge to the next and o that of the
    first: a × (Ω_N (x - o) - Σ (Ω_N - Ω_k) l_k(q)).
    """
    count, last = len(tool.radius), reach.rates[-1]
    middle, half = (q.lo + q.hi) / 2, (q.hi - q.lo) / 2
    found = (tool - fixed(reach.origin, count)).scaled(float(last))
    for arm, rate, phase in zip(reach.arms, reach.rates, reach.phases, strict=False):
        angle = (rate * middle + phase)[:, None]
        turned = arm * np.cos(angle) + np.cross(reach.axis, arm) * np.sin(angle)
        bent = Vectors(turned, float(np.linalg.norm(arm)) * abs(rate) * half)
        found = found - bent.scaled(float(last - rate))
    return fixed(reach.axis, count).cross(found)


def _over(force: Interval, lever: Interval) -> Interval:
    """A joint's force as a force at the tool."""
    near, far = np.maximum(lever.lo, NEAR_AXIS), np.maximum(lever.hi, NEAR_AXIS)
    low = np.where(force.lo < 0, force.lo / near, force.lo / far)
    high = np.where(force.hi > 0, force.hi / near, force.hi / far)
    return Interval(np.nextafter(low, -np.inf), np.nextafter(high, np.inf))
