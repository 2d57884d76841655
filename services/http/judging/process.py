"""The process that judges: kitchens loaded once, one question at a time over a socket.

Run as `python -m services.http.judging.process DESCRIPTOR`; the first frame says what to load.
"""

import logging
import signal
import socket
import sys
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pyoxigraph as ox

from predicates.case import Answer, Outcome, Verdict
from predicates.record import Record, StoredVerdict, diagnosis_json, read_verdict, to_json, to_record
from predicates.record.recall import Recall
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, SdtError
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import Task
from sdt_kg.twin import Twin
from services.app import Policy, Service, load
from services.compute import compute
from services.compute.run import Bounds, Loaded
from services.motions.files import arrays_of, motion_of
from services.store.workers.confine import die_with_parent
from services.store.workers.frames import Head, packed, receive

KEPT = 4
"""Combinations of state and policy whose scenes are kept."""

Key = tuple[str, tuple[str, ...], Policy]
_log = logging.getLogger("sdt.judge")


def main(descriptor: int) -> None:
    """Answer until the channel is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    die_with_parent()
    channel = socket.socket(fileno=descriptor)
    try:
        setup, _ = receive(channel)
        sources = tuple(setup["kitchens"].values())
        loaded = Loaded(sources, tuple(setup["robots"]))
        judge = Judge(
            {name: load(source, setup["robots"]) for name, source in setup["kitchens"].items()}, loaded
        )
        channel.sendall(packed({"ready": True}))
        while True:
            head, _ = receive(channel)
            channel.sendall(packed(_answered(judge, head, _Recall(channel))))
    except (EOFError, ConnectionError):
        return


def _answered(judge: "Judge", head: Head, recall: Recall) -> Head:
    try:
        if head["do"] == "compute":
            return judge.compute(head, recall)
        return judge.causes(head) if head["do"] == "causes" else judge.achieve(head, recall)
    except InputError as error:
        return {"wrong": {"what": error.what, "allowed": error.allowed, "remedy": error.remedy}}
    except SdtError as error:
        return {"failed": str(error)}
    except Exception:  # noqa: BLE001 - the edge of a process: logged, and answered as a failure
        _log.exception("a case could not be judged")
        return {"failed": "the case could not be judged; the service's log says why"}


class _Recall:
    """What the service holds under a verdict's IRI."""

    def __init__(self, channel: socket.socket) -> None:
        self._channel = channel

    def __call__(self, iri: Iri) -> StoredVerdict | None:
        self._channel.sendall(packed({"wanted": iri}))
        _, quads = receive(self._channel)
        return read_verdict(ox.parse(quads, format=ox.RdfFormat.N_QUADS), iri) if quads else None


@dataclass(slots=True)
class Judge:
    """The Law over some kitchens.

    Attributes:
        services: By the kitchen's name.
        loaded: The same, as a computation loads it.
    """

    services: dict[str, Service]
    loaded: Loaded
    _kept: dict[Key, Service] = field(default_factory=dict[Key, Service])

    def causes(self, head: Head) -> Head:
        """Motions that would cause the task, or whether the given one does."""
        service = self.services[head["kitchen"]].at(*head["states"])
        motion = _motion(service, head["motion"], None)
        if isinstance(motion, BodyMotion):
            raise InputError(
                "the motion is a robot's", allowed="a container's", remedy="POST /api/v1/achieve"
            )
        return {"answers": [_caused(answer) for answer in service.causes(head["task"], motion)]}

    def achieve(self, head: Head, recall: Recall) -> Head:
        """Verdicts, and the records of those that are new."""
        drive = Drive(head["drive"]) if head["drive"] else None
        base = tuple(head["base"]) if head["base"] else None
        policy = Policy(drive, base, head["budget"], head["seed"])
        service = self._under(head["kitchen"], tuple(head["states"]), policy, recall)
        robots = [service.robot(head["robot"])] if head["robot"] else service.twin.robots
        verdicts: list[Verdict] = []
        for robot in robots:
            motion = _motion(service, head["motion"], robot)
            verdicts += service.achieve(head["task"], robot, motion)
        reply: Head = {
            "verdicts": [to_json(verdict) for verdict in verdicts],
            "records": [[each.iri, _quads(each)] for each in verdicts if not each.stored],
        }
        return reply | ({"motions": [_certified(each) for each in verdicts]} if head["motions"] else {})

    def compute(self, head: Head, recall: Recall) -> Head:
        """What a query can touch and nobody has judged yet, judged within bounds."""
        keeper = _Keeper(recall)
        loaded = replace(self.loaded, states=tuple(head["states"]))
        computed = compute(head["query"], loaded, Bounds(head["budget"], head["limit"]), keeper)
        return {"computed": computed.to_json(), "records": keeper.records}

    def _under(self, kitchen: str, states: tuple[str, ...], policy: Policy, recall: Recall) -> Service:
        """The kitchen in this state under this policy; the last few keep their scenes."""
        key = (kitchen, states, policy)
        service = self._kept.pop(key, None)
        if service is None:
            service = replace(self.services[kitchen].at(*states), policy=policy, recall=recall)
        while len(self._kept) >= KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[key] = service
        return service


class _Keeper:
    """Where a computation finds verdicts, and what it wants to be kept.

    Attributes:
        records: IRI and N-Quads of each new verdict.
    """

    def __init__(self, recall: Recall) -> None:
        self._recall = recall
        self.records: list[tuple[Iri, str]] = []

    def stored(self, verdict: Iri) -> StoredVerdict | None:
        """What the service holds of the verdict."""
        return self._recall(verdict)

    def add_twin(self, twin: Twin) -> None:
        """The service has its twins already."""

    def add_record(self, record: Record) -> None:
        """To be kept when the computation is done."""
        self.records.append((record.verdict, _lines(record)))


def _motion(service: Service, arrays: dict[str, Any] | None, robot: Iri | None) -> Motion | BodyMotion | None:
    if arrays is None:
        return None
    try:
        given = {name: np.asarray(value) for name, value in arrays.items()}
    except ValueError as error:
        raise InputError(f"the motion has a list of lists of different lengths: {error}") from None
    return motion_of(given, service.twin, robot)


def _caused(answer: Answer) -> Head:
    motion, task = answer.case.motion, answer.case.task
    return {
        "task": task.verb.value if isinstance(task, Task) else None,
        "container": task.container if isinstance(task, Task) and isinstance(task.container, str) else None,
        "holds": answer.holds,
        "diagnoses": [diagnosis_json(each) for each in answer.diagnoses],
        "motion": _listed(motion) if isinstance(motion, Motion) else None,
    }


def _certified(verdict: Verdict) -> Head | None:
    motion = verdict.case.body_motion
    if verdict.outcome is not Outcome.CERTIFIED or not isinstance(motion, BodyMotion):
        return None
    return _listed(motion)


def _listed(motion: Motion | BodyMotion) -> Head:
    return {name: array.tolist() for name, array in arrays_of(motion).items()}


def _quads(verdict: Verdict) -> str:
    return _lines(to_record(verdict))


def _lines(record: Record) -> str:
    return "".join(f"{quad} .\n" for quad in record.quads())


if __name__ == "__main__":
    main(int(sys.argv[1]))
