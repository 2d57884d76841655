"""Eq. (6): does a motion of the kitchen cause a final state, and which motion would?"""

from collections.abc import Iterator
from dataclasses import replace

from predicates.case import Answer, Case, Code, Diagnosis, Evidence, Kind, Quantity
from predicates.meant import containers_meant, moved_by, tasks_meant, unit_of
from predicates.oracle import LET_GO, Physics, Replayed, tee_class_of
from predicates.satisfies_request import demanded, meets, satisfies_request, threshold
from predicates.scope import claimed, out_of_scope
from sdt_kg.errors import NoModeError, UnknownEntityError
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import Motion
from sdt_kg.numbers import told_apart
from sdt_kg.state import Interval, Region, State
from sdt_kg.task import Task
from sdt_kg.twin import Container, Twin

STATE_TOLERANCE = 0.002
"""[rad or m] Within this, a final state given as positions counts as reached (≈ of Eq. (6))."""


def causes(case: Case, physics: Physics) -> Iterator[Answer]:
    r"""Eq. (6): :math:`Params(G) \in I_\Phi` and :math:`\Phi_{sim}(G, \tau) \approx G_{final}`.

    Modes: (+motion, ?final) one answer, with the final state;
    (-motion, +task) one answer for each container that the task may mean, with a motion if one exists;
    (-motion, -task, +final) one answer.
    The scope is checked first: outside it nothing is replayed. A request which the present state
    already meets leaves nothing to cause, so no motion causes it.

    Raises:
        NoModeError: Motion, task and final state are all unknown.
        MotionError: The motion is none of this kitchen.
    """
    if isinstance(case.motion, Motion):
        yield _verified(case, case.motion, physics)
    elif isinstance(case.task, Task):
        for task, container in tasks_meant(case):
            yield _found(replace(case, task=task), task, container, physics)
    elif isinstance(case.final, State | Region):
        yield _reached(case, case.final, physics)
    else:
        raise NoModeError("Causes needs a motion, a task or a final state")


def causes_request(case: Case, physics: Physics) -> Iterator[Answer]:
    """Whether the task is caused: Causes holds, and its final state meets the request.

    Modes: (+task, -motion) as `causes`; (+task, +motion) one answer for each container that the task
    and the motion may mean. Causes alone says of a given motion where it ends, not whether that is
    what was asked for.

    Raises:
        NoModeError: The task is unknown.
        MotionError: The motion is none of this kitchen.
    """
    for answer in causes(case, physics):
        if not answer.holds or not isinstance(case.motion, Motion):
            yield answer
            continue
        requests = list(satisfies_request(answer.case))
        for met in requests:
            found = replace(answer.case, task=met.case.task)
            yield replace(answer, case=found, holds=met.holds, diagnoses=met.diagnoses)
        if not requests:
            reason = f"the motion of {local_name(case.motion.of)} moves no container"
            yield replace(answer, holds=False, diagnoses=(Diagnosis(Kind.SEMANTIC, reason, proof=True),))


def nothing_to_cause(what: str, evidence: Evidence | None = None) -> Diagnosis:
    """The reason against a request that the present state already meets: in these words."""
    reason, code = f"nothing to cause: {what}", Code.NOTHING_TO_CAUSE
    return Diagnosis(Kind.CAUSAL, reason, evidence, proof=True, code=code)


def _verified(case: Case, motion: Motion, physics: Physics) -> Answer:
    """What the given motion causes."""
    tee = tee_class_of(physics)
    outside = [each for container in containers_meant(case) for each in out_of_scope(case, container, tee)]
    if outside:
        return Answer(case, holds=False, diagnoses=tuple(outside))
    replayed = physics.replay(case.twin, motion)
    diagnoses = list(replayed.violations)
    if isinstance(case.task, Task):
        for task, container in tasks_meant(case):
            diagnoses += _nothing_to_cause(case, task, container)
    certain = all(each.proof for each in replayed.violations)
    diagnoses += _missed(case, case.final, replayed.final, proof=certain)
    diagnoses += () if diagnoses else _left(case, replayed)
    solved = replace(case, motion=replayed.motion, final=replayed.final)
    return Answer(solved, not diagnoses, tuple(diagnoses), _notes(case, replayed), figures=replayed.figures)


def _found(case: Case, task: Task, container: Container, physics: Physics) -> Answer:
    """A motion of the container that causes what the task demands."""
    outside = out_of_scope(case, container, tee_class_of(physics))
    refusals = [*outside, *_nothing_to_cause(case, task, container)]
    if refusals:
        final = case.final if refusals[0].kind is Kind.OUT_OF_SCOPE else case.twin.state
        return Answer(replace(case, final=final), holds=False, diagnoses=claimed(refusals))
    return _generated(case, _wanted(case.final, demanded(container, task.verb)), physics)


def _reached(case: Case, final: State | Region, physics: Physics) -> Answer:
    """A motion that ends in the final state or region."""
    goal = final if isinstance(final, Region) else _difference(case.twin, final)
    joints = [joint for joint, _ in goal.intervals]
    if len(joints) != 1:
        names = ", ".join(map(local_name, joints)) or "nothing"
        reason = f"nothing to cause by one motion: {names} would move"
        return Answer(case, holds=False, diagnoses=(Diagnosis(Kind.CAUSAL, reason, proof=True),))
    moved, tee = moved_by(case.twin, joints[0]), tee_class_of(physics)
    outside = [each for container in moved for each in out_of_scope(case, container, tee)]
    if outside:
        return Answer(case, holds=False, diagnoses=tuple(outside))
    if case.twin.state in goal:
        found = nothing_to_cause(f"{local_name(joints[0])} is already there")
        return Answer(case, holds=False, diagnoses=(found,))
    return _generated(case, goal, physics)


def _generated(case: Case, goal: Region, physics: Physics) -> Answer:
    """The best motion into the goal, which replay must confirm."""
    for motion in physics.generate(case.twin, goal):
        replayed = physics.replay(case.twin, motion)
        diagnoses = replayed.violations + _missed(case, goal, replayed.final, proof=False)
        if goal != case.final and not diagnoses:
            diagnoses = _missed(case, case.final, replayed.final, proof=False)
        diagnoses += () if diagnoses else tuple(_left(case, replayed))
        solved = replace(case, motion=replayed.motion, final=replayed.final)
        return Answer(solved, not diagnoses, diagnoses, _notes(case, replayed), figures=replayed.figures)
    reason = "the physics found no motion into the goal"
    return Answer(case, holds=False, diagnoses=(Diagnosis(Kind.CAUSAL, reason),))


def _notes(case: Case, replayed: Replayed) -> tuple[str, ...]:
    """What Φ notes, whether positions count the other way than in the kitchen's file, and what is learned."""
    name, kitchen = local_name(replayed.motion.of), case.twin.mechanism(case.twin.environment)
    turned = next((joint.turned for joint in kitchen.joints if joint.name == name), "")
    moved = {name} | {
        local_name(each)
        for container in moved_by(case.twin, replayed.motion.of)
        for each in (container.joint, container.active_joint)
    }
    learned = (
        f"{joint.name} is {note}" for joint in kitchen.joints if joint.name in moved for note in joint.learned
    )
    return (*replayed.notes, *((f"{name} has in its file {turned}",) if turned else ()), *learned)


def _nothing_to_cause(case: Case, task: Task, container: Container) -> Iterator[Diagnosis]:
    """The request is already met."""
    state = case.twin.state
    if not meets(case.twin, state, task.verb, container):
        return
    position, unit = state[container.joint], unit_of(case.twin, container)
    bound = threshold(container, task.verb)
    met = f"{container.name} at {position:.4g} {unit} already meets {task.verb.value}"
    evidence = Evidence(Quantity.POSITION, position, bound, unit, entity=container.joint)
    yield nothing_to_cause(met, evidence)


def _missed(case: Case, goal: object, final: State, *, proof: bool) -> tuple[Diagnosis, ...]:
    """Where the final state lies outside the goal, if one is known; proved only if that state is certain."""
    for joint, _ in _intervals(goal):
        if joint not in final:
            raise UnknownEntityError("joint", local_name(joint), map(local_name, final))
    missed = [(joint, interval) for joint, interval in _intervals(goal) if final[joint] not in interval]
    return tuple(_outside_goal(case, joint, final[joint], interval, proof) for joint, interval in missed)


def _left(case: Case, replayed: Replayed) -> Iterator[Diagnosis]:
    """Where the container may leave a final state or region that was asked for, when it is let go.

    Φ lets it move further open than open, or further shut than closed: as far as its stop, perhaps.
    """
    if LET_GO not in replayed.figures:
        return
    container = moved_by(case.twin, replayed.motion.of)[0]
    at = replayed.final[container.joint]
    stop = container.lower if container.is_closed(at) else container.upper
    stopped = case.twin.at({container.joint: stop}).state
    for joint, interval in _intervals(case.final):
        if stopped[joint] not in interval:
            reason = f"{container.name} may move when it is let go at {at:.4g}, and leave {_text(interval)}"
            yield replace(
                _outside_goal(case, joint, stopped[joint], interval, proof=False),
                reason=reason,
                kind=Kind.OUT_OF_SCOPE,
            )


def _intervals(goal: object) -> tuple[tuple[Iri, Interval], ...]:
    """What a final state or region demands of each joint; nothing, if none is known."""
    if isinstance(goal, State):
        near = {joint: Interval(p - STATE_TOLERANCE, p + STATE_TOLERANCE) for joint, p in goal.items()}
        return tuple(near.items())
    return goal.intervals if isinstance(goal, Region) else ()


def _wanted(final: object, request: Region) -> Region:
    """The part of the request's region that is in a final state or region too; if none is, the request's."""
    ((joint, interval),) = request.intervals
    also = dict(_intervals(final)).get(joint, Interval())
    lower, upper = max(interval.lower, also.lower), min(interval.upper, also.upper)
    return Region(((joint, Interval(lower, upper)),)) if lower <= upper else request


def _outside_goal(case: Case, joint: Iri, position: float, interval: Interval, proof: bool) -> Diagnosis:
    moved = moved_by(case.twin, joint)
    unit = unit_of(case.twin, moved[0]) if moved else "1"
    bound = interval.lower if position < interval.lower else interval.upper
    evidence = Evidence(Quantity.POSITION, position, bound, unit, entity=joint)
    at, lower = told_apart(position, interval.lower, 4)
    upper = f"{interval.upper:.4g}"
    if bound == interval.upper:
        at, upper = told_apart(position, bound, 4)
    reason = f"{local_name(joint)} ends at {at}, not in [{lower}, {upper}]"
    return Diagnosis(Kind.CAUSAL, reason, evidence, proof)


def _text(interval: Interval) -> str:
    return f"[{interval.lower:.4g}, {interval.upper:.4g}]"


def _difference(twin: Twin, final: State) -> Region:
    """The joints that have to move, each to its final position; of those that are coupled, one."""
    moving = {
        joint: Interval(position, position)
        for joint, position in final.items()
        if abs(twin.state.get(joint, position) - position) > STATE_TOLERANCE
    }
    driving = {each.active_joint for each in twin.containers() if each.joint in moving} - {
        each.joint for each in twin.containers()
    }
    return Region(tuple((joint, at) for joint, at in moving.items() if joint not in driving))
