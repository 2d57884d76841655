"""A world in which a question is asked, and the same with another twin or policy."""

from dataclasses import dataclass, replace

from predicates.oracle import tee_class_of
from sdt_kg.iri import Iri
from sdt_kg.load import model_name
from sdt_kg.scope import D_ARTIC_DYN
from sdt_kg.twin import Twin
from services.app import Service
from services.edits import parse_edit


@dataclass(frozen=True, slots=True)
class World:
    """Where a question is asked, and of whom.

    Attributes:
        service: Kitchen, robots and policy.
        robot: Bundled name or path, as loaded.
    """

    service: Service
    robot: str

    @property
    def robot_iri(self) -> Iri:
        """IRI of the robot that is asked about."""
        return self.service.robot(model_name(self.robot))

    def with_twin(self, twin: Twin) -> "World":
        """The same robot and policy with another twin."""
        return replace(self, service=replace(self.service, twin=twin))

    def with_models(self, twin: Twin) -> "World":
        """The same robot and policy with a twin of other models, and what is bundled of their forces."""
        if tee_class_of(self.service.physics) == D_ARTIC_DYN:
            from services.dynamics.data import with_forces  # noqa: PLC0415 - only where forces are asked about

            twin = with_forces(twin, handle_force=self.service.handle_force)
        return self.with_twin(twin)

    def edited(self, text: str) -> "World":
        """The world after an edit of the twin, as people type it."""
        twin = self.service.twin
        return self.with_twin(parse_edit(twin, text).applied(twin))

    def under(self, **policy: object) -> "World":
        """The world under a policy that differs in this."""
        service = self.service
        return replace(self, service=replace(service, policy=replace(service.policy, **policy)))
