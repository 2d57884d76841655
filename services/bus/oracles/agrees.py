"""Whether a proof is about the start, tolerances and motion that were asked about."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from predicates.case import Case
from sdt_kg.annotation import Drive
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import Array, BodyMotion, Motion
from sdt_kg.twin import Container
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.proof.claim import Claim
from services.embodiment.proof_check.proof.content import Proof
from services.embodiment.recheck.proofs import is_turned
from services.physics.chain import of_joint
from services.physics.oracle import Kinematics
from services.physics.tree import build
from services.policy import Policy

SAME = 1e-9
"""[rad, m or s] By which two who compute it differ."""


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
        return self.policy.drive_of(self.asked.twin, self.robot)

    def of_proof(self, proof: Proof) -> Iterator[str]:
        """In what a proof, which holds, is about something else."""
        claim, twin = proof.claim, self.asked.twin
        container = twin.container(claim.container)
        if claim.drive is not self.drive:
            yield f"a base that is {claim.drive.value}"
        if claim.tolerances != Tolerances.within(self.policy.contact):
            yield "other tolerances"
        for one in (claim, *(each.claim for each in proof.others)):
            held = twin.container(one.container).by_handle(one.handle)
            if one.drive is Drive.FIXED and not self._starts_as(one, held):
                yield f"another start of who holds {local_name(held.handle)}"
        way = self._way(container)
        if way is None:
            yield "a motion of another container"
            return
        ends = sorted((twin.state[container.joint], float(way[-1])))
        if claim.span[0] < ends[0] - SAME or claim.span[1] > ends[1] + SAME:
            yield f"values that need not be passed, {claim.span[0]:.4g} to {claim.span[1]:.4g}"
        if claim.timing is not None and not self._are_times(claim.timing.times, claim.timing.values, way):
            yield "times that are not asked for"

    def _starts_as(self, claim: Claim, held: Container) -> bool:
        """Whether the policy has a fixed base stand there, where it is to hold a handle."""
        if self.policy.base is not None:
            return claim.start == self.policy.base
        return claim.start[:2] == self.asked.twin.kitchen().start[:2] and is_turned(
            claim, self.asked.twin, held
        )

    def _way(self, container: Container) -> Array | None:
        """Positions of a container along the motion that is asked about, shape (T,); None if it has none."""
        motion, twin = self.asked.motion, self.asked.twin
        if not isinstance(motion, Motion):
            return None
        if motion.is_poses:
            motion = Kinematics().replay(twin, motion).motion
        found = of_joint(build(twin.mechanism(twin.environment)), container.joint, motion)
        return None if found is None else found.values[:, 0]

    def _are_times(self, times: tuple[float, ...], values: tuple[float, ...], way: Array) -> bool:
        """Whether these are the times and values of the motion that is asked about, between the stops."""
        motion = self.asked.motion
        return (
            isinstance(motion, Motion)
            and motion.timed
            and not isinstance(self.asked.body_motion, BodyMotion)
            and np.array_equal(motion.times, times)
            and len(values) == len(way)
            and np.allclose(np.clip(way, min(values), max(values)), values, rtol=0.0, atol=SAME)
        )
