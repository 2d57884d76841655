"""Leg: what a step's motion does to the kitchen, between samples too."""

from dataclasses import dataclass

import numpy as np

from predicates.specification.cubic import Array, Cubic
from sdt_kg.history.trajectory import HELD_FROM, Grasp, Trajectory
from sdt_kg.motion import BodyMotion
from sdt_kg.state import State
from sdt_kg.twin import Container, Twin


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """One step's body motion, as the kitchen sees it.

    Attributes:
        number: Of the step, counted from 1.
        twin: Kitchen and robot in the state in which the step begins.
        motion: The body motion; between its samples it is a cubic Hermite spline.
        trajectory: Of the kitchen's joints, at the samples and at every extremum of every joint between
            them: from one sample of it to the next each joint only rises or only falls. What a joint
            reaches, it therefore reaches at one of these samples.
    """

    number: int
    twin: Twin
    motion: BodyMotion
    trajectory: Trajectory

    @staticmethod
    def of(number: int, twin: Twin, motion: BodyMotion) -> "Leg":
        """The leg of a body motion that says how the kitchen's joints move."""
        spline = Cubic(motion.times, motion.kitchen_q, motion.kitchen_v)
        times = spline.refined()
        held, grasp = dict(motion.phases).get(HELD_FROM), None
        if held is not None:
            grasp = Grasp(motion.robot, int(np.searchsorted(times, float(motion.times[held]))))
        return Leg(number, twin, motion, Trajectory(motion.kitchen_joints, times, spline.at(times), grasp))

    def positions(self, container: Container) -> Array:
        """The container's own joint at each sample of the trajectory, shape (T,) [rad or m]."""
        joints, values = self.trajectory.joints, self.trajectory.positions
        if container.active_joint in joints:
            active = values[:, joints.index(container.active_joint)]
            return container.multiplier * active + container.offset
        if container.joint in joints:
            return values[:, joints.index(container.joint)]
        return np.full(len(self.trajectory.times), self.twin.state[container.joint])

    def state(self, sample: int) -> State:
        """The state at a sample of the trajectory."""
        return self.trajectory.at(self.twin, sample).state
