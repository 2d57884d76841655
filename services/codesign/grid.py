"""Product grids: every container, for every robot, in every combination of edits, in worker processes."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import product

from predicates.meant import counted
from sdt_kg.errors import InputError, SdtError
from sdt_kg.load import load_twin, model_name
from services.app import load
from services.codesign.again import whole_body
from services.codesign.asked import Asked
from services.codesign.entries import Entry, Found, Grid, lost, no_world
from services.codesign.judge import Judge, judged_as_it_is
from services.requests import state_joints
from services.sweep.executors.engines import Loading, cpu_seconds
from services.sweep.executors.handed import each_or_lost
from services.sweep.executors.piece import Lost
from services.whatif import World, changed, depends_on_robot

Key = tuple[str, str, str]
"""Kitchen, robot and container."""
Base = dict[Key, Found]
Report = Callable[[Entry], None]


@dataclass(frozen=True, slots=True)
class Job:
    """Some entries of one kitchen, robot and world, for one process."""

    kitchen: str
    robot: str
    containers: tuple[str, ...]
    edits: tuple[str, ...]

    @property
    def key(self) -> Key:
        """Of the entry of its first container in the world as it is."""
        return self.kitchen, self.robot, self.containers[0]

    @property
    def world(self) -> tuple[str, tuple[str, ...]]:
        """What is loaded and made once for all robots."""
        return self.kitchen, self.edits


def run(
    asked: Asked, jobs: int, report: Report = lambda entry: None, kept: Mapping[Key, Found] | None = None
) -> Grid:
    """All entries, the worlds as they are first; each is reported as soon as it is there.

    Args:
        asked: What the grid is about.
        jobs: Processes.
        report: Told of each entry that is judged.
        kept: What is known of the worlds as they are and is not judged again.

    Raises:
        InputError: A kitchen, robot, state or container that is not there; an edit that can be made nowhere.
    """
    began, cpu_began = time.perf_counter(), cpu_seconds()
    names = _containers(asked)
    check_edits(asked)
    first = [
        Job(kitchen, robot, (container,), ())
        for kitchen in asked.kitchens
        for robot in asked.robots
        for container in names[kitchen]
    ]
    entries = [Entry(*key, (), found) for key, found in (kept or {}).items()]
    fresh = [each for each in first if each.key not in (kept or {})]
    entries += results(asked, partial(_as_it_is, asked), fresh, jobs, report)
    base: Base = {each.key: replace(each.found, record=None) for each in entries}
    more = [
        Job(kitchen, robot, names[kitchen], edits)
        for kitchen in asked.kitchens
        for edits in asked.worlds
        for robot in asked.robots
    ]
    entries += results(asked, partial(_otherwise, asked, base), more, jobs, report)
    worlds = {edits: number for number, edits in enumerate(((), *asked.worlds))}
    order = {each.key: n for n, each in enumerate(first)}
    entries.sort(key=lambda each: (worlds[each.edits], order[each.key]))
    return Grid(entries, time.perf_counter() - began, cpu_seconds() - cpu_began)


def _containers(asked: Asked) -> dict[str, tuple[str, ...]]:
    """Kitchen → names of the containers that are asked about."""
    found: dict[str, tuple[str, ...]] = {}
    states: set[str] = set()
    for kitchen in asked.kitchens:
        twin = load_twin(kitchen)
        own = tuple(each.name for each in counted(twin))
        found[kitchen] = tuple(each for each in own if each in asked.containers) if asked.containers else own
        states.update(state_joints(twin, asked.states))
    unknown = set(asked.containers) - {name for names in found.values() for name in names}
    if unknown:
        raise InputError(f"no kitchen has a container {', '.join(sorted(unknown))}")
    if unused := set(asked.states) - states:
        raise InputError(f"no kitchen has a joint for: {', '.join(sorted(unused))}")
    for models in (asked.kitchens, asked.robots):
        if len({model_name(each) for each in models}) < len(models):
            raise InputError(f"two models share a name: {', '.join(models)}", allowed="each model once")
    return found


def check_edits(asked: Asked) -> None:
    """Each edit can be made somewhere: alone, or where another was made before.

    Raises:
        InputError: One can be made in no kitchen, with no robot; as the first of them has it.
    """
    for text in dict.fromkeys(text for edits in asked.worlds for text in edits):
        worlds = [(text,), *(edits for edits in asked.worlds if text in edits)]
        errors = (_no_world(asked, edits) for edits in worlds)
        first = next(errors)
        if first is not None and all(errors):
            raise first


def _no_world(asked: Asked, edits: tuple[str, ...]) -> InputError | None:
    """Why the edits can be made in no kitchen, with no robot; None where they can."""
    robots = asked.robots if any(depends_on_robot(each) for each in edits) else asked.robots[:1]
    error = None
    for kitchen, robot in product(asked.kitchens, robots):
        try:
            _made(asked, kitchen, edits, robot)
        except InputError as found:
            error = error or found
        else:
            return None
    return error


def results(
    asked: Asked, work: Callable[[Job], list[Entry]], todo: Sequence[Job], jobs: int, report: Report
) -> Iterator[Entry]:
    """Every entry as soon as it is there.

    A job that kills its process twice is begun again container by container: only the one that kills has
    no verdict.
    """
    prepare, apart = Loading(partial(_prepare, asked)), list[Job]()
    for job, found in each_or_lost(todo, jobs, work, prepare, lambda job: job.world):
        if isinstance(found, Lost) and len(job.containers) > 1:
            apart += [replace(job, containers=(each,)) for each in job.containers]
            continue
        for entry in [_lost_entry(job, found)] if isinstance(found, Lost) else found:
            report(entry)
            yield entry
    if apart:
        yield from results(asked, work, apart, jobs, report)


def _lost_entry(job: Job, found: Lost) -> Entry:
    return Entry(job.kitchen, job.robot, job.containers[0], job.edits, lost(found.reason))


def _prepare(asked: Asked, job: Job) -> None:
    """Worlds as they are and compiled loops are loaded once, before processes begin as copies of this one.

    What cannot be loaded is told by the job.
    """
    with suppress(SdtError):
        before = ground(asked, job.kitchen)
        for robot in asked.robots:
            world = replace(before, robot=robot)
            whole_body(world.service).prepare(world.service.twin, world.robot_iri)


def _as_it_is(asked: Asked, job: Job) -> list[Entry]:
    world = replace(ground(asked, job.kitchen), robot=job.robot)
    return [
        Entry(job.kitchen, job.robot, each, (), judged_as_it_is(world, asked.verb, each))
        for each in job.containers
    ]


def _otherwise(asked: Asked, base: Base, job: Job) -> list[Entry]:
    """All entries of one kitchen and robot in an edited world."""
    before = replace(ground(asked, job.kitchen), robot=job.robot)
    known = {each.iri: each for each in base.values()}
    entries: list[Entry] = []
    try:
        judge = Judge(before, _edited(asked, job), known)
    except InputError as error:
        none = no_world(error)
        return [Entry(job.kitchen, job.robot, each, job.edits, none) for each in job.containers]
    for each in job.containers:
        found = _found(judge, asked.verb, each, base[job.kitchen, job.robot, each])
        entries.append(Entry(job.kitchen, job.robot, each, job.edits, found))
    return entries


def _edited(asked: Asked, job: Job) -> World:
    """The edited world, asked of the job's robot; one of the kitchen alone is made once for all robots."""
    if any(depends_on_robot(each) for each in job.edits):
        return _made(asked, job.kitchen, job.edits, job.robot)
    return replace(_made(asked, job.kitchen, job.edits, asked.robots[0]), robot=job.robot)


@lru_cache(maxsize=1)
def _made(asked: Asked, kitchen: str, edits: tuple[str, ...], robot: str) -> World:
    """Kept in each process for the jobs that follow each other."""
    before = replace(ground(asked, kitchen), robot=robot)
    return changed(before, tuple(map(asked.parse, edits)))


def _found(judge: Judge, verb: str, container: str, base: Found) -> Found:
    try:
        return judge.judged(f"{verb}:{container}", base)
    except InputError as error:  # the container is gone, say
        return no_world(error)


@lru_cache(maxsize=2)
def ground(asked: Asked, kitchen: str) -> World:
    """A kitchen as it is with all robots; loaded once in each process for the jobs that follow each other."""
    states = tuple(state_joints(load_twin(kitchen), asked.states)) if asked.states else ()
    service = load(kitchen, asked.robots, state=states, policy=asked.policy)
    return World(asked.relative.of(service), asked.robots[0])
