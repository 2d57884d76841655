"""Verdicts for a report: from the store where they are there, judged and kept where not."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property

import pyoxigraph as ox

from predicates.case import Outcome, Verdict
from predicates.meant import counted
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.load import model_name
from sdt_kg.motion import BodyMotion
from sdt_kg.twin import Container
from services.app import DEFAULT_BUDGET, Policy, Service, load
from services.physics.model import Scene
from services.reports.scene.clip import Clip, body_clip
from services.reports.scene.view import View, view_of
from services.requests import parse_friction, parse_task, state_of_asked, states_of_all
from services.store.embedded import EmbeddedStore
from services.store.files import SavedVerdicts, only_read, readable
from services.sweep.cell import Cell as Case
from services.sweep.cell import CellResult
from services.table import run


@dataclass(frozen=True, slots=True)
class Judged:
    """One verdict.

    Attributes:
        robot: Name of the robot.
        container: Which it was asked about.
    """

    robot: str
    container: Container
    verdict: Verdict

    @property
    def certified(self) -> bool:
        """Whether all three predicates hold."""
        return self.verdict.outcome is Outcome.CERTIFIED

    @property
    def motion(self) -> BodyMotion | None:
        """The certified body motion."""
        motion = self.verdict.case.body_motion
        return motion if self.certified and isinstance(motion, BodyMotion) else None


@dataclass(frozen=True)
class Judgements:
    """All verdicts about some containers of a kitchen and some robots, robot by robot.

    Attributes:
        service: The kitchen with all robots.
        robots: Names, in the order in which they were asked for.
        all: In the order of robots, then containers.
        computed: How many were not stored.
    """

    service: Service
    verb: str
    robots: tuple[str, ...]
    all: tuple[Judged, ...]
    computed: int

    @cached_property
    def scenes(self) -> dict[str, Scene]:
        """Robot → kitchen and robot as one scene."""
        return {name: Scene(self.service.twin, self.service.robot(name)) for name in self.robots}

    def of(self, robot: str) -> tuple[Judged, ...]:
        """Those of one robot."""
        return tuple(each for each in self.all if each.robot == robot)

    def clip_name(self, one: Judged) -> str:
        """What a certified motion is called in the view."""
        return f"{one.robot}: {self.verb} {one.container.name}"

    def view(self) -> View:
        """Kitchen and robots, with every certified motion to play."""
        clips = list(self._clips())
        kitchen = self.service.twin.name(self.service.twin.environment)
        title = (
            f"Kitchen {kitchen}: {len(clips)} certified body motions."
            " Drag to turn, click and scroll to zoom; red: the path of each handle that can still be moved."
        )
        return view_of(self.service.twin, list(self.scenes.values()), title, clips)

    def _clips(self) -> Iterator[Clip]:
        for each in self.all:
            if each.motion is not None:
                yield body_clip(self.clip_name(each), self.scenes[each.robot], each.motion)


def judged(  # noqa: PLR0913 - the options of sdt table
    kitchen: str,
    robots: str,
    task: str = "open",
    *,
    state: str = "",
    drive: str = "",
    friction: str = "",
    budget: float = DEFAULT_BUDGET,
    store: str = "",
    jobs: int = 1,
) -> Judgements:
    """Every verdict that is asked for; what the store has not is judged, and kept there.

    Args:
        kitchen: Bundled name or path.
        robots: Bundled names or paths, comma-separated.
        task: `open`, `close`, or with containers `open:NAME,NAME`.
        state: `JOINT=VALUE` texts, comma-separated; everything is closed without it.
        drive: omni, differential or fixed; empty: as each robot's hardware does.
        friction: Coefficient with which fingers rub on handles, as text; empty: verdicts say what is needed.
        budget: Seconds of search for each container.
        store: Where verdicts are; empty: nowhere, and nothing is kept.
        jobs: Processes that judge.

    Raises:
        InputError: A name, state, drive or friction that does not exist.
    """
    names, states = _parts(robots), _parts(state)
    policy = policy_of(drive, budget=budget, friction=friction)
    service = load(kitchen, names, state=states_of_all(states), policy=policy)
    verb, _, chosen = task.partition(":")
    parse_task(service.twin, verb)
    containers = [service.twin.container(each) for each in _parts(chosen)] or list(counted(service.twin))
    with opened(store) as saved:
        service = replace(service, recall=saved.stored)
        own = {one: state_of_asked(states, one.name) for one in containers}
        asked = [(name, one, service.at(*own[one])) for name in names for one in containers]
        missing = [
            (Case(kitchen, name, f"{verb}:{one.name}", own[one], policy), there.twin)
            for name, one, there in asked
            if there.stored(f"{verb}:{one.name}", model_name(name)) is None
        ]
        check_kept(store, len(missing))
        for twin in {twin.state: twin for _, twin in missing}.values():
            saved.add_twin(twin)
        if missing:
            run([case for case, _ in missing], jobs, lambda result: _keep(saved, result))
        found = [
            Judged(model_name(name), one, next(there.achieve(f"{verb}:{one.name}", model_name(name))))
            for name, one, there in asked
        ]
    return Judgements(service, verb, tuple(map(model_name, names)), tuple(found), len(missing))


def policy_of(
    drive: str = "",
    base: tuple[float, float, float] | None = None,
    budget: float = DEFAULT_BUDGET,
    friction: str = "",
) -> Policy:
    """The policy of texts.

    Raises:
        InputError: No such drive, or no coefficient of friction.
    """
    known = [each.value for each in Drive]
    if drive and drive not in known:
        raise InputError(f"no drive '{drive}'", allowed=", ".join(known))
    return Policy(Drive(drive) if drive else None, base, budget, friction=parse_friction(friction))


@contextmanager
def opened(store: str) -> Iterator[SavedVerdicts]:
    """The store, as it is where it can only be read; or one in memory where none is named."""
    place = readable(store) if only_read(store) else store or EmbeddedStore(ox.Store())
    with SavedVerdicts(place) as saved:
        yield saved


def check_kept(store: str, missing: int) -> None:
    """What is missing in the store can be kept there.

    Raises:
        InputError: It cannot, and nothing was judged in vain.
    """
    if missing and only_read(store):
        raise InputError(
            f"{missing} verdicts of the report are not in {store}, which can only be read",
            remedy="copy it to where it can be written, or leave --store out",
        )


def _keep(saved: SavedVerdicts, result: CellResult) -> None:
    saved.add_record(result.record)


def _parts(text: str) -> Sequence[str]:
    return [each.strip() for each in text.split(",") if each.strip()]
