"""What a process that judges does with each verb: a request message in, a reply message out."""

import logging
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import pyoxigraph as ox

from predicates.case import Verdict
from predicates.meant import asked_about
from predicates.record import StoredVerdict, to_json, to_record
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, SdtError, UnknownEntityError
from sdt_kg.iri import Iri
from sdt_kg.load import model_name
from services.app import Oracles, Policy, Service, load
from services.compute import compute
from services.compute.run import Bounds, Loaded
from services.judging.answers import (
    body_arrays,
    caused,
    judged_of,
    motion_given,
    n_quads,
    replied,
    stated,
)
from services.judging.codec import asked_in
from services.judging.computed import Keeper
from services.judging.loaded import Models, check_same
from services.judging.messages import (
    REQUESTS,
    AchieveRequest,
    CausesRequest,
    ComputeRequest,
    Message,
    Performed,
    PlaceRequest,
    SatisfiesRequest,
    TaskRequest,
    Verb,
    WhatIfRequest,
    WhyRequest,
)
from services.judging.problems import Problem, ProblemType, problem, problem_of
from services.judging.replies import (
    ComputeReply,
    PlaceReply,
    TaskReply,
    TextReply,
    ToldSection,
    VerdictsReply,
    WhatIfReply,
)
from services.judging.workers.jobs import Done, Handler, Quads
from services.judging.workers.jobs import Task as Asked
from services.requests import parse_task
from services.store.records import recalled
from services.why import sections, text

log = logging.getLogger(__name__)

SERVICES_KEPT = 4
"""Combinations of state and policy whose scenes a worker keeps."""
STATES_KEPT = 64
"""States whose met requests a worker keeps, a few kB each."""
LEAST_BUDGET = 0.01
"""[s] Of search, however near the deadline is."""

States = tuple[str, ...]
Key = tuple[str, States, States, Policy, str, float | None]


def nothing(iri: Iri) -> None:
    """A server that keeps no verdicts."""


@dataclass(frozen=True, slots=True)
class Setup:
    """What each process loads: picklable, and makes the process's handler.

    Attributes:
        kitchens: Names or paths.
        robots: Names or paths, loaded with every kitchen.
        served: What they were when the service read them.
        oracles: Made once in each process: who answers for Φ and R; None: the process itself.
    """

    kitchens: tuple[str, ...]
    robots: tuple[str, ...]
    served: Models
    oracles: Callable[[], Oracles] | None = None

    def __call__(self) -> Handler:
        """Load everything."""
        services = {model_name(each): load(each, self.robots) for each in self.kitchens}
        if self.oracles is not None:
            oracles = self.oracles()
            services = {name: replace(each, oracles=oracles) for name, each in services.items()}
        return Judge(services, Loaded(self.kitchens, self.robots), self.served)


@dataclass(slots=True)
class Judge:
    """The Law in a process of its own.

    Attributes:
        services: By the kitchen's name.
        loaded: The same, as a computation loads it.
        served: What it was when the service read it.
    """

    services: dict[str, Service]
    loaded: Loaded
    served: Models
    _kept: dict[Key, Service] = field(default_factory=dict[Key, Service])
    _met: dict[tuple[str, States, States, str], Done] = field(
        default_factory=dict[tuple[str, States, States, str], Done]
    )
    _recall: Quads = nothing

    def __call__(self, task: Asked, recall: Quads) -> Done | Problem:
        """The reply to a question, or what is wrong with it."""
        check_same((each.twin for each in self.services.values()), self.served)
        try:
            request = asked_in(REQUESTS[Verb(task.verb)], task.payload, task.encoding)
            self._recall = recall
            return self._answered(request, task)
        except SdtError as error:
            return problem_of(error)
        except Exception:  # the edge of a process: logged, and answered as a failure
            log.exception("a worker failed at %s", task.verb)
            return problem(ProblemType.INTERNAL, f"{task.verb} failed; the server's log says why")

    def _answered(self, request: Message, asked: Asked) -> Done:
        match request:
            case AchieveRequest():
                done = self._achieve(request, asked)
            case TaskRequest():
                done = self._task(request, asked)
            case ComputeRequest():
                done = self._compute(request, asked)
            case WhyRequest():
                done = replied(self._why(request.iri), asked.encoding)
            case PlaceRequest():
                done = replied(self._place(request, asked), asked.encoding)
            case WhatIfRequest():
                done = self._what_if(request, asked)
            case SatisfiesRequest():
                done = self._stated(request, asked)
            case _:
                assert isinstance(request, CausesRequest), "the server sends no others"
                service = request.relative.of(self._at(asked, request.state))
                done = replied(caused(service, request, asked.encoding), asked.encoding)
        return done

    def _service(self, twin: str) -> Service:
        if twin not in self.services:
            raise UnknownEntityError("kitchen", twin, self.services, "the server did not load it")
        return self.services[twin]

    def _at(self, asked: Asked, state: list[str]) -> Service:
        """The kitchen as it is now, moved on to the state."""
        service = self._service(asked.twin)
        return service.at(*asked.states).at(*state) if asked.states or state else service

    def _stated(self, request: SatisfiesRequest, asked: Asked) -> Done:
        """The requests that a state meets; twins do not change, so it meets the same when asked again."""
        key = asked.twin, asked.states, tuple(request.state), asked.encoding
        if key not in self._met:
            while len(self._met) >= STATES_KEPT:
                del self._met[next(iter(self._met))]
            self._met[key] = replied(stated(self._at(asked, request.state)), asked.encoding)
        return self._met[key]

    def _achieve(self, request: AchieveRequest, asked: Asked) -> Done:
        """Verdicts; those that are stored are not judged again."""
        service = self._under(asked, request)
        robots = [service.robot(request.robot)] if request.robot else service.twin.robots
        verdicts: list[Verdict] = []
        if request.single:
            _check_one(service, request, len(robots))
        for robot in robots:
            motion = motion_given(service, request.motion, robot)
            verdicts += service.achieve(request.task, robot, motion)
        records = [(verdict.iri, n_quads(to_record(verdict))) for verdict in verdicts]
        reply = VerdictsReply(
            verdicts=[to_json(verdict) for verdict in verdicts],
            quads=b"".join(quads for _, quads in records).decode() if request.quads else None,
            motions=[body_arrays(each, asked.encoding) for each in verdicts] if request.motions else None,
        )
        fresh = (kept for verdict, kept in zip(verdicts, records, strict=True) if not verdict.stored)
        return replace(replied(reply, asked.encoding), records=tuple(fresh), judged=judged_of(verdicts))

    def _task(self, request: TaskRequest, asked: Asked) -> Done:
        """What becomes of a task's steps and rules; the result is kept, and the verdict of each step."""
        from services.specifications import (  # noqa: PLC0415 - seldom asked
            achieve_task,
            result_json,
            specification_from,
            task_record,
        )

        service = self._under(asked, request)
        result = achieve_task(service, specification_from(service.twin, request.task), request.robot)
        verdicts = [step.verdict for step in result.steps]
        records = [(each.iri, n_quads(to_record(each))) for each in verdicts if not each.stored]
        records.append((result.iri, n_quads(task_record(result))))
        quads = b"".join(quads for _, quads in records).decode() if request.quads else None
        reply = TaskReply(result=result_json(result), quads=quads)
        return replace(replied(reply, asked.encoding), records=tuple(records), judged=judged_of(verdicts))

    def _compute(self, request: ComputeRequest, asked: Asked) -> Done:
        """What a query can touch, of one kitchen or of all, and nobody has judged: judged within bounds."""
        keeper = Keeper(self._stored, self.served)
        kitchens = tuple(each for each in self.loaded.kitchens if asked.twin in {"", model_name(each)})
        policy = Policy(Drive(request.drive) if request.drive else None, friction=request.friction)
        loaded = replace(self.loaded, kitchens=kitchens, states=asked.states, policy=policy)
        computed = compute(request.query, loaded, Bounds(request.budget, request.limit), keeper)
        reply = ComputeReply(computed=computed.to_json())
        return replace(replied(reply, asked.encoding), records=tuple(keeper.records))

    def _place(self, request: PlaceRequest, asked: Asked) -> PlaceReply:
        """Certified base poses, and the map of what is known about others."""
        from services.embodiment.place.asked import placed  # noqa: PLC0415 - seldom asked, loads much

        service = self._at(asked, request.state)
        robot = service.robot(request.robot)
        budget = min(request.budget, max(asked.seconds, LEAST_BUDGET))
        how = {"budget": budget, "seed": request.seed, "friction": request.friction}
        return PlaceReply(placement=placed(service.twin, robot, request.task, **how))

    def _what_if(self, request: WhatIfRequest, asked: Asked) -> Done:
        """The verdict as it is, which is kept, and those in other worlds, which nothing here is about."""
        from services.judging.worlds import Here, what_if  # noqa: PLC0415 - seldom asked, loads much

        here = Here(self._under(asked, request), asked.twin, *self.loaded.sources, self.served)
        told = what_if(here, request)
        quads = b"".join(each.quads for each in told.verdicts).decode() if request.quads else None
        fresh = tuple((each.iri, each.quads) for each in told.verdicts if each.is_fresh and each.is_here)
        reply = WhatIfReply(answer=told.said, quads=quads)
        return replace(replied(reply, asked.encoding), records=fresh, judged=told.judged)

    def _why(self, iri: Iri) -> TextReply:
        quads = self._recall(iri)
        if quads is None:
            raise InputError(
                f"no verdict <{iri}> is kept here",
                allowed="the IRI of one that is, or the beginning of its hash",
                remedy="select ?v { ?v a law:Verdict } lists what is kept",
            )
        story = sections(ox.parse(quads, format=ox.RdfFormat.N_QUADS), iri)
        told = [ToldSection(title=each.title, lines=list(each.lines)) for each in story]
        return TextReply(text=text(story), sections=told)

    def _under(self, asked: Asked, request: Performed) -> Service:
        """The kitchen in this state and class under this policy; the last few keep their scenes."""
        budget = min(request.budget, max(asked.seconds, LEAST_BUDGET))
        drive = Drive(request.drive) if request.drive else None
        policy = Policy(drive, request.base, budget, request.seed, friction=request.friction)
        if isinstance(request, AchieveRequest):
            policy = replace(policy, any_start=request.any_start, contact=request.contact)
        key = (asked.twin, asked.states, tuple(request.state), policy, request.tee, request.handle_force)
        kept = self._kept.pop(key, None)
        if kept is None:
            kept = replace(self._at(asked, request.state), policy=policy, recall=self._stored)
            kept = request.relative.of(kept)
        while len(self._kept) >= SERVICES_KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[key] = kept
        return kept

    def _stored(self, iri: Iri) -> StoredVerdict | None:
        quads = self._recall(iri)
        return None if quads is None else recalled(ox.parse(quads, format=ox.RdfFormat.N_QUADS), iri)


def _check_one(service: Service, request: AchieveRequest, robots: int) -> None:
    """There is one verdict about what is asked."""
    task = parse_task(service.twin, request.task)
    count = robots * (len(asked_about(service.twin, task)) if request.motion is None else 1)
    if count != 1:
        said = f"one verdict is asked for, and there are {count}"
        raise InputError(said, allowed="open:CONTAINER or close:CONTAINER, and one robot by its name")
