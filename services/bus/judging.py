"""What a worker process does with each verb: a request message in, a reply message out."""

import logging
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pyoxigraph as ox

from predicates.case import Answer, Outcome, Verdict
from predicates.record import diagnosis_json, read_verdict, to_json, to_record
from predicates.record.stored import StoredVerdict
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, SdtError, UnknownEntityError
from sdt_kg.iri import Iri, local_name
from sdt_kg.load import model_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task
from services.app import Policy, Service, load
from services.bus import messages
from services.bus.keys import Verb
from services.bus.messages import (
    CBOR,
    JSON,
    AchieveRequest,
    CausesReply,
    CausesRequest,
    MetRequest,
    Reply,
    SatisfiesReply,
    SatisfiesRequest,
    TextReply,
    VerdictsReply,
    WhyRequest,
)
from services.bus.oracles.remote import BusOracles
from services.bus.problems import Problem, ProblemType, problem, problem_of
from services.bus.sessions import Reach
from services.bus.work.jobs import Done, Handler
from services.bus.work.jobs import Task as Asked
from services.motions import arrays_of, motion_of
from services.why import why

log = logging.getLogger(__name__)

SERVICES_KEPT = 4
"""Combinations of state and policy whose scenes a worker keeps."""

LEAST_BUDGET = 0.01
"""[s] Of search, however near the deadline is."""

Quads = Callable[[str], bytes | None]
Arrays = dict[str, Any]
Key = tuple[str, tuple[str, ...], Policy]


def nothing(iri: Iri) -> None:
    """A server that keeps no verdicts."""


@dataclass(frozen=True, slots=True)
class Setup:
    """What each worker loads: picklable, and makes the worker's handler.

    Attributes:
        kitchens: Names or paths.
        robots: Names or paths, loaded with every kitchen.
        reach: How to get to oracles on the bus; None: the worker judges by itself.
    """

    kitchens: tuple[str, ...]
    robots: tuple[str, ...]
    reach: Reach | None = None

    def __call__(self) -> Handler:
        """Load everything."""
        services = {model_name(each): load(each, self.robots) for each in self.kitchens}
        if self.reach is not None:
            oracles = BusOracles.on(self.reach())
            services = {name: replace(each, oracles=oracles) for name, each in services.items()}
        return Judge(services)


@dataclass(slots=True)
class Judge:
    """The Law in a worker's process.

    Attributes:
        services: By the kitchen's name.
    """

    services: dict[str, Service]
    _kept: dict[Key, Service] = field(default_factory=dict[Key, Service])
    _recall: Quads = nothing

    def __call__(self, task: Asked, recall: Quads) -> Done | Problem:
        """The reply to a question, or what is wrong with it."""
        try:
            verb = Verb(task.verb)
            request = messages.decode(messages.REQUESTS[verb], task.payload, task.encoding)
            self._recall = recall
            if isinstance(request, AchieveRequest):
                return self._achieve(request, task)
            if isinstance(request, WhyRequest):
                return _done(self._why(request.iri), task.encoding)
            assert isinstance(request, SatisfiesRequest | CausesRequest), "the server sends no others"
            service = self._service(task.twin).at(*request.state)
            if isinstance(request, CausesRequest):
                return _done(_causes(service, request, task.encoding), task.encoding)
            return _done(_satisfies(service), task.encoding)
        except SdtError as error:
            return problem_of(error)
        except Exception:
            log.exception("a worker failed at %s", task.verb)
            return problem(ProblemType.INTERNAL, f"{task.verb} failed; the server's log says why")

    def _service(self, twin: str) -> Service:
        if twin not in self.services:
            raise UnknownEntityError("kitchen", twin, self.services, "the server did not load it")
        return self.services[twin]

    def _achieve(self, request: AchieveRequest, task: Asked) -> Done:
        """Verdicts; those that are stored are not judged again."""
        budget = min(request.budget, max(task.seconds, LEAST_BUDGET))
        drive = Drive(request.drive) if request.drive else None
        policy = Policy(drive, request.base, budget, request.seed)
        service = self._under(task.twin, tuple(request.state), policy)
        robot = _robot(service, request.robot)
        motion = None if request.motion is None else _motion(service, request.motion, robot)
        verdicts = list(service.achieve(request.task, robot, motion))
        records = [(verdict.iri, _quads(verdict)) for verdict in verdicts]
        reply = VerdictsReply(
            verdicts=[to_json(verdict) for verdict in verdicts],
            quads=b"".join(quads for _, quads in records).decode() if request.quads else None,
            motions=[_body_arrays(each, task.encoding) for each in verdicts] if request.motions else None,
        )
        fresh = (kept for verdict, kept in zip(verdicts, records, strict=True) if not verdict.stored)
        return replace(_done(reply, task.encoding), records=tuple(fresh))

    def _why(self, iri: Iri) -> TextReply:
        quads = self._recall(iri)
        if quads is None:
            raise UnknownEntityError("verdict", iri, (), "select ?v { ?v a law:Verdict } lists what is kept")
        return TextReply(text=why(ox.parse(quads, format=ox.RdfFormat.N_QUADS), iri))

    def _under(self, twin: str, state: tuple[str, ...], policy: Policy) -> Service:
        """The kitchen in this state under this policy; the last few keep their scenes."""
        key = (twin, state, policy)
        kept = self._kept.pop(key, None)
        if kept is None:
            kept = replace(self._service(twin).at(*state), policy=policy, recall=self._stored)
        while len(self._kept) >= SERVICES_KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[key] = kept
        return kept

    def _stored(self, iri: Iri) -> StoredVerdict | None:
        quads = self._recall(iri)
        return None if quads is None else read_verdict(ox.parse(quads, format=ox.RdfFormat.N_QUADS), iri)


def _satisfies(service: Service) -> SatisfiesReply:
    tasks = [answer.case.task for answer in service.satisfies()]
    met = [
        MetRequest(verb=task.verb.value, container=local_name(task.container))
        for task in tasks
        if isinstance(task, Task) and isinstance(task.container, str)
    ]
    return SatisfiesReply(requests=met)


def _causes(service: Service, request: CausesRequest, encoding: str) -> CausesReply:
    motion = None if request.motion is None else _motion(service, request.motion, None)
    if isinstance(motion, BodyMotion):
        raise InputError("the motion is a robot's", allowed="a container's", remedy="ask canachieve")
    answers = list(service.causes(request.task, motion))
    return CausesReply(
        holds=[answer.holds for answer in answers],
        diagnoses=[[diagnosis_json(each) for each in answer.diagnoses] for answer in answers],
        motions=[_caused(answer, encoding) for answer in answers],
    )


def _caused(answer: Answer, encoding: str) -> Arrays | None:
    motion = answer.case.motion
    return _portable(arrays_of(motion), encoding) if answer.holds and isinstance(motion, Motion) else None


def _body_arrays(verdict: Verdict, encoding: str) -> Arrays | None:
    motion = verdict.case.body_motion
    if verdict.outcome is not Outcome.CERTIFIED or not isinstance(motion, BodyMotion):
        return None
    return _portable(arrays_of(motion), encoding)


def _portable(arrays: dict[str, np.ndarray], encoding: str) -> Arrays:
    """Numbers as arrays in CBOR and as lists in JSON; names as lists in both."""
    return {
        name: array if encoding == CBOR and array.dtype.kind == "f" else array.tolist()
        for name, array in arrays.items()
    }


def _motion(service: Service, arrays: Arrays, robot: Iri | None) -> Motion | BodyMotion:
    return motion_of({name: np.asarray(value) for name, value in arrays.items()}, service.twin, robot)


def _robot(service: Service, name: str | None) -> Iri | None:
    """IRI of the robot asked about; None: every robot of the server."""
    return None if name is None else service.robot(name)


def _quads(verdict: Verdict) -> bytes:
    quads = ox.serialize(to_record(verdict).quads(), format=ox.RdfFormat.N_QUADS)
    assert quads is not None, "without an output, the bytes are returned"
    return quads


def _done(reply: Reply, encoding: str) -> Done:
    """The reply in the encoding of its request."""
    if encoding == CBOR:
        return Done(messages.encode_cbor(reply), CBOR)
    return Done(messages.encode(reply), JSON)
