"""Kinematics: the Physics protocol, in process."""

from collections.abc import Iterator
from dataclasses import replace

from predicates.oracle import Replayed
from sdt_kg.iri import Iri
from sdt_kg.mechanism import Mechanism
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.state import Region
from sdt_kg.twin import Container, Twin
from services.physics.carry import carried
from services.physics.generate import generate
from services.physics.model import Scene
from services.physics.replay import replay
from services.physics.stops.stop import stopped
from services.physics.stops.sweep import Sweep
from services.physics.tree import Model, build
from services.versions import kinematics

MODELS_KEPT = 4
"""[1] Kitchens whose models are kept."""


def _drawn(twin: Twin) -> Model | None:
    """The environment with its frames where they were drawn; None if no edit put one elsewhere."""
    if not (drawn := twin.drawn_at):
        return None
    kitchen = twin.mechanism(twin.environment)
    joints = (replace(each, origin=drawn.get(each.name, each.origin)) for each in kitchen.joints)
    return build(replace(kitchen, joints=tuple(joints)))


class Kinematics:
    """Φ of Eq. (6): rigid-body kinematics of the kitchen, built from the twin."""

    def __init__(self) -> None:
        self._models: list[tuple[Mechanism, Model]] = []
        self._sweeps: list[tuple[Model, Sweep]] = []
        self._scene: tuple[Twin, Iri, Scene] | None = None

    @property
    def version(self) -> str:
        return kinematics()

    def replay(self, twin: Twin, motion: Motion) -> Replayed:
        model = self._of(twin)
        return stopped(self._sweep_of(model, twin), model, twin, replay(model, twin, motion))

    def generate(self, twin: Twin, goal: Region) -> Iterator[Motion]:
        model = self._of(twin)
        for joint, interval in goal.intervals:
            motion = generate(model, twin, joint, interval)
            if motion is not None:
                yield motion

    def carried(self, twin: Twin, body_motion: BodyMotion, container: Container) -> Motion:
        return carried(
            self._of(twin), lambda: self._scene_of(twin, body_motion.robot), twin, body_motion, container
        )

    def _scene_of(self, twin: Twin, robot: Iri) -> Scene:
        """Scene of this twin and robot; the last one is kept, for the other containers of a question."""
        if self._scene is None or self._scene[0] is not twin or self._scene[1] != robot:
            self._scene = (twin, robot, Scene(twin, robot))
        return self._scene[2]

    def _sweep_of(self, model: Model, twin: Twin) -> Sweep:
        for known, sweep in self._sweeps:
            if known is model:
                return sweep
        self._sweeps = [
            (model, Sweep(model, twin.obstacles, _drawn(twin))),
            *self._sweeps[: MODELS_KEPT - 1],
        ]
        return self._sweeps[0][1]

    def _of(self, twin: Twin) -> Model:
        """Model of the twin's environment; twins that differ in their state share one."""
        mechanism = twin.mechanism(twin.environment)
        for known, model in self._models:
            if known is mechanism:
                return model
        self._models = [(mechanism, build(mechanism)), *self._models[: MODELS_KEPT - 1]]
        return self._models[0][1]
