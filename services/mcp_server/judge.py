"""What the process that judges for agents does: the same kitchens, motions of agents and what-ifs."""

import json
import logging
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Final

import pyoxigraph as ox

from predicates.case import Verdict
from predicates.record import StoredVerdict, to_json, to_record
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, SdtError
from sdt_kg.iri import Iri
from sdt_kg.load import model_name
from services.app import Oracles, Policy, Service, load
from services.judging.answers import motion_given, n_quads
from services.judging.codec import JSON, message_of
from services.judging.loaded import Models, check_same
from services.judging.messages import WhatIfRequest
from services.judging.problems import Problem, ProblemType, problem, problem_of
from services.judging.workers.jobs import Done, Handler, Kept, Quads, Task
from services.judging.worlds import Here, what_if
from services.relative import Relative
from services.store.records import recalled

KEPT: Final = 4
"""Combinations of kitchen, state and policy whose scenes are kept."""

Key = tuple[str, tuple[str, ...], Policy, Relative]
Head = dict[str, Any]  # JSON of the tool's arguments, and of the answer
_log = logging.getLogger("sdt.mcp.judge")


@dataclass(frozen=True, slots=True)
class JudgeSetup:
    """What the process loads: picklable, and makes its handler.

    Attributes:
        kitchens: Bundled names or paths.
        robots: Bundled names or paths, loaded with every kitchen.
        served: What they were when the server read them.
        oracles: Who answers for Φ and R; None: the process itself.
    """

    kitchens: tuple[str, ...]
    robots: tuple[str, ...]
    served: Models
    oracles: Callable[[], Oracles] | None = None

    def __call__(self) -> Handler:
        """Load everything."""
        services = {model_name(each): load(each, self.robots) for each in self.kitchens}
        oracles = None if self.oracles is None else self.oracles()
        kitchens, robots = ({model_name(each): each for each in of} for of in (self.kitchens, self.robots))
        return Judge(services, kitchens, robots, self.served, oracles)


@dataclass(slots=True)
class Judge:
    """The Law over some kitchens.

    Attributes:
        services: By the kitchen's name.
        kitchens, robots: Name → bundled name or path, as loaded.
        served: What all of it was when the server read it.
        oracles: Who answers for Φ and R; None: this process.
    """

    services: dict[str, Service]
    kitchens: dict[str, str]
    robots: dict[str, str]
    served: Models
    oracles: Oracles | None = None
    _kept: dict[Key, Service] = field(default_factory=dict[Key, Service])
    _quads: Quads | None = None

    def __call__(self, task: Task, recall: Quads) -> Done | Problem:
        """The answer as JSON, or what is wrong with the question."""
        self._quads = recall
        check_same((each.twin for each in self.services.values()), self.served)
        try:
            head = json.loads(task.payload)
            done = {"verify": self.verify, "what_if": self.what_if, "place": self.place}
            found, records = done[task.verb](head)
            return Done(json.dumps(found).encode(), JSON, records)
        except SdtError as error:
            return problem_of(error)
        except Exception:  # noqa: BLE001 - the edge of a process: logged, and answered as a failure
            _log.exception("a case could not be judged")
            return problem(ProblemType.INTERNAL, "the case could not be judged; the server's log says why")

    def verify(self, head: Head) -> tuple[Head, tuple[Kept, ...]]:
        """Verdicts about a motion that is given."""
        service = self._under(head)
        robot = service.robot(head["robot"])
        found = list(service.achieve(head["task"], robot, motion_given(service, head["motion"], robot)))
        return {"verdicts": [to_json(each) for each in found]}, _records(found)

    def what_if(self, head: Head) -> tuple[Head, tuple[Kept, ...]]:
        """What `sdt whatif --json` prints: of a change, of the smallest one, of a grid."""
        here = Here(self._under(head), head["kitchen"], self.kitchens, self.robots, self.served)
        fields = {name: head[name] for name in WhatIfRequest.model_fields.keys() & head.keys()}
        told = what_if(here, message_of(WhatIfRequest, fields))
        return told.said, tuple((each.iri, each.quads) for each in told.verdicts if each.is_fresh)

    def place(self, head: Head) -> tuple[Head, tuple[Kept, ...]]:
        """Where the base may stand, as JSON and as lines; nothing of it is kept."""
        from services.embodiment.place.answer import lines  # noqa: PLC0415 - seldom asked, loads much
        from services.embodiment.place.asked import placed  # noqa: PLC0415 - likewise

        service = self.services[head["kitchen"]].at(*head["state"])
        robot, friction = service.robot(head["robot"]), head["friction"]
        how = {"budget": head["budget"], "seed": head["seed"], "friction": friction}
        said = placed(service.twin, robot, head["task"], **how)
        return {"placement": said, "lines": list(lines(said, friction))}, ()

    def _recall(self, iri: Iri) -> StoredVerdict | None:
        """What the server keeps under a verdict's IRI."""
        assert self._quads is not None, "asked within a question"
        quads = self._quads(iri)
        return recalled(ox.parse(quads, format=ox.RdfFormat.N_QUADS), iri) if quads else None

    def _under(self, head: Head) -> Service:
        """The kitchen in this state under this policy; the last few keep their scenes."""
        policy = Policy(
            drive=_drive(head["drive"]),
            base=tuple(head["base"]) if head["base"] else None,
            budget=head["budget"],
            seed=head["seed"],
            any_start=head.get("any_start", False),
            contact=head.get("contact"),
            friction=head["friction"],
        )
        relative = Relative(head["tee"], handle_force=head["handle_force"])
        key = (head["kitchen"], tuple(head["state"]), policy, relative)
        service = self._kept.pop(key, None)
        if service is None:
            there = self.services[head["kitchen"]].at(*head["state"])
            there = replace(there, policy=policy, recall=self._recall, oracles=self.oracles)
            service = relative.of(there)
        while len(self._kept) >= KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[key] = service
        return service


def _drive(name: str | None) -> Drive | None:
    try:
        return None if name is None else Drive(name)
    except ValueError:
        raise InputError(f"no drive '{name}'", allowed=", ".join(each.value for each in Drive)) from None


def _records(verdicts: list[Verdict]) -> tuple[Kept, ...]:
    """IRI and N-Quads of each new verdict."""
    return tuple((each.iri, n_quads(to_record(each))) for each in verdicts if not each.stored)
