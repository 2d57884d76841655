"""One question for each robot, container and request that a case leaves open."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from predicates.case import Case
from predicates.meant import containers_meant
from predicates.oracle import Embodiment, Physics
from predicates.satisfies_request import met_requests
from sdt_kg.errors import NoModeError
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import UNKNOWN, Task
from sdt_kg.twin import Container

STILL = 1e-3
"""[rad or m] A container that a body motion moves by less is not what the motion is about."""


@dataclass(frozen=True, slots=True)
class Question:
    """One verdict's question.

    Attributes:
        container: None where the motion moves no container, or meets no request that was not met
            before.
        asked: The case as it was asked, about this robot and this request: what is hashed.
        case: The same with what is known from it: τ as the body motion carries it.
    """

    container: Container | None
    asked: Case
    case: Case


def questions(case: Case, physics: Physics, embodiment: Embodiment | None) -> Iterator[Question]:
    """One question for each robot, container and request which the case may mean.

    Raises:
        NoModeError: Task and motion are both unknown.
    """
    if case.task is UNKNOWN and case.motion is UNKNOWN and case.body_motion is UNKNOWN:
        raise NoModeError("the Law needs a task or a motion")
    for asked in _robots(case, embodiment):
        parts = _parts(asked, physics)
        found = [
            Question(container, replace(asked, task=task), replace(part, task=task))
            for container, part in parts
            for task in _tasks(container, part, physics)
        ]
        yield from found or [Question(None, asked, parts[0][1] if parts else asked)]


def _robots(case: Case, embodiment: Embodiment | None) -> Iterator[Case]:
    """The case for each robot it may mean."""
    if isinstance(case.body_motion, BodyMotion) and case.robot is UNKNOWN:
        yield replace(case, robot=case.body_motion.robot)
    elif case.robot is UNKNOWN and embodiment is not None and case.twin.robots:
        for robot in case.twin.robots:
            yield replace(case, robot=robot)
    else:
        yield case


def _parts(case: Case, physics: Physics) -> list[tuple[Container, Case]]:
    """The case for each container it may mean; a body motion brings the container's motion along."""
    containers = containers_meant(case)
    if not isinstance(case.body_motion, BodyMotion):
        return [(each, case) for each in containers]
    parts = [(each, _as_given(case, case.body_motion, each, physics)) for each in containers]
    named = isinstance(case.task, Task) and case.task.container is not UNKNOWN
    return parts if named else [(each, part) for each, part in parts if _moves(part.motion)]


def _as_given(case: Case, body_motion: BodyMotion, container: Container, physics: Physics) -> Case:
    """As `with_carried`; but a τ that was given too is the one that is asked about."""
    part = with_carried(case, body_motion, container, physics)
    return replace(part, motion=case.motion) if isinstance(case.motion, Motion) else part


def with_carried(case: Case, body_motion: BodyMotion, container: Container, physics: Physics) -> Case:
    """The case with the body motion, and τ of the container as that carries it.

    A motion of another robot than the case's carries nothing, whoever else is loaded.
    """
    own = case.robot in {UNKNOWN, body_motion.robot}
    motion = physics.carried(case.twin if own else case.twin.bare, body_motion, container)
    together = {container.joint, *case.twin.entities.coupling.together(container.joint)}
    if not together & set(body_motion.kitchen_joints):
        assert motion.velocities is not None, "Γ is a Hermite spline, so is what it carries"
        body_motion = replace(
            body_motion,
            kitchen_joints=(container.active_joint,),
            kitchen_q=(motion.values - container.offset) / container.multiplier,
            kitchen_v=motion.velocities / container.multiplier,
        )
    return replace(case, body_motion=body_motion, motion=motion)


def unhurried(case: Case) -> Case:
    """The case with a τ that nobody asked for as it is: what it does too fast, another may do more slowly."""
    assert isinstance(case.motion, Motion)
    return replace(case, motion=replace(case.motion, timed=False))


def _moves(motion: object) -> bool:
    assert isinstance(motion, Motion)
    return bool(abs(motion.values - motion.values[0]).max() > STILL)


def _tasks(container: Container, case: Case, physics: Physics) -> Iterator[Task]:
    """The task about this container; where it is unknown, each request that is newly met."""
    if isinstance(case.task, Task):
        yield Task(case.task.verb, container.iri)
        return
    assert isinstance(case.motion, Motion)
    final = physics.replay(case.twin, case.motion).final
    new = met_requests(case.twin, final) - met_requests(case.twin, case.twin.state)
    for verb, of in sorted(new, key=lambda each: (each[1], each[0].value)):
        if of == container.iri:
            yield Task(verb, of)
