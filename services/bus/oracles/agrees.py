"""Whether a proof is about the start, tolerances and motion that were asked about."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from predicates.case import Case
from sdt_kg.annotation import Drive
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import Array, BodyMotion, Motion
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.content import Proof
from services.embodiment.proof_check.statement import Statement
from services.embodiment.recheck.embodiment import faces
from services.physics.oracle import Kinematics
from services.policy import Policy

Start = tuple[float, float, float]
ROUNDING = 1e-9
"""[rad or m] by which two who compute it differ in where a joint is that moves with another."""


@dataclass(frozen=True, slots=True)
class Demand:
    """What a question demands of an answer beyond robot, kitchen and container.

    Attributes:
        robot: That is asked about.
        policy: Under which.
    """

    asked: Case
    robot: Iri
    policy: Policy

    @property
    def drive(self) -> Drive:
        """How the base moves."""
        return self.policy.drive or self.twin.robot(self.robot).drive

    @property
    def twin(self) -> Twin:
        """Of the case."""
        return self.asked.twin

    @property
    def tolerances(self) -> Tolerances:
        """Of certification."""
        contact = self.policy.contact
        return Tolerances() if contact is None else replace(Tolerances(), contact=contact)

    def of_proof(self, proof: Proof) -> Iterator[str]:
        """In what a proof, which holds, is about something else."""
        claim, container = proof.claim, self.twin.container(proof.claim.container)
        if claim.drive is not self.drive:
            yield f"a base that is {claim.drive.value}"
        if claim.tolerances != self.tolerances:
            yield "other tolerances"
        for one in (claim, *(each.claim for each in proof.others)):
            held = self.twin.container(one.container).by_handle(one.handle)
            if one.drive is Drive.FIXED and not self._starts(one.start, held):
                yield f"another start of who holds {local_name(held.handle)}"
        way = self._way(container)
        if way is None:
            yield "a motion of another container"
            return
        ends = sorted((self.twin.state[container.joint], float(way[-1])))
        if claim.span[0] < ends[0] - ROUNDING or claim.span[1] > ends[1] + ROUNDING:
            yield f"values that need not be passed, {claim.span[0]:.4g} to {claim.span[1]:.4g}"
        if claim.timing is not None and not self._are_times(claim.timing.times, claim.timing.values, way):
            yield "times that are not asked for"

    def _starts(self, start: Start, held: Container) -> bool:
        """Whether the policy has the robot start there, where it is to hold a handle."""
        if self.policy.base is not None:
            return start == self.policy.base
        about = self.twin, self.robot, held, self.drive, start, self.tolerances
        turned = faces(start, Statement(*about).handle_origin())
        return turned and (self.drive is not Drive.FIXED or start[:2] == self.twin.kitchen().start[:2])

    def _has_times(self) -> bool:
        motion = self.asked.motion
        return (
            isinstance(motion, Motion) and motion.timed and not isinstance(self.asked.body_motion, BodyMotion)
        )

    def _way(self, container: Container) -> Array | None:
        """Positions of a container along the motion that is asked about, shape (T,); None if it has none."""
        motion = self.asked.motion
        if not isinstance(motion, Motion):
            return None
        if motion.is_poses:
            motion = Kinematics().replay(self.twin, motion).motion
        if motion.of == container.joint:
            return motion.values[:, 0]
        ratio = self.twin.entities.coupling.together(motion.of).get(container.joint)
        return None if ratio is None else ratio[0] * motion.values[:, 0] + ratio[1]

    def _are_times(self, times: tuple[float, ...], values: tuple[float, ...], way: Array) -> bool:
        """Whether these are the times and values of the motion that is asked about, between the stops."""
        motion = self.asked.motion
        return (
            self._has_times()
            and isinstance(motion, Motion)
            and np.array_equal(motion.times, times)
            and len(values) == len(way)
            and np.allclose(np.clip(way, min(values), max(values)), values, rtol=0.0, atol=ROUNDING)
        )
