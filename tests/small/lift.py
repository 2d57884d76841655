"""Lift: a real embodiment oracle for robots with one joint.

The small robots drive anywhere and reach with a lift. They can move a container if the lift brings
the gripper to the height of the handle all along its path; how the handle turns does not matter to
them, since their gripper holds it like a ball. Closed form, so a refusal is a proof.
"""

from dataclasses import replace

import numpy as np

from predicates.case import Answer, Case, Diagnosis, Evidence, Kind, Quantity
from predicates.meant import moved_by
from predicates.oracle import Embodiment, Physics
from sdt_kg.annotation import RobotAnnotation
from sdt_kg.iri import Iri, body_iri, local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Container, Twin
from services.app import Policy
from services.physics.chain import chain
from services.physics.oracle import Kinematics
from services.physics.spline import at_rest_velocities
from services.physics.tree import build

LIFT = "lift_joint"
SLACK = 1e-9


class Lifts:
    """The closed-form robots in place of the planner: oracles of a service."""

    def physics(self) -> Physics:
        return Kinematics()

    def embodiment(self, policy: Policy) -> Embodiment:
        return Lift()


class Lift:
    """Eq. (7) for a lift on wheels."""

    version = "lift 1"

    def settings(self, twin: Twin, robot: Iri) -> tuple[tuple[str, str], ...]:
        return (("drive", twin.robot(robot).drive.value), ("budget", "1.0"))

    def perform(self, case: Case) -> Answer:
        assert isinstance(case.robot, str)
        if isinstance(case.body_motion, BodyMotion):
            return self._verified(case, case.body_motion)
        assert isinstance(case.motion, Motion)
        path = _handle_path(case, case.motion)
        heights = path[:, 2] - _zero_height(case)
        limits = case.twin.mechanism(case.robot).joint(LIFT).limits
        for worst in (float(heights.min()), float(heights.max())):
            if not limits.lower - SLACK <= worst <= limits.upper + SLACK:
                return self._too_far(case, worst, limits.lower if worst < limits.lower else limits.upper)
        return Answer(_followed(case, case.motion, path, heights), holds=True, figures={"margin": (0.0, "m")})

    def _too_far(self, case: Case, height: float, bound: float) -> Answer:
        name = _container(case).name
        reason = f"the handle of {name} needs the lift at {height:.3g} m"
        evidence = Evidence(Quantity.POSITION, height, bound, "m", entity=f"{case.robot}/joint/{LIFT}")
        return Answer(
            case, holds=False, diagnoses=(Diagnosis(Kind.EMBODIMENT, reason, evidence, proof=True),)
        )

    def _verified(self, case: Case, body: BodyMotion) -> Answer:
        """The gripper is where the handle is, whenever the container moves."""
        assert isinstance(case.motion, Motion)
        handle, tool = _handle_path(case, case.motion), tool_path(case, body)
        gap = float(np.abs(handle - tool).max())
        if gap < 0.002:
            return Answer(case, holds=True, figures={"tool_error": (gap, "m")})
        reason = f"{local_name(body.robot)} holds the handle {gap:.3g} m beside its grasp"
        evidence = Evidence(Quantity.TOOL_ERROR, gap, 0.002, "m")
        return Answer(
            case, holds=False, diagnoses=(Diagnosis(Kind.EMBODIMENT, reason, evidence, proof=True),)
        )


def tool_path(case: Case, body: BodyMotion) -> np.ndarray:
    """Positions of the gripper, shape (T, 3); the base does not turn."""
    heights = _zero_height(case) + body.q[:, list(body.joints).index(LIFT)]
    return np.column_stack([body.base[:, 0] + _arm(case), body.base[:, 1], heights])


def _container(case: Case) -> Container:
    assert isinstance(case.motion, Motion)
    return moved_by(case.twin, case.motion.of)[0]


def _annotation(case: Case) -> RobotAnnotation:
    assert isinstance(case.robot, str)
    return case.twin.robot(case.robot)


def _arm(case: Case) -> float:
    return _annotation(case).grippers[0].tool.position[0]


def _zero_height(case: Case) -> float:
    assert isinstance(case.robot, str)
    joint = case.twin.mechanism(case.robot).joint(LIFT)
    return _annotation(case).base_height + joint.origin.position[2]


def _handle_path(case: Case, motion: Motion) -> np.ndarray:
    """Positions of the handle along τ, shape (T, 3)."""
    container = _container(case)
    model = build(case.twin.mechanism(case.twin.environment))
    handle = chain(
        model, body_iri(local_name(case.twin.environment), local_name(container.handle)), case.twin.state
    )
    active = (motion.values[:, 0] - container.offset) / container.multiplier
    return handle.poses(active)[0][:, :3, 3]


def _followed(case: Case, motion: Motion, path: np.ndarray, heights: np.ndarray) -> Case:
    """Base and lift follow the handle, slowly enough for both if τ may be slowed."""
    assert isinstance(case.robot, str)
    container = _container(case)
    base = np.column_stack([path[:, 0] - _arm(case), path[:, 1], np.zeros(len(path))])
    speed = (
        np.linalg.norm(at_rest_velocities(motion.times, base), axis=1).max()
        / _annotation(case).base_limits.linear_velocity
    )
    lifting = np.abs(at_rest_velocities(motion.times, heights[:, None])).max()
    slower = max(
        1.0, 1.1 * speed, 1.1 * lifting / case.twin.mechanism(case.robot).joint(LIFT).limits.velocity
    )
    times = motion.times * (1.0 if motion.timed else slower)
    active = (motion.values - container.offset) / container.multiplier
    body = BodyMotion(
        robot=case.robot,
        gripper="gripper",
        joints=(LIFT,),
        times=times,
        base=base,
        q=heights[:, None],
        v=at_rest_velocities(times, heights[:, None]),
        base_v=at_rest_velocities(times, base),
        kitchen_joints=(container.active_joint,),
        kitchen_q=active,
        kitchen_v=at_rest_velocities(times, active),
        phases=(("follow", 0),),
    )
    return replace(case, body_motion=body, motion=replace(motion, times=times))
