"""The process that judges for agents: kitchens loaded once, one question at a time over a socket.

Run as `python -m services.mcp_server.judge DESCRIPTOR`; the first frame says what to load.
"""

import logging
import signal
import socket
import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np
import pyoxigraph as ox

from predicates.case import Verdict
from predicates.counterfactual import Contrast
from predicates.record import StoredVerdict, diagnosis_json, read_verdict, to_json, to_record
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, NoModeError, SdtError
from sdt_kg.iri import Iri
from sdt_kg.load import model_name
from sdt_kg.motion import BodyMotion, Motion
from services.app import Oracles, Policy, Service, load
from services.motions.files import motion_of
from services.store.workers.confine import die_with_parent
from services.store.workers.frames import Head, packed, receive
from services.whatif import World, changed, parse_change

KEPT: Final = 4
"""Combinations of kitchen, state and policy whose scenes are kept."""

Key = tuple[str, tuple[str, ...], Policy]
Recall = Callable[[Iri], StoredVerdict | None]
_log = logging.getLogger("sdt.mcp.judge")


def main(descriptor: int) -> None:
    """Answer until the channel is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    die_with_parent()
    channel = socket.socket(fileno=descriptor)
    try:
        setup, _ = receive(channel)
        kitchens = {name: load(source, setup["robots"]) for name, source in setup["kitchens"].items()}
        robots = {model_name(each): each for each in setup["robots"]}
        judge = Judge(kitchens, robots, _asking(channel), _oracles(setup["connect"]))
        channel.sendall(packed({"ready": True}))
        while True:
            head, _ = receive(channel)
            channel.sendall(packed(_answered(judge, head)))
    except (EOFError, ConnectionError):
        return


def _oracles(endpoint: str | None) -> Oracles | None:
    """Φ and R on the bus; None: this process answers itself.

    Raises:
        BusUnavailableError: Nobody listens there.
    """
    if endpoint is None:
        return None
    from services.bus.oracles.remote import BusOracles  # noqa: PLC0415 - most need no bus
    from services.bus.sessions import Reach  # noqa: PLC0415 - see above

    oracles = BusOracles.on(Reach(endpoint)())
    return oracles  # pyright: ignore[reportReturnType]  # it caches what the Protocol has as an attribute


def _answered(judge: "Judge", head: Head) -> Head:
    try:
        return judge.what_if(head) if head["do"] == "what_if" else judge.verify(head)
    except InputError as error:
        return {"wrong": {"what": error.what, "allowed": error.allowed, "remedy": error.remedy}}
    except NoModeError as error:
        return {"wrong": {"what": str(error), "allowed": "", "remedy": ""}}
    except SdtError as error:
        return {"failed": str(error)}
    except Exception:  # noqa: BLE001 - the edge of a process: logged, and answered as a failure
        _log.exception("a case could not be judged")
        return {"failed": "the case could not be judged; the server's log says why"}


def _asking(channel: socket.socket) -> Recall:
    """What the server keeps under a verdict's IRI."""

    def recall(iri: Iri) -> StoredVerdict | None:
        channel.sendall(packed({"wanted": iri}))
        _, quads = receive(channel)
        return read_verdict(ox.parse(quads, format=ox.RdfFormat.N_QUADS), iri) if quads else None

    return recall


@dataclass(slots=True)
class Judge:
    """The Law over some kitchens.

    Attributes:
        services: By the kitchen's name.
        robots: Name → bundled name or path, as loaded.
        recall: What the server keeps under a verdict's IRI.
        oracles: Who answers for Φ and R; None: this process.
    """

    services: dict[str, Service]
    robots: dict[str, str]
    recall: Recall
    oracles: Oracles | None = None
    _kept: dict[Key, Service] = field(default_factory=dict[Key, Service])

    def verify(self, head: Head) -> Head:
        """Verdicts about a motion that is given."""
        service = self._under(head)
        robot = service.robot(head["robot"])
        found = list(service.achieve(head["task"], robot, _motion(service, head["motion"], robot)))
        return {"verdicts": [to_json(each) for each in found], "records": _records(found)}

    def what_if(self, head: Head) -> Head:
        """The verdict as it is, the verdict otherwise, and what differs."""
        service = self._under(head)
        name = service.twin.name(service.robot(head["robot"]))
        world = World(service, self.robots.get(name, name))
        other = changed(world, tuple(parse_change(each) for each in head["edits"]))
        found = Contrast(_one(world, head["task"]), _one(other, head["task"]))
        return {
            "turned": found.turned,
            "predicates": [list(each) for each in found.turned_predicates()],
            "no_longer": [diagnosis_json(each) for each in found.gone()],
            "now": [diagnosis_json(each) for each in found.new()],
            "actual": to_json(found.actual),
            "counterfactual": to_json(found.counterfactual),
            "records": _records([found.actual, found.counterfactual]),
        }

    def _under(self, head: Head) -> Service:
        """The kitchen in this state under this policy; the last few keep their scenes."""
        policy = Policy(
            drive=_drive(head["drive"]),
            base=tuple(head["base"]) if head["base"] else None,
            budget=head["budget"],
            seed=head["seed"],
            any_start=head.get("any_start", False),
        )
        key = (head["kitchen"], tuple(head["state"]), policy)
        service = self._kept.pop(key, None)
        if service is None:
            there = self.services[head["kitchen"]].at(*head["state"])
            service = replace(there, policy=policy, recall=self.recall, oracles=self.oracles)
        while len(self._kept) >= KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[key] = service
        return service


def _drive(name: str | None) -> Drive | None:
    try:
        return None if name is None else Drive(name)
    except ValueError:
        raise InputError(f"no drive '{name}'", allowed=", ".join(each.value for each in Drive)) from None


def _one(world: World, task: str) -> Verdict:
    found = list(world.service.achieve(task, world.robot_iri))
    if len(found) != 1:
        raise InputError(f"'{task}' is {len(found)} questions", allowed="one container: open:CONTAINER say")
    return found[0]


def _motion(
    service: Service, arrays: dict[str, Any], robot: Iri
) -> Motion | BodyMotion:  # JSON of the caller
    given: dict[str, np.ndarray] = {}
    for name, value in arrays.items():
        try:
            given[name] = np.asarray(value)
        except ValueError:
            raise InputError(f"'{name}' has rows of different lengths", allowed="a full array") from None
    return motion_of(given, service.twin, robot)


def _records(verdicts: list[Verdict]) -> list[tuple[Iri, str]]:
    """IRI and N-Quads of each new verdict."""
    new = [each for each in verdicts if not each.stored]
    return [(each.iri, "".join(f"{quad} .\n" for quad in to_record(each).quads())) for each in new]


if __name__ == "__main__":
    main(int(sys.argv[1]))
