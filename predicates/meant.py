"""Which containers a case is about, and which joints a robot's motion leaves parked."""

from collections.abc import Iterator

from predicates.case import Case
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.mechanism import Joint, JointType, Mechanism
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task
from sdt_kg.twin import Container, Twin


def containers_meant(case: Case) -> tuple[Container, ...]:
    """The task's container; where the task leaves it open, those that the motion moves, or all.

    Raises:
        InputError: A task about all of a kitchen that has none.
    """
    left_open = not isinstance(case.task, Task) or not isinstance(case.task.container, str)
    if left_open and isinstance(case.motion, Motion):
        return moved_by(case.twin, case.motion.of)
    return asked_about(case.twin, case.task) if isinstance(case.task, Task) else case.twin.containers()


def asked_about(twin: Twin, task: Task) -> tuple[Container, ...]:
    """The task's container; where the task leaves it open, every one.

    Raises:
        InputError: A task about all of a kitchen that has none.
    """
    return (twin.container(task.container),) if isinstance(task.container, str) else counted(twin)


def counted(twin: Twin) -> tuple[Container, ...]:
    """The kitchen's containers: what a task about every one of them is about.

    Raises:
        InputError: It has none, so there would be no verdict.
    """
    containers = twin.containers()
    if not containers:
        name = local_name(twin.environment)
        raise InputError(
            f"kitchen '{name}' has no door or drawer that counts, so there is nothing to open or close",
            allowed="a kitchen with at least one",
            remedy="sdt containers KITCHEN --all tells why each of its joints is left out",
        )
    return containers


def moved_by(twin: Twin, of: Iri) -> tuple[Container, ...]:
    """Containers whose own joint is this one, or moves this body; else those which follow it.

    Raises:
        UnknownEntityError: The kitchen has neither a joint nor a body of that IRI.
    """
    joint = _joint(twin, of)
    own = tuple(each for each in twin.containers() if each.joint == joint)
    return own or tuple(each for each in twin.containers() if each.active_joint == joint)


def coupled(twin: Twin, container: Container) -> tuple[Container, ...]:
    """Containers that move with another one, by whose handles it is moved as well."""
    return tuple(
        each
        for each in twin.containers()
        if each.active_joint == container.active_joint and each.iri != container.iri
    )


def by_other_handles(twin: Twin, container: Container) -> tuple[Container, ...]:
    """The container, and those that move with it, by each handle but its own.

    What is proved of its own says nothing of them.
    """
    others = (other for each in coupled(twin, container) for other in each.by_each_handle)
    return (*container.by_each_handle[1:], *others)


def handles_of_no_container(twin: Twin, container: Container) -> tuple[Iri, ...]:
    """Handles (IRIs) on what moves with the container and is none: nobody looks at them."""
    rows = twin.knowing(container).select("handles_of_no_container", container=container.iri)
    return tuple(str(row["handle"]) for row in rows)


def _joint(twin: Twin, of: Iri) -> Iri | None:
    """The joint itself, or the nearest one that moves the body; None if nothing does."""
    mechanism, name = twin.mechanism(twin.environment), local_name(of)
    if of == joint_iri(mechanism.name, name) and any(each.name == name for each in mechanism.joints):
        return of
    bodies = {each.name for each in mechanism.bodies}
    if name not in bodies:
        raise UnknownEntityError("joint or frame", name, bodies)
    carrier = mechanism.carriers()[name]
    moves = (each.name for each in mechanism.joints if each.child == carrier)
    return next((joint_iri(mechanism.name, each) for each in moves), None)


def left_parked(case: Case) -> tuple[Iri, ...]:
    """Joints of the acting gripper's chain, from the base on, that the body motion leaves as they are parked.

    It lists neither them nor one that they follow. Where it names no gripper, the one of whose chain it lists
    most is meant. None where no body motion is known, or that is of another robot than is asked about.
    """
    motion, twin = case.body_motion, case.twin
    if not isinstance(motion, BodyMotion) or motion.robot != case.robot:
        return ()
    annotation, mechanism = twin.robot(motion.robot), twin.mechanism(motion.robot)
    listed = {*motion.joints}
    for group in annotation.coupled:
        listed |= {*group} if listed & {*group} else set()
    chains = {one.name: _chain(mechanism, one.tool_body) for one in annotation.grippers}
    best = max(
        chains.values(), key=lambda chain: len(listed & {one.name for one in chain}), default=list[Joint]()
    )
    chain = chains.get(motion.gripper, best)
    parked = (one.name for one in chain if not listed & {one.name, one.mimic and one.mimic.joint})
    return tuple(joint_iri(mechanism.name, name) for name in parked)


def _chain(mechanism: Mechanism, body: str) -> list[Joint]:
    """Joints that move a body, from the root on."""
    above, chain = {joint.child: joint for joint in mechanism.joints}, list[Joint]()
    while body in above:
        chain.insert(0, above[body])
        body = above[body].parent
    return [joint for joint in chain if joint.type is not JointType.FIXED]


def tasks_meant(case: Case) -> Iterator[tuple[Task, Container]]:
    """The case's task about each container that it may mean."""
    if isinstance(case.task, Task):
        for container in containers_meant(case):
            yield Task(case.task.verb, container.iri), container


def unit_of(twin: Twin, container: Container) -> str:
    """Unit of the container's own joint: m or rad."""
    joint = twin.mechanism(twin.environment).joint(local_name(container.joint))
    return "m" if joint.type is JointType.PRISMATIC else "rad"
