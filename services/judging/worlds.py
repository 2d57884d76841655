"""Other worlds, as somebody elsewhere asks about them: a change, the smallest change, a grid."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from predicates.case import Verdict
from predicates.meant import counted
from predicates.record import to_record
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from services.app import Service
from services.codesign.again import whole_body
from services.codesign.asked import Asked, check_size, task_of_grid, worlds_of
from services.codesign.entries import Found, How, found_of
from services.codesign.grid import Key, ground, run
from services.codesign.report import to_json
from services.codesign.smallest.sought import Question, world_of
from services.codesign.smallest.told import turned_json
from services.codesign.smallest.turning import turned
from services.judging.answers import judged_of, n_quads
from services.judging.loaded import Models, check_same
from services.judging.messages import WhatIfRequest
from services.policy import DEFAULT_WITHIN
from services.requests import state_texts
from services.telemetry.metrics import Judged
from services.whatif import Change, World, answered, named_change

ONE: Final = 1
"""[1] Processes: this one."""

Json = dict[str, Any]  # JSON object


@dataclass(frozen=True, slots=True)
class Here:
    """The world as it is, in a process that judges.

    Attributes:
        service: In the state, under the policy and relative to the class that are asked about.
        name: Of the kitchen, as it is served.
        kitchens, robots: Name → bundled name or path, as loaded.
        served: What all of it was when the service read it.
    """

    service: Service
    name: str
    kitchens: Mapping[str, str]
    robots: Mapping[str, str]
    served: Models

    @property
    def kitchen(self) -> str:
        """Bundled name or path."""
        return self.kitchens[self.name]

    def robot(self, name: str | None) -> str:
        """Bundled name or path of a robot; its name where it came with the kitchen."""
        own = self.service.twin.name(self.service.robot(name))
        return self.robots.get(own, own)

    def change(self, text: str) -> Change:
        """What an edit means that may name no file."""
        return named_change(text, {"kitchen": self.kitchens, "robot": self.robots})


@dataclass(frozen=True, slots=True)
class One:
    """A verdict that an answer tells.

    Attributes:
        quads: Its record as N-Quads.
        is_here: Whether it is about the world as it is.
        is_fresh: Whether nobody has kept it yet.
    """

    iri: Iri
    quads: bytes
    is_here: bool
    is_fresh: bool


@dataclass(frozen=True, slots=True)
class Told:
    """An answer.

    Attributes:
        said: The object that `sdt whatif --json` prints.
        verdicts: Those which it tells; where no single world is named, of the world as it is alone.
        judged: What is counted.
    """

    said: Json
    verdicts: tuple[One, ...]
    judged: tuple[Judged, ...]


def what_if(here: Here, asked: WhatIfRequest) -> Told:
    """What `sdt whatif --json` prints about the same.

    Raises:
        InputError: Nothing is asked, or two things at once; or what is asked is wrong, said before anything
            is judged.
        OtherModelsError: Files have changed since the service began.
    """
    _check(asked)
    if asked.grid:
        return _grid(here, asked)
    return _named(here, asked) if asked.edits else _smallest(here, asked)


def _check(asked: WhatIfRequest) -> None:
    if asked.grid and asked.turn:
        raise InputError("a grid and a turn are two questions", allowed="one of 'grid' and 'turn'")
    if not asked.edits and not asked.turn:
        raise InputError(
            "no other world is asked about",
            allowed="'edits', as sdt whatif --edit takes them; or 'turn' without edits",
            remedy="'turn' alone looks for the smallest change of every kind",
        )
    if asked.within is not None and (asked.edits or asked.grid):
        raise InputError("'within' says nothing where edits are named", allowed="'turn' without edits")


def _named(here: Here, asked: WhatIfRequest) -> Told:
    """One other world, or shares of it."""
    changes = [here.change(each) for each in asked.edits]
    world = World(here.service, here.robot(asked.robot))
    said, verdicts = answered(world, asked.task, changes, turn=asked.turn)
    told = {each["iri"] for each in (said["actual"], said["counterfactual"]) if each}
    first = verdicts[0].iri
    ones = {
        each.iri: One(each.iri, n_quads(to_record(each)), each.iri == first, not each.stored)
        for each in reversed(verdicts)
        if each.iri in told
    }
    return Told(said, tuple(reversed(ones.values())), judged_of(verdicts))


def _smallest(here: Here, asked: WhatIfRequest) -> Told:
    """The smallest change of each kind."""
    service = here.service
    whole_body(service)
    case = here.kitchen, here.robot(asked.robot), asked.task
    question = Question(*case, state_texts(service.twin), service.policy, asked.relative)
    check_same([world_of(question).service.twin], here.served)
    found = turned(question, asked.within or DEFAULT_WITHIN, ONE)
    return Told(turned_json(found), *_as_it_is(here, {}, [found.actual]))


def _grid(here: Here, asked: WhatIfRequest) -> Told:
    """Every container, for every robot that is meant, in every combination of the edits."""
    service, twin = here.service, here.service.twin
    whole_body(service)
    verb, containers = task_of_grid(asked.task)
    names = [asked.robot] if asked.robot else [twin.name(each) for each in twin.robots]
    meant = containers or tuple(each.name for each in counted(twin))
    check_size(asked.edits, len(names) * len(meant))
    robots = {name: here.robot(name) for name in names}
    worlds = worlds_of(asked.edits, here.change)
    cases = Asked(
        (here.kitchen,),
        tuple(robots.values()),
        verb,
        worlds,
        service.policy,
        state_texts(twin),
        containers,
        asked.relative,
        partial(Here.change, here),
    )
    check_same([ground(cases, here.kitchen).service.twin], here.served)
    stored = {
        (here.kitchen, robots[name], container): verdict
        for name in names
        for container in meant
        for verdict in service.stored(f"{verb}:{container}", name) or ()
    }
    kept = {key: found_of(each, How.KEPT, 0.0) for key, each in stored.items()}
    grid = run(cases, ONE, kept=kept)
    fresh = [each.found for each in grid.entries if not each.edits]
    return Told(to_json(grid), *_as_it_is(here, stored, fresh))


def _as_it_is(
    here: Here, stored: Mapping[Key, Verdict], found: list[Found]
) -> tuple[tuple[One, ...], tuple[Judged, ...]]:
    """Verdicts about the world as it is, stored ones and those that were judged now; what is kept stays."""
    old = [One(each.iri, n_quads(to_record(each)), True, False) for each in stored.values()]
    new = [
        One(each.iri, n_quads(each.record), True, here.service.recall(each.iri) is None)
        for each in found
        if each.record is not None
    ]
    fresh = (Judged(each.outcome.value, False, {}) for each in found if each.record and each.outcome)
    return (*old, *new), (*judged_of(stored.values()), *fresh)
