"""Eq. (5): does a state meet a request, and which requests does it meet?"""

from collections.abc import Iterator
from dataclasses import replace

from predicates.case import Answer, Case, Diagnosis, Evidence, Kind, Quantity
from predicates.meant import tasks_meant, unit_of
from predicates.scope import verb_iri
from sdt_kg.errors import NoModeError
from sdt_kg.iri import Iri, local_name
from sdt_kg.numbers import told_apart
from sdt_kg.state import Interval, Region, State
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Container, Twin


def satisfies_request(case: Case) -> Iterator[Answer]:
    r"""Eq. (5), :math:`SatisfiesRequest(\Pi, G_{final})`, judged by SPARQL over entities and state.

    Modes: (+task, +final) one answer for each container that the task may mean;
    (+task, -final) one for each of them, with the region that the request demands;
    (-task, +final) one for each request that the state meets.

    Raises:
        NoModeError: Neither the task nor the final state is known.
    """
    if isinstance(case.task, Task):
        for task, container in tasks_meant(case):
            yield _forwards(replace(case, task=task), task, container)
    elif isinstance(case.final, State):
        met = met_requests(case.twin, case.final)
        for verb, container in sorted(met, key=lambda each: (each[1], each[0].value)):
            yield Answer(replace(case, task=Task(verb, container)), holds=True)
    else:
        raise NoModeError("SatisfiesRequest needs a task or a final state")


def demanded(container: Container, verb: Verb) -> Region:
    """G_final of a request, as an interval of the container's own joint."""
    interval = {
        Verb.OPEN: Interval(container.open_from, container.upper),
        Verb.CLOSE: Interval(container.lower, container.closed_to),
    }[verb]
    return Region(((container.joint, interval),))


def met_requests(twin: Twin, state: State) -> frozenset[tuple[Verb, Iri]]:
    """Every request which the state meets, as verb and container."""
    rows = twin.at(state).select("satisfied_requests")
    return frozenset((Verb(local_name(str(row["verb"])).lower()), str(row["container"])) for row in rows)


def meets(twin: Twin, state: State, verb: Verb, container: Container) -> bool:
    """Whether the state meets this request; the same query, of which one answer is looked for.

    A kitchen's own container is asked about without the robots: what one of them finds out, all know.
    """
    asked = twin.knowing(container).at(state)
    return asked.has_row("satisfied_requests", verb=verb_iri(verb), container=container.iri)


def _forwards(case: Case, task: Task, container: Container) -> Answer:
    """The answer for one container, its request known."""
    region = demanded(container, task.verb)
    if isinstance(case.final, State):
        if meets(case.twin, case.final, task.verb, container):
            return Answer(case, holds=True)
        return Answer(case, holds=False, diagnoses=(_unmet(case.twin, container, task.verb, case.final),))
    if isinstance(case.final, Region):
        if _within(case.final, region):
            return Answer(case, holds=True)
        reason = f"the final region of {container.name} holds states that do not meet {task.verb.value}"
        return Answer(case, holds=False, diagnoses=(Diagnosis(Kind.SEMANTIC, reason, proof=True),))
    return Answer(replace(case, final=region), holds=True)


def _within(inner: Region, outer: Region) -> bool:
    """Whether every state of the inner region is in the outer one."""
    bounds = dict(inner.intervals)
    return all(
        joint in bounds and bounds[joint].lower in interval and bounds[joint].upper in interval
        for joint, interval in outer.intervals
    )


def _unmet(twin: Twin, container: Container, verb: Verb, final: State) -> Diagnosis:
    """How far the state is from the request; joints that it does not name are where the twin has them."""
    position = twin.at(final).state[container.joint]
    bound = threshold(container, verb)
    unit = unit_of(twin, container)
    at, demanded = told_apart(position, bound, 4)
    demand = f"open begins at {demanded}" if verb is Verb.OPEN else f"closed ends at {demanded}"
    reason = f"{container.name} ends at {at} {unit}: {demand} {unit}"
    evidence = Evidence(Quantity.POSITION, position, bound, unit, entity=container.joint)
    return Diagnosis(Kind.SEMANTIC, reason, evidence, proof=True)


def threshold(container: Container, verb: Verb) -> float:
    """Where open begins, or closed ends, as a position of the container's own joint [rad or m]."""
    return container.open_from if verb is Verb.OPEN else container.closed_to
