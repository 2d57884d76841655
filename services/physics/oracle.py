"""Kinematics: the Physics protocol, in process."""

from collections.abc import Iterator
from importlib.metadata import version

from predicates.oracle import Replayed
from sdt_kg.mechanism import Mechanism
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import Region
from sdt_kg.twin import Container, Twin
from services.physics.carry import carried
from services.physics.generate import generate
from services.physics.replay import replay
from services.physics.tree import Model, build

KINEMATICS_VERSION = "1"
"""Raised whenever an answer of this oracle may change."""

MODELS_KEPT = 4
"""[1] Kitchens whose models are kept."""


class Kinematics:
    """Φ of Eq. (6): rigid-body kinematics of the kitchen, built from the twin."""

    def __init__(self) -> None:
        self._models: list[tuple[Mechanism, Model]] = []

    @property
    def version(self) -> str:
        return f"kinematics {KINEMATICS_VERSION}, pin {version('pin')}"

    def replay(self, twin: Twin, motion: Motion) -> Replayed:
        return replay(self._of(twin), twin, motion)

    def generate(self, twin: Twin, goal: Region) -> Iterator[Motion]:
        model = self._of(twin)
        for joint, interval in goal.intervals:
            yield generate(model, twin, joint, interval)

    def carried(self, twin: Twin, body_motion: BodyMotion, container: Container) -> Motion:
        return carried(self._of(twin), twin, body_motion, container)

    def _of(self, twin: Twin) -> Model:
        """Model of the twin's environment; twins that differ in their state share one."""
        mechanism = twin.mechanism(twin.environment)
        for known, model in self._models:
            if known is mechanism:
                return model
        self._models = [(mechanism, build(mechanism)), *self._models[: MODELS_KEPT - 1]]
        return self._models[0][1]
