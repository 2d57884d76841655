"""What the worker of an oracle does: rebuild twins from their graphs, and ask Φ or R about them."""

import logging
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import pyoxigraph as ox

from predicates.oracle import Embodiment, Physics
from sdt_kg.errors import GraphError, InputError, SdtError
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Twin
from services.bus.keys import Oracle
from services.bus.oracles.codec import (
    Plain,
    answer_plain,
    case_value,
    motion_plain,
    motion_value,
    policy_value,
    region_value,
    replayed_plain,
    twin_key,
)
from services.bus.oracles.own import own_embodiment, own_physics
from services.judging.codec import CBOR, from_cbor, to_cbor
from services.judging.problems import Problem, ProblemType, problem, problem_of
from services.judging.workers.jobs import Done, Handler, Task
from services.relative import TeeName, tee_of

log = logging.getLogger(__name__)

TWINS_KEPT = 8
"""Twins (kitchen with robots, whatever the state) that an oracle keeps."""
UNKNOWN_TWIN = "this oracle does not hold that twin: send its quads"


@dataclass(frozen=True, slots=True)
class OracleSetup:
    """Makes the handler of an oracle's worker; picklable."""

    kind: Oracle

    def __call__(self) -> Handler:
        """Load what the oracle is made of."""
        return Causing() if self.kind is Oracle.CAUSES else Performing()


class UnknownTwinError(SdtError):
    """The twin has not been sent, or was forgotten."""


class OtherVersionError(SdtError):
    """The verdict would name a version that did not judge."""


class UnreadTwinError(SdtError):
    """The twin cannot be read here: it is of another version perhaps, or its files are elsewhere."""


@dataclass(slots=True)
class Twins:
    """The twins that were sent lately, by their key."""

    _known: OrderedDict[str, Twin] = field(default_factory=OrderedDict[str, Twin])

    def of(self, plain: Mapping[str, Any]) -> Twin:
        """The twin that is meant, in the state that is meant.

        Raises:
            UnknownTwinError: Its quads are needed.
            UnreadTwinError: They are no twin for this version, on this machine.
            GraphError: They are not the one that the key says.
        """
        key = str(plain["key"])
        if "quads" in plain:
            quads = list(ox.parse(plain["quads"], format=ox.RdfFormat.N_QUADS))
            robots = [str(robot) for robot in plain["robots"]]
            try:
                sent = Twin.from_quads(quads, plain["environment"], robots)
            except GraphError as error:
                raise UnreadTwinError(f"this oracle cannot read that twin: {error.what}") from None
            if twin_key(sent) != key:  # others ask by the key alone
                raise GraphError(f"the quads are {twin_key(sent)}, and the key is {key}", allowed="one twin")
            self._known[key] = sent
        if key not in self._known:
            raise UnknownTwinError(UNKNOWN_TWIN)
        self._known.move_to_end(key)
        while len(self._known) > TWINS_KEPT:
            self._known.popitem(last=False)
        return self._known[key].at(plain["state"])


def _handled(answer: Callable[[str, TeeName, Plain], object], task: Task) -> Done | Problem:
    """The answer as CBOR, or what is wrong; the question is `VERB` or `VERB;CLASS`."""
    verb, _, tee = task.verb.partition(";")
    try:
        return Done(to_cbor(answer(verb, tee_of(tee or "d_artic"), _fields(task.payload))), CBOR)
    except (UnknownTwinError, OtherVersionError, UnreadTwinError) as error:
        return problem(ProblemType.CONFLICT, str(error))
    except SdtError as error:
        return problem_of(error)
    except Exception:  # the edge of a process: logged, and answered as a failure
        log.exception("an oracle failed at %s", task.verb)
        return problem(ProblemType.INTERNAL, f"{task.verb} failed; the oracle's log says why")


def _check_version(own: str, plain: Plain) -> None:
    if plain["version"] != own:
        raise OtherVersionError(f"this oracle is '{own}', and '{plain['version']}' is asked")


def _fields(payload: bytes) -> Plain:
    """What was sent.

    Raises:
        InputError: It is no map.
    """
    plain = from_cbor(payload)
    if not isinstance(plain, dict):
        raise InputError(f"the question is a {type(plain).__name__}", allowed="a map of named fields")
    return plain


class Causing:
    """Φ in a worker's process."""

    def __init__(self) -> None:
        self._twins = Twins()
        tees: tuple[TeeName, ...] = ("d_artic", "d_artic_dyn")
        self._physics: dict[TeeName, Physics] = {tee: own_physics(tee) for tee in tees}

    def __call__(self, task: Task, recall: Callable[[str], bytes | None]) -> Done | Problem:
        """Answer version, replay, generate or carried."""
        del recall
        return _handled(self._answer, task)

    def _answer(self, verb: str, tee: TeeName, plain: Plain) -> object:
        physics = self._physics[tee]
        if verb == "version":
            return physics.version
        if verb not in {"replay", "generate", "carried"}:
            raise InputError(f"no question '{verb}'", allowed="version, replay, generate, carried")
        _check_version(physics.version, plain)
        twin = self._twins.of(plain["twin"])
        if verb == "replay":
            return replayed_plain(physics.replay(twin, motion_value(Motion, plain["motion"])))
        if verb == "generate":
            return [motion_plain(each) for each in physics.generate(twin, region_value(plain["goal"]))]
        body_motion = motion_value(BodyMotion, plain["body_motion"])
        return motion_plain(physics.carried(twin, body_motion, twin.container(plain["container"])))


class Performing:
    """CanPerform in a worker's process; each policy keeps its scenes."""

    def __init__(self) -> None:
        self._twins = Twins()
        self._known: dict[str, Embodiment] = {}

    def __call__(self, task: Task, recall: Callable[[str], bytes | None]) -> Done | Problem:
        """Answer version, settings or perform."""
        del recall
        return _handled(self._answer, task)

    def _answer(self, verb: str, tee: TeeName, plain: Plain) -> object:
        embodiment = self._under(plain["policy"], tee)
        if verb == "version":
            return embodiment.version
        if verb not in {"settings", "perform"}:
            raise InputError(f"no question '{verb}'", allowed="version, settings, perform")
        _check_version(embodiment.version, plain)
        twin = self._twins.of(plain["twin"])
        if verb == "settings":
            return [list(each) for each in embodiment.settings(twin, plain["robot"])]
        return answer_plain(embodiment.perform(case_value(twin, plain["case"])))

    def _under(self, plain: Plain, tee: TeeName) -> Embodiment:
        policy = policy_value(plain)
        key = f"{tee} {policy}"
        if key not in self._known:
            self._known = {
                key: own_embodiment(tee, policy),
                **dict(list(self._known.items())[: TWINS_KEPT - 1]),
            }
        return self._known[key]
