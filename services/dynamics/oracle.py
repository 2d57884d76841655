"""Dynamics: the Physics protocol of D_artic_dyn, in process."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from predicates.case import Diagnosis, Kind
from predicates.meant import coupled, moved_by
from predicates.oracle import Replayed
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.mechanism import Mechanism
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.scope import D_ARTIC_DYN, TeeClass
from sdt_kg.state import Region
from sdt_kg.twin import Container, Twin
from services.dynamics.judge import AT_MOST, Forced, forced
from services.dynamics.model import Mechanics
from services.dynamics.need import need
from services.dynamics.parameters import mechanics_of, unfit
from services.dynamics.unheld import unheld
from services.physics.chain import of_own_joint
from services.physics.oracle import Kinematics
from services.physics.tree import Model, build
from services.versions import dynamics

SLOWER = (1.0, 2.0, 4.0, 8.0)
"""[1] By which the times of a generated motion are stretched, until the force that it needs is allowed."""


class Dynamics:
    """Φ of Eq. (6) with forces: kinematics, and at the handle what the force model demands."""

    def __init__(self) -> None:
        self._kinematics = Kinematics()
        self._models: list[tuple[Mechanism, Model]] = []

    @property
    def tee_class(self) -> TeeClass:
        """D_artic_dyn: whoever asks this Φ asks about that class."""
        return D_ARTIC_DYN

    @property
    def version(self) -> str:
        return dynamics()

    def replay(self, twin: Twin, motion: Motion) -> Replayed:
        replayed = self._kinematics.replay(twin, motion)
        moved, model = _moved(twin, replayed.motion.of), self._model(twin)
        mechanics = [mechanics_of(model, twin, each) for each in moved]
        found, pulled = list[Forced](), list[Diagnosis]()
        for container, own in zip(moved, mechanics, strict=True):
            values = of_own_joint(model, container, replayed.motion)
            off = twin.state[container.joint] - float(values.values[0, 0])
            one = forced(own, container, values, off)
            found.append(one)
            pulled += _of_one_handle(one.diagnoses, container) if coupled(twin, container) else one.diagnoses
        others = unheld(model, twin, moved[0], mechanics[0])
        violations, open_questions = _decided(
            (*replayed.violations, *dict.fromkeys(pulled), *others.diagnoses)
        )
        notes = (*(note for one in found for note in one.notes), *_at_each(moved), *others.notes)
        of_all = dict(figure for one in found for figure in one.figures.items())
        figures = of_all | max((one.figures for one in found), key=lambda each: each[AT_MOST])
        return replace(
            replayed,
            violations=violations,
            notes=(*replayed.notes, *dict.fromkeys((*notes, *open_questions))),
            figures=figures | others.figures,
        )

    def generate(self, twin: Twin, goal: Region) -> Iterator[Motion]:
        for motion in self._kinematics.generate(twin, goal):
            container, model = _moved(twin, motion.of)[0], self._model(twin)
            if unfit(twin.mechanism(twin.environment), container.joint):
                yield motion
                continue
            stretch = _slow_enough(
                mechanics_of(model, twin, container), of_own_joint(model, container, motion)
            )
            yield _slower(motion, stretch)

    def carried(self, twin: Twin, body_motion: BodyMotion, container: Container) -> Motion:
        return self._kinematics.carried(twin, body_motion, container)

    def mechanics(self, twin: Twin, container: Container) -> Mechanics:
        """All that forces at the container's handle depend on."""
        return mechanics_of(self._model(twin), twin, container)

    def _model(self, twin: Twin) -> Model:
        mechanism = twin.mechanism(twin.environment)
        for known, model in self._models:
            if known is mechanism:
                return model
        self._models = [(mechanism, build(mechanism)), *self._models[:3]]
        return self._models[0][1]


def _moved(twin: Twin, joint: Iri) -> tuple[Container, ...]:
    """The containers that the joint moves; at the handle of any a force may act.

    Raises:
        OracleRejectedError: There is none, and so no handle.
    """
    moved = moved_by(twin, joint)
    if not moved:
        raise OracleRejectedError(f"{local_name(joint)} moves no container, so no handle has a force")
    return moved


def _at_each(moved: tuple[Container, ...]) -> tuple[str, ...]:
    """That several handles were asked about, and how to ask about one."""
    if len(moved) == 1:
        return ()
    names = " and ".join(each.name for each in moved)
    return (f"forces are judged at the handles of {names}: a motion of one's own joint asks of that alone",)


def _of_one_handle(found: tuple[Diagnosis, ...], container: Container) -> tuple[Diagnosis, ...]:
    """The diagnoses, proving nothing of the force at a handle: another handle moves the container, too."""
    return tuple(
        replace(each, proof=False)
        if each.evidence is not None and each.evidence.entity == container.handle
        else each
        for each in found
    )


def _decided(found: tuple[Diagnosis, ...]) -> tuple[tuple[Diagnosis, ...], tuple[str, ...]]:
    """The diagnoses, and as notes the abstentions that a failure for every value makes idle."""
    failures = tuple(each for each in found if each.kind is not Kind.OUT_OF_SCOPE)
    if not failures:
        return found, ()
    return failures, tuple(each.reason for each in found if each.kind is Kind.OUT_OF_SCOPE)


def _slow_enough(mechanics: Mechanics, motion: Motion) -> float:
    """By how much the motion is made slower where that spares force; by most where nothing helps."""
    allowed = mechanics.forces.allowed
    return next(
        (each for each in SLOWER if need(mechanics, _slower(motion, each)).most <= allowed), SLOWER[-1]
    )


def _slower(motion: Motion, stretch: float) -> Motion:
    slowed = replace(motion, times=motion.times * stretch)
    if motion.velocities is None:
        return slowed
    return replace(slowed, velocities=np.asarray(motion.velocities / stretch))
