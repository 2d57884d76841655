"""The cases that a query can touch, and those of them that no stored verdict answers."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from predicates.case import Case
from predicates.oracle import Embodiment, Physics, tee_class_of
from predicates.record.inputs import inputs_of, verdict_iri
from predicates.record.recall import Recall, answers_again
from predicates.scope import verb_iri
from sdt_kg.annotation import Drive
from sdt_kg.iri import Iri, local_name
from sdt_kg.iri import verdict_iri as verdict_stem
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.app import Policy, Service
from services.compute.patterns import Bound, Pattern


@dataclass(frozen=True, slots=True)
class Request:
    """One case that a query can touch.

    Attributes:
        drive: How the base moves; None takes the robot's own.
        verdict: IRI that its verdict has or will have.
    """

    environment: Iri
    robot: Iri
    task: Task
    drive: Drive | None
    verdict: Iri

    def to_json(self) -> dict[str, object]:
        """Names instead of IRIs."""
        return {
            "kitchen": local_name(self.environment),
            "robot": local_name(self.robot),
            "task": self.task.verb.value,
            "container": local_name(str(self.task.container)),
            "drive": None if self.drive is None else self.drive.value,
            "verdict": self.verdict,
        }


@dataclass(frozen=True, slots=True)
class Unplanned:
    """Something that the query names and no case has, so that nothing is computed about it.

    Attributes:
        kind: kitchen, robot, container, verb, drive, class, verdict or record.
        iri: Of a drive its name.
        why: Why there is no such case.
    """

    kind: str
    iri: Iri
    why: str = "it is not loaded"


@dataclass(frozen=True, slots=True)
class Plan:
    """What a query needs.

    Attributes:
        stored: Cases whose verdict is there already.
        missing: Cases that have to be run, in the order of kitchens, robots, verbs and containers.
        unplanned: What the query names and no case has.
    """

    stored: tuple[Request, ...]
    missing: tuple[Request, ...]
    unplanned: tuple[Unplanned, ...]


def planned(patterns: Sequence[Pattern], services: Sequence[Service], recall: Recall) -> Plan:
    """The cases that the patterns can match, over the loaded twins in their present states.

    Nothing is run: the verdicts' IRIs follow from the inputs.
    """
    touched = {each.verdict: each for service in services for each in _requests(patterns, service)}
    by_service = {service.twin.environment: service for service in services}
    stored = {
        iri: each for iri, each in touched.items() if _is_stored(each, by_service[each.environment], recall)
    }
    missing = tuple(each for iri, each in touched.items() if iri not in stored)
    unplanned = [*_not_loaded(patterns, services), *_without_case(patterns, services)]
    unplanned += _of_other_inputs(patterns, touched, recall)
    return Plan(tuple(stored.values()), missing, tuple(dict.fromkeys(unplanned)))


def case_of(request: Request, twin: Twin) -> Case:
    """The case that the request is about."""
    return Case(twin, robot=request.robot, task=request.task)


def policy_of(request: Request, policy: Policy) -> Policy:
    """The policy, with the drive that the query asks for."""
    return replace(policy, drive=request.drive)


def _requests(patterns: Sequence[Pattern], service: Service) -> Iterator[Request]:
    """Cases of one twin; the same case may come twice."""
    twin = service.twin
    for robot in twin.robots:
        for verb in Verb:
            for container in twin.containers():
                task = Task(verb, container.iri)
                drives = {
                    drive
                    for pattern in patterns
                    if _matches(pattern, twin.environment, robot, task, _tee(service))
                    for drive in _drives(pattern, service.policy)
                }
                for drive in sorted(drives, key=str):
                    request = Request(twin.environment, robot, task, drive, "")
                    request = replace(request, verdict=verdict_iri(_inputs(request, service)))
                    if any(_is_meant(pattern, request, _tee(service)) for pattern in patterns):
                        yield request


def _tee(service: Service) -> Iri:
    """The class D relative to which its verdicts are."""
    return tee_class_of(service.physics).iri


def _matches(pattern: Pattern, environment: Iri, robot: Iri, task: Task, tee: Iri) -> bool:
    asked = (
        (tee, pattern.classes),
        (environment, pattern.environments),
        (robot, pattern.robots),
        (verb_iri(task.verb), pattern.verbs),
        (str(task.container), pattern.containers),
    )
    return all(_is_in(value, bound) for value, bound in asked)


def _is_meant(pattern: Pattern, request: Request, tee: Iri) -> bool:
    """Whether the pattern also lets the verdict itself be this one."""
    case = _matches(pattern, request.environment, request.robot, request.task, tee)
    return case and _is_in(request.verdict, pattern.verdicts)


def _is_in(value: str, bound: Bound) -> bool:
    return bound is None or value in bound


def _drives(pattern: Pattern, policy: Policy) -> Iterable[Drive | None]:
    """Drives to be tried: the policy's, or those which the query names where the policy leaves it open."""
    if pattern.drives is None:
        return (policy.drive,)
    return [drive for drive in _allowed(policy) if drive.value in pattern.drives]


def _allowed(policy: Policy) -> list[Drive]:
    """Drives that the policy leaves open."""
    return [drive for drive in Drive if policy.drive in {None, drive}]


def _inputs(request: Request, service: Service) -> tuple[tuple[str, str], ...]:
    physics, embodiment = _oracles(request, service)
    return inputs_of(case_of(request, service.twin), physics, embodiment)


def _oracles(request: Request, service: Service) -> tuple[Physics, Embodiment]:
    asked = replace(service, policy=policy_of(request, service.policy))
    return asked.physics, asked.embodiment


def _is_stored(request: Request, service: Service, recall: Recall) -> bool:
    """Whether a stored verdict answers the request; a search that was shorter than ours does not."""
    stored = recall(request.verdict)
    return stored is not None and answers_again(stored, _inputs(request, service))


def _not_loaded(patterns: Iterable[Pattern], services: Sequence[Service]) -> Iterator[Unplanned]:
    """What the query names and no loaded twin has."""
    known = {
        "kitchen": {service.twin.environment for service in services},
        "robot": {robot for service in services for robot in service.twin.robots},
        "container": {each.iri for service in services for each in service.twin.containers()},
    }
    for pattern in patterns:
        bounds = {"kitchen": pattern.environments, "robot": pattern.robots, "container": pattern.containers}
        for kind, bound in bounds.items():
            yield from (Unplanned(kind, iri) for iri in sorted((bound or frozenset()) - known[kind]))


def _without_case(patterns: Iterable[Pattern], services: Sequence[Service]) -> Iterator[Unplanned]:
    """Verbs, drives and classes D that the query names and no case of these services has."""
    drives = {drive.value for service in services for drive in _allowed(service.policy)}
    known = {
        "verb": ({verb_iri(verb) for verb in Verb}, "there is no such verb"),
        "drive": (drives, "--drive says otherwise, or there is none"),
        "class": ({_tee(service) for service in services}, "cases are judged relative to another class D"),
    }
    for pattern in patterns if services else ():
        bounds = {"verb": pattern.verbs, "drive": pattern.drives, "class": pattern.classes}
        for kind, bound in bounds.items():
            there, why = known[kind]
            yield from (Unplanned(kind, each, why) for each in sorted((bound or frozenset()) - there))


def _of_other_inputs(
    patterns: Iterable[Pattern], touched: Collection[Iri], recall: Recall
) -> Iterator[Unplanned]:
    """Verdicts that the query names, that are not stored, and that none of the cases has."""
    named = {
        iri for pattern in patterns for iri in pattern.verdicts or () if iri.startswith(verdict_stem(""))
    }
    for iri in sorted(named.difference(touched)):
        if recall(iri) is None:
            yield Unplanned("verdict", iri, "no case of what is loaded has these inputs")
