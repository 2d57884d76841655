"""Running what a query needs, within bounds, before the query runs."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from typing import Protocol

from predicates.record import Record, StoredVerdict
from predicates.record.inputs import model_input
from sdt_kg.errors import InputError, QueryError
from sdt_kg.iri import Iri, local_name, model_iri
from sdt_kg.load import load_twin, model_name
from sdt_kg.twin import Twin
from services.app import Policy, Service, load
from services.compute.patterns import Bound, Pattern, may_take_back, not_judged, verdict_patterns
from services.compute.plan import Plan, Request, planned, policy_of
from services.compute.terms import MADE_BY
from services.ontology_page.spelling import misspelled
from services.requests import state_joints
from services.table import Cell, CellResult, run

NOT_JUDGED_IS_NOT_NO = (
    "the query counts, or asks for what is not there: what has no verdict is taken for failed"
)
NO_QUESTION = "nothing to compute: no pattern of the query asks about a verdict; what is there was searched"

SHOWN = 10
"""[lines] Of the cases that were left out, where people read it."""

Report = Callable[[CellResult], None]
Runner = Callable[[Sequence[Cell], int, Report], object]


class Keeper(Protocol):
    """Where verdicts are kept, and found again."""

    def stored(self, verdict: Iri) -> StoredVerdict | None:
        """What is kept of the verdict of this IRI."""
        ...

    def add_twin(self, twin: Twin) -> None:
        """Keep a twin's graphs, so that verdicts can be asked together with what they are about."""
        ...

    def add_record(self, record: Record) -> object:
        """Keep a verdict's triples."""
        ...


@dataclass(frozen=True, slots=True)
class Loaded:
    """Kitchens and robots that a query without constraint may touch, by bundled name or path.

    Attributes:
        states: `JOINT=VALUE`, each for the kitchens that have the joint.
        policy: What decides CanPerform beyond the case.
    """

    kitchens: tuple[str, ...]
    robots: tuple[str, ...]
    states: tuple[str, ...] = ()
    policy: Policy = field(default_factory=Policy)

    @property
    def sources(self) -> tuple[dict[str, str], dict[str, str]]:
        """Of kitchens and robots: name → bundled name or path under which it is loaded."""
        kitchens, robots = ({model_name(each): each for each in of} for of in (self.kitchens, self.robots))
        return kitchens, robots


@dataclass(frozen=True, slots=True)
class Bounds:
    """How much is computed for one query.

    Attributes:
        budget: Seconds in all. A case that has begun is given no more than its own policy's budget.
        limit: Cases.
        jobs: Worker processes; 1 works in this one.
    """

    budget: float
    limit: int
    jobs: int = 1


@dataclass(slots=True)
class Computed:
    """What was run for a query, and what was left out.

    Attributes:
        plan: The cases that the query can touch.
        about_verdicts: Whether the query asks about verdicts; if not, it finds what is there.
        ran: JSON objects of the verdicts that were made, as `sdt achieve --json` prints them.
        left_out: Cases that the query can touch and that were not run, with the reason.
        not_judged: Classes of records that the query asks for and that no judging makes.
        takes_back: Whether one more verdict can make an answer false: the query asks for what is not there.
        seconds: Wall time [s].
        models: Of what was loaded, as inputs of verdicts name it with its content.
    """

    plan: Plan
    about_verdicts: bool = True
    ran: list[dict[str, object]] = field(default_factory=list[dict[str, object]])
    left_out: list[tuple[Request, str]] = field(default_factory=list[tuple[Request, str]])
    not_judged: tuple[Iri, ...] = ()
    takes_back: bool = False
    seconds: float = 0.0
    models: frozenset[str] = frozenset()

    @property
    def holds(self) -> bool:
        """Whether what the query answers stays true, whatever comes of the cases that have no verdict."""
        return not self.takes_back or not (self.left_out or self.plan.unplanned)

    def to_json(self) -> dict[str, object]:
        """What `sdt query --compute --json` says beside the rows."""
        keys = ("kitchen", "robot", "task", "container", "drive", "outcome", "seconds", "iri")
        return {
            "stored": len(self.plan.stored),
            "ran": [{key: each[key] for key in keys} for each in self.ran],
            "left_out": [each.to_json() | {"why": why} for each, why in self.left_out],
            "not_loaded": [asdict(each) for each in self.plan.unplanned],
            "not_judged": [{"class": each, "made_by": MADE_BY[each]} for each in self.not_judged],
            "about_verdicts": self.about_verdicts,
            "holds": self.holds,
            "seconds": round(self.seconds, 3),
        }

    def told(self) -> str:
        """The same on a few lines."""
        if not self.about_verdicts:
            return "\n".join([NO_QUESTION, *self._beyond()])
        lines = [
            f"computed {len(self.ran)} verdicts in {self.seconds:.1f} s; {len(self.plan.stored)} were stored"
        ]
        for each in self.ran:
            lines.append("  {task}({container})  {robot} in kitchen {kitchen}: {outcome}".format_map(each))
        for why in dict.fromkeys(why for _, why in self.left_out):
            names = [_name(each) for each, reason in self.left_out if reason == why]
            lines.append(f"left out {len(names)} cases, {why}: the answer may lack them")
            lines += [f"  {name}" for name in names[:SHOWN]]
            lines += [f"  and {len(names) - SHOWN} more, which --json names"] if len(names) > SHOWN else []
        for each in self.plan.unplanned:
            lines.append(f"nothing computed about {each.kind} {local_name(each.iri)}: {each.why}")
        if not self.holds:
            lines.append(NOT_JUDGED_IS_NOT_NO)
        return "\n".join([*lines, *self._beyond()])

    def _beyond(self) -> list[str]:
        return [f"no {local_name(each)} is computed: {MADE_BY[each]} makes them" for each in self.not_judged]


class _BoundReachedError(Exception):
    """The seconds are spent."""


def compute(sparql: str, loaded: Loaded, bounds: Bounds, keeper: Keeper, runner: Runner = run) -> Computed:
    """Run the cases that the query can touch and that no stored verdict answers; keep what comes out.

    A result is kept as soon as it is there, so that an interrupt or a dead oracle loses only what
    had not been finished.

    Raises:
        QueryError: It cannot be told what the query asks for, or it asks for what the ontology does not have.
        InputError: Two kitchens share a name, or a state names a joint that no kitchen has.
        OracleUnavailableError: An oracle did not answer: what is missing stays missing.
    """
    began = time.perf_counter()
    patterns, beyond = verdict_patterns(sparql), not_judged(sparql)
    if not patterns:
        return Computed(Plan((), (), ()), about_verdicts=False, not_judged=beyond)
    _refuse_misspelled(sparql)
    policy = loaded.policy
    loaded = replace(loaded, policy=replace(policy, budget=min(policy.budget, bounds.budget)))
    loaded = _narrowed(loaded, patterns)
    services = _services(loaded)
    plan = planned(patterns, list(services.values()), keeper.stored)
    computed = Computed(plan, not_judged=beyond, takes_back=may_take_back(sparql))
    twins = [service.twin for service in services.values()]
    computed.models = frozenset(model_input(twin, each) for twin in twins for each in twin.entities.asserted)
    cells = {_cell(each, loaded, services): each for each in computed.plan.missing}
    for environment in {request.environment: None for request in cells.values()}:
        keeper.add_twin(_of(services, environment)[1].twin)
    done: set[Cell] = set()

    def report(result: CellResult) -> None:
        keeper.add_record(result.record)
        computed.ran.append(result.verdict)
        done.add(result.cell)
        if time.perf_counter() - began > bounds.budget:
            raise _BoundReachedError

    chosen = list(cells)[: bounds.limit]
    with suppress(_BoundReachedError):
        if chosen:
            runner(chosen, min(bounds.jobs, len(chosen)), report)
    for cell in [each for each in cells if each not in done]:
        bound = f"budget of {bounds.budget:g} s" if cell in chosen else f"limit of {bounds.limit} cases"
        computed.left_out.append((cells[cell], f"beyond the {bound}"))
    computed.seconds = time.perf_counter() - began
    return computed


def _refuse_misspelled(sparql: str) -> None:
    """What nothing has is told before anything is computed: no case gives it to the query."""
    if wrong := misspelled(sparql):
        raise QueryError(
            f"{', '.join(wrong)}: no term of the ontology, so nothing was computed",
            allowed="; ".join(dict.fromkeys(wrong.values())),
            remedy="mend it, or ask what is there, without computing",
        )


def _narrowed(loaded: Loaded, patterns: Sequence[Pattern]) -> Loaded:
    """Without the models about which no pattern asks, which need not be read then.

    States of a kitchen that is left out go with it.
    """
    kitchens = _meant(loaded.kitchens, [each.environments for each in patterns])
    robots = _meant(loaded.robots, [each.robots for each in patterns])
    if kitchens == loaded.kitchens:
        return replace(loaded, robots=robots)
    twins = [load_twin(kitchen) for kitchen in kitchens]
    states = tuple(each for each in loaded.states if any(state_joints(twin, [each]) for twin in twins))
    return Loaded(kitchens, robots, states, loaded.policy)


def _meant(names: tuple[str, ...], bounds: Sequence[Bound]) -> tuple[str, ...]:
    if None in bounds:
        return names
    iris = frozenset[str]().union(*(bound or frozenset() for bound in bounds))
    return tuple(name for name in names if model_iri(model_name(name)) in iris)


def _services(loaded: Loaded) -> dict[str, Service]:
    """Each kitchen with all robots, in its state."""
    services: dict[str, Service] = {}
    used: set[str] = set()
    for kitchen in loaded.kitchens:
        service = load(kitchen, loaded.robots, policy=loaded.policy)
        own = state_joints(service.twin, loaded.states)
        used.update(own)
        services[kitchen] = service.at(*own) if own else service
    names = [service.twin.environment for service in services.values()]
    if len(set(names)) < len(loaded.kitchens):
        raise InputError(f"two kitchens share a name: {', '.join(loaded.kitchens)}", allowed="each once")
    if unused := set(loaded.states) - used:
        raise InputError(f"no kitchen has a joint for: {', '.join(sorted(unused))}")
    return services


def _of(services: Mapping[str, Service], environment: Iri) -> tuple[str, Service]:
    """The kitchen as it was named, and its service."""
    return next(each for each in services.items() if each[1].twin.environment == environment)


def _cell(request: Request, loaded: Loaded, services: Mapping[str, Service]) -> Cell:
    """The request as a case of a table: names and paths, small enough to travel."""
    kitchen, service = _of(services, request.environment)
    names = {service.robot(model_name(each)): each for each in loaded.robots}
    states = tuple(state_joints(service.twin, loaded.states))
    robot = names.get(request.robot) or service.twin.name(request.robot)  # one that was saved with it
    return Cell(kitchen, robot, str(request.task), states, policy_of(request, loaded.policy))


def _name(request: Request) -> str:
    return "{task}({container})  {robot} in kitchen {kitchen}".format_map(request.to_json())
