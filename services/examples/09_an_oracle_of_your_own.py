"""CanPerform by an oracle of your own: a robot that must not reach up high.

An oracle says who it is (`version`) and what decides its answer (`settings`): both are in the verdict's name,
so a verdict of one oracle is never taken for one of another.
"""
# What was asked for is known in the answers below, which types alone do not say.
# pyright: reportAttributeAccessIssue=false

from dataclasses import dataclass

from predicates.case import Answer, Case, Diagnosis, Evidence, Kind, Quantity
from predicates.law import law
from predicates.oracle import Embodiment
from sdt_kg.iri import Iri
from sdt_kg.twin import Twin
from services import load
from services.physics.chain import chain
from services.physics.tree import build


@dataclass(frozen=True)
class LowHandles:
    """R of robots that reach no handle above a height [m]; whatever is lower, another oracle judges."""

    other: Embodiment
    height: float

    @property
    def version(self) -> str:
        return f"low handles 1, {self.other.version}"

    def settings(self, twin: Twin, robot: Iri) -> tuple[tuple[str, str], ...]:
        return (*self.other.settings(twin, robot), ("height", f"{self.height:g} m"))

    def perform(self, case: Case) -> Answer:
        twin, container = case.twin, case.twin.container(str(case.task.container))
        handle = chain(build(twin.mechanism(twin.environment)), container.handle, twin.state)
        height = handle.poses(case.motion.values[:, 0])[0][:, 2, 3].max()
        if height <= self.height:
            return self.other.perform(case)
        reason = f"the handle of {container.name} comes to {height:.2f} m, above {self.height:g} m"
        evidence = Evidence(Quantity.POSITION, float(height), self.height, "m", entity=container.handle)
        return Answer(case, holds=False, diagnoses=(Diagnosis(Kind.EMBODIMENT, reason, evidence),))


kitchen = load("b", robots=["pr2"])
case = kitchen.case("open:sink_area_left_middle_drawer_main", "pr2")
for limit in (0.3, 2.0):
    (verdict,) = law(case, kitchen.physics, LowHandles(kitchen.embodiment, limit))
    print(f"{limit} m: {verdict.outcome.value}", *(each.reason for each in verdict.diagnoses))
