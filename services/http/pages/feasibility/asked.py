"""What a page about a kitchen is asked: its state, the task, the drive, the friction."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

from starlette.requests import Request

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name
from sdt_kg.scope import D_ARTIC, TEE_CLASSES, TeeClass
from sdt_kg.task import Verb
from sdt_kg.twin import Twin
from services.http.kitchens import Kitchen
from services.http.pages.asking import Wish
from services.http.protocol.exchange import check_spelling
from services.http.world import World
from services.requests import parse_friction, state_texts

T = TypeVar("T")

STATE: Final = re.compile(r"[^=]+(?:=\s*\S*)?")
"""A name, which may have blanks in it, and a value, which has none."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What a matrix is about.

    Attributes:
        kitchen: As it is served.
        twin: In the state that is asked about.
        states: Texts of that state, on top of the present one.
        verb: Of the task.
        drive: How all bases move; None takes each robot's own.
        tee: The class D that verdicts are to be relative to.
        friction: Coefficient with which fingers rub on handles [1]; None: verdicts say what is needed.
    """

    kitchen: Kitchen
    twin: Twin
    states: tuple[str, ...]
    verb: Verb
    drive: Drive | None
    tee: TeeClass = D_ARTIC
    friction: float | None = None

    def drive_of(self, robot: Iri) -> str | None:
        """How a robot's base moves; None for a robot which is not loaded."""
        if self.drive is not None:
            return self.drive.value
        return self.twin.robot(robot).drive.value if robot in self.twin.robots else None

    def wish(self, robot: str, container: str) -> Wish | None:
        """One case of it, to be judged; None for a class that the judges of this service do not ask about."""
        if self.tee != D_ARTIC or robot not in map(local_name, self.twin.robots):
            return None
        drive = None if self.drive is None else self.drive.value
        task, states = f"{self.verb.value}:{container}", state_texts(self.twin)
        return Wish(self.kitchen.name, robot, task, states, drive, self.friction)


def asked_of(request: Request, world: World) -> Asked:
    """What the URL asks about.

    Raises:
        InputError: No such kitchen, task, drive, class, friction or state, or one of these words misspelled.
    """
    return asked_about(world.kitchen(request.path_params["kitchen"]), request.query_params.multi_items())


def asked_about(kitchen: Kitchen, fields: Sequence[tuple[str, str]]) -> Asked:
    """What the fields of a URL or form ask: task, drive, class, friction, state."""
    check_spelling(fields, ("task", "drive", "class", "friction", "state"))
    wanted = dict(fields)
    states = tuple(each for name, text in fields if name == "state" for each in _split(text))
    verbs, drives = {each.value: each for each in Verb}, {each.value: each for each in Drive}
    classes = {each.name: each for each in TEE_CLASSES}
    return Asked(
        kitchen,
        kitchen.service.at(*states).twin if states else kitchen.twin,
        states,
        _one(verbs, "task type", wanted.get("task")) or Verb.OPEN,
        _one(drives, "drive", wanted.get("drive")),
        _one(classes, "class", wanted.get("class")) or D_ARTIC,
        parse_friction(wanted.get("friction", "")),
    )


def _split(text: str) -> list[str]:
    """`JOINT=VALUE` texts that blanks part; there may be blanks in the name of a joint, too."""
    return [each.strip() for each in STATE.findall(text) if each.strip()]


def _one(known: Mapping[str, T], what: str, name: str | None) -> T | None:
    """What has this name; None without one.

    Raises:
        InputError: Nothing has.
    """
    if not name:
        return None
    if name not in known:
        raise InputError(f"no {what} '{name}'", allowed=", ".join(known))
    return known[name]


def moved(twin: Twin) -> list[str]:
    """Joints that are not where the kitchen starts, with their positions."""
    start = twin.entities.coupling.start()
    return [f"{local_name(joint)}={at!r}" for joint, at in sorted(twin.state.items()) if at != start[joint]]
