"""One case in an edited world, judged with what is known of the world as it is."""

import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from predicates.case import ArtefactKind, Case, Outcome, Verdict
from predicates.law import law
from predicates.record import to_record
from predicates.record.inputs import inputs_of, verdict_iri
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion
from sdt_kg.task import Task
from services.codesign.again import Again, as_asked, has_forces, whole_body
from services.codesign.entries import Found, Holds, How, found_of
from services.codesign.room import reusable
from services.codesign.touched import Touched, touched
from services.embodiment.certify.certificate import read_certificate
from services.requests import parse_task
from services.whatif import World


@dataclass(slots=True, eq=False)
class Judge:
    """An edited world, and the same robot's as it is.

    Attributes:
        known: Verdict IRI → what was found in a world as it is.
    """

    before: World
    after: World
    known: Mapping[Iri, Found]
    _touched: Touched | None = None

    def judged(self, task: str, base: Found | None) -> Found:
        """The outcome in the edited world; certified only by a motion that was certified in it.

        Args:
            task: `open:CONTAINER` or `close:CONTAINER`.
            base: What was found of the same robot and task in the world as it is.
        """
        began = time.process_time()
        service, robot = self.after.service, self.after.robot_iri
        case = service.case(parse_task(service.twin, task), robot)
        iri = verdict_iri(inputs_of(case, service.physics, service.embodiment))
        if iri in self.known:
            return replace(self.known[iri], how=How.SAME, seconds=time.process_time() - began)
        found = None if base is None else self._from(base, case)
        if found is None:
            verdict = one_of(service.achieve(case_task(case), robot))
            found = found_of(verdict, How.LAW, 0.0)
        return replace(found, seconds=time.process_time() - began)

    def _from(self, base: Found, case: Case) -> Found | None:
        """What follows in this world from what was found in the world as it is, if anything does."""
        if base.is_certified and self._same_robot():
            again = self._certified_again(base, case)
            if again is not None:
                return again
        service = self.after.service
        quick = one_of(law(case, service.physics))
        held = [one is not None and one.holds for one in (quick.satisfies_request, quick.causes)]
        if quick.outcome is Outcome.ABSTAINED or not all(held):
            return found_of(quick, How.CAUSES, 0.0)
        if base.outcome is not Outcome.NOT_CERTIFIED or base.holds["canPerform"] is not False:
            return None
        how = None if has_forces(service) else reusable(self.before, self.after, case, self.difference)
        if how is None:
            return None
        said = tuple(each for each in base.diagnoses if each["kind"] == "embodiment")
        holds: Holds = {"satisfiesRequest": True, "causes": True, "canPerform": False}
        return Found(base.iri, Outcome.NOT_CERTIFIED, how, holds, said)

    def _certified_again(self, base: Found, case: Case) -> Found | None:
        """What the motion of the world as it is does in this one; None where it is not certified there.

        Where it names no gripper, one takes over from another: which hold then, the certifier looks for.
        """
        motion = motion_of(base)
        grippers = {each.name for each in self.after.service.twin.robot(self.after.robot_iri).grippers}
        if motion is None or motion.gripper not in {"", *grippers}:
            return None
        service = self.after.service
        again = Again(whole_body(service), self.difference)
        asked = replace(case, body_motion=motion)
        verdict = one_of(law(asked, service.physics, as_asked(service, again)))
        if verdict.outcome is not Outcome.CERTIFIED:
            return None
        return replace(found_of(verdict, How.AGAIN, 0.0, again.swept), artefact=base.artefact)

    def _same_robot(self) -> bool:
        return self.before.robot_iri == self.after.robot_iri

    @property
    def difference(self) -> Touched:
        """What the edit touches."""
        if self._touched is None:
            twins = self.before.service.twin, self.after.service.twin
            self._touched = touched(*twins, self.after.robot_iri)
        return self._touched


def judged_as_it_is(world: World, verb: str, container: str) -> Found:
    """The whole Law in the world as it is."""
    began = time.process_time()
    verdict = one_of(world.service.achieve(f"{verb}:{container}", world.robot_iri))
    return replace(found_of(verdict, How.LAW, time.process_time() - began), record=to_record(verdict))


def motion_of(found: Found) -> BodyMotion | None:
    """The body motion of a certificate."""
    if found.artefact is None or found.artefact.kind is not ArtefactKind.CERTIFICATE:
        return None
    return read_certificate(found.artefact.content).motion


def case_task(case: Case) -> Task:
    """The case's task."""
    assert isinstance(case.task, Task), "an entry is about one task"
    return case.task


def one_of(verdicts: Iterable[Verdict]) -> Verdict:
    """The only verdict."""
    (verdict,) = verdicts
    return verdict
