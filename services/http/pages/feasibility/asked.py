"""What a page about a kitchen is asked: its state, the task, the drive."""

from dataclasses import dataclass

from starlette.requests import Request

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name
from sdt_kg.task import Verb
from sdt_kg.twin import Twin
from services.http.kitchens import Kitchen
from services.http.pages.asking import Wish
from services.http.world import World


@dataclass(frozen=True, slots=True)
class Asked:
    """What a matrix is about.

    Attributes:
        kitchen: As it is served.
        twin: In the state that is asked about.
        states: Texts of that state, on top of the present one.
        verb: Of the task.
        drive: How all bases move; None takes each robot's own.
    """

    kitchen: Kitchen
    twin: Twin
    states: tuple[str, ...]
    verb: Verb
    drive: Drive | None

    def drive_of(self, robot: Iri) -> str | None:
        """How a robot's base moves; None for a robot which is not loaded."""
        if self.drive is not None:
            return self.drive.value
        return self.twin.robot(robot).drive.value if robot in self.twin.robots else None

    def wish(self, robot: str, container: str) -> Wish:
        """One case of it, to be judged."""
        pinned = (*self.kitchen.states, *self.states)
        drive = None if self.drive is None else self.drive.value
        return Wish(self.kitchen.name, robot, f"{self.verb.value}:{container}", pinned, drive)


def asked_of(request: Request, world: World) -> Asked:
    """What the URL asks about.

    Raises:
        InputError: No such kitchen, task, drive or state.
    """
    kitchen = world.kitchen(request.path_params["kitchen"])
    states = tuple(each for text in request.query_params.getlist("state") for each in text.split())
    return asked_about(
        kitchen, request.query_params.get("task", ""), request.query_params.get("drive", ""), states
    )


def asked_about(kitchen: Kitchen, task: str, drive: str, states: tuple[str, ...]) -> Asked:
    """A kitchen, verb, drive and state, as people type them."""
    twin = kitchen.service.at(*states).twin if states else kitchen.twin
    verbs, drives = [each.value for each in Verb], [each.value for each in Drive]
    if task and task not in verbs:
        raise InputError(f"no task type '{task}'", allowed=", ".join(verbs))
    if drive and drive not in drives:
        raise InputError(f"no drive '{drive}'", allowed=", ".join(drives))
    return Asked(kitchen, twin, states, Verb(task) if task else Verb.OPEN, Drive(drive) if drive else None)


def moved(twin: Twin) -> list[str]:
    """Joints that are not where the kitchen starts, with their positions."""
    start = twin.entities.coupling.start()
    return [f"{local_name(joint)}={at:.6g}" for joint, at in sorted(twin.state.items()) if at != start[joint]]
