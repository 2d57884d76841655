"""Another Φ: a door that falls shut by itself from a gap on, as many fridges do.

A physics replays a motion into a final state, and says what the motion does that the kitchen cannot. Its
version is part of every verdict's name.
"""
# What was asked for is known in the answers below, which types alone do not say.
# pyright: reportIndexIssue=false

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from predicates.case import Case
from predicates.causes import causes
from predicates.oracle import Physics, Replayed
from predicates.satisfies_request import satisfies_request
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import Region
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Container, Twin
from services import load
from services.physics.oracle import Kinematics


@dataclass(frozen=True)
class FallsShut:
    """Φ in which one joint that is left below `gap` [rad] goes on to 0; all else is another Φ's."""

    other: Physics
    joint: Iri
    gap: float

    @property
    def version(self) -> str:
        return f"falls shut 1 below {self.gap:g} rad, {self.other.version}"

    def replay(self, twin: Twin, motion: Motion) -> Replayed:
        found = self.other.replay(twin, motion)
        left = found.final.get(self.joint, 0.0)
        return replace(found, final=found.final.moved(self.joint, 0.0)) if 0 < left < self.gap else found

    def generate(self, twin: Twin, goal: Region) -> Iterator[Motion]:
        return self.other.generate(twin, goal)

    def carried(self, twin: Twin, body_motion: BodyMotion, container: Container) -> Motion:
        return self.other.carried(twin, body_motion, container)


kitchen = load("b").at("iai_fridge_door=1.0")
door = kitchen.twin.container("iai_fridge_door")
smooth = np.linspace(0, 1, 21)
push = Motion(door.joint, 4 * smooth, (1.0 - 0.8 * (3 * smooth**2 - 2 * smooth**3))[:, None])  # to 0.2 rad
case = Case(kitchen.twin, task=Task(Verb.CLOSE, door.iri), motion=push)

for physics in (Kinematics(), FallsShut(Kinematics(), door.joint, gap=0.35)):
    (answer,) = causes(case, physics)  # (+motion, ?final): where does it end?
    (met,) = satisfies_request(answer.case)  # and is that what was asked for?
    print(f"{physics.version}: ends at {answer.case.final[door.joint]:.2f} rad, closed: {met.holds}")
