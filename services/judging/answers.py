"""Answers of the Law as reply messages, and motions as what JSON and CBOR carry."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pyoxigraph as ox

from predicates.case import Answer, Outcome, Verdict
from predicates.record import Record, diagnosis_json
from predicates.record.caused import caused_json
from predicates.record.report import times
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task
from services.app import Service
from services.judging.codec import CBOR, JSON, encode, encode_cbor
from services.judging.messages import MOTION, CausesRequest
from services.judging.replies import CausesReply, MetRequest, Reply, SatisfiesReply
from services.judging.workers.jobs import Done
from services.motions.files import arrays_of, motion_of
from services.telemetry.metrics import Judged

Arrays = dict[str, Any]


def stated(service: Service) -> SatisfiesReply:
    """The requests that the service's state meets."""
    tasks = [answer.case.task for answer in service.satisfies()]
    met = [
        MetRequest(verb=task.verb.value, container=local_name(task.container))
        for task in tasks
        if isinstance(task, Task) and isinstance(task.container, str)
    ]
    return SatisfiesReply(requests=met)


def caused(service: Service, request: CausesRequest, encoding: str) -> CausesReply:
    """Motions that would cause the task, or whether the given one does.

    Raises:
        InputError: The motion is a robot's.
    """
    motion = motion_given(service, request.motion, None)
    if isinstance(motion, BodyMotion):
        raise InputError(
            "the motion is a robot's", allowed="a container's", remedy="ask canachieve (POST /api/v1/achieve)"
        )
    answers = list(service.causes(request.task, motion))
    return CausesReply(
        tasks=[_asked(answer) for answer in answers],
        holds=[answer.holds for answer in answers],
        diagnoses=[[diagnosis_json(each) for each in answer.diagnoses] for answer in answers],
        motions=[_tau(answer, encoding) for answer in answers],
        answers=[caused_json(answer, request.tee) for answer in answers],
    )


def body_arrays(verdict: Verdict, encoding: str) -> Arrays | None:
    """Γ of a certified verdict."""
    motion = verdict.case.body_motion
    if verdict.outcome is not Outcome.CERTIFIED or not isinstance(motion, BodyMotion):
        return None
    return _portable(arrays_of(motion), encoding)


def motion_given(
    service: Service, arrays: Mapping[str, Any] | None, robot: Iri | None
) -> Motion | BodyMotion | None:
    """The motion of these arrays; None of none.

    Raises:
        InputError: They are no motion of this kitchen; it says that it is about the motion.
    """
    if arrays is None:
        return None
    try:
        return motion_of(arrays, service.twin, robot)
    except InputError as error:
        error.be_from(MOTION)
        raise


def n_quads(record: Record) -> bytes:
    """The record as it is kept."""
    quads = ox.serialize(record.quads(), format=ox.RdfFormat.N_QUADS)
    assert quads is not None, "without an output, the bytes are returned"
    return quads


def judged_of(verdicts: Iterable[Verdict]) -> tuple[Judged, ...]:
    """What is counted of them."""
    return tuple(Judged(each.outcome.value, each.stored, times(each)) for each in verdicts)


def replied(reply: Reply, encoding: str) -> Done:
    """The reply in the encoding of its request."""
    if encoding == CBOR:
        return Done(encode_cbor(reply), CBOR)
    return Done(encode(reply), JSON)


def _asked(answer: Answer) -> MetRequest | None:
    task = answer.case.task
    if not isinstance(task, Task) or not isinstance(task.container, str):
        return None
    return MetRequest(verb=task.verb.value, container=task.container)


def _tau(answer: Answer, encoding: str) -> Arrays | None:
    motion = answer.case.motion
    return _portable(arrays_of(motion), encoding) if answer.holds and isinstance(motion, Motion) else None


def _portable(arrays: dict[str, np.ndarray], encoding: str) -> Arrays:
    """Numbers as arrays in CBOR and as lists in JSON; names as lists in both."""
    return {
        name: array if encoding == CBOR and array.dtype.kind == "f" else array.tolist()
        for name, array in arrays.items()
    }
